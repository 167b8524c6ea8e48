# SPDX-License-Identifier: Apache-2.0
"""Terrains from recipes."""

import math
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate, generate_layers, recipe_of
from sim.landforms import Landform
from sim.rocks import area_fraction
from sim.terrain import centred
from sim.terrain_io import write_terrain
from sim.undulation import Undulation


def test_the_same_recipe_gives_the_same_bytes() -> None:
    recipe = TerrainRecipe(size_m=20, cfa=0.1, slope_deg=10, seed=9)
    one, two = generate(recipe), generate(recipe)
    assert one.z_site_m.tobytes() == two.z_site_m.tobytes()
    assert one.rocks.tobytes() == two.rocks.tobytes()
    assert generate(recipe, seed=10).z_site_m.tobytes() != one.z_site_m.tobytes()


def test_the_stored_recipe_makes_it_again() -> None:
    terrain = generate(TerrainRecipe(size_m=20, cfa=0.1), clear=(-3.0, 1.0, 0.5), seed=4)
    recipe = recipe_of(terrain)
    assert recipe is not None
    assert (recipe.seed, recipe.start_m) == (4, (-3.0, 1.0))
    assert generate(recipe).z_site_m.tobytes() == terrain.z_site_m.tobytes()
    assert recipe_of(centred(terrain.z_site_m, 0.1)) is None


def test_default_size() -> None:
    terrain = generate(TerrainRecipe())
    assert terrain.z_site_m.shape == (1200, 1200)
    assert terrain.north_min_m == pytest.approx(-59.95)
    assert 0.4 < np.ptp(terrain.z_site_m) < 2.5


@pytest.mark.parametrize("azimuth_deg", [0, 90, 200, -45])
def test_slope_rises_towards_its_azimuth(azimuth_deg: float) -> None:
    terrain = generate(
        TerrainRecipe(size_m=20, slope_deg=15, slope_azimuth_deg=azimuth_deg, undulation=())
    )
    azimuth = math.radians(azimuth_deg)
    ahead = terrain.height_at(5 * math.cos(azimuth), 5 * math.sin(azimuth))
    assert -float(ahead) == pytest.approx(5 * math.tan(math.radians(15)), abs=1e-5)
    across = terrain.height_at(-5 * math.sin(azimuth), 5 * math.cos(azimuth))
    assert float(across) == pytest.approx(0.0, abs=1e-5)


def test_the_azimuth_is_drawn_from_the_seed() -> None:
    recipe = TerrainRecipe(size_m=10, slope_deg=15, undulation=())
    corners = {float(generate(recipe, seed=seed).z_site_m[0, 0]) for seed in (1, 2, 3)}
    assert len(corners) == 3


def test_rocks_cover_what_the_law_says() -> None:
    recipe = TerrainRecipe(cfa=0.12, seed=1, undulation=())
    terrain = generate(recipe)
    expected = float(area_fraction(0.12, 0.1) - area_fraction(0.12, 2.0))
    listed = float((0.25 * math.pi * terrain.rocks["diameter_m"] ** 2).sum()) / 120.0**2
    assert listed == pytest.approx(expected, rel=0.05)
    # rocks overlap and the smallest fall between nodes: what is seen is a little less
    seen = np.count_nonzero(terrain.z_site_m < -1e-3) / terrain.z_site_m.size
    assert 0.80 * expected < seen < 1.0 * expected


def test_clearing_the_start_changes_nothing_elsewhere() -> None:
    recipe = TerrainRecipe(size_m=60, cfa=0.15, seed=2, undulation=())
    open_start = generate(recipe, clear=(-10.0, 0.0, 0.0))
    rough = generate(recipe)
    n, e = np.meshgrid(open_start.north_m, open_start.east_m, indexing="ij")
    strip = (n > -12.5) & (n < -2.0) & (np.abs(e) < 2.2)
    # texture adds its own centimetre
    assert -open_start.z_site_m[strip].min() <= 0.12
    assert -rough.z_site_m[strip].min() > 0.2
    far = (n < -15) | (n > 0.5) | (np.abs(e) > 5)
    np.testing.assert_array_equal(open_start.z_site_m[far], rough.z_site_m[far])
    kept = set(map(tuple, open_start.rocks.tolist()))
    assert kept < set(map(tuple, rough.rocks.tolist()))


def test_rocks_do_not_change_with_the_ground() -> None:
    level = generate(TerrainRecipe(size_m=30, cfa=0.1, seed=2, undulation=()))
    sloped = generate(TerrainRecipe(size_m=30, cfa=0.1, seed=2, slope_deg=20))
    assert level.rocks.tobytes() == sloped.rocks.tobytes()


