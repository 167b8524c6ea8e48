# SPDX-License-Identifier: Apache-2.0
import json

import pytest
from click.testing import CliRunner

from pyharness.cli import cli
from pyharness.errors import HarnessError
from pyharness.tests.campaign_runs import write_campaign
from sim.errors import SimError


def invoke(*arguments):
    return CliRunner().invoke(cli, ["montecarlo", *map(str, arguments)])


def said(*arguments):
    """Return what an invocation that fails says."""
    answer = invoke(*arguments)
    assert answer.exit_code != 0
    assert isinstance(answer.exception, HarnessError | SimError | SystemExit)
    return answer.output + str(answer.exception)


def test_a_campaign_is_run_and_its_status_shown(tmp_path):
    name = write_campaign(tmp_path, axes={"terrain.cfa": [0.03]}, seeds=2)
    answer = invoke("run", name, "-o", tmp_path / "out", "--workers", 2)
    assert answer.exit_code == 0, answer.output
    assert answer.output == f"2 of 2 drives reached their goal\n{tmp_path / 'out'}\n"
    assert json.loads((tmp_path / "out/run.json").read_text())["workers"] == 2
    lines = invoke("status", tmp_path / "out").output.splitlines()
    assert [line.split() for line in lines] == [
        ["planner", "parameter_set", "terrain.cfa", "done", "missing", "goal_reached"],
        ["enav", "default", "0.03", "2", "0", "2"],
        ["all", "all", "all", "2", "0", "2"],
    ]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--workers", "0"], "0 is not in the range"),
        (["--workers", "2", "--scheduler", "tcp://x:1"], "give --workers or --scheduler, not both"),
    ],
)
def test_bad_options_are_refused(tmp_path, options, message):
    name = write_campaign(tmp_path)
    assert message in said("run", name, "-o", tmp_path / "out", *options)
    assert not (tmp_path / "out").exists()


def test_a_campaign_with_a_fault_makes_no_folder(tmp_path):
    name = write_campaign(tmp_path, axes={"terrain.cfa": [2]})
    assert "terrain.cfa: expected <= " in said("run", name, "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_status_of_no_campaign_is_one_line(tmp_path):
    assert "expected the folder of a campaign" in said("status", tmp_path)
