# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of results.json, generated from the dataclasses that hold the file's content."""

from dataclasses import fields, is_dataclass
from enum import Enum
from types import NoneType
from typing import Any, Literal, TypeAlias, get_args, get_origin, get_type_hints

import numpy as np

from mxeon.conformance.results import Result
from mxeon.io.records import NOT_FINITE
from mxeon.report import ADDED, JSON_FORMAT, SCHEMA
from mxeon.report.diff import Report

Schema: TypeAlias = dict[str, Any]

NUMBER: Schema = {"anyOf": [{"type": "number"}, {"enum": [*NOT_FINITE]}]}
ROWS: Schema = {
    "type": "array",
    "items": {"anyOf": [{"type": "number"}, {"$ref": "#/$defs/Rows"}]},
}
SIMPLE: dict[Any, Schema] = {
    str: {"type": "string"},
    bool: {"type": "boolean"},
    int: {"type": "integer"},
    float: {"$ref": "#/$defs/Number"},
    NoneType: {"type": "null"},
}


def schema() -> Schema:
    """The JSON Schema (draft 2020-12) of results.json.

    The schema states keys and types. `read_results` also requires that counts match results, that
    each error has a tolerance, that errors and tolerances are not negative, and that an array's
    rows have equal lengths.
    """
    records: dict[str, Schema] = {"Number": NUMBER, "Rows": ROWS}
    root = _record(Report, records)
    root["properties"] |= {"$schema": {"const": SCHEMA}, "format": {"const": JSON_FORMAT}}
    root["required"].append("$schema")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA}
    return head | {"title": "results.json of mxeon"} | root | {"$defs": records}


def _record(kind: type, records: dict[str, Schema]) -> Schema:
    """The schema of a dataclass. Schemas of dataclasses in the fields are added to `records`."""
    types = get_type_hints(kind)
    names = [each.name for each in fields(kind)]
    return {
        "type": "object",
        "properties": {name: _value(types[name], records) for name in names},
        "required": [name for name in names if kind is not Result or name not in ADDED],
        "additionalProperties": False,
    }


def _value(kind: Any, records: dict[str, Schema]) -> Schema:
    origin, inner = get_origin(kind), get_args(kind)
    if kind in SIMPLE:
        return SIMPLE[kind]
    if origin is np.ndarray:
        return {"$ref": "#/$defs/Rows"}
    if is_dataclass(kind) and isinstance(kind, type):
        if kind.__name__ not in records:
            records[kind.__name__] = _record(kind, records)
        return {"$ref": f"#/$defs/{kind.__name__}"}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return {"enum": [each.value for each in kind]}
    if origin is Literal:
        return {"enum": [*inner]}
    if origin is dict:
        keys, values = (_value(each, records) for each in inner)
        return {"type": "object", "propertyNames": keys, "additionalProperties": values}
    if origin in (list, tuple) and inner[1:] in ((), (...,)):
        return {"type": "array", "items": _value(inner[0], records)}
    if origin is tuple:
        items = [_value(each, records) for each in inner]
        return {"type": "array", "prefixItems": items, "minItems": len(items), "items": False}
    return {"anyOf": [_value(each, records) for each in inner]}  # a union, such as `str | None`
