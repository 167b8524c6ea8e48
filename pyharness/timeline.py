# SPDX-License-Identifier: Apache-2.0
"""Who worked when: the executive's activities as lanes over time (SIM Fig. 9, of a real drive)."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from pyharness.history import History
from pyharness.replay import read_history
from pyharness.status import Activity

WINDOW_S = 180.0  # six or seven planning cycles: short enough to read


def draw_timeline_of(drive: Path, path: Path) -> None:
    """Write the timeline of a recorded drive as PNG, from its first planning cycle on."""
    history, _ = read_history(drive)
    draw_timeline(history, path)


def draw_timeline(history: History, path: Path) -> None:
    """Write the timeline as PNG."""
    planned = [float(item["start_s"]) for item in history.timeline if int(item["cycle"]) > 0]
    start_s = min(planned, default=0.0)
    with mpl.rc_context({"font.family": "DejaVu Sans", "font.size": 9}):
        figure = Figure(figsize=(13.0, 4.2), dpi=120, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        for item in history.timeline:
            activity, cycle = int(item["activity"]), int(item["cycle"])
            begin_s, end_s = float(item["start_s"]), float(item["end_s"])
            if end_s < start_s or begin_s > start_s + WINDOW_S:
                continue
            color = mpl.colormaps["tab10"](cycle % 10)
            axes.barh(activity, end_s - begin_s, left=begin_s, height=0.7, color=color)
            if activity == Activity.DRIVING:
                middle_s = 0.5 * (begin_s + end_s)
                axes.text(
                    middle_s, activity, f"arc {cycle}", ha="center", va="center", clip_on=True
                )
        names = [activity.name.lower().replace("_", " ") for activity in Activity]
        axes.set_yticks(range(len(names)), names)
        axes.set(xlim=(start_s, start_s + WINDOW_S), xlabel="simulated time, s")
        axes.invert_yaxis()
        axes.grid(axis="x", alpha=0.4)
        axes.set_title(f"{history.info.name}: activities, coloured by planning cycle", loc="left")
        figure.savefig(path, format="png", metadata={"Software": None})
