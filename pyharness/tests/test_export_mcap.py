# SPDX-License-Identifier: Apache-2.0
import base64
import json
import math
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pyharness.dp import Kind, new_message
from pyharness.dp_file import DpReader
from pyharness.errors import HarnessError
from pyharness.export_mcap import SCHEMAS, _grid, _quaternion, write_mcap
from pyharness.tests.quick_drive import record_drive

reader_of = pytest.importorskip("mcap.reader").make_reader


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """Messages by topic, and the schema of each topic, of a drive with all products."""
    folder = tmp_path_factory.mktemp("mcap")
    record_drive(folder / "drive.dp", {"records": "full"})
    with DpReader(folder / "drive.dp") as reader:
        ((path, count),) = write_mcap(reader.schema, reader.records(), folder)
    messages, schemas = {}, {}
    with path.open("rb") as file:
        for schema, channel, message in reader_of(file).iter_messages():
            messages.setdefault(channel.topic, []).append(json.loads(message.data))
            schemas[channel.topic] = schema.name
            assert channel.message_encoding == "json"
            assert schema.encoding == "jsonschema"
    assert count == sum(map(len, messages.values()))
    return folder / "drive.dp", messages, schemas


def test_topics_have_the_standard_schemas(exported):
    _, _, schemas = exported
    standard = {topic: name for topic, name in schemas.items() if not topic.startswith("/records")}
    assert standard == {
        "/tf": "foxglove.FrameTransform",
        "/truth": "foxglove.PoseInFrame",
        "/rover": "foxglove.PoseInFrame",
        "/cloud": "foxglove.PointCloud",
        "/surface": "foxglove.Grid",
        "/costmap": "foxglove.Grid",
        "/path": "foxglove.PosesInFrame",
        "/evr": "foxglove.Log",
    }


def test_messages_have_the_fields_of_their_schemas(exported):
    _, messages, schemas = exported
    for topic, name in schemas.items():
        if name in SCHEMAS:
            assert all(set(item) == set(SCHEMAS[name]["properties"]) for item in messages[topic])


def test_a_cloud_comes_back_from_its_bytes(exported):
    path, messages, _ = exported
    with DpReader(path) as reader:
        record = next(item for item in reader.records() if item.kind == Kind.PROCESS_DISPARITY_IN)
        recorded = reader.schema.decode(record.kind, record.payload)
    cloud = messages["/cloud"][0]
    assert [item["name"] for item in cloud["fields"]] == ["x", "y", "z"]
    assert [item["type"] for item in cloud["fields"]] == [7, 7, 7]
    points = np.frombuffer(base64.b64decode(cloud["data"]), "<f4").reshape(-1, 3)
    assert cloud["point_stride"] == 12
    assert points[:, 2].tolist() == recorded["points"]["z_m"][: recorded["point_count"]].tolist()


def test_every_record_is_there_with_its_numbers(exported):
    path, messages, _ = exported
    with DpReader(path) as reader:
        kinds = [record.kind for record in reader.records() if record.kind]
    for kind in set(kinds):
        topic = f"/records/{Kind(kind).name.lower()}"
        assert len(messages[topic]) == kinds.count(kind)
    assert messages["/records/truth"][-1]["distance_driven_m"] > 5.0


def test_a_pose_is_turned_by_yaw_then_pitch_then_roll():
    pose = new_message(Kind.TRUTH)["pose"]
    pose["roll_rad"], pose["pitch_rad"], pose["yaw_rad"] = 0.1, -0.2, 2.5
    turn = _quaternion(pose)
    expected = Rotation.from_euler("ZYX", [2.5, -0.2, 0.1]).as_quat()
    assert [turn[name] for name in "xyzw"] == pytest.approx(expected.tolist())
    nose = Rotation.from_quat(expected).apply([1.0, 0.0, 0.0])
    assert nose[2] > 0.0  # pitch is positive nose up, z is down: this one looks down
    assert math.atan2(nose[1], nose[0]) == pytest.approx(2.5)


def test_a_grid_has_north_along_its_columns():
    surface = new_message(Kind.SURFACE)
    size = math.isqrt(len(surface["z_site_m"]))
    surface["cell_m"], surface["origin_row"], surface["origin_col"] = 0.1, -10, 20
    cells = np.zeros(size * size, [("elevation_m", "<f4")])
    cells["elevation_m"][7 * size + 3] = 1.0  # row 7 to the north, column 3 to the east
    grid = _grid(surface, 2.0, cells)
    values = np.frombuffer(base64.b64decode(grid["data"]), "<f4")
    (place,) = np.flatnonzero(values)
    row, column = divmod(int(place) * 4, grid["row_stride"])
    x_m = grid["pose"]["position"]["x"] + column // grid["cell_stride"] * grid["cell_size"]["x"]
    y_m = grid["pose"]["position"]["y"] + row * grid["cell_size"]["y"]
    assert (x_m, y_m) == pytest.approx((-1.0 + 0.7, 2.0 + 0.3))


def test_the_same_drive_gives_the_same_bytes(exported, tmp_path):
    path, _, _ = exported
    (tmp_path / "again").mkdir()
    with DpReader(path) as reader:
        write_mcap(reader.schema, reader.records(), tmp_path / "again")
    assert (tmp_path / "again/drive.mcap").read_bytes() == (path.parent / "drive.mcap").read_bytes()


def test_without_mcap_one_line_names_the_extra(exported, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with (
        DpReader(exported[0]) as reader,
        pytest.raises(HarnessError, match=r"pip install 'enav-sim\[export\]'"),
    ):
        write_mcap(reader.schema, reader.records(), tmp_path)
