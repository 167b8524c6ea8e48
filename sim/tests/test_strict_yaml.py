# SPDX-License-Identifier: Apache-2.0
"""Scalars as people mean them."""

import pytest

from sim.strict_yaml import read_tree, resolve_plain, write_tree


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        ("-0", 0),
        ("1e3", 1000.0),
        ("1e-3", 0.001),
        (".5", 0.5),
        ("5.", 5.0),
        ("+1.5E+2", 150.0),
        ("true", True),
        ("False", False),
        ("", None),
        ("~", None),
        ("yes", "yes"),
        ("on", "on"),
        ("0777", "0777"),
        ("1_000", "1_000"),
        ("12:30", "12:30"),
        (".nan", ".nan"),
        ("-.inf", "-.inf"),
        ("1e400", "1e400"),
        ("2001-01-01", "2001-01-01"),
        ("0x1F", "0x1F"),
        ("\u0661", "\u0661"),
    ],
)
def test_plain_scalars(text: str, value: object) -> None:
    found = resolve_plain(text)
    assert found == value
    assert type(found) is type(value)


def test_places_of_keys_and_items() -> None:
    tree = read_tree("a: 1\nb:\n  - x\n  - {c: 2}\n", "f")
    assert tree.data == {"a": 1, "b": ["x", {"c": 2}]}
    assert tree.places["a",] == "f:1:1"
    assert tree.places["b", 0] == "f:3:5"
    assert tree.places["b", 1, "c"] == "f:4:6"


def test_written_text_keeps_types() -> None:
    data = {"a": "1e3", "b": 1e3, "c": "yes", "d": None, "e": [1, 2.5], "f": "true", "g": 1e-300}
    assert read_tree(write_tree(data), "f").data == data
