# SPDX-License-Identifier: Apache-2.0
"""Campaigns: many drives that differ in their seeds, in some keys, in planners or parameters."""

import itertools
import json
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, JsonValue, Tag, model_validator

from pyharness.campaigns import BUILT_IN, built_in
from pyharness.errors import HarnessError
from pyharness.scenario import NAME, Scenario, check_name, load_scenario
from sim.config import ConfigModel, load_model
from sim.errors import ConfigError
from sim.random_streams import SEED_MAX
from sim.strict_yaml import Path as KeyPath
from sim.strict_yaml import read_tree

DRIVES_MAX = 1_000_000
NAME_LENGTH_MAX = 100
OWN_KEYS = {"name": "name", "seed": "seeds", "planner": "planners"}
OVERRIDE_PLACE = re.compile(r"--set (?P<key>[^:]+): (?:(?P<inner>[\w.-]+): )?(?P<fault>.*)")

Seed = Annotated[int, Field(ge=0, le=SEED_MAX)]
Settings = dict[str, JsonValue]


def _check_distinct(values: tuple[Any, ...]) -> tuple[Any, ...]:
    if not values:
        raise ValueError("expected at least one value")
    if len({_text(value) for value in values}) != len(values):
        raise ValueError("a value is given twice")
    return values


def _check_settings(settings: Settings) -> Settings:
    for key, own_key in OWN_KEYS.items():
        if key in settings:
            raise ValueError(f"{key} is not for here, give {own_key} of the campaign")
    return settings


def _check_parameter_set(settings: Settings) -> Settings:
    for key in OWN_KEYS.keys() - {"planner"}:
        if key in settings:
            raise ValueError(f"{key} is not for here, give {OWN_KEYS[key]} of the campaign")
    if not isinstance(settings.get("planner", ""), str):
        raise ValueError("planner: expected text")
    return settings


def _one_set() -> dict[str, Settings]:
    return {"default": {}}


def _holds(outer: str, inner: str) -> bool:
    return inner == outer or inner.startswith(f"{outer}.")


def _seeds_tag(value: object) -> str:
    return "list" if isinstance(value, list | tuple) else "count"


class SuccessRequirement(ConfigModel):
    """The least share of drives that reach their goal, in every cell chosen.

    Attributes:
        where: Axis to those of its values that are meant; an axis that is left out, all.
        value: Least share, 0 to 1.
    """

    where: dict[str, tuple[JsonValue, ...]] = Field(default_factory=dict)
    value: Annotated[float, Field(ge=0, le=1)]


class Requirements(ConfigModel):
    """What a campaign is held against; all optional.

    Attributes:
        success_rate_min: In every cell chosen.
        path_inefficiency_mean_max: Over the drives that reached their goal.
        drive_rate_mean_min_m_per_h: Over the drives that reached their goal.
        violations_called_safe_max: True limits violated on arcs that the planner called safe.
        clearance_min_m: Over all steps of all drives, as all below.
        wheel_drop_max_m: Largest height span under a wheel.
        tilt_max_deg: Against gravity.
        rocker_max_deg: Of either side.
        bogie_max_deg: Of either side.
    """

    success_rate_min: tuple[SuccessRequirement, ...] = ()
    path_inefficiency_mean_max: float | None = None
    drive_rate_mean_min_m_per_h: float | None = None
    violations_called_safe_max: Annotated[int, Field(ge=0)] | None = None
    clearance_min_m: float | None = None
    wheel_drop_max_m: float | None = None
    tilt_max_deg: float | None = None
    rocker_max_deg: float | None = None
    bogie_max_deg: float | None = None


