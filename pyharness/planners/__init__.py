# SPDX-License-Identifier: Apache-2.0
"""The planners that come with the simulator, and how others are found."""

import importlib
import importlib.util
from importlib import metadata
from pathlib import Path

from pyharness.errors import PlannerLoadError
from pyharness.planner import Planner

ENTRY_POINT_GROUP = "enav_sim.planners"
OWN_PLANNERS = {
    "enav": "pyharness.planners.enav:Enav",
    "gestalt": "pyharness.planners.gestalt:Gestalt",
    "rrtsharp": "pyharness.planners.rrtsharp:RrtSharp",
}


def load_planner(name: str) -> type[Planner]:
    """Find a planner's class by its own name, another entry point, or `file.py:Class`.

    Raises:
        PlannerLoadError: There is none, or it is not a planner.
    """
    found = _from_file(name) if ":" in name else _from_entry_points(name)
    if not (isinstance(found, type) and issubclass(found, Planner)):
        raise PlannerLoadError(
            f"planner {name}: expected a class derived from pyharness.planner.Planner"
        )
    return found


def _from_entry_points(name: str) -> object:
    if name in OWN_PLANNERS:
        module, class_name = OWN_PLANNERS[name].split(":")
        return getattr(importlib.import_module(module), class_name)
    points = metadata.entry_points(group=ENTRY_POINT_GROUP)
    if name not in points.names:
        known = ", ".join(sorted({*OWN_PLANNERS, *points.names}))
        raise PlannerLoadError(f"planner {name}: expected file.py:Class or one of {known}")
    try:
        return points[name].load()
    except Exception as error:
        raise PlannerLoadError(f"planner {name}: cannot be loaded: {error}") from error


def _from_file(name: str) -> object:
    file_name, _, class_name = name.rpartition(":")
    path = Path(file_name)
    if not path.is_file():
        raise PlannerLoadError(f"planner {name}: no file {path}, expected file.py:Class")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise PlannerLoadError(f"planner {name}: {path} is not a Python file")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise PlannerLoadError(f"planner {name}: {path} fails: {error!r}") from error
    if not hasattr(module, class_name):
        raise PlannerLoadError(f"planner {name}: {path} has no {class_name}")
    return getattr(module, class_name)
