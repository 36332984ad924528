# `just` lists the recipes, `just check` is what CI runs.

_default:
    @just --list

# everything that CI runs
check:
    .ci/run

# the command line tool, again after a change: one line of `scheme` takes 25 s, of the edge flux itself 55 s; same bits, same speed
build:
    CARGO_INCREMENTAL=1 cargo build --release

# format the sources
fmt:
    cargo fmt --all

# warnings are errors
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings

# lines of Rust outside tests, room by room
lines-of-code:
    tools/lines.py

# the tests of the README
test:
    cargo test --release --workspace

# those that take long
test-long:
    cargo test --release --workspace -- --ignored

# mutated inputs, killed runs, a public database of sections, odd surfaces, error bars of forces and shocks that come to rest, for the night; they print what is not survived
night count="10000":
    cargo build --release
    tests/nightly/mutate.py target/release/alula --count {{count}} --seed $(date +%j)
    tests/nightly/kill.py target/release/alula --count 300 --seed $(date +%j)
    tests/nightly/sections.py target/release/alula
    tests/nightly/surfaces.py target/release/alula --plain
    tests/nightly/forces.py target/release/alula
    tests/nightly/steady.py target/release/alula

# pages of the book in target/book, by mdBook 0.5
pages:
    mdbook build book
    python3 tests/read_book.py target/book

# bring the generated pages of the book up to date
book:
    ALULA_WRITE=1 cargo test --release --workspace --test tidy
    ALULA_WRITE=1 cargo test --release --workspace --test command book

# the table of accuracy of the book, measured again: hours; `--fast` or a name as filter are shorter
accuracy *filter:
    -cargo run --release -- verify --json {{filter}} > target/claims.json
    python3 book/accuracy.py target/claims.json

# the program and the Python wheel of a release, in `dist/`
release:
    tools/release.sh

# particles a second of the kernels, one thread
bench *filter:
    RAYON_NUM_THREADS=1 cargo bench -p alula -- {{filter}}

# the wheel of the Python package, tested in an environment of its own
python:
    python3 -m venv .venv
    .venv/bin/pip install --quiet maturin pytest
    CARGO_TARGET_DIR=$PWD/target .venv/bin/pip install ./python
    .venv/bin/pytest -q python

# documentation of the library
doc:
    cargo doc --workspace --no-deps --open

# the case of the README
run case="cases/naca0012-transonic/case.toml":
    cargo run --release -- run {{case}}

# licences, advisories and sources of the dependencies
deny:
    cargo deny check