class Campaign(ConfigModel):
    """Drives in every cell of a grid, with the same seeds.

    Attributes:
        name: Of the campaign.
        scenario: Scenario keys that all drives have in common.
        axes: Scenario key to its values; every combination is a cell.
        seeds: How many, from 0 on, or which.
        planners: What is compared on the same seeds; names as in a scenario.
        parameter_sets: Name to scenario keys; each is driven with every planner, unless the sets
            name planners themselves.
        keep: Of which drives the folder is kept.
        time_out_s: Wall time after which a drive is given up.
        requirements: What the report holds the campaign against.
        folder: Where relative names of files start; that of the campaign's file if left out.
    """

    name: Annotated[str, AfterValidator(check_name)]
    scenario: Annotated[Settings, AfterValidator(_check_settings)] = Field(default_factory=dict)
    axes: Annotated[
        dict[str, Annotated[tuple[JsonValue, ...], AfterValidator(_check_distinct)]],
        AfterValidator(_check_settings),
    ] = Field(default_factory=dict)
    seeds: Annotated[
        Annotated[int, Field(ge=1, le=DRIVES_MAX), Tag("count")]
        | Annotated[tuple[Seed, ...], AfterValidator(_check_distinct), Tag("list")],
        Discriminator(_seeds_tag),
    ]
    planners: Annotated[tuple[str, ...], AfterValidator(_check_distinct)] = ("enav",)
    parameter_sets: Annotated[
        dict[
            Annotated[str, AfterValidator(check_name)],
            Annotated[Settings, AfterValidator(_check_parameter_set)],
        ],
        Field(min_length=1),
    ] = Field(default_factory=_one_set)
    keep: Literal["all", "failures", "none"] = "failures"
    time_out_s: Annotated[float, Field(gt=0, le=1e6)] = 600.0
    requirements: Requirements = Requirements()
    folder: str | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if "planners" in self.model_fields_set and len(self.planners) > 1 and self._sets_planner():
            raise ValueError("give several planners, or planners in parameter_sets, not both")
        if self.drive_count > DRIVES_MAX:
            raise ValueError(f"{self.drive_count} drives, expected at most {DRIVES_MAX}")
        self._check_overlaps()
        for index, wanted in enumerate(self.requirements.success_rate_min):
            for key, values in wanted.where.items():
                place = f"requirements.success_rate_min.{index}.where.{key}"
                if key not in self.axes:
                    raise ValueError(
                        f"{place}: not an axis, expected one of {', '.join(self.axes)}"
                    )
                for value in values:
                    if value not in self.axes[key]:
                        raise ValueError(f"{place}: {_text(value)} is not a value of that axis")
        return self

    def _check_overlaps(self) -> None:
        """Refuse keys that would replace the value of an axis."""
        axes = list(self.axes)
        others = [(f"axes.{key}", key) for key in axes]
        for name, settings in self.parameter_sets.items():
            others += [(f"parameter_sets.{name}.{key}", key) for key in settings]
        for place, key in others:
            for axis in axes:
                if place != f"axes.{axis}" and (_holds(key, axis) or _holds(axis, key)):
                    raise ValueError(f"{place}: would replace the axis {axis}")
        for key in self.scenario:
            for axis in axes:
                if _holds(axis, key):
                    raise ValueError(f"scenario.{key}: would be replaced by the axis {axis}")

    def _sets_planner(self) -> bool:
        return any("planner" in settings for settings in self.parameter_sets.values())

    @property
    def seed_list(self) -> tuple[int, ...]:
        """Return the seeds of every cell."""
        return tuple(range(self.seeds)) if isinstance(self.seeds, int) else self.seeds

    @property
    def drive_count(self) -> int:
        """Return how many drives there are."""
        values = math.prod(map(len, self.axes.values()))
        return len(self.seed_list) * values * len(self.planners) * len(self.parameter_sets)

    @property
    def place_columns(self) -> tuple[str, ...]:
        """Return the names of what tells the drives apart."""
        return ("name", "planner", "parameter_set", *self.axes, "seed")


@dataclass(frozen=True, slots=True)
class Drive:
    """One drive of a campaign.

    Attributes:
        name: Its own, and that of its files.
        planner: As the summary has it.
        parameter_set: Name of it.
        axis_values: In the order of the axes.
        seed: Of terrain and noise.
        settings: All scenario keys that are given.
        places: Where in the campaign each of them comes from.
    """

    name: str
    planner: str
    parameter_set: str
    axis_values: tuple[JsonValue, ...]
    seed: int
    settings: Mapping[str, object]
    places: Mapping[str, KeyPath]

    @property
    def cell(self) -> tuple[JsonValue, ...]:
        """Return everything but the seed."""
        return (self.planner, self.parameter_set, *self.axis_values)

    def place(self, campaign: Campaign) -> dict[str, Any]:
        """Return what tells this drive from the others, by `Campaign.place_columns`."""
        values = (self.name, self.planner, self.parameter_set, *self.axis_values, self.seed)
        return dict(zip(campaign.place_columns, values, strict=True))


# ------------------------------------------------------------------ reading


def load_campaign(name: str) -> Campaign:
    """Read a campaign's file, or take one that comes with the simulator; check all its drives.

    Raises:
        ConfigError: With one line for every fault.
        HarnessError: A planner cannot be used.
    """
    if name in BUILT_IN:
        path, folder = built_in(name), None
    else:
        path, folder = Path(name), str(Path(name).parent.absolute())
        if not path.exists():
            known = ", ".join(BUILT_IN)
            raise ConfigError(
                [f"{path}: no such file, expected a campaign's file or one of {known}"]
            )
    campaign = load_model(path, Campaign)
    if "folder" not in campaign.model_fields_set:
        campaign = campaign.model_copy(update={"folder": folder})
    places = read_tree(path.read_text("utf-8-sig"), str(path)).places
    _check_drives(campaign, path, places)
    return campaign


