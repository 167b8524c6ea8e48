# SPDX-License-Identifier: Apache-2.0
import re
import sys
import zlib

import pytest
from click.testing import CliRunner

from pyharness import drive_table
from pyharness.cli import cli
from pyharness.errors import HarnessError
from pyharness.report import compile_pdf, material_of, small_jpeg, write_report
from pyharness.report_blocks import Column, Heading, Paragraph, Report, Table
from pyharness.report_content import build_report
from pyharness.tests.campaign_rows import add_picture, made_campaign, write_campaign

ODD = (
    '#set $x_1$ @ref <label> *bold* _it_ `code` \\ // /* [y] {z} "q" ~ 测试 é \N{ROCKET} \x07 '
    + "w" * 300
)


def all_reach(*_):
    return "goal_reached", ""


def odd_failures(_, rng):
    return rng.choice(
        [("goal_reached", ""), ("no_path", ODD), ("of_my_own", ODD), ("crashed", ODD)]
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A campaign with odd texts, pictures and a drive that is missing."""
    folder = tmp_path_factory.mktemp("campaign") / "made"
    campaign = made_campaign(requirements={"clearance_min_m": 0.3})
    write_campaign(folder, campaign, odd_failures, skip=["slope_deg0-cfa0.07-seed0000"])
    failed = [
        row["name"] for row in drive_table.load(folder).rows if row["outcome"] != "goal_reached"
    ]
    add_picture(folder, failed[0])
    return folder


def streams(pdf):
    """Contents of a PDF."""
    for found in re.finditer(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL):
        try:
            yield zlib.decompress(found[1])
        except zlib.error:
            yield found[1]


def test_the_same_folder_gives_the_same_bytes(folder, tmp_path):
    for name in ("a.pdf", "b.pdf"):
        write_report(folder, tmp_path / name, folder)
    pdf = (tmp_path / "a.pdf").read_bytes()
    assert pdf.startswith(b"%PDF")
    assert pdf == (tmp_path / "b.pdf").read_bytes()
    assert b"CreationDate" not in b"".join([pdf, *streams(pdf)])
    assert sum(b"JFIF" in content for content in streams(pdf)) == 1


def test_what_is_known_of_a_campaign(folder):
    known = material_of(drive_table.load(folder))
    assert (len(known.rows), known.drives_expected) == (11, 12)
    assert known.version == "0.1.0 (abc)"
    assert known.when == "2026-01-02"
    assert ("axis CFA", "7 %, 10 %") in known.about_campaign
    assert ("seeds", "3 in every cell: 0 to 2") in known.about_campaign
    assert [item.terrain.cfa for item in known.scenarios["enav", "default"]] == [0.07, 0.1] * 2
    assert [check.requirement for check in known.checks] == ["belly clearance at every step"]


def test_parameter_sets_and_seeds_are_told(tmp_path):
    campaign = made_campaign(
        axes={}, seeds=[1, 5], parameter_sets={"a": {}, "b": {"navlib.tilt_max_rad": 0.4}}
    )
    known = material_of(drive_table.load(write_campaign(tmp_path / "c", campaign, all_reach)))
    assert ("seeds", "2 in every cell: 1, 5") in known.about_campaign
    assert ("parameter set b", "navlib.tilt_max_rad = 0.4") in known.about_campaign
    data = build_report(known, None, [])[0].as_json()
    settings = next(block for block in data["blocks"] if block.get("label") == "tab-settings")
    assert settings["rows"] == [[{"code": "b: navlib.tilt_max_rad"}, "0.523599", "0.4"]]


def test_files_that_a_campaign_names_may_be_gone(tmp_path):
    campaign = made_campaign(scenario={"vehicle": "gone.yaml"})
    folder = write_campaign(tmp_path / "c", campaign, all_reach)
    assert material_of(drive_table.load(folder)).scenarios == {}
    write_report(folder, tmp_path / "r.pdf", None)


@pytest.mark.parametrize(
    "block", [Paragraph(ODD), Table("t", ODD, [Column(ODD, wide=True)], [[ODD]]), Heading(ODD)]
)
def test_no_text_is_taken_for_markup(block):
    assert compile_pdf(Report(ODD, ODD, ODD, [block]), {}).startswith(b"%PDF")


def test_fonts_come_with_typst():
    pdf = compile_pdf(Report("T", "", "", [Paragraph([{"code": "x"}])]), {})
    fonts = set(
        re.findall(rb"/BaseFont\s*/\w+\+(\w+(?:-Regular|-Bold)?)", b"".join([pdf, *streams(pdf)]))
    )
    assert fonts == {b"LibertinusSerif-Regular", b"LibertinusSerif-Bold", b"DejaVuSansMono"}


# ------------------------------------------------------------------ bad input


def refusal(*arguments):
    """One line that the command ends with."""
    result = CliRunner().invoke(cli, ["montecarlo", "report", *map(str, arguments)])
    return str(result.exception)


def test_a_folder_that_is_no_campaign_is_refused(tmp_path):
    assert "expected the folder of a campaign" in refusal(tmp_path, "-o", tmp_path / "r.pdf")


def test_a_campaign_without_drives_is_refused(folder, tmp_path):
    names = [
        f"slope_deg{slope}-cfa{cfa}-seed000{seed}"
        for slope in (0, 10)
        for cfa in (0.07, 0.1)
        for seed in range(3)
    ]
    empty = write_campaign(tmp_path / "empty", made_campaign(), all_reach, skip=names)
    assert refusal(empty, "-o", tmp_path / "r.pdf") == (
        f"{empty}: no drive is finished, nothing can be reported"
    )
    assert "no drive is finished" in refusal(folder, "-o", tmp_path / "r.pdf", "--compare", empty)
    assert not (tmp_path / "r.pdf").exists()


def test_a_place_that_cannot_be_written_is_named(folder, tmp_path):
    assert "cannot be written" in refusal(folder, "-o", tmp_path / "none" / "r.pdf")


def test_a_damaged_picture_is_named(tmp_path):
    path = tmp_path / "overhead.png"
    path.write_bytes(b"not a picture")
    with pytest.raises(HarnessError, match=r"overhead.png: cannot be read as a picture"):
        small_jpeg(path)


def test_without_typst_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(HarnessError, match=r"pip install 'enav-sim\[report\]'"):
        compile_pdf(Report("", "", "", []), {})
