# SPDX-License-Identifier: Apache-2.0
"""What a report is made of: headings, paragraphs, tables, grids, pictures; numbers as text.

The blocks become JSON, which the template lays out. No text is ever taken for markup.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from matplotlib import colormaps
from matplotlib.colors import to_hex

from pyharness.campaign_statistics import Mean, Rate

Run = str | Mapping[str, str]
"""Plain text, or one of `code`, `strong`, `ref` (label of a table or picture) with its text."""
Text = Run | Sequence[Run]
Tone = Literal["good", "bad", "note"]

NOTHING = "\N{EN DASH}"
NAME_WIDTH = 44
"""Letters of a drive's name for which there is room beside other columns."""
P_LEAST = 1e-4
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


# ------------------------------------------------------------------ blocks


@dataclass(frozen=True, slots=True)
class Heading:
    """Level 1 stands in the contents."""

    text: str
    level: int = 1
    new_page: bool = False
    kind: str = "heading"


@dataclass(frozen=True, slots=True)
class Contents:
    """The list of sections."""

    kind: str = "contents"


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    text: Text
    kind: str = "paragraph"


@dataclass(frozen=True, slots=True)
class Callout:
    """Lines that must not be overlooked."""

    tone: Tone
    lines: Sequence[Text]
    kind: str = "callout"


@dataclass(frozen=True, slots=True)
class Column:
    """Heading of a column; a wide one takes the room that is left."""

    title: str
    right: bool = False
    wide: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text; a cell may be `{"text": ..., "tone": ...}`."""

    label: str
    caption: Text
    columns: Sequence[Column]
    rows: Sequence[Sequence[Any]]
    small: bool = False
    kind: str = "table"


@dataclass(frozen=True, slots=True)
class GridCell:
    """A coloured field with a number and a line under it."""

    main: str
    sub: str
    fill: str


@dataclass(frozen=True, slots=True)
class GridRow:
    """Fields of one value of the first axis."""

    title: str
    cells: Sequence[GridCell]


@dataclass(frozen=True, slots=True)
class Grid:
    """A heat map over two axes."""

    label: str
    caption: Text
    corner: str
    columns: Sequence[str]
    rows: Sequence[GridRow]
    kind: str = "grid"


@dataclass(frozen=True, slots=True)
class Picture:
    """A file with its caption."""

    label: str
    caption: Text
    file: str
    width_percent: int = 100


@dataclass(frozen=True, slots=True)
class Pictures:
    """Pictures side by side."""

    pictures: Sequence[Picture]
    across: int = 1
    kind: str = "pictures"


Block = Heading | Contents | Paragraph | Callout | Table | Grid | Pictures


@dataclass(frozen=True, slots=True)
class Report:
    """A whole report."""

    title: str
    subtitle: str
    version: str
    blocks: Sequence[Block]

    def as_json(self) -> dict[str, Any]:
        """Return what the template reads."""
        content: dict[str, Any] = _printable(asdict(self))
        return content


def _printable(value: Any) -> Any:
    """Replace what cannot be printed."""
    if isinstance(value, str):
        return _CONTROL.sub("\N{REPLACEMENT CHARACTER}", value.replace("\n", " "))
    if isinstance(value, dict):
        return {name: _printable(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_printable(item) for item in value]
    return value


def strong(text: str) -> Run:
    """Return bold text."""
    return {"strong": text}


def code(text: str) -> Run:
    """Return text as it is typed."""
    return {"code": text}


def ref(label: str) -> Run:
    """Return the number of a table or picture."""
    return {"ref": label}


def drive_name(name: str) -> Run:
    """Return the name of a drive; only one that is very long may break anywhere."""
    return code(re.sub(rf"\S{{{NAME_WIDTH}}}(?=\S)", "\\g<0>\N{ZERO WIDTH SPACE}", name))


# ------------------------------------------------------------------ numbers as text


def number(value: float | None, digits: int) -> str:
    """Return a number with some decimal places."""
    if value is None:
        return NOTHING
    text = f"{value:.{digits}f}"
    return text.replace("-", "\N{MINUS SIGN}" if float(text) else "")


def percent(share: float | None, digits: int = 0) -> str:
    """Return a share in per cent."""
    return NOTHING if share is None else f"{number(100.0 * share, digits)} %"


def signed(value: float, digits: int) -> str:
    """Return a difference."""
    text = number(value, digits)
    return f"+{text}" if value > 0.0 and float(text) else text


def interval(rate: Rate | None) -> str:
    """Return the interval of a rate in per cent."""
    return NOTHING if rate is None else f"{100 * rate.low:.0f} to {100 * rate.high:.0f} %"


def mean_text(mean: Mean | None, scale: float, digits: int) -> str:
    """Return a mean without the number of drives it is of."""
    return NOTHING if mean is None else number(scale * mean.value, digits)


def p_text(p: float) -> str:
    """Return a p value as a number."""
    if p < P_LEAST:
        return f"< {P_LEAST:.4f}"
    return f"{p:.4f}" if p < 0.1 else f"{p:.2f}"


def p_equation(p: float) -> str:
    """Return a p value as it stands in a sentence, on one line."""
    text = f"p {p_text(p)}" if p < P_LEAST else f"p = {p_text(p)}"
    return text.replace(" ", "\N{NO-BREAK SPACE}")


def whole(value: float) -> str:
    """Return a whole number, its thousands apart."""
    return f"{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def count_text(count: int, noun: str) -> str:
    """Return how many of something."""
    return f"{whole(count)} {noun}{'' if count == 1 else 's'}"


def distance_text(distance_m: float) -> str:
    """Return a distance in whole metres."""
    return f"{whole(distance_m)} m"


# ------------------------------------------------------------------ colours of grids

EMPTY_FILL = "#eeeeee"


def shade(share: float) -> str:
    """Return the fill for 0..1, pale to middle blue, on which dark text can be read."""
    return to_hex(colormaps["Blues"](0.04 + 0.46 * min(max(share, 0.0), 1.0)))


def shade_signed(share: float) -> str:
    """Return the fill for -1..1, orange over pale grey to blue."""
    end = (0.34, 0.62, 0.82) if share > 0 else (0.93, 0.55, 0.27)
    strength = min(abs(share), 1.0)
    red, green, blue = (0.96 + strength * (part - 0.96) for part in end)
    return to_hex((red, green, blue))


def scaled(value: float, values: Sequence[float]) -> float:
    """Return where a value lies between the least and the largest."""
    low, high = min(values), max(values)
    return 0.5 if math.isclose(low, high) else (value - low) / (high - low)
