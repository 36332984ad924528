"""Checks the schema that `alula schema` prints with an independent validator: every case of the repository is valid, nonsense is not.

    python3 tests/read_schema.py target/release/alula

Needs the package `jsonschema`.
"""
import json
import pathlib
import subprocess
import sys
import tomllib

import jsonschema

BODY = '[flow]\nmach = 0.5\n[[body]]\n{}\n[cloud]\nspacing = 0.1\n'
VALID = [
    BODY.format('naca = "0012"\nchord = "30 cm"'),
    BODY.format('naca = "0012"') + "[motion]\nperiod = 4\nplunge = 0.1\n[time]\nharmonics = 2\n",
    BODY.format('naca = "0012"') + '[motion]\nperiod = 4\nplunge = 0.1\n[time]\nharmonics = "auto"\n',
    BODY.format('naca = "0012"') + "[time]\nsteady = {}\n",
    BODY.format("circle = { radius = 0.5 }\nwall = { temperature = \"300 K\" }"),
]
INVALID = [
    BODY.format('naca = "12"'),
    BODY.format('naca = "0012"\ncircle = { radius = 0.5 }'),
    BODY.format('name = "nothing"'),
    BODY.format('naca = "0012"\nat = [0, 0]'),
    BODY.format('naca = "0012"\nchord = "30 degrees"'),
    BODY.format('naca = "0012"').replace("mach", "machh"),
    BODY.format('naca = "0012"') + "[time]\nharmonics = 0\n",
]


def main():
    printed = subprocess.run([sys.argv[1], "schema"], check=True, capture_output=True).stdout
    schema = json.loads(printed)
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    root = pathlib.Path(__file__).resolve().parent.parent
    files = sorted([*root.glob("cases/**/*.toml"), *root.glob("verification/**/case*.toml")])
    wrong = 0
    for name, text in [(str(f.relative_to(root)), f.read_text()) for f in files] + [("valid", v) for v in VALID]:
        for error in validator.iter_errors(tomllib.loads(text)):
            wrong += 1
            print(f"{name}: {error.json_path}: {error.message[:200]}")
    for text in INVALID:
        if validator.is_valid(tomllib.loads(text)):
            wrong += 1
            print(f"accepted, but should not be:\n{text}")
    print(f"{len(files)} cases and {len(VALID) + len(INVALID)} samples: {wrong} mistakes of the schema")
    sys.exit(1 if wrong or not files else 0)


if __name__ == "__main__":
    main()