@pytest.mark.parametrize("cfa", [None, 0, 0.0])
def test_no_cfa_is_no_rocks(cfa: float | None) -> None:
    assert len(generate(TerrainRecipe(size_m=10, cfa=cfa)).rocks) == 0


def test_a_base_file_brings_no_undulation_and_is_scaled(tmp_path: Path) -> None:
    axis = np.arange(61) - 30.0
    up = 0.1 * axis[:, None] + 0.002 * axis[None, :] ** 2 + 100
    path = tmp_path / "base.pgm"
    write_terrain(centred((-up).astype(np.float32), 1.0), path)
    terrain = generate(
        TerrainRecipe(size_m=20, base_file=str(path), base_center_m=(5, -3), base_scale=2.0)
    )
    n, e = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
    expected = 2 * (0.1 * n + 0.002 * ((e - 3) ** 2 - 9))
    np.testing.assert_allclose(-terrain.z_site_m, expected, atol=0.012)
    with pytest.raises(TerrainError, match="not inside the base"):
        generate(TerrainRecipe(size_m=20, base_file=str(path), base_center_m=(25, 0)))
    with pytest.raises(TerrainError, match="no such file"):
        generate(TerrainRecipe(size_m=20, base_file=str(tmp_path / "none.pgm")))


def test_a_base_with_a_hole_in_the_window_is_refused(tmp_path: Path) -> None:
    rasterio = pytest.importorskip("rasterio")
    heights = np.ones((1, 40, 40), np.float32)
    heights[0, 20, 20] = -9999
    path = tmp_path / "base.tif"
    with rasterio.open(
        path, "w", driver="GTiff", dtype="float32", count=1, height=40, width=40, nodata=-9999,
        crs="+proj=eqc +R=3396190 +units=m", transform=rasterio.Affine(1, 0, 7, 0, -1, 9),
    ) as dataset:  # fmt: skip
        dataset.write(heights)
    with pytest.raises(TerrainError, match="no-data"):
        generate(TerrainRecipe(size_m=10, base_file=str(path)))
    assert generate(TerrainRecipe(size_m=5, base_file=str(path), base_center_m=(-12, -12)))


def test_a_landform_is_a_base_with_undulation() -> None:
    recipe = TerrainRecipe(size_m=30, landform=Landform(kind="crater", height_m=2), undulation=())
    assert generate(recipe).z_site_m.max() == pytest.approx(2.0, abs=0.01)
    assert recipe.model_copy(update={"undulation": None}) != recipe


def test_a_real_dem_as_base(data_dir: Path) -> None:
    recipe = TerrainRecipe(
        base_file=str(data_dir / "gale_hirise_1m.pgm"), base_center_m=(50, -60), cfa=0.07
    )
    terrain = generate(recipe)
    assert np.isfinite(terrain.z_site_m).all()
    assert 3 < np.ptp(terrain.z_site_m) < 40


@pytest.mark.parametrize(
    "bad",
    [
        {"cfa": -0.1},
        {"cfa": 1.0},
        {"cfa": math.nan},
        {"slope_deg": 61},
        {"size_m": 0},
        {"size_m": math.inf},
        {"resolution_m": 0},
        {"size_m": 10_000, "resolution_m": 0.01},
        {"size_m": 1, "resolution_m": 1},
        {"seed": -1},
        {"seed": 2**64},
        {"rock_diameter_min_m": 0},
        {"rock_diameter_min_m": 1, "rock_diameter_max_m": 1},
        {"base_file": "x", "bases": ({"file": "y"},)},
        {"landform": {"kind": "crater"}, "landforms": ({"kind": "cliff"},)},
        {"cfa": 0.1, "cfa_file": "c.tif"},
        {"cfa": 0.41},
        {"base_center_m": (1.0, 0.0)},
        {"base_scale": 2.0},
        {"base_true_scale": True},
        {"start_m": (61.0, 0.0)},
        {"undulation": ({"height_span_m": 1},)},
        {"undulation": ({"horizontal_scale_m": 0, "height_span_m": 1},)},
    ],
)
def test_bad_recipes_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        TerrainRecipe.model_validate(bad)


def test_several_undulations_add_up() -> None:
    layers = (
        Undulation(horizontal_scale_m=5, height_span_m=1.0),
        Undulation(horizontal_scale_m=0.2, height_span_m=0.1),
    )
    both = generate(TerrainRecipe(size_m=20, undulation=layers))
    first = generate(TerrainRecipe(size_m=20, undulation=layers[:1]))
    rest = both.z_site_m - first.z_site_m
    assert 4 * rest.std() == pytest.approx(0.1, rel=1e-3)


