# SPDX-License-Identifier: Apache-2.0
"""SIM Fig. 8 as a command, and what it should show."""

import math
import sys

import numpy as np
import pytest
from PIL import Image

from pyharness import cli
from pyharness.stereo_noise_picture import draw_stereo_noise
from sim.camera import CameraConfig
from sim.generate import TerrainRecipe, generate

CONFIG = CameraConfig(cloud_width_px=160, cloud_height_px=120)


def run(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["enav", "terrain", "stereo-noise", *arguments])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    return caught.value.code


def test_errors_grow_with_sigma_and_with_distance(tmp_path):
    terrain = generate(TerrainRecipe(size_m=40, cfa=0.0, seed=1))
    maps = draw_stereo_noise(
        terrain, (0.0, 0.0, 0.5), CONFIG, (0.0, 1.0, 10.0), 1, tmp_path / "a.png"
    )

    def rms_m(one, near_m, far_m):
        error = (one.up_m - one.true_up_m)[(one.range_m > near_m) & (one.range_m < far_m)]
        return math.sqrt(np.nanmean(error**2))

    near, far = ([rms_m(one, *band) for one in maps] for band in ((3.0, 5.0), (8.0, 12.0)))
    # without noise a cell differs from its middle only by the slope within it
    assert near[0] < 0.01
    assert near == sorted(near)
    assert far == sorted(far)
    assert far[1] > 2 * near[1]
    assert far[2] > 0.1


def test_the_command_draws_the_same_picture_every_time(monkeypatch, tmp_path):
    paths = [tmp_path / name for name in ("one.png", "two.png")]
    for path in paths:
        assert run(monkeypatch, "-o", str(path), "--sigma-px", "0", "--sigma-px", "2") == 0
    assert paths[0].read_bytes() == paths[1].read_bytes()
    with Image.open(paths[0]) as picture:
        assert picture.width > 1000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "a.jpg"], "a.jpg: expected a name ending in .png"),
        (["--sigma-px", "-1"], "--sigma-px: expected 0 to 100, got -1"),
        (["--sigma-px", "nan"], "--sigma-px: expected 0 to 100, got nan"),
        (["--at", "500,0,0"], "the rover cannot stand at 500, 0: no ground"),
        (["--at", "inf,0,0"], "--at: expected finite numbers"),
        (["none.pgm"], "none.pgm: no such file"),
        (["--seed", "-1"], "--seed: expected >= 0, got -1"),
    ],
)
def test_bad_input_is_one_line_and_2(monkeypatch, capsys, tmp_path, arguments, message):
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, *arguments) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.glob("*.png"))
