# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import Kind
from pyharness.errors import PlannerLoadError
from pyharness.params import param_values
from pyharness.planners import OWN_PLANNERS, load_planner
from pyharness.planners.enav import Enav
from pyharness.records import RecordStream


def test_enav_starts_with_its_parameters_on_record():
    records = []
    Enav(param_values({}), RecordStream([records.append]).publish)
    assert {item.kind for item in records} == {Kind.INIT_IN, Kind.INIT_OUT, Kind.EVR}


def test_the_simulators_own_planners_are_found_by_name():
    assert load_planner("enav") is Enav
    names = [load_planner(name).__name__ for name in OWN_PLANNERS]
    assert names == ["Enav", "Gestalt", "RrtSharp"]


def test_a_class_of_a_file_is_found(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("from pyharness.planners.enav import Enav\nclass Mine(Enav): pass\n")
    assert load_planner(f"{path}:Mine").__name__ == "Mine"


@pytest.mark.parametrize(
    ("text", "name", "message"),
    [
        ("", "nobody", "expected file.py:Class or one of enav"),
        ("", "{}/missing.py:Mine", "no file"),
        ("class Other: pass", "{}/mine.py:Mine", "has no Mine"),
        ("class Mine: pass", "{}/mine.py:Mine", "expected a class derived from"),
        ("import nothing_like_this", "{}/mine.py:Mine", "fails: ModuleNotFoundError"),
    ],
)
def test_what_is_no_planner_is_one_clear_error(tmp_path, text, name, message):
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(PlannerLoadError, match=message):
        load_planner(name.format(tmp_path))
