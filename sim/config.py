# SPDX-License-Identifier: Apache-2.0
"""Strict configuration: YAML to frozen pydantic models, all faults at once with their place."""

import difflib
import json
import math
import typing
from collections.abc import Mapping, Sequence
from pathlib import Path

import pydantic

from sim.errors import ConfigError
from sim.strict_yaml import Path as KeyPath
from sim.strict_yaml import Tree, read_tree, write_tree

FILE_SIZE_MAX_BYTES = 4 * 1024 * 1024

Model = typing.TypeVar("Model", bound=pydantic.BaseModel)


class ConfigModel(pydantic.BaseModel):
    """Base of every configuration section: unknown keys are errors, values never change."""

    model_config = pydantic.ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, validate_default=True
    )


def load_model(
    path: Path | str, model: type[Model], overrides: Mapping[str, object] | None = None
) -> Model:
    """Read and check one YAML file.

    Args:
        path: The file, UTF-8.
        model: What it must hold.
        overrides: Dotted key to value, e.g. {"terrain.cfa": 0.1}; text is read as YAML.

    Raises:
        ConfigError: With one line `file:line:column: key: fault` for every fault.
    """
    return parse_model(_read_text(Path(path)), str(path), model, overrides)


def parse_model(
    text: str, source_name: str, model: type[Model], overrides: Mapping[str, object] | None = None
) -> Model:
    """Check YAML text as `load_model` does; `source_name` names it in the messages."""
    tree = read_tree(text, source_name)
    if tree.problems:
        raise ConfigError(tree.problems)
    data = {} if tree.data is None else tree.data
    if not isinstance(data, dict):
        raise ConfigError(
            [f"{source_name}:1:1: expected keys and values at the top, got {_shown(data)}"]
        )
    places = {(): f"{source_name}:1:1", **tree.places}
    problems: list[str] = []
    for key, value in (overrides or {}).items():
        problems += _apply_override(data, places, key, value)
    try:
        result = model.model_validate_json(json.dumps(data))
    except pydantic.ValidationError as error:
        faults = error.errors(include_url=False)
        lines = [_fault_line(fault, model, data, places) for fault in faults]
        raise ConfigError(problems + list(dict.fromkeys(lines))) from None
    if problems:
        raise ConfigError(problems)
    return result


def dump_model(model: pydantic.BaseModel) -> str:
    """YAML text, the same for equal models, that `parse_model` reads back to an equal model."""
    return write_tree(model.model_dump(mode="json"))


def _read_text(path: Path) -> str:
    try:
        if not path.exists():
            raise ConfigError([f"{path}: no such file"])
        if not path.is_file():
            raise ConfigError([f"{path}: not a file, expected YAML text"])
        if path.stat().st_size > FILE_SIZE_MAX_BYTES:
            raise ConfigError([f"{path}: larger than {FILE_SIZE_MAX_BYTES} bytes, not YAML for us"])
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError([f"{path}: not UTF-8 text (byte {error.start})"]) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise ConfigError([f"{path}: cannot be read: {reason}"]) from None


# ------------------------------------------------------------------ overrides


def _apply_override(
    data: dict[str, object], places: dict[KeyPath, str], key: str, value: object
) -> list[str]:
    """Set one dotted key in the plain data; returns what was wrong with it."""
    label = f"--set {key}"
    if isinstance(value, str):
        tree: Tree = read_tree(value, label)
        if tree.problems:
            return [f"{label}: {tree.problems[0].split(': ', 1)[1]}"]
        value = tree.data
    try:
        value = _plain(value)
    except ValueError as error:
        return [f"{label}: {error}"]
    parts = key.split(".")
    if not all(parts):
        return [f"{label}: expected a key such as terrain.cfa"]
    path: KeyPath = ()
    holder: object = data
    for depth, part in enumerate(parts):
        is_last = depth == len(parts) - 1
        if isinstance(holder, dict):
            index: str | int = part
            if not is_last and holder.get(part) is None:
                holder[part] = {}
                places[*path, part] = label
        elif isinstance(holder, list) and part.isdecimal() and int(part) < len(holder):
            index = int(part)
        else:
            return [f"{label}: '{'.'.join(parts[:depth])}' has no part '{part}'"]
        path = (*path, index)
        if is_last:
            holder[index] = value  # type: ignore[index]
        else:
            holder = holder[index]  # type: ignore[index]
    for old in [known for known in places if known[: len(path)] == path]:
        del places[old]
    places[path] = label
    return []


