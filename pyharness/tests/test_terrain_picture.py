# SPDX-License-Identifier: Apache-2.0
"""Pictures of terrain: what is in them, and the input they refuse."""

import math

import numpy as np
import pytest
from matplotlib import image

from pyharness.cfa_picture import DIAMETERS_M, cover_of_terrain, covers_of_draws, draw_cfa
from pyharness.map_style import hillshade, slope_deg
from pyharness.terrain_picture import (
    draw_all_layers,
    draw_layer,
    draw_overview,
    rock_mask,
    shown_terrain,
)
from sim.classes import ClassLayer
from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate
from sim.landforms import Landform
from sim.terrain import centred
from sim.terrain_io import read_terrain, write_terrain

RECIPE = TerrainRecipe(
    size_m=30, cfa=0.12, slope_deg=8, seed=3, start_m=(-8.0, 0.0), landform=Landform(kind="crater"),
    classes=(ClassLayer(terrain_class="sand", cover=0.4),),
)  # fmt: skip


@pytest.fixture(scope="module")
def shown():
    return shown_terrain(generate(RECIPE), "t.pgm")


def test_the_layers_of_a_stored_terrain_are_found_again(tmp_path, shown):
    write_terrain(generate(RECIPE), tmp_path / "t.pgm")
    again = shown_terrain(read_terrain(tmp_path / "t.pgm"), "t.pgm")
    assert set(again.layers) == set(shown.layers)
    np.testing.assert_allclose(again.layers["ground"], shown.layers["ground"])


def test_heights_that_are_not_the_recipes_have_no_layers():
    made = generate(RECIPE)
    z = made.z_site_m.copy()
    z[5, 5] -= 0.5
    other = shown_terrain(centred(z, 0.1, made.rocks, made.recipe), "t.pgm")
    assert set(other.layers) == {"surface"}
    gone = {**made.recipe, "base_file": "gone.tif"}
    other = shown_terrain(centred(z, 0.1, made.rocks, gone), "t.pgm")
    assert set(other.layers) == {"surface"}


def test_slopes_are_those_of_planes():
    axis = np.arange(200) * 0.1
    up_m = math.tan(math.radians(12)) * (0.6 * axis[:, None] + 0.8 * axis[None, :])
    np.testing.assert_allclose(slope_deg(up_m, 0.1, 2.5), 12.0, atol=1e-6)


def test_the_sun_stands_in_the_north_west():
    axis = np.arange(50.0)
    facing = hillshade(0.5 * axis[None, :] - 0.5 * axis[:, None], 1.0)
    away = hillshade(0.5 * axis[:, None] - 0.5 * axis[None, :], 1.0)
    # the first rises to the south-east: it faces the sun
    assert facing.mean() > away.mean() + 0.3


@pytest.mark.parametrize("above_m", [0.15, 0.25, 0.4])
def test_only_rocks_over_the_height_are_marked(shown, above_m):
    mask = rock_mask(shown, above_m)
    rocks = shown.terrain.rocks
    high = rocks[rocks["height_m"] > above_m]
    assert len(high) > 0
    for rock in high:
        i = round((rock["north_m"] - shown.terrain.north_min_m) / 0.1)
        j = round((rock["east_m"] - shown.terrain.east_min_m) / 0.1)
        assert mask[np.clip(i, 0, 299), np.clip(j, 0, 299)]
    area_m2 = float((0.25 * np.pi * high["diameter_m"] ** 2).sum())
    assert 0.6 * area_m2 < 0.01 * mask.sum() < 1.15 * area_m2


def colors_in(path, color):
    picture = image.imread(path)[..., :3]
    return int((np.abs(picture - np.array(color)).max(axis=-1) < 0.12).sum())


def test_the_overview_shows_rocks_in_blue(tmp_path, shown):
    draw_overview(shown, tmp_path / "low.png", 0.10, 2.5, None)
    draw_overview(shown, tmp_path / "high.png", 0.40, 2.5, [(-10, -10), (10, 8)])
    blue = (0.04, 0.39, 1.0)
    assert colors_in(tmp_path / "low.png", blue) > 3 * colors_in(tmp_path / "high.png", blue) > 0
    draw_overview(shown, tmp_path / "again.png", 0.10, 2.5, None)
    assert (tmp_path / "again.png").read_bytes() == (tmp_path / "low.png").read_bytes()


@pytest.mark.parametrize(
    "layer", ["surface", "ground", "base", "undulation", "slope", "rocks", "class"]
)
def test_every_layer_is_drawn_on_its_own(tmp_path, shown, layer):
    draw_layer(shown, layer, tmp_path / "l.png", [(0.0, -5.0), (0.0, 5.0)])
    picture = image.imread(tmp_path / "l.png")[..., :3]
    assert len(np.unique((picture[::8, ::8] * 32).astype(int).reshape(-1, 3), axis=0)) > 5


def test_all_layers_and_holes_are_drawn(tmp_path, shown):
    draw_all_layers(shown, tmp_path / "all.png")
    z = np.zeros((40, 50), np.float32)
    z[10:14, 20:30] = np.nan
    holed = shown_terrain(centred(z, 0.5), "h.tif")
    draw_overview(holed, tmp_path / "h.png", 0.25, 2.5, None)
    draw_layer(holed, "surface", tmp_path / "s.png", None)
    assert (tmp_path / "all.png").stat().st_size > (tmp_path / "s.png").stat().st_size > 1000


def test_what_cannot_be_shown_is_one_clear_line(tmp_path, shown):
    plain = shown_terrain(centred(np.zeros((20, 20), np.float32), 0.5), "p.pgm")
    for layer, expected in (("ground", "layers are not known"), ("class", "no terrain classes")):
        with pytest.raises(TerrainError, match=expected):
            draw_layer(plain, layer, tmp_path / "x.png")
    with pytest.raises(TerrainError, match="99, 0 is not on the terrain"):
        draw_overview(shown, tmp_path / "x.png", 0.2, 2.5, [(99.0, 0.0), (0.0, 0.0)])
    with pytest.raises(TerrainError, match="both points are the same"):
        draw_overview(shown, tmp_path / "x.png", 0.2, 2.5, [(1.0, 0.0), (1.0, 0.0)])
    with pytest.raises(TerrainError, match="cannot be written"):
        draw_overview(plain, tmp_path / "none/x.png", 0.2, 2.5, None)
    assert list(tmp_path.iterdir()) == []


def test_the_law_is_drawn_with_what_was_achieved(tmp_path):
    covers = covers_of_draws([0.07, 0.15], 6)
    small = DIAMETERS_M <= 0.3
    for cover in covers:
        np.testing.assert_allclose(cover.achieved[small], cover.law[small], rtol=0.05)
    draw_cfa(covers, tmp_path / "cfa.png")
    one = cover_of_terrain(generate(RECIPE), "t.pgm")
    draw_cfa([one], tmp_path / "one.png")
    assert one.achieved[0] == pytest.approx(one.law[0], rel=0.3)
    with pytest.raises(TerrainError, match="not made with a CFA"):
        cover_of_terrain(generate(TerrainRecipe(size_m=10)), "t.pgm")
