# SPDX-License-Identifier: Apache-2.0
"""The records of a drive as tables, one for each kind: CSV and Parquet."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pyharness.dp import Schema
from pyharness.errors import HarnessError
from pyharness.records import KIND_END, Record

BATCH_BYTES = 1 << 24
COLUMNS_MAX = 16  # the numbers of shorter arrays are columns
Written = list[tuple[Path, int]]
"""Files with the number of their rows."""


@dataclass(slots=True)
class Batch:
    """Some records of one kind, decoded together.

    Attributes:
        name: Of the kind.
        sequence: Numbers of the records [n].
        time_s: Their times [n].
        fields: The records [n], what was trimmed being zero.
        sizes_bytes: Their true lengths [n].
    """

    name: str
    sequence: list[int]
    time_s: list[float]
    fields: npt.NDArray[Any]
    sizes_bytes: npt.NDArray[np.int64]


@dataclass(slots=True)
class _Pile:
    records: list[Record] = field(default_factory=list)
    size_bytes: int = 0


def batches(schema: Schema, records: Iterable[Record]) -> Iterator[Batch]:
    """Yield records, those of one kind together, each kind in order."""
    piles: dict[int, _Pile] = {}
    for record in records:
        if record.kind == KIND_END:
            continue
        pile = piles.setdefault(record.kind, _Pile())
        pile.records.append(record)
        pile.size_bytes += schema.kind_dtype(record.kind).itemsize
        if pile.size_bytes >= BATCH_BYTES:
            yield _decoded(schema, piles.pop(record.kind).records)
    for kind in sorted(piles):
        yield _decoded(schema, piles[kind].records)


def _decoded(schema: Schema, records: Sequence[Record]) -> Batch:
    kind = records[0].kind
    dtype = schema.kind_dtype(kind)
    data = b"".join(record.payload.ljust(dtype.itemsize, b"\0") for record in records)
    return Batch(
        name=schema.kinds[kind].name,
        sequence=[record.sequence for record in records],
        time_s=[record.time_s for record in records],
        fields=np.frombuffer(data, dtype),
        sizes_bytes=np.array([len(record.payload) for record in records]),
    )


def leaves(values: npt.NDArray[Any], prefix: str = "") -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Yield the fields of records [n] by name: numbers [n], and longer arrays [n, m] whole."""
    for name in values.dtype.names or ():
        column = values[name]
        if name.startswith("pad_"):
            continue
        if column.dtype.names and column.ndim == 1:
            yield from leaves(column, f"{prefix}{name}.")
        elif column.ndim == 1 or column.dtype.names or column.shape[1] > COLUMNS_MAX:
            yield f"{prefix}{name}", column
        else:
            for index in range(column.shape[1]):
                yield f"{prefix}{name}[{index}]", column[:, index]


