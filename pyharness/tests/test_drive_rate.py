# SPDX-License-Identifier: Apache-2.0
from pyharness.drive_rate import Rate, table


def rate(thinking, seed, duration_s, standing_s, outcome="goal_reached"):
    return Rate(thinking, seed, outcome, 80.0, duration_s, 1800.0, 100.0, standing_s, 80)


def test_the_table_weighs_drives_by_their_time_and_shows_those_that_failed():
    text = table(
        [
            rate("while_driving", 0, 2400.0, 80.0),
            rate("while_driving", 1, 3600.0, 80.0, "no_path"),
            rate("standing", 0, 4800.0, 1600.0),
        ]
    )
    driving, standing = text.splitlines()[2:]
    assert "| 1 of 2 | 96 (80 to 120) |" in driving
    assert "| 1 of 1 | 60 (60 to 60) | 38 % | 2 % | 33 % | 20.0 | 15-18 (Curiosity) |" in standing
