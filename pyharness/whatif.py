# SPDX-License-Identifier: Apache-2.0
"""What-if: how the answers to the same inputs change with other parameters or another planner."""

import math
from collections.abc import Iterable, Mapping

from pyharness.dp import Message
from pyharness.errors import HarnessError
from pyharness.history import History
from pyharness.metrics import rejection_counts
from pyharness.scenario import Scenario
from pyharness.status import Reason, Status
from pyharness.tables import Row, to_text
from pyharness.thinker import describe_rejections, rejections_of
from sim.config import parse_model


def changed_params(settings: Iterable[tuple[str, str]]) -> dict[str, float]:
    """Read `navlib.NAME=VALUE` settings as a scenario would.

    Raises:
        HarnessError: One does not begin with `navlib.`.
        ConfigError: Names or values are wrong, one line for each.
    """
    given = dict(settings)
    for key in given:
        if not key.startswith("navlib."):
            raise HarnessError(f"--set {key}: expected navlib.NAME, only parameters can be changed")
    section = parse_model("", "scenario", Scenario, given).navlib
    return {name: value for name, value in section if value is not None}


def comparison_text(recorded: History, rerun: History) -> str:
    """Return what changed: the totals, then the planning cycles and the evaluations."""
    cycles = _changed_cycles(recorded, rerun)
    verdicts = _changed_verdicts(recorded, rerun)
    cycle_count = len(recorded.selections)
    verdict_count = len(recorded.evaluations)
    parts = [
        to_text(_total_rows(recorded, rerun)),
        f"\nselected arcs that changed: {len(cycles)} of {cycle_count}\n",
        to_text(cycles) if cycles else "",
        f"\nevaluations of arcs that changed: {len(verdicts)} of {verdict_count}\n",
        to_text(verdicts) if verdicts else "",
    ]
    return "".join(parts)


def _total_rows(recorded: History, rerun: History) -> list[Row]:
    columns: list[Mapping[str, object]] = [_totals(recorded), _totals(rerun)]
    return [
        {"": name, "recorded": columns[0][name], "re-run": columns[1][name]} for name in columns[0]
    ]


def _totals(history: History) -> Mapping[str, object]:
    answers = [answer for _, answer in history.selections]
    evaluations = [int(answer["ace_evaluations"]) for answer in answers]
    counts = rejection_counts(history)
    return {
        "planning cycles": len(answers),
        "cycles without a path": sum(int(item["status"]) != Status.OK for item in answers),
        "ACE evaluations, mean": round(sum(evaluations) / max(1, len(evaluations)), 1),
        "ACE evaluations, max": max(evaluations, default=0),
        "arcs found unsafe": sum(not item["is_safe"] for _, item in history.evaluations),
        **{f"paths rejected: {name}": count for name, count in counts.items()},
    }


def _changed_cycles(recorded: History, rerun: History) -> list[Row]:
    rows: list[Row] = []
    pairs = zip(recorded.selections, rerun.selections, strict=False)
    for cycle, ((request, old), (_, new)) in enumerate(pairs, start=1):
        if arc_text(old) != arc_text(new):
            rows.append(
                {
                    "cycle": cycle,
                    "time_s": round(float(request["time_s"]), 3),
                    "recorded": arc_text(old),
                    "re-run": arc_text(new),
                    "ACE evaluations": f"{old['ace_evaluations']} -> {new['ace_evaluations']}",
                    "rejected (re-run)": describe_rejections(rejections_of(new)),
                }
            )
    return rows


def _changed_verdicts(recorded: History, rerun: History) -> list[Row]:
    return [
        {
            "time_s": round(float(request["time_s"]), 3),
            "recorded": _verdict(old),
            "re-run": _verdict(new),
        }
        for (request, old), (_, new) in zip(recorded.evaluations, rerun.evaluations, strict=False)
        if _verdict(old) != _verdict(new)
    ]


def arc_text(answer: Message) -> str:
    """Return the arc that was selected, or why there is none."""
    if int(answer["status"]) != Status.OK:
        return str(Status(int(answer["status"])).name.lower())
    arc = answer["arc"]
    turn_deg = math.degrees(float(arc["heading_change_rad"]))
    return f"{float(arc['length_m']):.2f} m, {turn_deg:+.1f} deg"


def _verdict(answer: Message) -> str:
    if int(answer["status"]) != Status.OK:
        return str(Status(int(answer["status"])).name.lower())
    if answer["is_safe"]:
        return "safe"
    return f"{Reason(int(answer['reason'])).name.lower()} at pose {answer['failing_index']}"