def used_counts(batch: Batch, name: str, column: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Return how many entries of an array are in use in each record [n].

    A field named after the array says so (`points`, `point_count`), else the length of the record.
    """
    capacity = np.full(len(column), column.shape[1])
    counted_by = f"{name.removesuffix('s')}_count"
    if counted_by in (batch.fields.dtype.names or ()):
        return np.asarray(np.minimum(capacity, batch.fields[counted_by]))
    places = batch.fields.dtype.fields
    if places is None or name not in places:
        return capacity
    behind_bytes = batch.sizes_bytes - places[name][1]
    return np.asarray(np.clip(behind_bytes // column.dtype.itemsize, 0, capacity))


# ------------------------------------------------------------------ CSV


def write_csv(schema: Schema, records: Iterable[Record], folder: Path) -> Written:
    """Write KIND.csv with a row for each record, and KIND.FIELD.csv for every longer array."""
    rows: dict[Path, int] = {}
    with ExitStack() as files:
        writers: dict[Path, Any] = {}

        def write(path: Path, header: list[str], columns: list[list[Any]]) -> None:
            if path not in writers:
                file = files.enter_context(path.open("w", encoding="utf-8", newline=""))
                writers[path] = csv.writer(file, lineterminator="\n")
                writers[path].writerow(header)
            writers[path].writerows(zip(*columns, strict=True))
            rows[path] = rows.get(path, 0) + len(columns[0])

        for batch in batches(schema, records):
            header = ["sequence", "record_time_s"]
            columns: list[list[Any]] = [batch.sequence, batch.time_s]
            for name, column in leaves(batch.fields):
                if column.ndim == 1:
                    header.append(name)
                    columns.append(_shown(column))
                else:
                    write(folder / f"{batch.name}.{name}.csv", *_long_table(batch, name, column))
            write(folder / f"{batch.name}.csv", header, columns)
    return sorted(rows.items())


def _long_table(
    batch: Batch, name: str, column: npt.NDArray[Any]
) -> tuple[list[str], list[list[Any]]]:
    """Return header and columns of an array: a row for each entry in use."""
    counts = used_counts(batch, name, column)
    is_used = np.arange(column.shape[1]) < counts[:, None]
    header = ["sequence", "index"]
    columns: list[list[Any]] = [
        np.repeat(batch.sequence, counts).tolist(),
        np.nonzero(is_used)[1].tolist(),
    ]
    entries = column[is_used]
    parts = list(leaves(entries)) if entries.dtype.names else [("value", entries)]
    for part, values in parts:
        header.append(part)
        columns.append(_shown(values))
    return header, columns


def _shown(values: npt.NDArray[Any]) -> list[Any]:
    """Return numbers as they are written: enough digits to read back the same bits."""
    if values.dtype.kind == "f" and values.dtype.itemsize == 4:
        return [f"{number:.9g}" for number in values.tolist()]
    numbers: list[Any] = values.tolist()
    return numbers


# ------------------------------------------------------------------ Parquet

_MISSING = "--export parquet needs pyarrow: pip install 'enav-sim[export]'"


def write_parquet(schema: Schema, records: Iterable[Record], folder: Path) -> Written:
    """Write KIND.parquet: a row for each record, arrays as lists.

    Raises:
        HarnessError: pyarrow is not installed.
    """
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise HarnessError(
            "--export parquet needs pyarrow: pip install 'enav-sim[export]'"
        ) from None
    rows: dict[Path, int] = {}
    with ExitStack() as files:
        writers: dict[Path, Any] = {}
        for batch in batches(schema, records):
            columns: dict[str, Any] = {
                "sequence": pa.array(batch.sequence, pa.uint32()),
                "record_time_s": pa.array(batch.time_s, pa.float64()),
            }
            for name, column in leaves(batch.fields):
                columns[name] = (
                    pa.array(_native(column))
                    if column.ndim == 1
                    else _list_column(column, used_counts(batch, name, column))
                )
            table = pa.table(columns)
            path = folder / f"{batch.name}.parquet"
            if path not in writers:
                writers[path] = files.enter_context(parquet.ParquetWriter(path, table.schema))
            writers[path].write_table(table)
            rows[path] = rows.get(path, 0) + table.num_rows
    return sorted(rows.items())


def _list_column(column: npt.NDArray[Any], counts: npt.NDArray[np.int64]) -> Any:
    """Return arrays [n, capacity] as lists of the entries in use."""
    import pyarrow as pa

    entries = column[np.arange(column.shape[1]) < counts[:, None]]
    offsets = pa.array(np.concatenate([[0], np.cumsum(counts)]), pa.int32())
    if entries.dtype.names is None:
        return pa.ListArray.from_arrays(offsets, pa.array(_native(entries)))
    parts = list(leaves(entries))
    values = pa.StructArray.from_arrays(
        [pa.array(_native(values)) for _, values in parts], [name for name, _ in parts]
    )
    return pa.ListArray.from_arrays(offsets, values)


def _native(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return numbers without gaps, in the byte order of this machine."""
    return np.ascontiguousarray(values.astype(values.dtype.newbyteorder("=")))
