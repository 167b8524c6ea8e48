# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness import bench


def test_the_ratio_is_value_over_reference():
    result = bench.compared("x", 3.0, "ms", "other", 2.0)
    assert (result.reference, result.ratio) == ("other", 1.5)


def test_a_reference_that_is_not_installed_leaves_nothing():
    result = bench.compared("x", 3.0, "ms", "other", None)
    assert (result.reference, result.reference_value, result.ratio) == (None, None, None)


def test_the_shortest_repeat_counts():
    calls = []
    assert bench.best_of(lambda: calls.append(1), 5) >= 0.0
    assert len(calls) == 5


@pytest.mark.parametrize(
    "measure",
    [
        lambda small: [bench.bench_dijkstra(small)],
        lambda small: [bench.bench_select_arc(small)],
        bench.bench_analyze_terrain,
        bench.bench_process_disparity,
        bench.bench_cycle_share,
    ],
    ids=["dijkstra", "select_arc", "analyze_terrain", "process_disparity", "cycle_share"],
)
def test_what_is_measured_runs(measure, monkeypatch):
    monkeypatch.setattr(bench, "REPEATS", 1)
    scenario = bench.load_scenario(None, {})
    small = bench.Bench(scenario, bench.make_terrain(scenario), scenario.vehicle)
    assert all(result.value > 0.0 for result in measure(small))
