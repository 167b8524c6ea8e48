# SPDX-License-Identifier: Apache-2.0
"""What must hold for every world: Navlib against itself in a changed world, and against scipy."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from pyharness.clib import ffi, lib
from pyharness.dp import Kind, new_message
from pyharness.layout import dtype_of
from pyharness.messages import Pose6, cloud_requests
from pyharness.navlib import Navlib
from pyharness.params import param_values
from pyharness.status import Mode, Reason
from pyharness.tests.ace_oracle import ace_bounds, navlib_on
from sim.generate import TerrainRecipe, generate
from sim.terrain import Terrain, centred

SIZE_M = 30.0
RESOLUTION_M = 0.1
COST_CELL_M = 0.5
SIDE = lib.NAV_COSTMAP_SIZE
INFINITE_S = 1.0e12
# ACE bounds clearance row by row of the grid: how much it gives away depends on the heading of the
# rows. Where worlds are turned, clearance must not decide.
ANY_CLEARANCE = {"clearance_min_m": 0.0, "belly_height_m": 1.2}
START_M = (0.13, 0.07)  # on no line of the grids: a border belongs to one of two cells
quick = settings(
    max_examples=8,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
seeds = st.integers(0, 10_000)
goals = st.tuples(st.floats(8.0, 20.0), st.floats(-2.5, 2.5))


def rocky(seed, cfa=0.07, slope_deg=5.0):
    return generate(TerrainRecipe(size_m=SIZE_M, cfa=cfa, slope_deg=slope_deg, seed=seed))


def terrain_of(z_m):
    return centred(np.ascontiguousarray(z_m, dtype=np.float32), RESOLUTION_M)


def grid_m():
    count = round(SIZE_M / RESOLUTION_M)
    axis_m = (np.arange(count) - 0.5 * (count - 1)) * RESOLUTION_M
    return np.meshgrid(axis_m, axis_m, indexing="ij")


def polar(distance_m, bearing_rad):
    return distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad)


def decision(navlib, goal_m, yaw_rad=0.0, start_m=START_M, mode=Mode.AVOID_ALL):
    """Status, cost, arc of the call from a pose."""
    request = new_message(Kind.SELECT_ARC_IN)
    request["pose"]["x_site_m"], request["pose"]["y_site_m"] = start_m
    request["pose"]["yaw_rad"] = yaw_rad
    request["goal"]["x_site_m"], request["goal"]["y_site_m"] = goal_m
    request["goal"]["radius_m"] = 1.0
    request["mode"] = mode
    answer = navlib.select_arc(request)
    lib.nav_stub_clear()
    arc = answer["arc"]
    return (
        int(answer["status"]),
        float(answer["path_cost_s"]),
        float(arc["length_m"]),
        float(arc["heading_change_rad"]),
    )


@quick
@given(seed=seeds, goal=goals, quarters=st.integers(1, 3))
def test_a_world_turned_by_quarters_is_decided_the_same(seed, goal, quarters):
    z_m = rocky(seed).z_site_m
    expected = decision(navlib_on(terrain_of(z_m), ANY_CLEARANCE), polar(*goal))
    for _ in range(quarters):
        z_m = z_m.T[::-1]  # what lay north lies east
    turn_rad = quarters * math.pi / 2.0
    turned_goal = polar(goal[0], goal[1] + turn_rad)
    start_m = polar(math.hypot(*START_M), math.atan2(START_M[1], START_M[0]) + turn_rad)
    turned = decision(navlib_on(terrain_of(z_m), ANY_CLEARANCE), turned_goal, turn_rad, start_m)
    assert turned == pytest.approx(expected, rel=1e-6, abs=1e-6)


@quick
@given(seed=seeds, goal=goals)
def test_a_mirrored_world_is_decided_as_in_a_mirror(seed, goal):
    z_m = rocky(seed).z_site_m
    north_m, east_m = polar(*goal)
    plain = decision(navlib_on(terrain_of(z_m), ANY_CLEARANCE), (north_m, east_m))
    mirrored = decision(
        navlib_on(terrain_of(z_m[:, ::-1]), ANY_CLEARANCE),
        (north_m, -east_m),
        start_m=(START_M[0], -START_M[1]),
    )
    assert mirrored[:3] == pytest.approx(plain[:3], rel=1e-6, abs=1e-6)
    if plain[2] == 0.0:  # a half turn in place goes the same way in both worlds
        assert abs(mirrored[3]) == pytest.approx(abs(plain[3]), abs=1e-6)
    else:
        assert mirrored[3] == pytest.approx(-plain[3], abs=1e-6)


@quick
@given(seed=seeds)
def test_a_world_turned_by_a_quarter_has_the_same_bounds(seed):
    z_m = rocky(seed).z_site_m
    rng = np.random.default_rng(seed)
    poses = rng.uniform((-10.0, -10.0, -math.pi), (10.0, 10.0, math.pi), (300, 3))
    turned = np.column_stack([-poses[:, 1], poses[:, 0], poses[:, 2] + math.pi / 2.0])
    certain = np.zeros((300, 2))
    plain_bounds = ace_bounds(navlib_on(terrain_of(z_m)), poses, certain)
    turned_bounds = ace_bounds(navlib_on(terrain_of(z_m.T[::-1])), turned, certain)
    assert np.array_equal(plain_bounds["reason"], turned_bounds["reason"])
    assert np.array_equal(plain_bounds["is_certified"], turned_bounds["is_certified"])
    for name in plain_bounds.dtype.names:
        if name.endswith("_rad") or name in ("wheel_drop_max_m", "z_min_site_m", "z_max_site_m"):
            # rough looks take whole batches, of a few columns but two rows: where these are more
            # than the wheel needs, bounds differ a little; a cell on the border of a box can
            # fall to either side by rounding
            apart = np.abs(plain_bounds[name] - turned_bounds[name])
            assert np.median(apart) < 1e-6, name
            assert np.sum(apart > 1e-3) <= 15, name


@quick
@given(seed=seeds, goal=goals, rows=st.integers(-4000, 4000), cols=st.integers(-4000, 4000))
def test_a_world_shifted_by_whole_cells_is_decided_the_same(seed, goal, rows, cols):
    terrain = rocky(seed)
    expected = decision(navlib_on(terrain), polar(*goal))
    shift_m = (rows * COST_CELL_M, cols * COST_CELL_M)
    north, east = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
    points = np.stack([north, east, terrain.z_site_m], axis=-1).reshape(-1, 3)
    navlib = Navlib(param_values({}))
    pose = Pose6(*shift_m, 0.0, 0.0, 0.0, 0.0)
    for chunk in cloud_requests(0.0, pose, 1, points.astype(np.float32)):
        assert navlib.process_disparity(chunk)["status"] == 0
        lib.nav_stub_clear()
    look = new_message(Kind.ANALYZE_TERRAIN_IN)
    look["pose"]["x_site_m"], look["pose"]["y_site_m"] = shift_m
    assert navlib.analyze_terrain(look)["status"] == 0
    goal_m, start_m = (np.add(place, shift_m) for place in (polar(*goal), START_M))
    shifted = decision(navlib, goal_m, start_m=start_m)
    assert shifted == pytest.approx(expected, rel=1e-6, abs=1e-6)


@quick
@given(seed=seeds, splits=st.lists(st.integers(1, 5000), min_size=1, max_size=6))
def test_a_cloud_split_in_any_chunks_makes_the_same_heightmap(seed, splits):
    rng = np.random.default_rng(seed)
    points = rng.uniform((-16.0, -16.0, -1.0), (16.0, 16.0, 1.0), (6000, 3)).astype(np.float32)
    pose = Pose6(1.3, -2.7, 0.2, 0.05, -0.1, 0.7)
    bounds = np.unique(np.concatenate([[0], np.cumsum(splits), [len(points)]]))
    bounds = bounds[bounds <= len(points)]
    maps = []
    for cuts in ([0, len(points)], bounds):
        navlib = Navlib(param_values({}))
        for index, (first, end) in enumerate(itertools.pairwise(cuts)):
            (request,) = cloud_requests(0.0, pose, 1, points[first:end])
            request["chunk_index"], request["chunk_count"] = index, len(cuts) - 1
            assert navlib.process_disparity(request)["status"] == 0
            lib.nav_stub_clear()
        maps.append(bytes(ffi.buffer(ffi.addressof(navlib.context, "heightmap"))))
    assert maps[0] == maps[1]


@quick
@given(
    seed=seeds,
    place=st.tuples(st.floats(-0.8, 0.5), st.floats(-0.4, 0.4)),
    height_m=st.floats(0.05, 0.4),
    raised_m=st.floats(0.02, 0.3),
)
def test_raising_a_rock_under_the_belly_never_makes_ace_safer(seed, place, height_m, raised_m):
    north, east = grid_m()
    rng = np.random.default_rng(seed)
    slope = rng.uniform(-0.2, 0.2, 2)
    ground = slope[0] * north + slope[1] * east + 0.02 * np.sin(north + rng.uniform(0.0, 6.0))
    rock = np.hypot(north - 0.25 - place[0], east - 0.25 - place[1]) < 0.15
    pose = np.array([[0.25, 0.25, 0.0]])
    low, high = (
        ace_bounds(navlib_on(terrain_of(-(ground + rock * size_m))), pose, np.zeros((1, 2)))[0]
        for size_m in (height_m, height_m + raised_m)
    )
    assert high["clearance_min_m"] <= low["clearance_min_m"] + 1e-3
    assert low["reason"] == Reason.NONE or high["reason"] != Reason.NONE


def cost_to_go_s(navlib, goal_m, use_terrain=True, use_zones=True):
    ctx = navlib.context
    goal = ffi.new("nav_waydisc_t *", (*goal_m, 1.0))
    lib.nav_global_plan(
        ffi.addressof(ctx, "global"),
        ffi.addressof(ctx, "costmap"),
        ffi.addressof(ctx, "params"),
        goal,
        use_terrain,
        use_zones,
    )
    costs = np.frombuffer(ffi.buffer(getattr(ctx, "global").cost_to_go_s), dtype=np.float64)
    return costs.reshape(SIDE + 2, SIDE + 2)[1:-1, 1:-1].copy()


@quick
@given(
    seed=seeds,
    place=st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0)),
    radius_m=st.floats(0.6, 6.0),
)
def test_a_keep_out_zone_never_lowers_a_cost_to_go(seed, place, radius_m):
    goal_m = (12.0, 3.0)
    assume(math.dist(place, goal_m) > radius_m + 2.0)
    navlib = navlib_on(rocky(seed))
    before = cost_to_go_s(navlib, goal_m)
    request = new_message(Kind.SET_KIOZ_IN)
    request["zone_count"] = 1
    zone = request["zones"][0]
    zone["kind"], zone["shape"] = lib.NAV_ZONE_KEEP_OUT, lib.NAV_ZONE_CIRCLE
    zone["center_x_site_m"], zone["center_y_site_m"] = place
    zone["radius_m"] = radius_m
    assert navlib.set_kioz(request)["status"] == 0
    assert navlib.analyze_terrain(new_message(Kind.ANALYZE_TERRAIN_IN))["status"] == 0
    lib.nav_stub_clear()
    after = cost_to_go_s(navlib, goal_m)
    assert np.all(after >= before)
    assert np.any(after > before)


@quick
@given(
    height_m=st.floats(-50.0, 50.0),
    place=st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0)),
    radius_m=st.floats(1.5, 5.0),
)
def test_unknown_cells_in_a_known_flat_map_are_never_cheaper(height_m, place, radius_m):
    # flat: on a slope the filled rim of a hole is a little more level than the ground was
    north, east = grid_m()
    z_m = np.full_like(north, height_m, dtype=np.float32)
    goal_m = (12.0, 3.0)
    before = cost_to_go_s(navlib_on(terrain_of(z_m)), goal_m)
    z_m[np.hypot(north - place[0], east - place[1]) < radius_m] = np.nan
    hidden = Terrain(z_m, RESOLUTION_M, float(north[0, 0]), float(east[0, 0]))
    after = cost_to_go_s(navlib_on(hidden), goal_m)
    assert np.all(after >= before * (1.0 - 1e-6))
    assert np.any(after > before * 1.001)


@quick
@given(seed=seeds, cfa=st.floats(0.03, 0.15), slope_deg=st.floats(0.0, 20.0))
def test_with_more_uncertainty_ace_accepts_no_other_poses(seed, cfa, slope_deg):
    navlib = navlib_on(rocky(seed, cfa, slope_deg))
    rng = np.random.default_rng(seed)
    poses = rng.uniform((-10.0, -10.0, -math.pi), (10.0, 10.0, math.pi), (300, 3))
    accepted = [
        ace_bounds(navlib, poses, np.full((300, 2), (doubt, 0.3 * doubt)))["reason"] == Reason.NONE
        for doubt in (0.0, 0.03, 0.08, 0.2)
    ]
    for less, more in itertools.pairwise(accepted):
        # where a wider range starts from other samples a bound can move by a millimetre
        assert np.sum(more & ~less) <= 1
    assert np.sum(accepted[0]) > np.sum(accepted[-1])


def edges_of(cost, blocked):
    """Edges between free cells: length times mean cost, none between two blocked corners."""
    rows, cols = np.indices(cost.shape)
    cells = rows * SIDE + cols
    starts, ends, weights = [], [], []
    for d_row, d_col in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = (slice(0, SIDE - d_row), slice(max(0, -d_col), SIDE - max(0, d_col)))
        there = (slice(d_row, SIDE), slice(max(0, d_col), SIDE + min(0, d_col)))
        is_open = ~blocked[here] & ~blocked[there]
        if d_row and d_col:
            beside_row = blocked[here[0], there[1]]
            beside_col = blocked[there[0], here[1]]
            is_open &= ~(beside_row & beside_col)
        length_m = COST_CELL_M * math.hypot(d_row, d_col)
        starts.append(cells[here][is_open])
        ends.append(cells[there][is_open])
        weights.append((length_m * 0.5 * (cost[here] + cost[there]))[is_open])
    a, b, w = (np.concatenate(parts) for parts in (starts, ends, weights))
    shape = (SIDE * SIDE, SIDE * SIDE)
    return csr_array((np.tile(w, 2), (np.concatenate([a, b]), np.concatenate([b, a]))), shape)


@quick
@given(seed=seeds, share=st.floats(0.0, 0.45), spread=st.floats(0.0, 4.0))
def test_costs_to_go_agree_with_those_of_scipy(seed, share, spread):
    rng = np.random.default_rng(seed)
    navlib = navlib_on(terrain_of(np.zeros((300, 300))))
    cells = np.frombuffer(
        ffi.buffer(navlib.context.costmap.cells), dtype=dtype_of("nav_cost_cell_t")
    )
    cells["cost_s_per_m"] = np.exp(rng.normal(3.0, spread, SIDE * SIDE))
    cells["terrain_reason"] = np.where(rng.random(SIDE * SIDE) < share, Reason.TILT, 0)
    goal_cell = (60, 42)
    goal_index = goal_cell[0] * SIDE + goal_cell[1]
    cells["terrain_reason"][goal_index] = 0
    goal_m = tuple((index - SIDE / 2 + 0.5) * COST_CELL_M for index in goal_cell)
    found = cost_to_go_s(navlib, goal_m)
    cost = cells["cost_s_per_m"].astype(np.float64).reshape(SIDE, SIDE)
    blocked = (cells["terrain_reason"] != 0).reshape(SIDE, SIDE)
    rows, cols = np.indices((SIDE, SIDE))
    near = COST_CELL_M * np.hypot(rows - goal_cell[0], cols - goal_cell[1]) <= 1.0
    sources = np.flatnonzero((near & ~blocked).ravel())
    expected = dijkstra(edges_of(cost, blocked), indices=sources, min_only=True)
    expected = np.where(np.isinf(expected), INFINITE_S, expected).reshape(SIDE, SIDE)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
