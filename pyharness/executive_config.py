# SPDX-License-Identifier: Apache-2.0
"""Settings of the executive. No flight value of them is published: each says why it was chosen."""

from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

Duration = Annotated[float, Field(ge=0, le=3600)]
Positive = Annotated[float, Field(gt=0, le=1e6)]
Share = Annotated[float, Field(ge=0, le=1)]
AzimuthDeg = Annotated[float, Field(ge=-180, le=180)]


class _Section(BaseModel):
    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, validate_default=True
    )


class ComputeTimes(_Section):
    """How long thinking takes on the rover's computer, one thing after the other.

    Together they just fit an arc of 1 m (23.8 s at 4.2 cm/s): after the middle of the arc VO,
    analysis and 275 ACE evaluations end with it; more than that makes the rover wait.
    """

    imaging_s: Duration = 2.0  # exposure and readout of a pair; the rover need not stop
    process_disparity_s: Duration = 3.0  # per pair, in the first half of the next arc
    vo_s: Duration = 6.0  # feature matching on the vision processor
    analyze_terrain_s: Duration = 2.0  # 10,000 plane fits and Dijkstra
    select_base_s: Duration = 0.5  # ranking 1,694 paths
    select_per_evaluation_s: Duration = 0.012  # ACE on a RAD750: 10 to 20 ms a pose
    evaluate_base_s: Duration = 0.1
    evaluate_per_pose_s: Duration = 0.012


COMPUTE_SETS = {
    "flight_like": ComputeTimes(),
    "zero": ComputeTimes(**dict.fromkeys(ComputeTimes.model_fields, 0.0)),
}


def _compute_times(value: object) -> object:
    """Let a set be given by its name."""
    if not isinstance(value, str):
        return value
    if value not in COMPUTE_SETS:
        raise ValueError(f"expected {', '.join(COMPUTE_SETS)} or its own keys, got {value!r}")
    return COMPUTE_SETS[value]


class PoseUncertainty(_Section):
    """How far the rover may be from where it plans to be, relative to the map."""

    position_base_m: Share = 0.02  # error of a VO fix
    local_sigmas: Annotated[float, Field(ge=0, le=10)] = 1.0  # of the motion since that fix
    slip_sigmas: Annotated[float, Field(ge=0, le=10)] = 1.0  # of what slip does to the arc's rest
    yaw_base_deg: Annotated[float, Field(ge=0, le=30)] = 0.2  # two sigmas of a VO fix
    # added to a selection for every time in a row that the selected arc turned out unsafe: what was
    # only just passed between two evaluated poses is not selected again
    unsafe_margin_m: Share = 0.03
    global_sigmas: Annotated[float, Field(ge=0, le=10)] = 3.0  # zones grow by that many sigmas
    # from the selection of an arc of 1 m to the fix on it: half of it, and what VO takes to compute
    unfixed_ahead_m: Annotated[float, Field(ge=0, le=10)] = 0.75
    # kept on top of them while there is a path that does: they grow further along it, and a rover
    # driving along their edge would find itself inside; six metres at a poor localisation's 5 cm/m
    zone_margin_m: Annotated[float, Field(ge=0, le=10)] = 0.3


class StuckRules(_Section):
    """When a drive has stopped getting anywhere."""

    slip_window_m: Positive = 5.0  # of commanded path: a few arcs, so that one bad one is forgiven
    slip_progress_min: Share = 0.3  # less of it actually moved is digging in
    progress_window_m: Positive = 200.0  # of path without coming nearer: two dead ends 50 m deep


class ExecutiveConfig(_Section):
    """Settings of the executive."""

    # at least that; SIM section 3. No more than evaluate_arc takes
    crawl_length_m: Annotated[float, Field(ge=0, le=10)] = 5.5
    image_spacing_m: Annotated[float, Field(gt=0, le=10)] = 1.0  # crawling or directed: as planned
    # standing: stop after every arc, look, think, as rovers before did
    thinking: Literal["while_driving", "standing"] = "while_driving"
    vo_fraction: Share = 0.5  # of the arc at which VO starts: "mid-arc"
    evaluate_period_s: Positive = 5.0  # 0.2 m of driving
    evaluate_remaining_min: Share = 0.05  # of the arc: less is over before an answer comes
    replans_max: Annotated[int, Field(ge=0, le=100)] = 3
    # where the mast looks when no path was found, from straight ahead, clockwise
    look_around_deg: Annotated[tuple[AzimuthDeg, ...], Field(min_length=1)] = (
        -120.0, -60.0, 0.0, 60.0, 120.0
    )  # fmt: skip
    time_limit_s: Positive = 21600.0  # 6 h: a long sol of driving
    compute: Annotated[ComputeTimes, BeforeValidator(_compute_times)] = ComputeTimes()
    uncertainty: PoseUncertainty = PoseUncertainty()
    stuck: StuckRules = StuckRules()
