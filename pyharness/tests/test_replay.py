# SPDX-License-Identifier: Apache-2.0
import struct
import zlib

import pytest

from pyharness import metrics
from pyharness.dp import Kind
from pyharness.dp_file import DpReader, DpWriter
from pyharness.errors import DpFileError
from pyharness.history import History
from pyharness.records import RecordStream
from pyharness.replay import Player, read_history


class Clock:
    """Time that passes only by sleeping."""

    def __init__(self):
        self.now_s = 0.0

    def read(self):
        return self.now_s

    def sleep(self, duration_s):
        assert duration_s > 0.0
        self.now_s += duration_s


@pytest.fixture
def player(quick_drive):
    with DpReader(quick_drive) as reader:
        heard = []
        yield Player(reader, RecordStream([heard.append])), heard


def test_a_replay_publishes_every_record_as_it_was(player, quick_drive):
    player, heard = player
    player.play()
    with DpReader(quick_drive) as reader:
        assert heard == list(reader.records())
    assert player.is_done


@pytest.mark.parametrize("speed", [1.0, 50.0])
def test_a_replay_takes_the_drives_time_divided_by_its_speed(player, speed):
    player, heard = player
    clock = Clock()
    player.play(speed, clock.read, clock.sleep)
    assert heard[-1].time_s > 100.0
    assert clock.now_s == pytest.approx(heard[-1].time_s / speed, rel=1e-9)


def test_every_record_is_published_when_its_time_has_come(quick_drive):
    clock = Clock()
    late_s = []
    with DpReader(quick_drive) as reader:
        stream = RecordStream([lambda record: late_s.append(clock.now_s - record.time_s / 4.0)])
        Player(reader, stream).play(4.0, clock.read, clock.sleep)
    assert min(late_s) > -1e-9


def test_seeking_stands_before_the_first_record_of_a_cycle(player):
    player, heard = player
    player.seek(3)
    assert player.cycle == 2
    assert heard[-1].kind == Kind.SELECT_ARC_OUT
    time_s = player.time_s
    clock = Clock()
    player.play(10.0, clock.read, clock.sleep)
    assert clock.now_s == pytest.approx((player.time_s - time_s) / 10.0)


def test_seeking_backward_begins_again(player):
    player, heard = player
    player.seek(4)
    heard.clear()
    player.seek(2)
    assert heard[0].sequence == 0
    assert player.cycle == 1


def test_seeking_behind_the_end_publishes_everything(player):
    player, heard = player
    player.seek(10_000)
    assert player.is_done
    assert heard[-1].kind == 0


def test_a_played_file_gives_the_same_metrics_as_one_read(quick_drive):
    replayed, damage = read_history(quick_drive)
    assert damage is None
    with DpReader(quick_drive) as reader:
        history = History(reader.schema, reader.info)
        Player(reader, RecordStream([history.take])).play()
    assert metrics.summarize(history) == metrics.summarize(replayed)
    assert metrics.cycles_csv(history) == metrics.cycles_csv(replayed)


@pytest.mark.faults
def test_a_gap_costs_the_answer_whose_request_is_lost_and_nothing_else(quick_drive, tmp_path):
    with DpReader(quick_drive) as reader:
        records = list(reader.records())
        lost = [item.sequence for item in records if item.kind == Kind.SELECT_ARC_IN][1]
        with DpWriter(tmp_path / "gap.dp", reader.info) as writer:
            for record in records[:lost] + records[lost + 1 :]:
                writer.write(record)
    whole, _ = read_history(quick_drive)
    history, damage = read_history(tmp_path / "gap.dp")
    assert damage is not None
    assert len(history.selections) == len(whole.selections) - 1
    assert history.outcome == whole.outcome
    assert len(history.truth) == len(whole.truth)


@pytest.mark.faults
def test_records_laid_out_otherwise_are_one_error(quick_drive, tmp_path):
    data = quick_drive.read_bytes()
    path = tmp_path / "other.dp"
    path.write_bytes(_with_description(data, b"point_count", b"print_count"))
    read_history(path)  # a field that nobody here needs
    path.write_bytes(_with_description(data, b'"params"', b'"pirams"'))
    with pytest.raises(DpFileError, match="record 0 is not laid out as this program expects"):
        read_history(path)


def _with_description(data, old, new):
    size = struct.unpack_from("=I", data, 20)[0]
    head = data[: 24 + size].replace(old, new)
    return head + struct.pack("=I", zlib.crc32(head)) + data[28 + size :]
