# SPDX-License-Identifier: Apache-2.0
"""An operator's question: is this arc safe, as far as a drive had seen, or on known terrain?"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pyharness.clib import lib
from pyharness.dp import Kind, Message, new_message
from pyharness.dp_file import Damage, DpReader
from pyharness.errors import HarnessError, RerunError
from pyharness.history import History
from pyharness.messages import Arc, Pose6, Uncertainty, cloud_requests, evaluate_request
from pyharness.navlib import Navlib
from pyharness.params import param_values
from pyharness.planners.enav import Enav
from pyharness.replay import take
from pyharness.rerun import Feeder, unbroken
from pyharness.status import Reason, Status, reason_text, status_text
from pyharness.tables import Row, to_text
from sim.terrain import Terrain

MODE = "avoid_all"  # zones and terrain are checked
Place = tuple[float, float, float]
"""North and east in metres, yaw in radians."""


@dataclass(frozen=True, slots=True)
class ArcCheck:
    """A question and its answer, with the limits it was measured against.

    Attributes:
        request: To evaluate_arc.
        answer: Of evaluate_arc.
        params: Of Navlib, its limits among them.
        damage: Of the file, where it ended the records before the time that was asked for.
    """

    request: Message
    answer: Message
    params: dict[str, float]
    damage: Damage | None = None

    @property
    def is_safe(self) -> bool:
        """Whether every pose along the arc passes."""
        return bool(self.answer["is_safe"])


# ------------------------------------------------------------------ asking


def check_on_drive(
    path: Path, arc: Arc, time_s: float | None = None, place: Place | None = None
) -> ArcCheck:
    """Ask Navlib in the state it had at a time of a recorded drive, by default at its end.

    The place is by default where the rover believed to be; its uncertainty is that of then.

    Raises:
        RerunError: Nothing had been seen yet, or the records cannot be run again.
    """
    with DpReader(path) as reader:
        history = History(reader.schema, reader.info)
        feeder = Feeder(reader.schema, Enav, lambda *_: None)
        now_s = time_s or 0.0
        for record in unbroken(reader.records()):
            if time_s is not None and record.time_s > time_s:
                break
            take(history, record, path)
            now_s = max(now_s, record.time_s)
            if record.kind != Kind.EVALUATE_ARC_IN:  # asks the same, changes nothing
                feeder.feed(record)
        damage = reader.damage
    if feeder.planner is None or history.analysis is None or not history.estimates:
        when = "" if time_s is None else f" at {time_s:g} s"
        raise RerunError(f"{path}: no terrain had been analyzed yet{when}")
    estimate = history.estimates[-1]
    believed, doubt = estimate["pose"], estimate["uncertainty"]
    north_m, east_m, yaw_rad = place or (
        float(believed[name]) for name in ("x_site_m", "y_site_m", "yaw_rad")
    )
    request = evaluate_request(
        now_s,
        Pose6(north_m, east_m, float(believed["z_site_m"]), 0.0, 0.0, yaw_rad),
        Uncertainty(*(float(doubt[name]) for name in doubt.dtype.names or ())),
        arc,
        MODE,
    )
    return _answered(request, feeder.planner.evaluate_arc(request), history.params, damage)


def check_on_terrain(terrain: Terrain, arc: Arc, place: Place) -> ArcCheck:
    """Ask Navlib with perfect knowledge of the terrain and of the pose."""
    north_m, east_m, yaw_rad = place
    if not terrain.contains(north_m, east_m):
        raise HarnessError(f"--pose: {north_m:g}, {east_m:g} is not on the terrain")
    params = param_values({})
    navlib = Navlib(params)
    stands = Pose6(north_m, east_m, float(terrain.height_at(north_m, east_m)), 0.0, 0.0, 0.0)
    cloud = _known_points(terrain, stands, params["heightmap_cell_m"])
    for chunk in cloud_requests(0.0, stands, 1, cloud):
        navlib.process_disparity(chunk)
        list(navlib.drain())
    look = new_message(Kind.ANALYZE_TERRAIN_IN)
    look["pose"]["x_site_m"], look["pose"]["y_site_m"] = north_m, east_m
    navlib.analyze_terrain(look)
    pose = Pose6(north_m, east_m, stands.z_m, 0.0, 0.0, yaw_rad)
    request = evaluate_request(0.0, pose, Uncertainty(0.0, 0.0, 0.0), arc, MODE)
    return _answered(request, navlib.evaluate_arc(request), params)


def _known_points(terrain: Terrain, center: Pose6, cell_m: float) -> npt.NDArray[np.float32]:
    """Return the surface at the middle of every heightmap cell round a pose, relative to it."""
    size = int(lib.NAV_HEIGHTMAP_SIZE)
    steps = np.arange(size) - size // 2 + 0.5
    middle = [math.floor(value / cell_m) * cell_m for value in (center.x_m, center.y_m)]
    north, east = np.meshgrid(*(value + steps * cell_m for value in middle), indexing="ij")
    z = terrain.height_at(north, east)
    points = np.stack([north - center.x_m, east - center.y_m, z - center.z_m], axis=-1)
    return points[np.isfinite(z)].astype(np.float32)


def _answered(
    request: Message, answer: Message, params: dict[str, float], damage: Damage | None = None
) -> ArcCheck:
    if answer["status"] != Status.OK:
        raise HarnessError(f"evaluate_arc: {status_text(int(answer['status']))}")
    return ArcCheck(request, answer, params, damage)


# ------------------------------------------------------------------ showing


def check_text(check: ArcCheck) -> str:
    """Return the verdict, and every bound along the arc against its limit."""
    pose, arc = check.request["pose"], check.request["arc"]
    is_turn = float(arc["length_m"]) == 0.0
    unit, scale = ("deg", math.degrees(1.0)) if is_turn else ("m", 1.0)
    verdict = "safe"
    if not check.is_safe:
        verdict = (
            f"not safe: {reason_text(int(check.answer['reason']))}"
            f" ({Reason(int(check.answer['reason'])).name}),"
            f" first {scale * float(check.answer['failing_at']):.2f} {unit} along the arc"
        )
    return (
        f"{verdict}\n"
        f"arc of {float(arc['length_m']):.2f} m, {math.degrees(arc['heading_change_rad']):+.1f} deg"
        f" from north {float(pose['x_site_m']):.2f} m, east {float(pose['y_site_m']):.2f} m,"
        f" yaw {math.degrees(pose['yaw_rad']):.1f} deg at {float(check.request['time_s']):.3f} s;"
        f" position within {float(check.request['uncertainty']['position_m']):.3f} m,"
        f" yaw within {math.degrees(check.request['uncertainty']['yaw_rad']):.2f} deg\n"
        + to_text(_margin_rows(check, unit, scale))
    )


def _margin_rows(check: ArcCheck, unit: str, scale: float) -> list[Row]:
    """Return one row per limit: the worst bound along the arc, where it is, and what is left."""
    count = int(check.answer["pose_count"])
    arc = check.request["arc"]
    whole = float(arc["length_m"]) or float(arc["heading_change_rad"])
    bounds, params = check.answer["bounds"][:count], check.params
    deg = math.degrees(1.0)

    def both(name: str) -> npt.NDArray[np.float64]:
        return np.asarray(np.maximum(-bounds[f"{name}_min_rad"], bounds[f"{name}_max_rad"]))

    bogie = np.maximum(both("bogie_left"), both("bogie_right"))
    quantities = (
        ("clearance, m", -bounds["clearance_min_m"], -params["clearance_min_m"], -1.0),
        ("wheel drop, m", bounds["wheel_drop_max_m"], params["wheel_drop_max_m"], 1.0),
        ("tilt, deg", bounds["tilt_max_rad"], params["tilt_max_rad"], deg),
        ("rocker, deg", both("rocker"), params["rocker_max_rad"], deg),
        ("bogie, deg", bogie, params["bogie_max_rad"], deg),
        ("unknown under a wheel", bounds["wheel_unknown"], params["wheel_unknown_max"], 1.0),
        ("unknown under the belly", bounds["belly_unknown"], params["belly_unknown_max"], 1.0),
    )
    rows: list[Row] = []
    for name, values, limit, factor in quantities:
        worst = int(np.argmax(values))
        rows.append(
            {
                "bound": name,
                "worst": f"{factor * values[worst]:.3f}",
                "limit": f"{factor * limit:.3f}",
                "margin": f"{abs(factor) * (limit - values[worst]):+.3f}",
                f"at, {unit}": f"{scale * whole * (worst + 1) / count:.2f}",
            }
        )
    return rows
