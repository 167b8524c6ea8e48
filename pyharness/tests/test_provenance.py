# SPDX-License-Identifier: Apache-2.0
import subprocess

from pyharness.provenance import cpu_name, provenance, revision


def git(folder, *command):
    identity = ["-c", "user.name=n", "-c", "user.email=e@x"]
    subprocess.run(["git", "-C", folder, *identity, *command], check=True, capture_output=True)


def test_everything_that_a_result_depends_on_is_named():
    found = provenance()
    assert list(found) == ["enav_sim", "revision", "python", "numpy", "platform", "cpu", "cores"]
    assert all(found[name] for name in found if name != "revision")


def test_the_revision_says_whether_the_source_was_changed(tmp_path):
    assert revision(tmp_path) is None
    git(tmp_path, "init")
    assert revision(tmp_path) is None
    (tmp_path / "a").write_text("1")
    git(tmp_path, "add", "a")
    git(tmp_path, "commit", "-m", "a")
    clean = revision(tmp_path)
    assert len(clean) == 12
    (tmp_path / "a").write_text("2")
    assert revision(tmp_path) == f"{clean}-dirty"


def test_the_processor_has_a_name_also_where_it_is_not_listed(tmp_path):
    (tmp_path / "cpuinfo").write_text(
        "processor\t: 0\nmodel name\t: RAD 750\nmodel name\t: other\n"
    )
    assert cpu_name(tmp_path / "cpuinfo") == "RAD 750"
    assert cpu_name(tmp_path / "nothing")
