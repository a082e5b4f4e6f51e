#!/usr/bin/python3
"""validate_schema.py SCHEMA FILE…: holds JSON files ("-": standard input) to a JSON Schema.

Exit code 0: all valid; 1: the first violation of each file is printed; 77: python3-jsonschema is
missing. NaN and Infinity, which Python's reader would take, are refused, and so are double keys.
"""
import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed")
    sys.exit(77)


def refuse(constant):
    raise ValueError(f"{constant} is not JSON")


def unique(pairs):
    keys = [key for key, _ in pairs]
    if len(set(keys)) != len(keys):
        raise ValueError(f"double key among {keys}")
    return dict(pairs)


def load(path):
    with sys.stdin if path == "-" else open(path, encoding="utf-8") as file:
        return json.load(file, parse_constant=refuse, object_pairs_hook=unique)


def main(schema_path, *paths):
    schema = load(schema_path)
    jsonschema.Draft202012Validator.check_schema(schema)
    # "$ref": "picture.schema.json" is a file beside this one.
    base = pathlib.Path(schema_path).resolve().as_uri()
    validator = jsonschema.Draft202012Validator(
        schema, resolver=jsonschema.RefResolver(base, schema))
    valid = True
    for path in paths:
        try:
            error = jsonschema.exceptions.best_match(validator.iter_errors(load(path)))
            if error is None:
                continue
            where = "/".join(str(step) for step in error.absolute_path)
            print(f"{path}: /{where}: {error.message[:300]}")
        except ValueError as error:
            print(f"{path}: {error}")
        valid = False
    return 0 if valid else 1


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
