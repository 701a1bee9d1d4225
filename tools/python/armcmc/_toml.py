"""A configuration as the estimator reads it, from a file with some keys replaced."""

import json
import numbers
import os
import tomllib
from collections.abc import Mapping


def merged(base, changes):
    """`base` with the keys of `changes`, table by table."""
    result = dict(base)
    for key, value in changes.items():
        old = result.get(key)
        both = isinstance(value, Mapping) and isinstance(old, Mapping)
        result[key] = merged(old, value) if both else value
    return result


def text(table):
    """TOML of a table: one key a line, what is below it inline."""
    return "".join(f"{_key(key)} = {_value(key, value)}\n" for key, value in table.items())


def read(path):
    try:
        with open(path, "rb") as file:
            return tomllib.load(file)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise ValueError(f"{os.fsdecode(path)}: {why}") from None


def _key(key):
    if not isinstance(key, str):
        raise ValueError(f"key {key!r} of the configuration is no text")
    return _string(key)


def _string(value):
    # TOML has the same escapes as JSON, except for DEL.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(key, value):
    if hasattr(value, "tolist"):  # numbers and arrays of numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k)} = {_value(k, v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(key, v) for v in value) + "]"
    raise ValueError(f"{key} = {value!r}: expected a number, a text, True or False, a list or a dict")
