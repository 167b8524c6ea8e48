# SPDX-License-Identifier: Apache-2.0
"""Scenarios: everything that decides how a drive goes, from YAML and the command line."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    SerializerFunctionWrapHandler,
    Tag,
    create_model,
    model_serializer,
    model_validator,
)

from pyharness.dp import Kind, Message, new_message
from pyharness.executive_config import ExecutiveConfig
from pyharness.messages import Arc, DirectedArc, Pose6, pose_after
from pyharness.navlib import zone_fault
from pyharness.params import ParamDefinition, param_table, param_values, params_fault
from pyharness.planner import own_param_faults, own_param_values
from pyharness.planners import load_planner
from pyharness.records import DriveInfo, Waypoint
from pyharness.status import ZoneKind, ZoneShape
from sim.camera import CameraConfig
from sim.config import ConfigModel, load_model, parse_model
from sim.errors import ConfigError
from sim.generate import TerrainRecipe, generate
from sim.localization import NoiseConfig
from sim.random_streams import SEED_MAX
from sim.slip import SlipConfig
from sim.strict_yaml import read_tree
from sim.terrain import Terrain
from sim.terrain_io import read_terrain
from sim.vehicle import Vehicle, load_vehicle

Place = tuple[float, float]
ModeName = Literal["unguarded", "guarded", "avoid_koz", "avoid_all"]
ArcModeName = Literal["unguarded", "guarded"]
Records = Literal["inputs", "display", "full"]
Length = Annotated[float, Field(gt=0, le=1e4)]

PRODUCT_LEVELS: Mapping[str, float] = {"inputs": 0.0, "display": 1.0, "full": 2.0}

# two arcs of 1 m: the rover decides every metre, and VO errors of a drive are below the other one
RADIUS_DEFAULT_M = 2.0
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
GOAL_DEFAULT_M = (40.0, 0.0)
# wheels and belly stay on the grid at any heading
MARGIN_M = 2.0


# ------------------------------------------------------------------ sections


class TerrainSection(TerrainRecipe):
    """A terrain file, or a recipe."""

    file: str | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        others = sorted(self.model_fields_set - {"file"})
        if self.file is not None and others:
            raise ValueError(f"give a file or a recipe, not both (also given: {', '.join(others)})")
        return self

    @model_serializer(mode="wrap")
    def _write(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data: dict[str, Any] = handler(self)
        file = data.pop("file", None)
        return data if file is None else {"file": file}


class WaypointSection(ConfigModel):
    """A goal."""

    goal_site_m: Place
    radius_m: Annotated[float, Field(ge=0.1, le=100)] = RADIUS_DEFAULT_M
    mode: ModeName = "avoid_all"


class ArcSection(ConfigModel):
    """An arc that is driven as given; its mode says what it is checked against."""

    length_m: Annotated[float, Field(ge=-10, le=10)]  # what evaluate_arc takes
    heading_change_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    mode: ArcModeName = "guarded"

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.length_m == 0.0 and self.heading_change_deg == 0.0:
            raise ValueError("an arc needs a length or a heading change")
        return self


class ZoneSection(ConfigModel):
    """A keep-in or keep-out zone; each shape has its own keys."""

    kind: Literal["keep_out", "keep_in"]
    shape: Literal["circle", "rectangle", "triangle"]
    center_site_m: Place | None = None
    radius_m: Length | None = None
    length_m: Length | None = None
    width_m: Length | None = None
    heading_deg: float | None = None
    vertices_site_m: tuple[Place, Place, Place] | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        needed = {
            "circle": {"center_site_m", "radius_m"},
            "rectangle": {"center_site_m", "length_m", "width_m"},
            "triangle": {"vertices_site_m"},
        }[self.shape]
        optional = {"heading_deg"} if self.shape == "rectangle" else set()
        given = {name for name, value in self if value is not None} - {"kind", "shape"}
        if needed - given:
            raise ValueError(f"a {self.shape} needs {', '.join(sorted(needed - given))}")
        if given - needed - optional:
            surplus = ", ".join(sorted(given - needed - optional))
            raise ValueError(f"a {self.shape} has no {surplus}")
        if fault := zone_fault(self.record()):
            raise ValueError(fault)
        return self

    def record(self) -> Message:
        """Return the zone as Navlib takes it."""
        zone: Message = np.zeros((), dtype=new_message(Kind.SET_KIOZ_IN)["zones"].dtype)
        zone["kind"] = ZoneKind[self.kind.upper()]
        zone["shape"] = ZoneShape[self.shape.upper()]
        if self.center_site_m is not None:
            zone["center_x_site_m"], zone["center_y_site_m"] = self.center_site_m
        zone["radius_m"] = self.radius_m or 0.0
        zone["length_m"] = self.length_m or 0.0
        zone["width_m"] = self.width_m or 0.0
        zone["heading_rad"] = math.radians(self.heading_deg or 0.0)
        if self.vertices_site_m is not None:
            zone["vertex_x_site_m"], zone["vertex_y_site_m"] = zip(
                *self.vertices_site_m, strict=True
            )
        return zone


def _param_type(row: ParamDefinition) -> Any:
    """Return the annotation of one parameter: its range is that of the C table."""

    def check(value: float) -> float:
        if fault := row.fault(value):
            raise ValueError(fault)
        return value

    return Annotated[float, AfterValidator(check)] | None


if TYPE_CHECKING:

    class NavlibSection(ConfigModel):
        """Navlib's parameters by name."""

