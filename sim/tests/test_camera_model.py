# SPDX-License-Identifier: Apache-2.0
"""CAHVORE models and their linearisation."""

import json
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from sim.camera import load_navcams
from sim.camera_model import Cahv, Cahvore, linearised, pinhole, project, rays

SIDES = ("left", "right")


def navcam(side: str) -> Cahvore:
    model: Cahvore = getattr(load_navcams(), side)
    return model


def seen_at(model: Cahvore, direction: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The forward model: pixel of a direction far away, written anew and solved by bisection."""
    a, h, v, o = (np.array(axis) for axis in (model.a, model.h, model.v, model.o))
    o /= np.linalg.norm(o)
    theta = math.atan2(float(np.linalg.norm(np.cross(o, direction))), float(direction @ o))
    linearity = model.linearity
    chi = math.tan(linearity * theta) / linearity
    seen = (1 + model.r[0]) * chi + model.r[1] * chi**3 + model.r[2] * chi**5
    side = direction - (direction @ o) * o
    length = np.linalg.norm(side)
    ray = o + seen * (side / length if length > 1e-15 else 0 * side)
    return np.array([ray @ h / (ray @ a), ray @ v / (ray @ a)])


@pytest.mark.parametrize("side", SIDES)
def test_rays_lead_back_to_their_pixels(side: str) -> None:
    model = navcam(side)
    rng = np.random.default_rng(1)
    pixels = rng.uniform(0, [model.width_px, model.height_px], (300, 2))
    directions = rays(model, pixels[:, 0], pixels[:, 1])
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    found = [seen_at(model, direction) for direction in directions]
    np.testing.assert_allclose(found, pixels, atol=1e-6)


@pytest.mark.parametrize("side", SIDES)
def test_the_constants_are_those_of_the_published_models(side: str, data_dir: Path) -> None:
    models = json.loads((data_dir / "m2020_camera_models.json").read_text())
    (found,) = [m["model"] for m in models if m["name"] == {"left": "NAVL", "right": "NAVR"}[side]]
    model = navcam(side)
    for name in "cahvore":
        assert list(getattr(model, name)) == found[name.upper()]
    assert (model.linearity, model.width_px, model.height_px) == (
        found["linearity"],
        found["width"],
        found["height"],
    )


@pytest.mark.parametrize("side", SIDES)
def test_a_linearised_camera_keeps_view_and_pointing(side: str) -> None:
    model = navcam(side)
    linear = linearised(model)
    np.testing.assert_array_equal(linear.c, model.c)
    middle = (0.5 * (model.width_px - 1), 0.5 * (model.height_px - 1))
    np.testing.assert_allclose(linear.a, rays(model, *middle), atol=1e-12)
    # square to each other, the image's middle on the axis
    for axis, center_px in ((linear.h, middle[0]), (linear.v, middle[1])):
        assert axis @ linear.a == pytest.approx(center_px)
    focal = [np.cross(linear.a, axis) for axis in (linear.h, linear.v)]
    assert focal[0] @ focal[1] == pytest.approx(0.0, abs=1e-6)
    # as wide and as high as the lens sees
    for index, ends in enumerate(
        (
            ((-0.5, middle[1]), (model.width_px - 0.5, middle[1])),
            ((middle[0], -0.5), (middle[0], model.height_px - 0.5)),
        )
    ):
        one, other = (rays(model, *end) for end in ends)
        assert linear.fov_rad[index] == pytest.approx(
            math.acos(one @ linear.a) + math.acos(other @ linear.a)
        )


def test_the_navcams_see_what_is_published() -> None:
    """Maki et al. 2020: 96 x 73 degrees, no toe-in; the models give a little less."""
    left, right = (linearised(navcam(side)) for side in SIDES)
    for linear in (left, right):
        assert math.degrees(linear.fov_rad[0]) == pytest.approx(96, abs=2.5)
        assert math.degrees(linear.fov_rad[1]) == pytest.approx(73, abs=1.5)
        assert math.degrees(math.acos(linear.a[0])) < 1.1
    assert math.degrees(math.acos(left.a @ right.a)) < 0.5


@pytest.mark.parametrize("side", SIDES)
def test_a_linear_camera_makes_straight_lines_straight(side: str) -> None:
    linear = linearised(navcam(side))
    line = np.array([3.0, -2.0, 0.5]) + np.linspace(0, 1, 20)[:, None] * np.array([1.0, 4.0, 0.3])
    pixels = project(linear, line)
    chord = pixels[-1] - pixels[0]
    offset = pixels - pixels[0]
    across = chord[0] * offset[:, 1] - chord[1] * offset[:, 0]
    np.testing.assert_allclose(across / np.linalg.norm(chord), 0.0, atol=1e-8)


@pytest.mark.parametrize("size", [(5120, 3840), (320, 240), (7, 5)])
def test_directions_go_through_the_middles_of_pixels(size: tuple[int, int]) -> None:
    linear = linearised(navcam("left"))
    width, height = size
    directions = linear.directions(width, height).reshape(height, width, 3)
    for row, col in ((0, 0), (height - 1, width - 1), (height // 2, 1)):
        expected = [(col + 0.5) * 5120 / width - 0.5, (row + 0.5) * 3840 / height - 0.5]
        found = project(linear, linear.c + 4.0 * directions[row, col][None])
        np.testing.assert_allclose(found[0], expected, atol=1e-7)


def test_a_pinhole_is_what_its_angles_say() -> None:
    camera = pinhole((0.0, 1.0, 2.0), 90.0, 60.0, (100, 50))
    edge = project(camera, camera.c + np.array([[1.0, 1.0, 0.0], [1, 0, math.tan(math.pi / 6)]]))
    np.testing.assert_allclose(edge, [[99.5, 24.5], [49.5, 49.5]])
    assert np.isnan(project(camera, camera.c - np.array([[1.0, 0, 0]]))).all()


def test_turning_a_camera_turns_its_rays() -> None:
    camera = pinhole((0.1, 0.2, 0.3), 90.0, 60.0, (8, 6))
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    turned: Cahv = camera.turned(quarter, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(turned.c, [0.8, 2.1, 3.3])
    np.testing.assert_allclose(
        turned.directions(8, 6), camera.directions(8, 6) @ quarter.T, atol=1e-12
    )