def test_layers_add_up_to_the_terrain() -> None:
    layers = generate_layers(
        TerrainRecipe(size_m=30, slope_deg=10, cfa=0.1, landform=Landform(kind="valley"), seed=3)
    )
    np.testing.assert_allclose(
        layers.ground, layers.base + layers.undulation + layers.slope, atol=1e-12
    )
    z = layers.terrain.z_site_m
    assert (z <= layers.ground.astype(np.float32)).all()
    assert 0.03 < (z < layers.ground - 0.01).mean() < 0.12


def test_landforms_combine_in_their_order() -> None:
    crater = Landform(kind="crater", height_m=2, width_m=8)
    cliff = Landform(kind="cliff", height_m=1.5, combine="higher")
    pile = Landform(kind="rock_pile", center_m=(6.0, 6.0))
    alone = [
        generate(TerrainRecipe(size_m=30, landform=form, undulation=())).z_site_m
        for form in (crater, cliff)
    ]
    both = TerrainRecipe(size_m=30, landforms=(crater, cliff), undulation=())
    np.testing.assert_array_equal(generate(both).z_site_m, np.minimum(*alone))
    lower = cliff.model_copy(update={"combine": "lower"})
    both = TerrainRecipe(size_m=30, landforms=(crater, lower), undulation=())
    np.testing.assert_array_equal(generate(both).z_site_m, np.maximum(*alone))
    three = TerrainRecipe(size_m=30, landforms=(crater, cliff, pile), undulation=())
    assert (generate(three).z_site_m <= np.minimum(*alone)).all()


def test_bases_and_landforms_combine(tmp_path: Path) -> None:
    axis = np.arange(61) - 30.0
    path = tmp_path / "base.pgm"
    write_terrain(centred((0.1 * axis[:, None] + 0 * axis).astype(np.float32), 1.0), path)
    crater = Landform(kind="crater")
    one = {"file": str(path), "scale": 2.0}
    two = {"file": str(path), "center_m": (4.0, 0.0), "scale": -1.0}
    recipe = TerrainRecipe.model_validate({"size_m": 20, "bases": (one, two), "landform": crater})
    layers = generate_layers(recipe)
    alone = generate_layers(TerrainRecipe(size_m=20, landform=crater)).base
    n = layers.terrain.north_m[:, None]
    # heights are zero at the node beside the middle
    np.testing.assert_allclose(layers.base, alone + 0.1 * (n - 0.05), atol=1e-3)
    assert not layers.undulation.any()


@pytest.mark.parametrize(("slope_deg", "azimuth_deg"), [(5, 30), (10, 123), (20, 300)])
def test_the_fitted_plane_has_the_slope_to_a_hundredth_of_a_degree(
    slope_deg: float, azimuth_deg: float
) -> None:
    terrain = generate(
        TerrainRecipe(slope_deg=slope_deg, slope_azimuth_deg=azimuth_deg, undulation=())
    )
    n, e = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
    sides = np.column_stack([n.ravel(), e.ravel(), np.ones(n.size)])
    north, east, _ = np.linalg.lstsq(sides, -terrain.z_site_m.ravel().astype(float))[0]
    assert math.degrees(math.atan(math.hypot(north, east))) == pytest.approx(slope_deg, abs=0.01)
    assert math.degrees(math.atan2(east, north)) % 360 == pytest.approx(azimuth_deg, abs=0.01)


def test_files_are_found_beside_a_recipe() -> None:
    recipe = TerrainRecipe.model_validate(
        {"bases": ({"file": "a.tif"}, {"file": "/d/b.tif"}), "cfa_file": "c.tif"}
    )
    found = recipe.with_files_in(Path("/f"))
    assert [base.file for base in found.bases] == ["/f/a.tif", "/d/b.tif"]
    assert found.cfa_file == "/f/c.tif"


def test_default_recipes_keep_what_their_seeds_gave() -> None:
    """Seeds are in use: the same ground and rocks must come again."""
    terrain = generate(TerrainRecipe(size_m=40, cfa=0.15, slope_deg=20, seed=5))
    assert len(terrain.rocks) == 4078
    assert terrain.rocks[0].item() == pytest.approx((19.4095087, -1.3374605, 0.1029363, 0.0514682))
    assert terrain.z_site_m[0, 0] == pytest.approx(5.294463, abs=1e-5)
    assert terrain.z_site_m[123, 321] == pytest.approx(-4.961577, abs=1e-5)
