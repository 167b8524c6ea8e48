# SPDX-License-Identifier: Apache-2.0
import csv
import sys

import numpy as np
import pytest

from pyharness.dp import Kind
from pyharness.dp_file import DpReader
from pyharness.errors import HarnessError
from pyharness.export_tables import write_csv, write_parquet
from pyharness.tests.byte_order import write_swapped


@pytest.fixture
def messages(quick_drive):
    """The decoded records of the drive by kind."""
    found = {}
    with DpReader(quick_drive) as reader:
        for record in reader.records():
            if record.kind:
                message = reader.schema.decode(record.kind, record.payload)
                found.setdefault(record.kind, []).append((record, message))
    return found


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_kind_has_a_csv_file_with_a_row_for_every_record(quick_drive, messages, tmp_path):
    with DpReader(quick_drive) as reader:
        written = dict(write_csv(reader.schema, reader.records(), tmp_path))
    assert set(written) == set(tmp_path.iterdir())
    for kind, items in messages.items():
        path = tmp_path / f"{Kind(kind).name}.csv"
        assert written[path] == len(items) == len(rows(path))


def test_csv_numbers_are_exact(quick_drive, messages, tmp_path):
    with DpReader(quick_drive) as reader:
        write_csv(reader.schema, reader.records(), tmp_path)
    for row, (record, message) in zip(
        rows(tmp_path / "TRUTH.csv"), messages[Kind.TRUTH], strict=True
    ):
        assert int(row["sequence"]) == record.sequence
        assert float(row["record_time_s"]) == record.time_s
        assert float(row["pose.x_site_m"]) == float(message["pose"]["x_site_m"])
        assert float(row["tilt_rad"]) == float(message["tilt_rad"])
    points = rows(tmp_path / "PROCESS_DISPARITY_IN.points.csv")
    clouds = [item["points"][: item["point_count"]] for _, item in messages[5]]
    recorded = np.concatenate(clouds)
    assert [np.float32(row["z_m"]) for row in points] == recorded["z_m"].tolist()


def test_arrays_end_with_the_entries_in_use(quick_drive, messages, tmp_path):
    with DpReader(quick_drive) as reader:
        write_csv(reader.schema, reader.records(), tmp_path)
    answers = [message for _, message in messages[Kind.EVALUATE_ARC_OUT]]
    bounds = rows(tmp_path / "EVALUATE_ARC_OUT.bounds.csv")
    assert len(bounds) == sum(int(answer["pose_count"]) for answer in answers)
    selected = [message for _, message in messages[Kind.SELECT_ARC_OUT]]
    path = rows(tmp_path / "SELECT_ARC_OUT.path_points.csv")
    assert len(path) == sum(int(answer["path_point_count"]) for answer in selected)
    assert path[1]["index"] == "1"
    rejected = rows(tmp_path / "SELECT_ARC_OUT.csv")[0]
    assert int(rejected["rejections[10]"]) == int(selected[0]["rejections"][10])


@pytest.mark.parametrize("is_swapped", [False, True])
def test_parquet_holds_the_same_numbers(quick_drive, messages, tmp_path, is_swapped):
    parquet = pytest.importorskip("pyarrow.parquet")
    path = quick_drive
    if is_swapped:
        path = tmp_path / "swapped.dp"
        write_swapped(quick_drive, path)
    with DpReader(path) as reader:
        written = dict(write_parquet(reader.schema, reader.records(), tmp_path))
    assert len(written) == len(messages)
    for kind, items in messages.items():
        table = parquet.read_table(tmp_path / f"{Kind(kind).name}.parquet").to_pydict()
        assert table["sequence"] == [record.sequence for record, _ in items]
    truth = parquet.read_table(tmp_path / "TRUTH.parquet").to_pydict()
    assert truth["pose.yaw_rad"] == [float(m["pose"]["yaw_rad"]) for _, m in messages[Kind.TRUTH]]
    clouds = parquet.read_table(tmp_path / "PROCESS_DISPARITY_IN.parquet").to_pydict()
    for points, (_, message) in zip(clouds["points"], messages[5], strict=True):
        recorded = message["points"][: message["point_count"]]
        assert [point["x_m"] for point in points] == recorded["x_m"].tolist()


def test_without_pyarrow_one_line_names_the_extra(quick_drive, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with (
        DpReader(quick_drive) as reader,
        pytest.raises(HarnessError, match=r"pip install 'enav-sim\[export\]'"),
    ):
        write_parquet(reader.schema, reader.records(), tmp_path)