else:
    NavlibSection = create_model(
        "NavlibSection",
        __base__=ConfigModel,
        **{name: (_param_type(row), None) for name, row in param_table().items()},
    )


def check_name(name: str) -> str:
    """Refuse names that cannot be part of a folder's name."""
    if not NAME.fullmatch(name):
        raise ValueError(f"expected letters, digits, '.', '_' and '-', got {name!r}")
    return name


def _vehicle_tag(value: object) -> str:
    return "path" if isinstance(value, str) else "inline"


VehicleSection = Annotated[
    Annotated[str, Tag("path")] | Annotated[Vehicle, Tag("inline")], Discriminator(_vehicle_tag)
]


class Scenario(ConfigModel):
    """A drive. What is left out has a default; `resolve` fills it in."""

    name: Annotated[str, AfterValidator(check_name)] = "demo"
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 0
    terrain: TerrainSection = TerrainSection(cfa=0.07)
    start: tuple[float, float, float] = (-40.0, 0.0, 0.0)  # north, east, yaw in degrees
    goal: Place | None = None
    mode: ModeName | None = None  # of the goal, or of all waypoints
    waypoints: tuple[WaypointSection, ...] | None = None
    arcs: tuple[ArcSection, ...] = ()  # driven before the waypoints; without those, alone
    prior_map_radius_m: Annotated[float, Field(ge=0, le=15)] = 0.0  # known at the start
    zones: Annotated[tuple[ZoneSection, ...], Field(max_length=32)] = ()
    planner: str = "enav"
    planner_params: dict[str, float] = Field(default_factory=dict)  # of a planner other than enav
    navlib: NavlibSection = NavlibSection()
    vehicle: VehicleSection = "perseverance"
    camera: CameraConfig = CameraConfig()
    noise: NoiseConfig = NoiseConfig()
    slip: SlipConfig = SlipConfig()
    executive: ExecutiveConfig = ExecutiveConfig()
    records: Records = "inputs"

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.waypoints is not None and self.goal is not None:
            raise ValueError("give waypoints or a goal, not both")
        if self.waypoints == () and not self.arcs:
            raise ValueError("give at least one waypoint or arc")
        return self


# ------------------------------------------------------------------ reading


