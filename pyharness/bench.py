# SPDX-License-Identifier: Apache-2.0
"""How fast is it: `make bench` prints a table and writes build/bench.json.

Every number stands beside one of a reference that does the same amount of the same kind of work,
measured in the same run; the ratio is value / reference.
"""

import json
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pyharness import messages
from pyharness.bench_ace import ace_instructions
from pyharness.clib import ffi, lib
from pyharness.dp import Message
from pyharness.drive import drive
from pyharness.history import History
from pyharness.layout import dtype_of
from pyharness.messages import Arc, Pose6, Uncertainty
from pyharness.navlib import Navlib
from pyharness.planners.enav import Enav
from pyharness.records import RecordStream, Waypoint
from pyharness.scenario import (
    Scenario,
    drive_info,
    load_scenario,
    make_terrain,
    navlib_params,
)
from sim.camera import CameraConfig, camera_pair
from sim.frames import rotation
from sim.generate import TerrainRecipe, generate
from sim.raycast import RayCaster
from sim.settle import Settler
from sim.terrain import Terrain
from sim.vehicle import Vehicle
from sim.world import World

REPEATS = 7
POINTS = 250_000
STEP_M = 0.042 / 8  # the fastest wheel in one tick
RANGE_MAX_M = 25.0
GOAL = Waypoint(40.0, 0.0, 2.0, "avoid_all")
CERTAIN = Uncertainty(0.03, 0.005, 0.1)
OUTPUT = Path("build/bench.json")

# The least that any merging must do. `bin_site` is given points that stand in the map's frame
# already; `bin_rover` is given what Navlib is given. Neither checks its input, knows a map that
# rolls, tells images apart or copies data products.
BINNING_C = """
void bin_site(const float *points, int count, double *sum, int *hits)
{
    for (int i = 0; i < count; ++i)
    {
        const int row = (int) (points[3 * i] * 10.0F);
        const int col = (int) (points[3 * i + 1] * 10.0F);
        if ((row >= 0) && (row < 300) && (col >= 0) && (col < 300))
        {
            sum[300 * row + col] += points[3 * i + 2];
            hits[300 * row + col] += 1;
        }
    }
}
void bin_rover(const float *points, int count, const double *to, double *sum, int *hits)
{
    for (int i = 0; i < count; ++i)
    {
        const double x = points[3 * i], y = points[3 * i + 1], z = points[3 * i + 2];
        const double row = to[0] * x + to[1] * y + to[2] * z + to[3];
        const double col = to[4] * x + to[5] * y + to[6] * z + to[7];
        if ((row >= 0.0) && (row < 300.0) && (col >= 0.0) && (col < 300.0))
        {
            const int cell = 300 * (int) row + (int) col;
            sum[cell] += to[8] * x + to[9] * y + to[10] * z + to[11];
            hits[cell] += 1;
        }
    }
}
"""
BINNING_CDEF = """
void bin_site(const float *points, int count, double *sum, int *hits);
void bin_rover(const float *points, int count, const double *to, double *sum, int *hits);
"""


@dataclass(frozen=True, slots=True)
class Result:
    """One measurement."""

    name: str
    value: float
    unit: str
    reference: str | None = None
    reference_value: float | None = None
    ratio: float | None = None


def compared(
    name: str, value: float, unit: str, reference: str, reference_value: float | None
) -> Result:
    """Return a measurement beside its reference, if that could be measured."""
    if reference_value is None:
        return Result(name, value, unit)
    return Result(name, value, unit, reference, reference_value, value / reference_value)


