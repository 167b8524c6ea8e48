# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.terrain_files import generate_terrain
from sim.errors import SimError

SMALL = {"size_m": 20.0, "cfa": 0.05, "seed": 3}


def test_the_yaml_beside_a_terrain_makes_it_again(tmp_path):
    generate_terrain(tmp_path / "deep/a.pgm", None, SMALL)
    generate_terrain(tmp_path / "b.pgm", tmp_path / "deep/a.yaml", {})
    for suffix in (".pgm", ".yaml", ".rocks.csv"):
        first = (tmp_path / "deep/a.pgm").with_suffix(suffix).read_bytes()
        assert (tmp_path / "b.pgm").with_suffix(suffix).read_bytes() == first


def test_a_recipe_file_may_be_overridden(tmp_path):
    (tmp_path / "r.yaml").write_text("size_m: 20\nslope_deg: 5\nslope_azimuth_deg: 0\n")
    terrain = generate_terrain(tmp_path / "a.pgm", tmp_path / "r.yaml", {"slope_deg": 10})
    assert terrain.recipe is not None
    assert terrain.recipe["slope_deg"] == 10.0


@pytest.mark.parametrize(
    ("name", "overrides", "message"),
    [
        ("a.png", {}, "expected a name ending in .pgm"),
        ("a.pgm", {"cfa": 7.0}, "--set cfa: expected <= 0.4"),
        ("a.pgm", {"size": 7.0}, "did you mean 'size_m'"),
        ("a.pgm", {"base_file": "none.tif"}, "no such file"),
    ],
)
def test_bad_input_is_one_clear_error_and_leaves_nothing(tmp_path, name, overrides, message):
    with pytest.raises(SimError, match=message):
        generate_terrain(tmp_path / name, None, overrides)
    assert list(tmp_path.iterdir()) == []
