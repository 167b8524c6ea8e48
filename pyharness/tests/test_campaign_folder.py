# SPDX-License-Identifier: Apache-2.0
import json

import pytest

from pyharness.campaign import Campaign, drives_of
from pyharness.campaign_folder import land, opened_folder, read_run, write_run
from pyharness.child_drives import DriveResult
from pyharness.errors import OutputError

KILLED = DriveResult(outcome="killed", detail="signal SIGKILL", files={"evr.log": b"1\n"})


def campaign(**changes):
    return Campaign.model_validate_json(json.dumps({"name": "c", "seeds": 2} | changes))


def landed(folder, result=KILLED):
    drive = next(drives_of(campaign()))
    land(folder, drive, drive.place(campaign()), "avoid_all", result)
    return folder / "drives" / drive.name, folder / "results" / f"{drive.name}.json"


def test_a_result_lands_with_its_files(tmp_path):
    with opened_folder(tmp_path / "new/c", campaign()):
        kept, result = landed(tmp_path / "new/c")
    assert (kept / "evr.log").read_bytes() == b"1\n"
    assert json.loads(result.read_text())["row"]["outcome"] == "killed"


def test_the_campaign_stands_there_with_all_defaults(tmp_path):
    with opened_folder(tmp_path / "c", campaign()):
        pass
    assert "keep: failures" in (tmp_path / "c/campaign.yaml").read_text()


@pytest.mark.faults
def test_what_a_killed_run_left_half_done_is_removed_and_done_again(tmp_path):
    with opened_folder(tmp_path, campaign()):
        kept, result = landed(tmp_path)
    result.unlink()  # killed between the files and the result
    kept.with_name("x.partial").mkdir()
    result.with_name(".x.json.1234").touch()
    (tmp_path / ".run.json.1234").touch()
    with opened_folder(tmp_path, campaign()):
        assert [path.name for path in kept.parent.iterdir()] == [kept.name]
        assert list(result.parent.iterdir()) == []
        assert not (tmp_path / ".run.json.1234").exists()
        landed(tmp_path, DriveResult(outcome="killed", detail="again"))
    assert not kept.exists()
    assert result.exists()


def test_another_campaign_is_refused_by_the_keys_that_differ(tmp_path):
    with opened_folder(tmp_path, campaign()):
        pass
    other = campaign(seeds=3, keep="none")
    with pytest.raises(OutputError) as error, opened_folder(tmp_path, other):
        pass
    assert str(error.value) == (
        f"{tmp_path}/campaign.yaml: a campaign with another seeds, keep,"
        " expected the same one or an empty folder"
    )


def test_requirements_may_change(tmp_path):
    with opened_folder(tmp_path, campaign()):
        pass
    with opened_folder(tmp_path, campaign(requirements={"clearance_min_m": 0.2})):
        pass
    assert "clearance_min_m: 0.2" in (tmp_path / "campaign.yaml").read_text()


def test_a_folder_of_something_else_is_refused(tmp_path):
    (tmp_path / "thesis.txt").touch()
    with pytest.raises(OutputError, match="exists and is not the folder of a campaign"):
        opened_folder(tmp_path, campaign()).__enter__()
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


@pytest.mark.faults
def test_only_one_run_holds_a_folder(tmp_path):
    second = opened_folder(tmp_path, campaign())
    with (
        opened_folder(tmp_path, campaign()),
        pytest.raises(OutputError, match="another run is at work there"),
    ):
        second.__enter__()
    with opened_folder(tmp_path, campaign()):
        pass


@pytest.mark.faults
def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=r"file.*: Not a directory"):
        opened_folder(tmp_path / "file/c", campaign()).__enter__()
    with pytest.raises(OutputError, match="file"):
        opened_folder(tmp_path / "file", campaign()).__enter__()


def test_how_it_was_run_is_read_back(tmp_path):
    assert read_run(tmp_path) == {}
    write_run(tmp_path, {"workers": 2})
    assert read_run(tmp_path) == {"workers": 2}
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(OutputError, match=r"run.json: not JSON text"):
        read_run(tmp_path)
