# SPDX-License-Identifier: Apache-2.0
"""Write what is made from tables of C and Python, pages of docs/ and enav_dp.ksy: `make docs`."""

from collections.abc import Mapping
from pathlib import Path

from pyharness import tables
from pyharness._build import make_ksy
from pyharness.planners.gestalt import Gestalt
from pyharness.planners.rrtsharp import RrtSharp

DOCS = Path(__file__).resolve().parents[2] / "docs"
NOTE = "<!-- made by `make docs` from the tables of navlib_c/include: do not edit -->\n\n"


def pages() -> Mapping[str, str]:
    """Return the text of every page by its name."""
    return {
        "parameters.md": "# Parameters of Navlib\n\n"
        + NOTE
        + "Sources: [U] geometry of NASA's M2020 URDF; [S] SIM, IEEE Aerospace 2020; [E] published"
        " ENav numbers;\n[C] chosen here, with the reason. None of [C] is flight data. Set them"
        " with `--set navlib.NAME=VALUE`.\n\n" + tables.to_markdown(tables.param_rows()),
        "planner_parameters.md": "# Parameters of GESTALT and RRT#\n\n"
        + "<!-- made by `make docs` from pyharness/planners: do not edit -->\n\n"
        + "[P] that there is such a quantity is published; [O] OMPL's default; [A] assumption, with"
        " the reason. None of the\nvalues is flight data. Set them with `--set"
        " planner_params.NAME=VALUE`; [planners](planners.md) says what they do.\n\n## GESTALT\n\n"
        + tables.to_markdown(tables.param_rows(Gestalt.OWN_PARAMS))
        + "\n## RRT#\n\n"
        + tables.to_markdown(tables.param_rows(RrtSharp.OWN_PARAMS)),
        "events.md": "# Event reports\n\n"
        + NOTE
        + "A `{}` in a text stands for an argument; the last column gives their meaning in order."
        " Calls are named by\nthe kind of their [data product](data_products.md). Events from 101 on"
        " are the [executive](executive.md)'s and stand\nin products of the kind HOST_EVR.\n\n"
        + tables.to_markdown(tables.evr_rows()),
        "data_products.md": "# Data products\n\n"
        + NOTE
        + "The records that a drive writes; [SPEC_DP](../navlib_c/SPEC_DP.md) says how they stand"
        " in a file.\n\n## Kinds\n\n"
        + tables.to_markdown(tables.dp_rows())
        + "\n## Fields\n\n"
        + tables.to_markdown(tables.field_rows()),
    }


def main() -> None:
    for name, text in pages().items():
        (DOCS / name).write_text(text, encoding="utf-8")
    make_ksy.main()


if __name__ == "__main__":
    main()
