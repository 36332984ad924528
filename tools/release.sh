#!/usr/bin/env bash
# Builds a release into the folder `dist/`: the program, statically linked where the target for it is installed, and the Python wheel.
#
#     tools/release.sh          needs Rust, and maturin (or python3 with venv and a package index)
set -euo pipefail
cd "$(dirname "$0")/.."

version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
static=x86_64-unknown-linux-musl
native=$(rustc -vV | sed -n 's/^host: //p')
dist=dist
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

step() { printf '\n== %s\n' "$*"; }
say() { printf '%s\n' "$*"; }

grep -q "^## $version " CHANGELOG.md || { echo "error: CHANGELOG.md has no section for $version" >&2; exit 1; }
mkdir -p "$dist"

step "program, version $version"
if [[ -d "$(rustc --print sysroot)/lib/rustlib/$static/lib" ]]; then
    target=$static
    say "statically linked ($static): runs on any Linux with this processor"
else
    target=$native
    say "dynamically linked ($native): the target $static is not installed (rustup target add $static)"
fi
cargo build --release --locked --package alula-cli --target "$target"
name=alula-$version-$target
mkdir -p "$scratch/$name"
cp "${CARGO_TARGET_DIR:-target}/$target/release/alula" README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE "$scratch/$name/"
tar -C "$scratch" -czf "$dist/$name.tar.gz" "$name"
"$scratch/$name/alula" --version

step "wheel"
maturin=$(command -v maturin || true)
if [[ -z $maturin ]]; then
    python3 -m venv "$scratch/venv"
    "$scratch/venv/bin/pip" install --quiet --disable-pip-version-check maturin
    maturin=$scratch/venv/bin/maturin
fi
"$maturin" build --release --locked --manifest-path python/Cargo.toml --out "$dist"

step "$dist"
(cd "$dist" && sha256sum ./*"$version"* | tee SHA256SUMS)
