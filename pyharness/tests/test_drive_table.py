# SPDX-License-Identifier: Apache-2.0
import builtins
import csv
import json
import re
from pathlib import Path

import pytest

from pyharness import drive_table, margins
from pyharness.campaign import Campaign, drives_of
from pyharness.campaign_folder import land, opened_folder
from pyharness.child_drives import DriveResult
from pyharness.dp import native_schema
from pyharness.drive_folder import with_wall_time
from pyharness.errors import HarnessError
from pyharness.history import History
from pyharness.metrics import summarize


@pytest.fixture
def summary(drive_info):
    found = with_wall_time(summarize(History(native_schema(), drive_info)), 3.5)
    return found | {"outcome": "goal_reached", "path_inefficiency": 0.25, "clearance_min_m": 0.5}


@pytest.fixture
def folder(tmp_path, summary):
    """Two finished drives of four, the second crashed."""
    text = json.dumps({"name": "c", "seeds": 2, "axes": {"start": [[-40, 0, 0], [-30, 0, 0]]}})
    campaign = Campaign.model_validate_json(text)
    histograms = margins.to_data(margins.NO_MARGINS)
    histograms["tilt_rad"]["over"] = 1
    results = [
        DriveResult(summary, histograms, files={"evr.log": b"1\n"}),
        DriveResult(outcome="crashed", detail="exit code 7"),
    ]
    with opened_folder(tmp_path / "c", campaign):
        for drive, result in zip(drives_of(campaign), results, strict=False):
            land(tmp_path / "c", drive, drive.place(campaign), "avoid_all", result)
    return tmp_path / "c"


def test_a_row_is_what_tells_a_drive_apart_and_its_summary(folder, summary):
    table = drive_table.load(folder)
    assert len(table.rows) == len(table.margins) == 2
    first = table.rows[0]
    assert list(first) == table.columns
    assert table.columns[:7] == [
        "name", "planner", "parameter_set", "start", "seed", "outcome", "fault_detail",
    ]  # fmt: skip
    flat = {key for key in summary if key not in ("planner", "seed", "rejections")}
    rejections = {f"rejections_{reason}" for reason in summary["rejections"]}
    assert set(first) == {"name", "planner", "parameter_set", "start", "seed"} | flat | rejections
    assert first["path_inefficiency"] == 0.25
    assert table.margins[0]["tilt_rad"].over == 1


def test_of_a_drive_that_crashed_nothing_else_is_known(folder):
    row = drive_table.load(folder).rows[1]
    known = {key: value for key, value in row.items() if value is not None}
    assert known == {
        "name": "cell0001-seed0000",
        "planner": "enav",
        "parameter_set": "default",
        "start": [-30, 0, 0],
        "seed": 0,
        "outcome": "crashed",
        "fault_detail": "exit code 7",
        "mode": "avoid_all",
    }
    assert drive_table.load(folder).margins[1] == margins.NO_MARGINS


def test_the_tables_hold_every_finished_drive(folder):
    table = drive_table.load(folder)
    assert drive_table.write_tables(table)
    with (folder / "drives.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["start"] for row in rows] == ["[-40, 0, 0]", "[-30, 0, 0]"]
    assert [row["duration_wall_s"] for row in rows] == ["3.5", ""]
    parquet = pytest.importorskip("pyarrow.parquet").read_table(folder / "drives.parquet")
    assert parquet.column_names == table.columns
    assert parquet["path_inefficiency"].to_pylist() == [0.25, None]
    assert parquet["seed"].to_pylist() == [0, 0]


def test_without_pyarrow_there_is_the_csv_alone(folder, monkeypatch):
    original = builtins.__import__

    def no_pyarrow(name, *args, **kwargs):
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return original(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", no_pyarrow)
    assert not drive_table.write_tables(drive_table.load(folder))
    assert (folder / "drives.csv").exists()
    assert not (folder / "drives.parquet").exists()


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1, 2.5, None], [1.0, 2.5, None]),
        ([1, "two", None], ["1", "two", None]),
        ([[1], [2]], ["[1]", "[2]"]),
        ([True, None], [True, None]),
        ([True, 1], ["true", "1"]),
        ([1, None], [1, None]),
    ],
)
def test_a_column_of_parquet_has_one_type(values, expected):
    assert repr(drive_table._column(values)) == repr(expected)


def test_another_folder_is_one_line(tmp_path):
    with pytest.raises(HarnessError, match=r"no campaign.yaml in it, expected the folder"):
        drive_table.load(tmp_path)


@pytest.mark.parametrize("text", ["", "{}", '{"row": {}, "margins": {}}', "[1]"])
def test_a_damaged_result_is_one_line(folder, text):
    path = next((folder / "results").iterdir())
    path.write_text(text)
    with pytest.raises(HarnessError, match="not the result of a drive") as error:
        drive_table.load(folder)
    assert path.name in str(error.value)


def test_the_documentation_names_every_column():
    page = (Path(__file__).parents[2] / "docs/montecarlo.md").read_text("utf-8")
    named = set(re.findall(r"`(\w+)`", page.partition("| column |")[2].partition("\n\n")[0]))
    columns = {name for name in drive_table.SUMMARY_COLUMNS if not name.startswith("rejections_")}
    assert named >= columns
