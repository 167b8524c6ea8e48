# SPDX-License-Identifier: Apache-2.0
from pyharness.clib import lib
from pyharness.status import Activity, Mode, Reason, Status, ZoneShape, status_text


def test_enumerations_hold_every_value_of_c_and_no_sentinel():
    assert len(Status) == lib.NAV_STATUS_COUNT
    assert len(Reason) == lib.NAV_REASON_COUNT
    assert [mode.name for mode in Mode] == ["UNGUARDED", "GUARDED", "AVOID_KOZ", "AVOID_ALL"]
    assert [shape.name for shape in ZoneShape] == ["CIRCLE", "RECTANGLE", "TRIANGLE"]
    assert Activity.DRIVING == lib.NAV_HOST_DRIVING


def test_members_stand_in_the_order_of_their_values():
    assert [int(status) for status in Status] == list(range(len(Status)))


def test_status_has_a_text():
    assert status_text(Status.NO_PATH) == "no path passed the checks of its mode"
