# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.commands import COMMANDS, CommandError, EvaluateArc, id_of, parse_command


def test_every_command_is_read():
    values = {
        "seek": ', "time_s": 3.5',
        "speed": ', "factor": null',
        "place_rover": ', "north_m": 1, "east_m": 2.5, "yaw_deg": 90',
        "evaluate_arc": ', "length_m": 2, "from_north_east_yaw": [1, 2, 3]',
    }
    for name, command in COMMANDS.items():
        line = f'{{"command": "{name}", "id": 7{values.get(name, "")}}}'
        assert isinstance(parse_command(line.encode()), command)


def test_what_is_left_out_has_a_default():
    command = parse_command(b'{"command": "evaluate_arc", "length_m": 1.0}')
    assert command == EvaluateArc(command="evaluate_arc", length_m=1.0, mode="guarded")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (b"run", "not JSON: "),
        (b"\xff\xfe", "not JSON: "),
        (b"[1]", "expected an object with a command, got list"),
        (b"{}", "unknown command None, expected one of run, pause"),
        (b'{"command": "fly"}', "unknown command 'fly', expected one of run, pause"),
        (b'{"command": ["run"]}', "unknown command"),
        (b'{"command": "seek"}', "seek: time_s: Field required"),
        (b'{"command": "seek", "time_s": "soon"}', "seek: time_s: "),
        (b'{"command": "seek", "time_s": NaN}', "seek: "),
        (b'{"command": "step", "count": 0}', "step: count: "),
        (b'{"command": "run", "fast": true}', "run: fast: "),
        (b'{"command": "speed", "factor": -1}', "speed: factor: "),
        (b'{"command": "evaluate_arc", "length_m": 11}', "evaluate_arc: length_m: "),
    ],
)
def test_a_bad_line_is_one_clear_error(line, message):
    with pytest.raises(CommandError) as caught:
        parse_command(line)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_id_comes_back_whatever_is_wrong():
    assert id_of(b'{"command": "fly", "id": "a1"}') == "a1"
    assert id_of(b'{"id": [1]}') is None
    assert id_of(b"nonsense") is None