def best_of(function: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the shortest of several durations: the one with the least disturbance."""
    durations_s = []
    for _ in range(repeats):
        start_s = time.perf_counter()
        function()
        durations_s.append(time.perf_counter() - start_s)
    return min(durations_s)


@dataclass(frozen=True, slots=True)
class Bench:
    """The demonstration drive's scenario, terrain and rover."""

    scenario: Scenario
    terrain: Terrain
    vehicle: Vehicle

    def mapped(self) -> tuple[Navlib, Pose6]:
        """Return Navlib with a map of the ground under and around the rover, and where that is."""
        navlib = Navlib(navlib_params(self.scenario))
        images = self.images(start_m=-44.0, count=5, step_m=2.0)
        for _, requests in images:
            for request in requests:
                navlib.process_disparity(request)
        return navlib, images[-1][0]

    def images(
        self, start_m: float = -44.0, count: int = 8, step_m: float = 1.0
    ) -> list[tuple[Pose6, list[Message]]]:
        """Return clouds taken on the way north, in chunks, with the poses of their imaging."""
        found = []
        for index in range(count):
            world = World(self.terrain, self.vehicle, start=(start_m + step_m * index, 0.0, 0.0))
            pose = messages.copy_pose(world.truth)
            requests = list(messages.cloud_requests(0.0, pose, index + 1, world.image()))
            found.append((pose, requests))
        return found


def bench_process_disparity(bench: Bench) -> Iterator[Result]:
    """Merge a cloud in chunks, as C calls of Navlib that send their data products to the stubs.

    The rows after the first tell what else could be counted: a reference that need not turn the
    points, what the stubs' copies of the data products take, the calls from Python.
    """
    rng = np.random.default_rng(1)
    points_m = rng.uniform((-15, -15, -1), (15, 15, 1), (POINTS, 3)).astype(np.float32)
    level = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    requests = [
        list(messages.cloud_requests(0.0, level, image_id, points_m))
        for image_id in range(1, 3 * REPEATS + 1)
    ]
    navlib = Navlib(navlib_params(bench.scenario))
    answer = ffi.new("nav_process_disparity_out_t *")
    in_c = [
        [ffi.from_buffer("nav_process_disparity_in_t *", request) for request in image]
        for image in requests
    ]
    images, images_python = iter(in_c[: 2 * REPEATS]), iter(requests[2 * REPEATS :])

    def merge() -> None:
        for chunk in next(images):
            lib.nav_process_disparity(navlib.context, chunk, answer)
            lib.nav_stub_clear()

    def merge_python() -> None:
        for request in next(images_python):
            navlib.process_disparity(request)
            for _ in navlib.drain():
                pass

    def send() -> None:
        for request, chunk in zip(requests[0], in_c[0], strict=True):
            used = request.nbytes - 12 * (lib.NAV_CHUNK_POINTS_MAX - int(request["point_count"]))
            lib.nav_dp_send(lib.NAV_DP_PROCESS_DISPARITY_IN, 0.0, chunk, used)
            lib.nav_stub_clear()

    value_ms = 1e3 * best_of(merge, 2 * REPEATS)
    site_ms, rover_ms = _binning_ms(points_m) or (None, None)
    name = "process_disparity"
    yield compared(name, value_ms, "ms", "C loop: turn and bin", rover_ms)
    yield compared(f"{name}_floor", value_ms, "ms", "C loop: bin turned points", site_ms)
    yield Result(f"{name}_copies", 1e3 * best_of(send, REPEATS), "ms")
    yield Result(f"{name}_python", 1e3 * best_of(merge_python, REPEATS), "ms")


def _binning_ms(points_m: npt.NDArray[np.float32]) -> tuple[float, float] | None:
    """Compile and time the two loops."""
    from cffi import FFI

    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder, "bin.c"), Path(folder, "bin.so")
        source.write_text(BINNING_C)
        command = ["cc", "-O3", "-shared", "-fPIC", str(source), "-o", str(library)]
        if subprocess.run(command, check=False).returncode != 0:
            return None
        plain: Any = FFI()
        plain.cdef(BINNING_CDEF)
        loops = plain.dlopen(str(library))
        points = plain.from_buffer("float[]", points_m)
        moved = plain.from_buffer("float[]", points_m + np.float32(15.0))
        sums = plain.from_buffer("double[]", np.zeros(90_000))
        hits = plain.from_buffer("int[]", np.zeros(90_000, np.int32))
        to = plain.from_buffer(
            "double[]", np.array([10.0, 0, 0, 150, 0, 10.0, 0, 150, 0, 0, 1.0, 0])
        )
        count = len(points_m)
        site_s = best_of(lambda: loops.bin_site(moved, count, sums, hits), 2 * REPEATS)
        rover_s = best_of(lambda: loops.bin_rover(points, count, to, sums, hits), 2 * REPEATS)
        return 1e3 * site_s, 1e3 * rover_s


