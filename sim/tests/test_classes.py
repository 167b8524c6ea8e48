# SPDX-License-Identifier: Apache-2.0
"""Terrain class maps."""

import numpy as np
import pytest

from sim.classes import ClassLayer, class_map
from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate
from sim.terrain import CLASS_NAMES, Terrain, centred
from sim.terrain_io import classes_path, read_terrain, write_terrain

SAND, SOIL = CLASS_NAMES.index("sand"), CLASS_NAMES.index("cohesive_soil")
LAYERS = (
    ClassLayer(terrain_class="cohesive_soil"),
    ClassLayer(terrain_class="sand", cover=0.3, horizontal_scale_m=4.0),
)


def test_patches_cover_their_share() -> None:
    classes = class_map(LAYERS, (400, 300), 0.1, seed=1)
    assert classes is not None
    assert (classes == SAND).mean() == pytest.approx(0.3, abs=0.001)
    assert (classes == SOIL).mean() == pytest.approx(0.7, abs=0.001)
    # patches, not pepper: neighbours are alike
    assert (classes[1:] == classes[:-1]).mean() > 0.98
    assert class_map((), (4, 4), 0.1, seed=1) is None


def test_classes_do_not_change_the_ground() -> None:
    plain = generate(TerrainRecipe(size_m=20, cfa=0.1, seed=2))
    classed = generate(TerrainRecipe(size_m=20, cfa=0.1, seed=2, classes=LAYERS))
    assert classed.z_site_m.tobytes() == plain.z_site_m.tobytes()
    assert plain.classes is None
    assert plain.class_at(0.0, 0.0) == 0


def test_classes_are_stored_and_found_again(tmp_path) -> None:
    terrain = generate(TerrainRecipe(size_m=20, seed=2, classes=LAYERS))
    path = tmp_path / "t.pgm"
    write_terrain(terrain, path)
    again = read_terrain(path)
    assert again.classes is not None
    assert terrain.classes is not None
    np.testing.assert_array_equal(again.classes, terrain.classes)
    assert "class_names" in path.with_suffix(".yaml").read_text()
    n, e = terrain.north_m[17], terrain.east_m[150]
    assert again.class_at(n + 0.03, e - 0.04) == terrain.classes[17, 150]
    np.testing.assert_array_equal(again.class_at([n, 99.0], e), [terrain.classes[17, 150], 0])
    write_terrain(generate(TerrainRecipe(size_m=20)), path)
    assert read_terrain(path).classes is None


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"P5\n4 4\n255\n" + bytes([7] * 16), "class 7, expected 0 unspecified, 1 bedrock"),
        (b"P5\n4 3\n255\n" + bytes(12), "the terrain has 4 x 4"),
        (b"P5\n4 4\n65535\n" + bytes(32), "expected 255"),
        (b"P5\n4 4\n255\n" + bytes(15), "too short"),
    ],
)
def test_bad_class_maps_give_one_clear_line(tmp_path, content, expected) -> None:
    path = tmp_path / "t.pgm"
    write_terrain(centred(np.zeros((4, 4), np.float32), 1.0), path)
    classes_path(path).write_bytes(content)
    with pytest.raises(TerrainError, match=expected) as caught:
        read_terrain(path)
    assert len(str(caught.value).splitlines()) == 1


def test_classes_must_fit_the_grid() -> None:
    with pytest.raises(TerrainError, match="classes of shape"):
        Terrain(np.zeros((3, 3), np.float32), 1.0, 0, 0, classes=np.zeros((2, 3), np.uint8))
