# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.imaging import Images


@pytest.fixture
def images(fake_world):
    return Images(fake_world())


def test_what_is_taken_waits_until_it_is_released(images):
    images.take(images.world.image)
    assert not images.released
    images.release()
    images.take(images.world.image, pair_count=3)
    assert [(item.image_id, item.pair_count) for item in images.released] == [(1, 1)]
    images.release()
    assert [(item.image_id, item.pair_count) for item in images.released] == [(1, 1), (2, 3)]


def test_numbers_of_images_are_never_used_again(images):
    images.take(images.world.image)
    images.clear()
    images.take(images.world.image)
    images.release()
    assert [item.image_id for item in images.released] == [2]