def bench_analyze_terrain(bench: Bench) -> Iterator[Result]:
    """Compute surface and costmap; the reference fits a plane around each of 300 x 300 cells.

    Dijkstra is no part of it: select_arc plans. The references do not close gaps or move the map;
    the second only sums. First what a drive asks for, a new cloud a metre further on; then all
    anew; then nothing new.
    """
    drive_images = bench.images()
    navlib = Navlib(navlib_params(bench.scenario))
    typical_s, full_s = math.inf, math.inf
    for _ in range(REPEATS):
        navlib = Navlib(navlib_params(bench.scenario))
        for index, (pose, requests) in enumerate(drive_images):
            for request in requests:
                navlib.process_disparity(request)
            duration_s = _analysis_s(navlib, pose)
            typical_s = min(typical_s, duration_s) if index > 0 else typical_s
        for state in ("surface_state", "costmap_state", "relief"):
            ffi.memmove(ffi.addressof(navlib.context, state), *_zeros(navlib.context, state))
        full_s = min(full_s, _analysis_s(navlib, drive_images[-1][0]))
    nothing_s = min(_analysis_s(navlib, drive_images[-1][0]) for _ in range(REPEATS))

    z_m = np.random.default_rng(1).normal(size=(300, 300))
    sums_ms = 1e3 * best_of(partial(_box_sums, z_m))
    fits_ms = 1e3 * best_of(partial(_plane_fits, z_m))
    for name, value_s in (
        ("analyze_terrain", typical_s),
        ("analyze_terrain_all", full_s),
        ("analyze_terrain_idle", nothing_s),
    ):
        yield compared(name, 1e3 * value_s, "ms", "scipy plane fits of 300 x 300", fits_ms)
    yield compared("analyze_terrain_sums", 1e3 * typical_s, "ms", "five box sums", sums_ms)


def _box_sums(z_m: npt.NDArray[np.float64]) -> None:
    """Sum the boxes of the costmap's patches, as far as heights go: the least a fit can need."""
    from scipy.ndimage import uniform_filter

    axis_m = np.arange(len(z_m)) * 0.1
    for moment in (z_m, z_m**2, z_m * axis_m, z_m * axis_m[:, None], np.ones_like(z_m)):
        uniform_filter(moment, 25)[::5, ::5].copy()


