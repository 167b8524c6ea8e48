# SPDX-License-Identifier: Apache-2.0
"""The tables of the C headers as text, YAML or Markdown."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from pyharness.dp import native_schema
from pyharness.evr import evr_table
from pyharness.params import ParamDefinition, param_table

Row = Mapping[str, object]


def param_rows(definitions: Iterable[ParamDefinition] | None = None) -> list[Row]:
    """Return one row per parameter, of Navlib where nothing else is given."""
    return [
        {
            "name": row.name,
            "default": row.default,
            "minimum": row.minimum,
            "maximum": row.maximum,
            "unit": row.unit,
            "meaning": row.doc,
        }
        for row in (param_table().values() if definitions is None else definitions)
    ]


def evr_rows() -> list[Row]:
    """Return one row per event report, Navlib's before the executive's."""
    return [
        {
            "id": row.evr_id,
            "name": row.name,
            "severity": row.severity,
            "text": row.text,
            "cause": row.cause,
            "arguments": row.args,
        }
        for row in evr_table().values()
    ]


def dp_rows() -> list[Row]:
    """Return one row per kind of data product."""
    schema = native_schema()
    return [
        {
            "kind": row.kind,
            "name": row.name,
            "record": row.type,
            "size_bytes": schema.records[row.type].size_bytes,
            "meaning": row.doc,
        }
        for row in schema.kinds.values()
    ]


def field_rows() -> list[Row]:
    """Return one row per field of the records that stand in data products."""
    return [
        {
            "record": record.type,
            "field": field.name,
            "type": field.type if field.count == 1 else f"{field.type}[{field.count}]",
            "unit": field.unit,
            "meaning": field.doc,
        }
        for record in native_schema().records.values()
        for field in record.fields
    ]


def to_text(rows: Sequence[Row]) -> str:
    """Return aligned columns."""
    cells = [list(rows[0]), *([_cell(value) for value in row.values()] for row in rows)]
    widths = [max(len(line[index]) for line in cells) for index in range(len(cells[0]))]
    return "".join(
        "  ".join(item.ljust(width) for item, width in zip(line, widths, strict=True)).rstrip()
        + "\n"
        for line in cells
    )


def to_markdown(rows: Sequence[Row]) -> str:
    """Return a Markdown table."""
    lines = [list(rows[0]), ["---"] * len(rows[0])]
    lines += [[_cell(value).replace("|", "\\|") for value in row.values()] for row in rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def to_yaml(rows: Sequence[Row]) -> str:
    """Return a YAML list."""
    from sim.strict_yaml import write_tree

    return write_tree([dict(row) for row in rows])


FORMATS: Mapping[str, Callable[[Sequence[Row]], str]] = {
    "text": to_text,
    "yaml": to_yaml,
    "markdown": to_markdown,
}


def _cell(value: object) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)
