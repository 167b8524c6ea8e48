# SPDX-License-Identifier: Apache-2.0
"""YAML as people mean it: text to plain data, with the place of every value.

Differences from PyYAML's loader, each a trap that has bitten somebody: `1e-3` is a number, `yes`,
`012`, `12:30` and dates are text, duplicate keys, aliases, tags, several documents, NaN and
infinity are refused, and depth is limited.
"""

import math
import re
from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Any

import yaml

DEPTH_MAX = 40

_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]{0,999})")
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|(0|[1-9][0-9]*)(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WORDS: dict[str, bool | None] = {
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
}

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Tree:
    """Plain data, the place of each of its values and keys, and what was wrong with the text."""

    data: object
    places: dict[Path, str]
    problems: list[str] = field(default_factory=list)


def resolve_plain(text: str) -> object:
    """Meaning of an unquoted scalar: None, bool, int, finite float, or the text itself."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _NUMBER.fullmatch(text) and math.isfinite(number := float(text)):
        return number
    return text


@dataclass(slots=True)
class _Builder:
    """Builds plain data from parser events; the explicit stack keeps deep nesting harmless."""

    source: str
    places: dict[Path, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    root: object = None

    def place(self, mark: Any) -> str:
        return f"{self.source}:{mark.line + 1}:{mark.column + 1}"

    def build(self, text: str) -> None:
        stack: list[tuple[Path, dict[str, object] | list[object]]] = []
        key: str | None = None
        documents = 0
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            where = self.place(event.start_mark)
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    self.problems.append(f"{where}: only one document is expected")
                    return
            if isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
                stack.pop()
                continue
            if not isinstance(event, yaml.NodeEvent):
                continue
            if problem := _refusal(event, len(stack)):
                self.problems.append(f"{where}: {problem}")
                return
            path, holder = stack[-1] if stack else ((), None)
            if isinstance(holder, dict) and key is None:
                if not isinstance(event, yaml.ScalarEvent):
                    self.problems.append(f"{where}: a key must be a plain word")
                    return
                key = event.value
                if key in holder:
                    self.problems.append(f"{where}: {_dotted((*path, key))}: duplicate key")
                self.places[*path, key] = where
                continue
            value = _value_of(event)
            if isinstance(holder, dict):
                assert key is not None
                path = (*path, key)
                holder[key] = value
                key = None
            elif isinstance(holder, list):
                path = (*path, len(holder))
                holder.append(value)
                self.places[path] = where
            else:
                self.root = value
                self.places[()] = where
            if isinstance(value, dict | list):
                stack.append((path, value))


def _dotted(path: Path) -> str:
    return ".".join(str(part) for part in path)


def _refusal(event: yaml.NodeEvent, depth: int) -> str | None:
    if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
        return "anchors and aliases (&, *) are not supported, write the value out"
    tag = getattr(event, "tag", None)
    if tag is not None:
        return f"tags such as {tag!r} are not supported"
    if isinstance(event, yaml.ScalarEvent) and any("\ud800" <= c <= "\udfff" for c in event.value):
        return "half a surrogate pair is not text"
    if depth > DEPTH_MAX:
        return f"nested deeper than {DEPTH_MAX} levels"
    return None


def _value_of(event: yaml.NodeEvent) -> object:
    if isinstance(event, yaml.MappingStartEvent):
        return {}
    if isinstance(event, yaml.SequenceStartEvent):
        return []
    assert isinstance(event, yaml.ScalarEvent)
    return resolve_plain(event.value) if event.style is None else event.value


def read_tree(text: str, source: str) -> Tree:
    """Read YAML text; faults of the text itself are listed in `problems`, never raised."""
    builder = _Builder(source)
    try:
        builder.build(text)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = builder.place(mark) if mark else source
        builder.problems.append(f"{where}: not valid YAML: {error.problem or error.context}")
    except (yaml.YAMLError, ValueError) as error:
        first_line = str(error).splitlines()[0]
        builder.problems.append(f"{source}: not valid YAML: {first_line}")
    return Tree(builder.root, builder.places, builder.problems)


class _Dumper(yaml.SafeDumper):
    """Writes what `read_tree` reads back: no aliases, text quoted where it looks like a value."""

    def ignore_aliases(self, data: Hashable) -> bool:  # noqa: ARG002
        return True


def _represent_text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = None if isinstance(resolve_plain(text), str) else "'"
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


def _represent_number(dumper: yaml.SafeDumper, number: float) -> yaml.ScalarNode:
    text = repr(number)
    if "." not in text:  # 1e-09: PyYAML takes only 1.0e-09 for a number
        text = text.replace("e", ".0e")
    return dumper.represent_scalar("tag:yaml.org,2002:float", text)


_Dumper.add_representer(str, _represent_text)
_Dumper.add_representer(float, _represent_number)


def write_tree(data: object) -> str:
    """Deterministic YAML text of plain data, keys in their given order."""
    text: str = yaml.dump(
        data,
        Dumper=_Dumper,
        sort_keys=False,
        allow_unicode=True,
        default_flow_style=None,
        width=100,
    )
    return text
