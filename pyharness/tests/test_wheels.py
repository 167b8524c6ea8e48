# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import native_schema
from pyharness.messages import Arc
from pyharness.status import Activity
from pyharness.telemetry import Telemetry
from pyharness.wheels import Motion, Wheels


@pytest.fixture
def world(fake_world):
    return fake_world()


@pytest.fixture
def records():
    return []


@pytest.fixture
def wheels(world, records):
    def sink(kind, _, payload):
        record = native_schema().decode(kind, payload)
        records.append((Activity(int(record["activity"])), float(record["end_s"])))

    return Wheels(world, Telemetry(world, sink))


def pass_time(world, seconds):
    for _ in range(round(8 * seconds)):
        world.step()


def test_straight_on_they_drive_at_once(wheels):
    assert wheels.begin(Arc(1.0, 0.0))
    assert wheels.motion is Motion.DRIVING


def test_they_steer_standing_before_another_curvature(wheels, world, records):
    assert not wheels.begin(Arc(1.0, 0.5))
    assert wheels.motion is Motion.STEERING
    assert wheels.remaining == Arc(1.0, 0.5)
    pass_time(world, 9.0)
    assert not wheels.drive_if_steered()
    pass_time(world, 1.0)
    assert wheels.drive_if_steered()
    pass_time(world, 5.0)
    assert wheels.remaining == Arc(0.75, 0.375)
    assert wheels.end() == Arc(0.25, 0.125)
    assert world.arc is None
    assert wheels.remaining.is_empty
    assert records == [(Activity.STEERING, 10.0), (Activity.DRIVING, 15.0)]


def test_parts_of_one_arc_need_no_steering(wheels, world):
    arc = Arc(3.0, 0.7)
    wheels.begin(arc)
    pass_time(world, 10.0)
    wheels.drive_if_steered()
    wheels.end()
    for fraction in (0.1, 0.3, 1 / 3, 0.7):
        assert wheels.begin(arc.part(fraction))
        wheels.end()
