"""What a caller gives, as the compiled part and the programs take it."""

import csv
import os

import numpy as np


def numbers(name, value):
    """An array of float64, row by row; ValueError for anything that is not an array of real numbers."""
    if np.ma.is_masked(value):
        raise ValueError(f"{name} has masked values: leave out those samples, or fill the gap")
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "biufO":
            raise TypeError(f"its elements are of type {array.dtype}")
        return np.ascontiguousarray(array, dtype=float) if array.ndim else array.astype(float)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} is no array of real numbers: {error}") from None


def seconds(name, value):
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} = {value!r}: give a number of seconds") from None


def path_bytes(name, value):
    """The bytes of a path or name, also where they are no UTF-8."""
    try:
        path = os.fsencode(value)
    except TypeError:
        raise TypeError(f"{name} is of type {type(value).__name__}, expected a path or a name") from None
    if b"\0" in path:
        raise ValueError(f"{name} = {value!r}: neither a path nor a name contains a zero byte")
    return path


def is_table(value):
    """Whether it is a dict of columns, a structured array, a DataFrame; otherwise it is a path."""
    return hasattr(value, "keys") or hasattr(value, "dtype")


def write_csv(name, table, path, finite):
    """Writes named columns so that they read back as the same numbers."""
    keys = getattr(getattr(table, "dtype", None), "names", None) or (table.keys() if hasattr(table, "keys") else ())
    columns = {str(key): numbers(f"{name}[{key!r}]", table[key]) for key in keys}
    if not columns:
        raise ValueError(f'{name} has no named columns: give a dict of arrays, {{"t": t, ...}}, a structured array, a '
                         "DataFrame, or the path of a CSV")
    rows = {column.shape for column in columns.values()}
    if len(rows) != 1 or len(next(iter(rows))) != 1:
        shapes = ", ".join(f"{key} {column.shape}" for key, column in columns.items())
        raise ValueError(f"{name} has columns of the shapes {shapes}: expected (samples,), the same for all")
    for key, column in columns.items():
        bad = np.flatnonzero(~np.isfinite(column)) if finite else ()
        if len(bad):
            raise ValueError(f"{name}[{key!r}] is not finite at row {bad[0]}: leave out such rows, or give skip_bad=True")
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values())))
