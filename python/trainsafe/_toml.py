"""Python's values as a train file has them."""

from __future__ import annotations

import json
import numbers
from collections.abc import Mapping, Sequence
from typing import Any


def value(of: Any) -> str:
    """A value as TOML; a quantity of `pint` becomes a string with its unit."""
    if hasattr(of, "magnitude") and hasattr(of, "units"):
        return json.dumps(f"{of.magnitude!r} {format(of.units, '~C')}".replace("**", ""), ensure_ascii=False)
    if isinstance(of, str):
        return json.dumps(of, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(of, bool) or type(of).__name__ in ("bool_", "bool"):
        return "true" if of else "false"
    if isinstance(of, numbers.Integral):
        return str(int(of))
    if isinstance(of, numbers.Real):
        return repr(float(of))
    if isinstance(of, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {value(v)}" for k, v in of.items() if v is not None) + " }"
    if isinstance(of, Sequence) or hasattr(of, "tolist"):
        items = of.tolist() if hasattr(of, "tolist") else of
        return "[" + ", ".join(value(v) for v in items) + "]"
    raise TypeError(f"{type(of).__name__} has no form in a train file: give text with a unit, a number, a dict or a list")


_LISTS = ("vehicle", "coupler_override", "scenario", "vary")
"""Keys of lists of tables; a single table needs no list."""


def document(of: Mapping[str, Any]) -> str:
    """A dictionary with the keys of a train file or study, as its text."""
    plain, tables = [], []
    for key, held in of.items():
        if key in _LISTS and isinstance(held, Mapping):
            held = [held]
        if held is None:
            continue
        is_table = isinstance(held, Mapping)
        is_tables = isinstance(held, (list, tuple)) and len(held) > 0 and all(isinstance(t, Mapping) for t in held)
        if is_table:
            tables.append(f"\n[{_key(key)}]\n" + _lines(held))
        elif is_tables:
            tables.extend(f"\n[[{_key(key)}]]\n" + _lines(table) for table in held)
        else:
            plain.append(f"{_key(key)} = {value(held)}\n")
    return "".join(plain + tables)


def _lines(table: Mapping[str, Any]) -> str:
    return "".join(f"{_key(key)} = {value(held)}\n" for key, held in table.items() if held is not None)


def _key(key: Any) -> str:
    text = str(key)
    bare = text.isascii() and text.replace("_", "a").replace("-", "a").isalnum()
    return text if bare else json.dumps(text, ensure_ascii=False)