def _plain(value: object) -> object:
    """JSON-like copy of an override value given as a Python object."""
    item = getattr(value, "item", None)
    if callable(item):  # a NumPy scalar
        value = item()
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"expected a finite number, got {value}")
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Mapping):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return [_plain(part) for part in value]
    raise ValueError(f"cannot use a {type(value).__name__} as a value")


# ------------------------------------------------------------------ messages

_EXPECTED = {
    "int_type": "an integer",
    "int_from_float": "an integer",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "string_type": "text",
    "model_type": "keys and values",
    "dict_type": "keys and values",
    "list_type": "a list",
    "tuple_type": "a list",
}


def _fault_line(
    fault: typing.Any, model: type[pydantic.BaseModel], data: object, places: dict[KeyPath, str]
) -> str:
    """One line `place: key: fault` for one pydantic error."""
    kind: str = fault["type"]
    path, value = _locate(data, fault["loc"], keep_last=kind == "missing")
    text = _fault_text(kind, fault, model, path, value)
    place_path = path
    while place_path not in places:
        place_path = place_path[:-1]
    place = places[place_path]
    key = ".".join(str(part) for part in path)
    if place == f"--set {key}" or not key:
        return f"{place}: {text}"
    return f"{place}: {key}: {text}"


def _locate(data: object, location: KeyPath, keep_last: bool) -> tuple[KeyPath, object]:
    """Path of an error in the user's data; parts that pydantic added for unions are dropped."""
    path: KeyPath = ()
    value = data
    for depth, part in enumerate(location):
        if isinstance(value, dict) and part in value:  # noqa: SIM114 (mypy narrows each)
            value = value[part]
        elif isinstance(value, list) and isinstance(part, int) and part < len(value):
            value = value[part]
        elif not (keep_last and depth == len(location) - 1):
            continue
        path = (*path, part)
    return path, value


def _fault_text(
    kind: str,
    fault: typing.Any,
    model: type[pydantic.BaseModel],
    path: KeyPath,
    value: object,
) -> str:
    context = fault.get("ctx", {})
    if kind == "extra_forbidden":
        return f"unknown key{_suggestion(str(path[-1]), _known_keys(model, path[:-1]))}"
    if kind == "missing":
        is_item = isinstance(path[-1], int)
        return f"expected at least {int(path[-1]) + 1} items" if is_item else "missing key"
    if kind in _EXPECTED:
        return f"expected {_EXPECTED[kind]}, got {_shown(value)}"
    if kind == "literal_error":
        choices = context["expected"].replace("'", "").replace(" or ", ", ").split(", ")
        hint = _suggestion(str(value), choices) if isinstance(value, str) else ""
        return f"expected one of {', '.join(choices)}, got {_shown(value)}{hint}"
    if kind == "value_error":
        return str(context["error"])
    if kind == "too_long":
        return f"expected at most {context['max_length']} items, got {context['actual_length']}"
    if kind == "too_short":
        return f"expected at least {context['min_length']} items, got {context['actual_length']}"
    for name, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<=")):
        if name in context:
            return f"expected {sign} {context[name]}, got {_shown(value)}"
    return f"{fault['msg']}, got {_shown(value)}"


def _suggestion(word: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(word, known, n=1)
    if close:
        return f", did you mean '{close[0]}'?"
    return f" (known: {', '.join(known)})" if known else ""


def _known_keys(model: type[pydantic.BaseModel], path: KeyPath) -> list[str]:
    """Field names of the section at a path; of every candidate where it is a union."""
    candidates: list[typing.Any] = [model]
    for part in path:
        step: list[typing.Any] = []
        for candidate in candidates:
            if isinstance(part, str) and part in candidate.model_fields:
                step += _models_in(candidate.model_fields[part].annotation)
            elif not isinstance(part, str):
                step.append(candidate)
        candidates = step or candidates
    return list(dict.fromkeys(name for item in candidates for name in item.model_fields))


def _models_in(annotation: typing.Any) -> list[typing.Any]:
    if isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        return [annotation]
    return [model for part in typing.get_args(annotation) for model in _models_in(part)]


def _shown(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "keys and values"
    if isinstance(value, list):
        return "a list"
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
