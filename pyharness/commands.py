# SPDX-License-Identifier: Apache-2.0
"""The commands of the command socket: their form, and whoever carries them out."""

import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Protocol

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from pyharness.errors import HarnessError

Id = int | str | None
Metres = Annotated[float, Field(ge=-1e5, le=1e5)]
Degrees = Annotated[float, Field(ge=-360, le=360)]


class CommandError(HarnessError):
    """A command that is malformed, or cannot be carried out now."""


class _Command(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    id: Id = None  # of the client's choice, comes back in the reply


class Run(_Command):
    """Run, as fast as `speed` says, or until a time."""

    command: Literal["run"]
    until_s: Annotated[float, Field(ge=0)] | None = None


class Pause(_Command):
    """Stand still in time."""

    command: Literal["pause"]


class Step(_Command):
    """Advance by some steps and stand still again."""

    command: Literal["step"]
    count: Annotated[int, Field(ge=1, le=1_000_000)] = 1


class Speed(_Command):
    """Rover seconds per second; None is as fast as possible."""

    command: Literal["speed"]
    factor: Annotated[float, Field(gt=0, le=1e6)] | None


class Seek(_Command):
    """Go to a time of a recording."""

    command: Literal["seek"]
    time_s: Annotated[float, Field(ge=0)]


class ImageNow(_Command):
    """Take an image and merge it at once."""

    command: Literal["image_now"]


class PlaceRover(_Command):
    """Set the rover down somewhere else."""

    command: Literal["place_rover"]
    north_m: Metres
    east_m: Metres
    yaw_deg: Degrees


class EvaluateArc(_Command):
    """Ask whether an arc is safe, from a place or from where the rover is."""

    command: Literal["evaluate_arc"]
    length_m: Annotated[float, Field(ge=-10, le=10)]
    heading_change_deg: Degrees = 0.0
    mode: Literal["unguarded", "guarded"] = "guarded"
    from_north_east_yaw: Annotated[tuple[Metres, Metres, Degrees] | None, Field(strict=False)] = (
        None
    )


class Stop(_Command):
    """End the drive."""

    command: Literal["stop"]


Command = Run | Pause | Step | Speed | Seek | ImageNow | PlaceRover | EvaluateArc | Stop
COMMANDS: Mapping[str, type[_Command]] = {
    "run": Run,
    "pause": Pause,
    "step": Step,
    "speed": Speed,
    "seek": Seek,
    "image_now": ImageNow,
    "place_rover": PlaceRover,
    "evaluate_arc": EvaluateArc,
    "stop": Stop,
}
_ADAPTER: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="command")])


class Controllable(Protocol):
    """A drive, simulated or replayed, that is advanced step by step and told what to do.

    What it cannot do, or not now, it refuses with a `CommandError`.
    """

    @property
    def time_s(self) -> float:
        """Time of the drive."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether there will be nothing more to do."""
        ...

    def advance(self) -> bool:
        """Go one step on; whether there are more."""
        ...

    def seek(self, time_s: float) -> None:
        """Go to a time."""
        ...

    def image_now(self) -> Mapping[str, Any]:
        """Take an image and merge it."""
        ...

    def place_rover(self, command: PlaceRover) -> Mapping[str, Any]:
        """Set the rover down somewhere else."""
        ...

    def evaluate_arc(self, command: EvaluateArc) -> Mapping[str, Any]:
        """Say whether an arc is safe."""
        ...

    def stop(self) -> None:
        """End the drive."""
        ...


def parse_command(line: bytes) -> Command:
    """Read one line.

    Raises:
        CommandError: With one line that says what is wrong.
    """
    try:
        data = json.loads(line)
    except ValueError as error:
        raise CommandError(f"not JSON: {error}") from None
    if not isinstance(data, dict):
        raise CommandError(f"expected an object with a command, got {type(data).__name__}")
    name = data.get("command")
    if not isinstance(name, str) or name not in COMMANDS:
        raise CommandError(f"unknown command {name!r}, expected one of {', '.join(COMMANDS)}")
    try:
        return _ADAPTER.validate_json(line)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"][1:]) or "command"
        raise CommandError(f"{name}: {place}: {first['msg']}") from None


def id_of(line: bytes) -> Id:
    """Return the id of a line, whatever else is wrong with it."""
    try:
        value = json.loads(line)["id"]
    except (ValueError, TypeError, KeyError):
        return None
    return value if isinstance(value, int | str) else None