def load_scenario(
    path: Path | None, overrides: Mapping[str, object], overrides_folder: Path = Path()
) -> Scenario:
    """Read a scenario, apply overrides and fill in everything that was left out.

    Relative names of files in a scenario start at its own folder, those of overrides at the
    working directory or the folder given.

    Raises:
        ConfigError: With one line for every fault.
    """
    folder = overrides_folder if path is None else path.parent
    folders = _Folders(folder, overrides_folder)
    parts = {key: value for key, value in overrides.items() if key.startswith("vehicle.")}
    if parts:
        overrides = {key: value for key, value in overrides.items() if key not in parts}
        # parts of a vehicle that is named can be set once it is spelled out
        vehicle = _read(path, overrides).vehicle
        if isinstance(vehicle, str):
            spelled_out = _named_vehicle(vehicle, folders, overrides).model_dump(mode="json")
            overrides = {**overrides, "vehicle": spelled_out}
        overrides = {**overrides, **parts}
    scenario = _resolve(_read(path, overrides), folders, overrides)
    return _with_planner_params(scenario, path, overrides)


def _read(path: Path | None, overrides: Mapping[str, object]) -> Scenario:
    if path is None:
        return parse_model("", "scenario", Scenario, overrides)
    return load_model(path, Scenario, _for_another_planner(path, overrides))


class _Folders(NamedTuple):
    """Where relative names of files start: those of the scenario, and those of overrides."""

    scenario: Path
    overrides: Path

    def of(self, is_override: bool) -> Path:
        return self.overrides if is_override else self.scenario


def _named_vehicle(name: str, folders: _Folders, overrides: Mapping[str, object]) -> Vehicle:
    """Vehicle of a file, or a built-in one."""
    if not name.endswith((".yaml", ".yml")):
        return load_vehicle(name)
    return load_vehicle(folders.of("vehicle" in overrides) / name)


def check_places(
    scenario: Scenario, terrain: Terrain, path: Path | None, overrides: Mapping[str, object]
) -> None:
    """Check that start and goals of a resolved scenario lie on the terrain.

    Raises:
        ConfigError: With one line for every one that does not.
    """
    places = {"start": scenario.start[:2]}
    for index, waypoint in enumerate(scenario.waypoints or ()):
        places[f"waypoints.{index}.goal_site_m"] = waypoint.goal_site_m
    problems = [
        f"{_place_of(path, overrides, _names_of(key))}: {_off_terrain(terrain, *place)}"
        for key, place in places.items()
        if not is_on_terrain(terrain, *place)
    ]
    if problems:
        raise ConfigError(problems)


def is_on_terrain(terrain: Terrain, north_m: float, east_m: float) -> bool:
    """Whether a rover can stand there, wheels and belly on ground that is known."""
    return terrain.contains(north_m, east_m, MARGIN_M) and math.isfinite(
        terrain.height_at(north_m, east_m)
    )


def _off_terrain(terrain: Terrain, north_m: float, east_m: float) -> str:
    south_m, north_end_m = terrain.north_min_m + MARGIN_M, terrain.north_max_m - MARGIN_M
    west_m, east_end_m = terrain.east_min_m + MARGIN_M, terrain.east_max_m - MARGIN_M
    return (
        f"{north_m:g}, {east_m:g} is not on the terrain, expected ground within north"
        f" {south_m:.1f} to {north_end_m:.1f} m, east {west_m:.1f} to {east_end_m:.1f} m"
    )


def _names_of(key: str) -> list[str]:
    """Return the keys that may have given a place."""
    return [key] if key == "start" else ["goal", key, "waypoints"]


def _place_of(path: Path | None, overrides: Mapping[str, object], names: Sequence[str]) -> str:
    """Say where the value was given, by the first of the keys that was."""
    for name in names:
        if any(given == name or given.startswith(f"{name}.") for given in overrides):
            return f"--set {name}"
    if path is not None:
        known = read_tree(path.read_text("utf-8-sig"), str(path)).places
        for name in names:
            parts = tuple(int(part) if part.isdecimal() else part for part in name.split("."))
            if parts in known:
                return f"{known[parts]}: {name}"
    return f"default {names[0]}"


