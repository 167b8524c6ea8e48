# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from pyharness.executive_config import ComputeTimes
from pyharness.messages import Arc, Pose6, Uncertainty
from pyharness.params import param_values
from pyharness.records import RecordStream, Waypoint
from pyharness.status import Reason
from pyharness.thinker import (
    Image,
    PlannerFaultError,
    Selection,
    Thinker,
    describe_rejections,
)

POSE = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
CERTAIN = Uncertainty(0.0, 0.0, 0.0)
GOAL = Waypoint(5.0, 0.0, 1.0, "avoid_all")


@pytest.fixture
def planner(fake_planner):
    return fake_planner(param_values({}), RecordStream().publish)


@pytest.fixture
def thinker(planner):
    return Thinker(planner, ComputeTimes())


def test_compute_time_grows_with_the_work(thinker, planner):
    times = thinker.times
    image = Image(1, 0.0, POSE, np.zeros((3, 3), np.float32), pair_count=3)
    assert thinker.process(image) == 3 * times.process_disparity_s
    planner.ace_evaluations = 100
    _, duration_s = thinker.select(0.0, POSE, CERTAIN, GOAL, Arc(1.0, 0.0))
    assert duration_s == times.select_base_s + 100 * times.select_per_evaluation_s


def test_no_path_is_an_answer(thinker, planner):
    planner.arcs = [None]
    selection, _ = thinker.select(0.0, POSE, CERTAIN, GOAL, Arc(0.0, 0.0))
    assert selection.arc is None
    assert selection.rejections == {Reason.TILT: 1694}
    assert selection.main_reason == Reason.TILT


@pytest.mark.parametrize("name", ["process", "analyze", "select", "evaluate"])
def test_a_refusal_is_a_fault_with_its_text(thinker, planner, name):
    planner.refuses = name
    image = Image(1, 0.0, POSE, np.zeros((3, 3), np.float32), 1)
    calls = {
        "process": lambda: thinker.process(image),
        "analyze": lambda: thinker.analyze(0.0, POSE, GOAL, 0.0),
        "select": lambda: thinker.select(0.0, POSE, CERTAIN, GOAL, Arc(0.0, 0.0)),
        "evaluate": lambda: thinker.evaluate(
            0.0, POSE, CERTAIN, Arc(1.0, 0.0), "avoid_all", is_leaving=False
        ),
    }
    with pytest.raises(PlannerFaultError, match="only a defect can produce"):
        calls[name]()


@pytest.mark.parametrize("arc", [(0.0, 0.0), (math.nan, 0.0), (1.0, math.inf)])
def test_an_arc_that_leads_nowhere_is_a_fault(thinker, planner, arc):
    planner.arcs = [arc]
    with pytest.raises(PlannerFaultError, match="leads nowhere"):
        thinker.select(0.0, POSE, CERTAIN, GOAL, Arc(0.0, 0.0))


def test_a_planner_that_raises_is_a_fault(thinker, planner, monkeypatch):
    def fail(request):
        raise ZeroDivisionError(request.dtype.names[0])

    monkeypatch.setattr(planner, "_analyze_terrain", fail)
    with pytest.raises(PlannerFaultError, match="ZeroDivisionError"):
        thinker.analyze(0.0, POSE, GOAL, 0.0)


def test_rejections_are_named_the_most_frequent_first():
    assert describe_rejections({Reason.KIOZ: 1, Reason.TILT: 5}) == "tilt 5, kioz 1"
    assert describe_rejections({}) == "none"
    assert Selection(None, {Reason.COST: 9, Reason.KIOZ: 1}, "guarded").main_reason == Reason.KIOZ


def test_an_arc_passed_by_the_leave_limits_is_evaluated_by_them(thinker, planner, monkeypatch):
    asked = []
    evaluate = planner._evaluate_arc

    def spy(request):
        asked.append(int(request["is_leaving"]))
        return evaluate(request)

    monkeypatch.setattr(planner, "_evaluate_arc", spy)
    for is_leaving in (False, True):
        thinker.evaluate(0.0, POSE, CERTAIN, Arc(1.0, 0.0), "avoid_all", is_leaving)
    assert asked == [0, 1]
