# SPDX-License-Identifier: Apache-2.0
"""What a campaign found: one row per drive, and the histograms of its margins."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pyharness import margins, metrics
from pyharness.campaign import Campaign, Drive, drives_of
from pyharness.child_drives import DriveResult
from pyharness.dp import native_schema
from pyharness.drive_folder import with_wall_time
from pyharness.errors import HarnessError
from pyharness.history import History
from pyharness.margins import Margins
from pyharness.records import DriveInfo, Outcome, Waypoint
from sim.config import load_model
from sim.terrain_io import write_atomic

CAMPAIGN_FILE, RUN_FILE = "campaign.yaml", "run.json"
RESULTS_FOLDER, DRIVES_FOLDER = "results", "drives"
CSV_FILE, PARQUET_FILE = "drives.csv", "drives.parquet"

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class DriveTable:
    """The finished drives of a campaign, in its order.

    Attributes:
        campaign: With all defaults filled in.
        rows: One per drive: what tells it apart, and its summary; None where nothing is known.
        margins: One per drive.
        run: How the campaign was run.
        folder: Of the campaign.
    """

    campaign: Campaign
    rows: list[Row]
    margins: list[Margins]
    run: Mapping[str, Any]
    folder: Path

    @property
    def columns(self) -> list[str]:
        """Return the names of all columns."""
        return [*self.campaign.place_columns, *SUMMARY_COLUMNS]


def load(folder: Path) -> DriveTable:
    """Read a campaign's folder; drives that are not finished are left out.

    Raises:
        HarnessError: It is not one, or a result in it is damaged.
    """
    campaign = read_campaign(folder)
    rows, all_margins = [], []
    for drive in drives_of(campaign):
        path = result_path(folder, drive)
        if path.exists():
            row, counted = read_result(path)
            rows.append(row)
            all_margins.append(counted)
    run_path = folder / RUN_FILE
    run = json.loads(run_path.read_text("utf-8")) if run_path.exists() else {}
    return DriveTable(campaign, rows, all_margins, run, folder)


def read_campaign(folder: Path) -> Campaign:
    """Return the campaign that a folder belongs to.

    Raises:
        HarnessError: None does.
    """
    path = folder / CAMPAIGN_FILE
    if not path.exists():
        raise HarnessError(f"{folder}: no {CAMPAIGN_FILE} in it, expected the folder of a campaign")
    return load_model(path, Campaign)


# ------------------------------------------------------------------ one drive


def result_path(folder: Path, drive: Drive) -> Path:
    """Return the file whose presence means that a drive is finished."""
    return folder / RESULTS_FOLDER / f"{drive.name}.json"


def read_result(path: Path) -> tuple[Row, Margins]:
    """Return row and margins of a finished drive."""
    try:
        data = json.loads(path.read_text("utf-8"))
        return data["row"], margins.from_data(data["margins"])
    except (ValueError, KeyError, TypeError):
        raise HarnessError(
            f"{path}: not the result of a drive (removed, the drive is run again)"
        ) from None


def result_text(place: Row, mode: str, result: DriveResult) -> str:
    """Return the content of the file of a finished drive."""
    if result.summary is not None:
        summary = flat(result.summary)
        counted = result.margins
    else:
        summary = {"outcome": result.outcome, "fault_detail": result.detail, "mode": mode}
        counted = margins.to_data(margins.NO_MARGINS)
    row = place | {name: summary.get(name) for name in SUMMARY_COLUMNS}
    return json.dumps({"row": row, "margins": counted}, allow_nan=False, ensure_ascii=False) + "\n"


def flat(summary: Mapping[str, Any]) -> Row:
    """Return the columns of a summary; what tells the drive apart is not among them."""
    row = {key: value for key, value in summary.items() if key not in ("planner", "seed")}
    rejections = row.pop("rejections")
    return row | {f"rejections_{reason}": count for reason, count in rejections.items()}


def _summary_columns() -> tuple[str, ...]:
    """Return the columns of any drive's summary: those of a drive of which nothing is known."""
    info = DriveInfo("", "", 0, 0.0, 0.0, 0.0, (Waypoint(0.0, 0.0, 1.0, ""),))
    return tuple(flat(with_wall_time(metrics.summarize(History(native_schema(), info)), 0.0)))


SUMMARY_COLUMNS = _summary_columns()


def is_success(row: Row) -> bool:
    """Whether a drive did what it was told to."""
    return Outcome(row["outcome"]).is_reached


# ------------------------------------------------------------------ files


def write_tables(table: DriveTable) -> bool:
    """Write drives.csv, and drives.parquet where pyarrow is there; whether it was."""
    columns = table.columns
    rows = [[_cell(row[name]) for name in columns] for row in table.rows]
    write_atomic(table.folder / CSV_FILE, metrics.csv_text(columns, rows).encode())
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return False
    values = {name: _column([row[name] for row in table.rows]) for name in columns}
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table(values), sink)
    write_atomic(table.folder / PARQUET_FILE, sink.getvalue().to_pybytes())
    return True


def _cell(value: object) -> object:
    return json.dumps(value) if isinstance(value, list | dict) else value


def _column(values: Sequence[Any]) -> list[Any]:
    """Return the values of one type: numbers, or text where any of them is not a number."""
    if all(value is None or isinstance(value, bool) for value in values):
        return list(values)
    if any(isinstance(value, str | list | dict | bool) for value in values):
        return [
            value if value is None or isinstance(value, str) else json.dumps(value)
            for value in values
        ]
    if any(isinstance(value, float) for value in values):
        return [None if value is None else float(value) for value in values]
    return list(values)