def _resolve(scenario: Scenario, folders: _Folders, overrides: Mapping[str, object]) -> Scenario:
    is_terrain_override = not {"terrain", "terrain.file"}.isdisjoint(overrides)
    terrain_folder = folders.of(is_terrain_override)
    vehicle = scenario.vehicle
    if isinstance(vehicle, str):
        vehicle = _named_vehicle(vehicle, folders, overrides)
    given = {name: value for name, value in scenario.navlib if value is not None}
    level = {"product_level": PRODUCT_LEVELS[scenario.records]}
    params = param_values({**vehicle_params(vehicle), **level, **given})
    if fault := params_fault(params):
        raise ConfigError([f"navlib: {fault}"])
    waypoints = scenario.waypoints
    if waypoints is None:
        is_directed = scenario.arcs and scenario.goal is None
        goal = WaypointSection(goal_site_m=scenario.goal or GOAL_DEFAULT_M)
        waypoints = () if is_directed else (goal,)
    if scenario.mode is not None:
        waypoints = tuple(item.model_copy(update={"mode": scenario.mode}) for item in waypoints)
    return scenario.model_copy(
        update={
            "terrain": _resolve_terrain(scenario, terrain_folder),
            "goal": None,
            "mode": None,
            "waypoints": waypoints,
            "planner": _resolve_planner(scenario.planner, folders.of("planner" in overrides)),
            "navlib": NavlibSection.model_validate(params),
            "vehicle": vehicle,
        }
    )


def _resolve_terrain(scenario: Scenario, folder: Path) -> TerrainSection:
    terrain = scenario.terrain
    if terrain.file is not None:
        return TerrainSection(file=str((folder / terrain.file).absolute()))
    update: dict[str, Any] = {}
    if "seed" not in terrain.model_fields_set:
        update["seed"] = scenario.seed
    if terrain.start_m is None:
        update["start_m"] = scenario.start[:2]
        update["start_yaw_deg"] = scenario.start[2]
    return terrain.with_files_in(folder).model_copy(update=update)


def _resolve_planner(name: str, folder: Path) -> str:
    if ":" not in name:
        return name
    file_name, _, class_name = name.rpartition(":")
    return f"{(folder / file_name).absolute()}:{class_name}"


def _for_another_planner(path: Path, overrides: Mapping[str, object]) -> Mapping[str, object]:
    """Let another planner than that of the file start from its own defaults."""
    is_given = any(key.split(".")[0] == "planner_params" for key in overrides)
    if "planner" not in overrides or is_given:
        return overrides
    is_same = load_model(path, Scenario).planner == overrides["planner"]
    return overrides if is_same else {**overrides, "planner_params": {}}


def _with_planner_params(
    scenario: Scenario, path: Path | None, overrides: Mapping[str, object]
) -> Scenario:
    """Check the parameters of the planner and fill in those that were left out."""
    planner_class = load_planner(scenario.planner)
    faults = own_param_faults(planner_class, scenario.planner_params)
    problems = []
    for name, fault in faults.items():
        key = f"planner_params.{name}"
        place = _place_of(path, overrides, [key, "planner_params"])
        problems.append(f"{place}: {fault}" if place.endswith(key) else f"{place}: {key}: {fault}")
    if problems:
        raise ConfigError(problems)
    values = own_param_values(planner_class, scenario.planner_params)
    return scenario.model_copy(update={"planner_params": values})