def _plane_fits(z_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Fit a plane around every cell by box sums over known cells: tilt and squared residual."""
    from scipy.ndimage import uniform_filter

    known = np.isfinite(z_m).astype(np.float64)
    north, east = np.indices(z_m.shape) * 0.1
    z = np.where(known > 0.0, z_m, 0.0)
    n, x, y, h, xx, yy, xy, xh, yh, hh = (
        uniform_filter(moment, 25, mode="constant")
        for moment in (
            known, known * north, known * east, z, known * north**2, known * east**2,
            known * north * east, north * z, east * z, z * z,
        )
    )  # fmt: skip
    cxx, cyy, cxy = xx - x * x / n, yy - y * y / n, xy - x * y / n
    cxh, cyh, chh = xh - x * h / n, yh - y * h / n, hh - h * h / n
    determinant = cxx * cyy - cxy * cxy
    a, b = (cyy * cxh - cxy * cyh) / determinant, (cxx * cyh - cxy * cxh) / determinant
    return np.stack([np.arctan(np.hypot(a, b)), (chh - a * cxh - b * cyh) / n])


def bench_ace() -> Iterator[Result]:
    """Count instructions of ACE by callgrind, a pose of a CFA 10 % terrain each."""
    for name, per_pose in ace_instructions().items():
        yield Result(name, per_pose, "instructions")


def _zeros(context: Any, member: str) -> tuple[bytes, int]:
    size = ffi.sizeof(getattr(context, member))
    return bytes(size), size


def _analysis_s(navlib: Navlib, pose: Pose6) -> float:
    return _call_s(navlib, "analyze_terrain", messages.analyze_request(0.0, pose, GOAL, 0.1))


def _call_s(navlib: Navlib, name: str, request: Message) -> float:
    """Time a C call."""
    function = getattr(lib, f"nav_{name}")
    request_c = ffi.from_buffer(f"nav_{name}_in_t *", request)
    answer = ffi.new(f"nav_{name}_out_t *")
    lib.nav_stub_clear()
    start_s = time.perf_counter()
    function(navlib.context, request_c, answer)
    duration_s = time.perf_counter() - start_s
    lib.nav_stub_clear()
    return duration_s


def bench_cycle_share(bench: Bench) -> Iterator[Result]:
    """Share of each call in cycles of a drive over CFA 10 %: a 320 x 240 cloud, analyze, select."""
    recipe = TerrainRecipe(size_m=60.0, cfa=0.10, seed=1)
    rocky = Bench(bench.scenario, generate(recipe), bench.vehicle)
    navlib = Navlib(navlib_params(bench.scenario))
    spent_s = {"process_disparity": 0.0, "analyze_terrain": 0.0, "select_arc": 0.0}
    cycles = rocky.images(start_m=-5.0, count=8)

    for index, (pose, requests) in enumerate(cycles):
        calls = [("process_disparity", request) for request in requests]
        calls += [
            ("analyze_terrain", messages.analyze_request(0.0, pose, GOAL, 0.1)),
            ("select_arc", messages.select_request(0.0, pose, CERTAIN, GOAL, Arc(1.0, 0.0))),
        ]
        for name, request in calls:
            duration_s = _call_s(navlib, name, request)
            spent_s[name] += duration_s if index > 0 else 0.0  # the first has no map yet
    total_s = sum(spent_s.values())
    yield Result("cycle", 1e3 * total_s / (len(cycles) - 1), "ms")
    for name, value_s in spent_s.items():
        yield Result(f"cycle_share_{name}", 100.0 * value_s / total_s, "%")


def bench_dijkstra(bench: Bench) -> Result:
    """Compute the cost-to-go of every costmap cell; the reference finds the same costs."""
    navlib, pose = bench.mapped()
    navlib.analyze_terrain(messages.analyze_request(0.0, pose, GOAL, 0.1))
    lib.nav_stub_clear()
    ctx = navlib.context
    cells = np.frombuffer(ffi.buffer(ctx.costmap.cells), dtype_of("nav_cost_cell_t"))
    cells["terrain_reason"] = 0
    cells["barred_headings"] = 0  # the reference knows no headings
    cells["cost_s_per_m"] = np.random.default_rng(1).uniform(20.0, 60.0, len(cells))
    goal = ffi.new(
        "nav_waydisc_t *", {"x_site_m": -20.0, "y_site_m": 0.0, "radius_m": GOAL.radius_m}
    )
    costmap, planner = ffi.addressof(ctx, "costmap"), ffi.addressof(ctx, "global")

    def plan() -> None:
        lib.nav_global_plan(planner, costmap, ffi.addressof(ctx, "params"), goal, True, True)

    value_ms = 1e3 * best_of(plan)
    found_s = np.frombuffer(ffi.buffer(planner.cost_to_go_s), np.float64)
    side = lib.NAV_COSTMAP_SIZE
    found_s = found_s.reshape(side + 2, side + 2)[1:-1, 1:-1]
    costs_s = cells["cost_s_per_m"].reshape(side, side).astype(np.float64) * ctx.costmap.cell_m
    return compared("dijkstra", value_ms, "ms", "skimage MCP_Geometric", _mcp_ms(costs_s, found_s))


def _mcp_ms(costs_s: npt.NDArray[np.float64], expected_s: npt.NDArray[np.float64]) -> float | None:
    """Time the reference from the same cells; it must find the same costs."""
    try:
        from skimage.graph import MCP_Geometric  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        return None
    starts = np.argwhere(expected_s == 0.0)
    found_s, _ = MCP_Geometric(costs_s).find_costs(starts)
    assert np.allclose(found_s, expected_s, rtol=1e-9), "Dijkstra and its reference disagree"
    return 1e3 * best_of(lambda: MCP_Geometric(costs_s).find_costs(starts))


def bench_select_arc(bench: Bench) -> Result:
    """Rank and test the tree."""
    navlib, pose = bench.mapped()
    navlib.analyze_terrain(messages.analyze_request(0.0, pose, GOAL, 0.1))
    request = messages.select_request(0.0, pose, CERTAIN, GOAL, Arc(1.0, 0.0))

    def select() -> None:
        navlib.select_arc(request)
        lib.nav_stub_clear()

    return Result("select_arc", 1e3 * best_of(select), "ms")


def bench_settle_warm(bench: Bench) -> Iterator[Result]:
    """Settle along 20 m at 8 Hz; the reference solves the linkage alone."""
    settler = Settler(bench.terrain, bench.vehicle)
    along_m = np.arange(0.0, 20.0, STEP_M)
    reference_us = _root_us(bench)
    for name, curvature_1_m in (("settle_warm", 0.0), ("settle_warm_curve", 0.1)):
        yaw_rad = curvature_1_m * along_m
        north_m, east_m = (np.cumsum(turn(yaw_rad)) * STEP_M for turn in (np.cos, np.sin))
        poses = np.column_stack([north_m - 5.0, east_m, yaw_rad])
        value_s = best_of(partial(settler.settle_many, poses, chained=True))
        yield compared(name, 1e6 * value_s / len(poses), "us", "scipy root", reference_us)


def bench_world_step(bench: Bench) -> Result:
    """Advance the whole world by a tick: motion, slip, settling, odometry, in Python."""
    world = World(bench.terrain, bench.vehicle, start=(-40.0, 0.0, 0.0))

    def metre() -> None:
        world.start_arc(1.0, 0.1)
        for _ in range(190):
            world.step()

    return Result("world_step", 1e6 * best_of(metre) / 190, "us")


def _root_us(bench: Bench) -> float:
    """Time scipy on the same six equations, the wheels' heights known beforehand."""
    from scipy.optimize import root

    vehicle = ffi.new("nav_vehicle_t *")
    params = np.array(list(navlib_params(bench.scenario).values()))
    lib.nav_vehicle_init(ffi.from_buffer("nav_params_t *", params), vehicle)
    found_m, jacobian = np.zeros(6), np.zeros((6, 6))
    wanted_m = np.random.default_rng(1).uniform(-0.1, 0.1, 6)

    def residuals(state: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        lib.nav_vehicle_wheel_heights(
            vehicle,
            ffi.from_buffer("double[]", np.ascontiguousarray(state)),
            ffi.from_buffer("double[]", found_m),
            ffi.from_buffer("double[6][6]", jacobian),
        )
        return found_m - wanted_m

    def solve() -> None:
        for _ in range(100):
            root(residuals, np.zeros(6), jac=lambda _: jacobian.copy())

    return 1e4 * best_of(solve)


def bench_raycast(bench: Bench) -> Iterator[Result]:
    """Cast the rays of two sizes of cloud; the reference does it with Open3D, or marches them."""
    caster = RayCaster(bench.terrain)
    left, _ = camera_pair(CameraConfig())
    attitude = rotation(0.02, math.radians(-30.0), 0.3)
    origin_m = np.array([0.0, 0.0, float(bench.terrain.height_at(0.0, 0.0)) - 2.0])
    for name, width_px, height_px in (("raycast", 640, 480), ("raycast_320x240", 320, 240)):
        rays = left.directions(width_px, height_px)
        value_s = best_of(partial(caster.ranges_m, origin_m, rays, RANGE_MAX_M, attitude))
        reference, reference_ms = _rays_ms(bench.terrain, origin_m, rays @ attitude.T)
        yield compared(name, 1e3 * value_s, "ms", reference, reference_ms)
    build_s = best_of(lambda: RayCaster(bench.terrain))
    yield Result("raycast_build", 1e3 * build_s, "ms")


def _rays_ms(
    terrain: Terrain, origin_m: npt.NDArray[np.float64], rays: npt.NDArray[np.float64]
) -> tuple[str, float]:
    """Name and time of the reference."""
    try:
        import open3d  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        return "numpy marcher", 1e3 * best_of(partial(_march, terrain, origin_m, rays), 2)
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    north, east = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
    nodes = np.stack([north, east, terrain.z_site_m], axis=-1).reshape(-1, 3).astype(np.float32)
    corner = np.arange(nodes.shape[0], dtype=np.uint32).reshape(north.shape)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1],
                                            corner[1:, 1:]))  # fmt: skip
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([b, d, c], 1)])
    scene.add_triangles(open3d.core.Tensor(nodes), open3d.core.Tensor(triangles))
    both = np.concatenate([np.broadcast_to(origin_m, rays.shape), rays], axis=1)
    tensor = open3d.core.Tensor(both.astype(np.float32))
    return "Open3D", 1e3 * best_of(lambda: scene.cast_rays(tensor, nthreads=1))


