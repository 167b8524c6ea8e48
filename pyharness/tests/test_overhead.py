# SPDX-License-Identifier: Apache-2.0
import numpy as np
from PIL import Image

from pyharness.dp import native_schema
from pyharness.history import History
from pyharness.overhead import draw_overhead
from sim.terrain import centred


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
