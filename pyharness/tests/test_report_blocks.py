# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness import report_blocks as blocks
from pyharness.campaign_statistics import wilson


def test_a_report_becomes_plain_data():
    content = [blocks.Heading("A"), blocks.Paragraph(["see ", blocks.ref("tab-a")])]
    data = blocks.Report("T", "S", "V", content).as_json()
    assert data["title"] == "T"
    assert data["blocks"][0] == {"kind": "heading", "text": "A", "level": 1, "new_page": False}
    assert data["blocks"][1]["text"] == ["see ", {"ref": "tab-a"}]


def test_control_characters_do_not_reach_the_template():
    data = blocks.Report("a\x00b\nc", "", "", []).as_json()
    assert data["title"] == "a\N{REPLACEMENT CHARACTER}b c"


@pytest.mark.parametrize(
    ("p", "text"), [(0.5, "p = 0.50"), (0.0123, "p = 0.0123"), (1e-9, "p < 0.0001")]
)
def test_p_values_are_never_written_as_zero(p, text):
    assert blocks.p_equation(p).replace("\N{NO-BREAK SPACE}", " ") == text


def test_numbers_as_text():
    assert blocks.number(-0.125, 2) == "\N{MINUS SIGN}0.12"
    assert blocks.signed(3.0, 1) == "+3.0"
    assert blocks.signed(-3.0, 1) == "\N{MINUS SIGN}3.0"
    assert blocks.signed(0.0, 1) == "0.0"
    assert blocks.count_text(1, "drive") == "1 drive"
    assert blocks.count_text(1200, "drive") == "1\N{NARROW NO-BREAK SPACE}200 drives"
    assert blocks.percent(0.925, 1) == "92.5 %"
    assert blocks.interval(wilson(55, 60)) == "82 to 96 %"
    assert blocks.interval(None) == blocks.NOTHING


def test_a_rounded_zero_has_no_sign():
    assert blocks.signed(-0.001, 1) == "0.0"
    assert blocks.number(-0.001, 1) == "0.0"


def test_fills_get_darker_with_the_value():
    greens = [int(blocks.shade(share)[3:5], 16) for share in (0.0, 0.5, 1.0)]
    assert greens == sorted(greens, reverse=True)
    assert blocks.shade(2.0) == blocks.shade(1.0)


def test_a_loss_is_orange_and_a_gain_blue():
    loss, gain = blocks.shade_signed(-1.0), blocks.shade_signed(1.0)
    assert loss[1:3] > loss[5:7]
    assert gain[1:3] < gain[5:7]


def test_equal_values_lie_in_the_middle():
    assert blocks.scaled(3.0, [3.0, 3.0]) == 0.5
    assert blocks.scaled(3.0, [3.0, 5.0]) == 0.0


def test_names_of_drives_stay_as_they_are_typed_unless_they_are_very_long():
    name = "slope_deg20-cfa0.15-seed0059"
    assert blocks.drive_name(name) == {"code": name}
    parts = blocks.drive_name("x" * 100)["code"].split("\N{ZERO WIDTH SPACE}")
    assert [len(part) for part in parts] == [44, 44, 12]