def _march(
    terrain: Terrain, origin_m: npt.NDArray[np.float64], rays: npt.NDArray[np.float64]
) -> None:
    """Walk all rays in steps of a cell until they are under the ground."""
    alive, distance_m = rays, 0.3
    while len(alive) and distance_m < RANGE_MAX_M:
        points_m = origin_m + distance_m * alive
        alive = alive[points_m[:, 2] < terrain.height_at(points_m[:, 0], points_m[:, 1])]
        distance_m += terrain.resolution_m


def bench_drive_80m(bench: Bench) -> Iterator[Result]:
    """Run the demonstration drive, records kept, nothing written."""
    from pyharness.dp import native_schema

    history = History(native_schema(), drive_info(bench.scenario))
    start_s = time.process_time()
    drive(bench.scenario, bench.terrain, Enav, RecordStream([history.take]))
    value_s = time.process_time() - start_s
    yield Result("drive_80m", value_s, "s")
    yield Result("drive_80m_speed", float(history.truth["time_s"][-1]) / value_s, "rover s / s")


def bench_drive_memory() -> Result:
    """Run the demonstration drive in a process of its own and look at its greatest size."""
    code = (
        "import resource; from pyharness import bench; bench.demonstration_drive();"
        " print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    )
    return Result("drive_memory", int(answer.stdout) / 1024.0, "MiB")


def demonstration_drive() -> None:
    """Drive it with all records kept in memory."""
    from pyharness.dp import native_schema

    scenario = load_scenario(None, {})
    history = History(native_schema(), drive_info(scenario))
    drive(scenario, make_terrain(scenario), Enav, RecordStream([history.take]))


def main() -> None:
    """Measure everything, print a table, write the file."""
    scenario = load_scenario(None, {})
    vehicle = scenario.vehicle
    assert isinstance(vehicle, Vehicle)
    bench = Bench(scenario, make_terrain(scenario), vehicle)
    results = [
        *bench_process_disparity(bench),
        *bench_analyze_terrain(bench),
        bench_dijkstra(bench),
        bench_select_arc(bench),
        *bench_ace(),
        *bench_cycle_share(bench),
        *bench_settle_warm(bench),
        bench_world_step(bench),
        *bench_raycast(bench),
        *bench_drive_80m(bench),
        bench_drive_memory(),
    ]
    OUTPUT.parent.mkdir(exist_ok=True)
    rows = [asdict(result) for result in results]
    OUTPUT.write_text(json.dumps(rows, indent=2, allow_nan=False) + "\n", "utf-8")
    for result in results:
        sys.stdout.write(_line(result))


def _line(result: Result) -> str:
    text = f"{result.name:<30} {result.value:10.3f} {result.unit:<12}"
    if result.reference_value is None or result.ratio is None:
        return text.rstrip() + "\n"
    return f"{text} {result.reference_value:10.3f} {result.reference}, ratio {result.ratio:.3f}\n"


if __name__ == "__main__":
    main()
