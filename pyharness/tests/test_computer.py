# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.computer import Computer
from pyharness.status import Activity
from pyharness.telemetry import Telemetry


@pytest.fixture
def world(fake_world):
    return fake_world()


@pytest.fixture
def computer(world):
    return Computer(Telemetry(world, lambda *_: None))


def test_a_result_counts_when_its_time_is_over(computer, world):
    done = []
    computer.occupy(Activity.SELECT_ARC, 1.0, lambda: done.append(world.time_s))
    for _ in range(20):
        computer.finish_job()
        world.step()
    assert done == [1.0]


def test_tasks_run_one_after_the_other_and_wait_where_they_cannot_start(computer, world):
    log, gate = [], []

    def task(name, is_ready=lambda: True):
        def start():
            if is_ready():
                log.append((name, world.time_s))
                computer.occupy(Activity.SELECT_ARC, 0.25)
                return True
            return False

        return start

    computer.plan([task("first"), task("second", lambda: bool(gate)), task("third")])
    for tick in range(10):
        if tick == 5:
            gate.append(True)
        computer.finish_job()
        computer.start_next()
        world.step()
    assert log == [("first", 0.0), ("second", 0.625), ("third", 0.875)]


def test_a_task_with_nothing_to_do_takes_no_time(computer):
    computer.plan([lambda: True, lambda: True])
    computer.start_next()
    assert computer.is_done


def test_cleared_it_forgets_its_job(computer):
    done = []
    computer.occupy(Activity.SELECT_ARC, 0.0, lambda: done.append(1))
    computer.clear()
    computer.finish_job()
    assert done == []