def vehicle_params(vehicle: Vehicle) -> dict[str, float]:
    """Return what Navlib must know of a vehicle, by the names of its parameters."""
    geometry, belly, limits = vehicle.geometry, vehicle.belly, vehicle.navlib_limits
    front, middle, rear = (
        geometry.hub_left_front_m,
        geometry.hub_left_middle_m,
        geometry.hub_left_rear_m,
    )
    return {
        "wheel_radius_m": geometry.wheel_radius_m,
        "wheel_width_m": geometry.wheel_width_m,
        "front_x_m": front[0],
        "front_y_m": -front[1],
        "middle_x_m": middle[0],
        "middle_y_m": -middle[1],
        "rear_x_m": rear[0],
        "rear_y_m": -rear[1],
        "rocker_pivot_x_m": geometry.rocker_pivot_left_m[0],
        "rocker_pivot_height_m": -geometry.rocker_pivot_left_m[2],
        "bogie_pivot_x_m": geometry.bogie_pivot_left_m[0],
        "bogie_pivot_height_m": -geometry.bogie_pivot_left_m[2],
        "belly_front_x_m": belly.front_m,
        "belly_rear_x_m": belly.rear_m,
        "belly_half_width_m": belly.half_width_m,
        "belly_height_m": belly.height_m,
        "speed_max_m_per_s": vehicle.drive.wheel_speed_max_m_s,
        "steering_rate_rad_per_s": vehicle.steering_rate_rad_s,
        "clearance_min_m": belly.height_m - limits.clearance_margin_m,
        "tilt_max_rad": math.radians(limits.tilt_max_deg),
        "rocker_max_rad": math.radians(limits.rocker_max_deg),
        "bogie_max_rad": math.radians(limits.bogie_max_deg),
        "wheel_drop_max_m": limits.wheel_drop_max_m,
    }


# ------------------------------------------------------------------ parts of a resolved scenario


def make_terrain(scenario: Scenario) -> Terrain:
    """Read or generate the terrain of a resolved scenario."""
    if scenario.terrain.file is not None:
        return read_terrain(scenario.terrain.file)
    recipe = {name: getattr(scenario.terrain, name) for name in TerrainRecipe.model_fields}
    return generate(TerrainRecipe.model_construct(**recipe))


def drive_info(scenario: Scenario) -> DriveInfo:
    """Return what the record stream does not say about a resolved scenario.

    A drive of arcs alone goes to where they lead.
    """
    north_m, east_m, yaw_deg = scenario.start
    waypoints = tuple(
        Waypoint(*item.goal_site_m, item.radius_m, item.mode) for item in scenario.waypoints or ()
    )
    if not waypoints:
        pose = Pose6(north_m, east_m, 0.0, 0.0, 0.0, math.radians(yaw_deg))
        for directed in directed_arcs(scenario):
            pose = pose_after(pose, directed.arc)
        mode = scenario.arcs[-1].mode
        waypoints = (Waypoint(pose.x_m, pose.y_m, RADIUS_DEFAULT_M, mode),)
    return DriveInfo(
        name=scenario.name,
        planner=scenario.planner if ":" not in scenario.planner else Path(scenario.planner).name,
        seed=scenario.seed,
        start_north_m=north_m,
        start_east_m=east_m,
        start_yaw_rad=math.radians(yaw_deg),
        waypoints=waypoints,
        planner_params=scenario.planner_params,
    )


def directed_arcs(scenario: Scenario) -> tuple[DirectedArc, ...]:
    """Return the arcs that are driven as given."""
    return tuple(
        DirectedArc(Arc(item.length_m, math.radians(item.heading_change_deg)), item.mode)
        for item in scenario.arcs
    )


def zones_request(scenario: Scenario) -> Message:
    """Return the zones of a resolved scenario as Navlib takes them."""
    request = new_message(Kind.SET_KIOZ_IN)
    request["zone_count"] = len(scenario.zones)
    for index, zone in enumerate(scenario.zones):
        request["zones"][index] = zone.record()
    return request


def navlib_params(scenario: Scenario) -> dict[str, float]:
    """Return all parameters of a resolved scenario."""
    return {name: float(value) for name, value in scenario.navlib}
