# SPDX-License-Identifier: Apache-2.0
import numpy as np
from PIL import Image

from pyharness.dp import Kind, native_schema
from pyharness.history import History
from pyharness.messages import truth_record
from pyharness.overhead import draw_overhead, wheel_tracks_m
from pyharness.records import RecordStream
from sim.slip import SlipConfig
from sim.terrain import centred
from sim.vehicle import load_vehicle
from sim.world import World


def test_a_picture_is_drawn_the_same_every_time(tmp_path, drive_info, some_records):
    history = History(native_schema(), drive_info)
    for record in some_records:
        history.take(record)
    terrain = centred(np.zeros((600, 600), np.float32), 0.1)
    draw_overhead(history, terrain, tmp_path / "a.png")
    draw_overhead(history, terrain, tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    with Image.open(tmp_path / "a.png") as image:
        assert min(image.size) > 500


def test_a_drive_without_a_step_has_a_picture_too(tmp_path, drive_info):
    terrain = centred(np.zeros((600, 600), np.float32), 0.1)
    draw_overhead(History(native_schema(), drive_info), terrain, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 1000


def test_six_wheels_leave_tracks_beside_the_rover(drive_info):
    history = History(native_schema(), drive_info)
    terrain = centred(np.zeros((200, 200), np.float32), 0.1)
    vehicle = load_vehicle()
    world = World(terrain, vehicle, slip=SlipConfig(enabled=False))
    world.start_arc(2.0, 0.0)
    stream = RecordStream([history.take])
    while not world.arc_done:
        record = truth_record(world.time_s, world.step())
        stream.publish(Kind.TRUTH, world.time_s, record.tobytes())
    tracks_m = wheel_tracks_m(history)
    ahead_m, beside_m, _ = vehicle.hubs_m.T
    assert tracks_m.shape == (6, len(history.truth), 2)
    np.testing.assert_allclose(tracks_m[..., 0], beside_m[:, None] * np.ones(len(history.truth)))
    np.testing.assert_allclose(tracks_m[:, -1, 1], 2.0 + ahead_m, atol=1e-6)
    assert (np.diff(tracks_m[..., 1]) > 0).all()