def _check_drives(campaign: Campaign, path: Path, places: Mapping[KeyPath, str]) -> None:
    """Check one drive of every cell, and the seeds."""
    problems: dict[str, str] = {}
    for drive in itertools.islice(drives_of(campaign), len(list(_cells(campaign)))):
        try:
            scenario_of(campaign, drive)
        except ConfigError as error:
            for problem in error.problems:
                text = problem.removeprefix("scenario:1:1: ")
                problems.setdefault(text, _placed(text, drive, path, places))
        except HarnessError as error:
            place = places.get(drive.places["planner"], str(path))
            problems.setdefault(str(error), f"{place}: {error}")
    if problems:
        raise ConfigError(list(dict.fromkeys(problems.values())))


def _placed(problem: str, drive: Drive, path: Path, places: Mapping[KeyPath, str]) -> str:
    """Say where in the campaign's file the fault of a drive's scenario lies."""
    match = OVERRIDE_PLACE.fullmatch(problem)
    if match is None or match["key"] not in drive.places:
        return f"{path}: {drive.name}: {problem}"
    key = match["key"]
    origin = drive.places[key]
    for part in (match["inner"] or key).removeprefix(key).split("."):
        inner = (*origin, int(part) if part.isdecimal() else part)
        origin = inner if inner in places else origin
    while origin and origin not in places:
        origin = origin[:-1]
    return f"{places.get(origin, path)}: {match['inner'] or key}: {match['fault']}"


# ------------------------------------------------------------------ drives


def scenario_of(campaign: Campaign, drive: Drive) -> Scenario:
    """Return everything that decides a drive."""
    return load_scenario(None, drive.settings, Path(campaign.folder or ""))


def drives_of(campaign: Campaign) -> Iterator[Drive]:
    """Yield the drives, seed by seed: what is finished of them is a fair sample at any time."""
    cell_name = _cell_namer(campaign)
    cells = list(_cells(campaign))
    for seed_index, seed in enumerate(campaign.seed_list):
        seed_place: KeyPath = (
            ("seeds",) if isinstance(campaign.seeds, int) else ("seeds", seed_index)
        )
        for cell in cells:
            name = f"{cell_name(cell)}seed{seed:04d}"
            yield _drive(campaign, cell, name, seed, seed_place)


@dataclass(frozen=True, slots=True)
class _Cell:
    """Where in the grid: indices of the axes' values, of the planner, and the set's name."""

    index: int
    axis_indices: tuple[int, ...]
    planner_index: int
    parameter_set: str


def _cells(campaign: Campaign) -> Iterator[_Cell]:
    grid = itertools.product(
        itertools.product(*(range(len(values)) for values in campaign.axes.values())),
        range(len(campaign.planners)),
        campaign.parameter_sets,
    )
    for index, cell in enumerate(grid):
        yield _Cell(index, *cell)


def _drive(campaign: Campaign, cell: _Cell, name: str, seed: int, seed_place: KeyPath) -> Drive:
    own = campaign.parameter_sets[cell.parameter_set]
    settings: dict[str, object] = {"name": name, "seed": seed}
    places: dict[str, KeyPath] = {"name": ("name",), "seed": seed_place}
    settings["planner"] = campaign.planners[cell.planner_index]
    places["planner"] = ("planners", cell.planner_index)
    for key, value in campaign.scenario.items():
        settings[key], places[key] = value, ("scenario", key)
    axis_values = []
    for (key, values), index in zip(campaign.axes.items(), cell.axis_indices, strict=True):
        settings.pop(key, None)  # later keys are applied later
        settings[key], places[key] = values[index], ("axes", key, index)
        axis_values.append(values[index])
    for key, value in own.items():
        settings.pop(key, None)
        settings[key], places[key] = value, ("parameter_sets", cell.parameter_set, key)
    planner = str(settings["planner"])
    planner = Path(planner).name if ":" in planner else planner
    return Drive(name, planner, cell.parameter_set, tuple(axis_values), seed, settings, places)


# ------------------------------------------------------------------ names


def _cell_namer(campaign: Campaign) -> Callable[[_Cell], str]:
    """Return what names a cell: readable where that is possible, else by its number."""
    names = [_readable(campaign, cell) for cell in _cells(campaign)]
    longest = NAME_LENGTH_MAX - len(f"seed{max(campaign.seed_list):04d}")
    is_usable = len(set(names)) == len(names) and all(
        len(name) <= longest and NAME.fullmatch(f"{name}s") for name in names
    )
    return lambda cell: names[cell.index] if is_usable else f"cell{cell.index:04d}-"


def _readable(campaign: Campaign, cell: _Cell) -> str:
    parts = []
    if len(campaign.planners) > 1:
        parts.append(Path(campaign.planners[cell.planner_index]).name.rpartition(":")[2])
    if len(campaign.parameter_sets) > 1:
        parts.append(cell.parameter_set)
    for (key, values), index in zip(campaign.axes.items(), cell.axis_indices, strict=True):
        value = values[index]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        parts.append(
            f"{key.rpartition('.')[2]}{'' if is_number else '_'}{_text(value).strip(chr(34))}"
        )
    return "".join(f"{part}-" for part in parts)


def _text(value: object) -> str:
    return json.dumps(value)
