# SPDX-License-Identifier: Apache-2.0
"""Configuration: every fault at once, each with its place; traps of YAML do not spring."""

import contextlib
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from sim.config import ConfigModel, dump_model, load_model, parse_model
from sim.errors import ConfigError


class Layer(ConfigModel):
    scale_m: float = 1.0


class Ground(ConfigModel):
    slope_deg: Annotated[float, Field(ge=0, le=60)] = 0.0
    cfa: float | None = None
    layers: tuple[Layer, ...] = ()
    start_m: tuple[float, float] = (0.0, 0.0)


class Scenario(ConfigModel):
    name: str = "demo"
    seed: int = 0
    noisy: bool = True
    mode: Literal["avoid_all", "guarded"] = "avoid_all"
    terrain: Ground = Ground()
    tables: dict[str, float] = Field(default_factory=dict)


def problems(text: str, **overrides: object) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        parse_model(text, "s.yaml", Scenario, overrides)
    assert str(caught.value) == "\n".join(caught.value.problems)
    assert all("\n" not in line for line in caught.value.problems)
    return list(caught.value.problems)


def test_values_arrive_typed() -> None:
    scenario = parse_model(
        "name: x\nseed: 7\nnoisy: false\n"
        "terrain: {slope_deg: 1e1, cfa: 1e-3, start_m: [1, -2.5]}\n",
        "s.yaml",
        Scenario,
    )
    assert scenario.terrain == Ground(slope_deg=10.0, cfa=0.001, start_m=(1.0, -2.5))
    assert isinstance(scenario.terrain.start_m[0], float)


def test_all_faults_at_once_with_their_place() -> None:
    text = "seed: abc\nterrain:\n  slope_dg: 3\n  cfa: lots\nmode: guardd\nnoisy: 1\n"
    assert sorted(problems(text)) == [
        "s.yaml:1:1: seed: expected an integer, got 'abc'",
        "s.yaml:3:3: terrain.slope_dg: unknown key, did you mean 'slope_deg'?",
        "s.yaml:4:3: terrain.cfa: expected a number, got 'lots'",
        "s.yaml:5:1: mode: expected one of avoid_all, guarded, got 'guardd',"
        " did you mean 'guarded'?",
        "s.yaml:6:1: noisy: expected true or false, got 1",
    ]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("seed: true", "expected an integer, got true"),
        ("seed: 1.0", "expected an integer, got 1.0"),
        ("seed: 012", "expected an integer, got '012'"),
        ("seed: 0x10", "expected an integer, got '0x10'"),
        ("seed: 1_000", "expected an integer, got '1_000'"),
        ("seed: 12:30", "expected an integer, got '12:30'"),
        ("seed: 2001-13-45", "expected an integer, got '2001-13-45'"),
        ("seed: null", "expected an integer, got nothing"),
        ("seed: '3'", "expected an integer, got '3'"),
        ("seed: [1]", "expected an integer, got a list"),
        ("noisy: yes", "expected true or false, got 'yes'"),
        ("noisy: off", "expected true or false, got 'off'"),
        ("name: 12", "expected text, got 12"),
        ("name: {a: 1}", "expected text, got keys and values"),
        ("terrain: {cfa: .nan}", "expected a number, got '.nan'"),
        ("terrain: {cfa: .inf}", "expected a number, got '.inf'"),
        ("terrain: {cfa: 1e400}", "expected a number, got '1e400'"),
        ("terrain: {cfa: true}", "expected a number, got true"),
        ("terrain: {slope_deg: 61}", "expected <= 60.0, got 61"),
        ("terrain: {slope_deg: -0.1}", "expected >= 0.0, got -0.1"),
        ("terrain: {start_m: [1]}", "expected at least 2 items"),
        ("terrain: {start_m: [1, 2, 3]}", "expected at most 2 items, got 3"),
        ("terrain: {start_m: [1, x]}", "terrain.start_m.1: expected a number, got 'x'"),
        ("terrain: 3", "expected keys and values, got 3"),
        ("terrain:", "expected keys and values, got nothing"),
        ("terrain: {layers: [{scal_m: 1}]}", "unknown key, did you mean 'scale_m'?"),
        ("seed: 1\nseed: 2", "s.yaml:2:1: seed: duplicate key"),
        ("terrain: {cfa: 1, cfa: 2}", "terrain.cfa: duplicate key"),
        ("<<: {seed: 1}", "unknown key"),
        ("- 1", "expected keys and values at the top, got a list"),
        ("hello", "expected keys and values at the top, got 'hello'"),
        ("a: &x 1\nb: *x", "anchors and aliases"),
        ("a: &a [*a]", "anchors and aliases"),
        ("seed: !!python/object:os.system x", "tags such as"),
        ("seed: !!timestamp 1", "tags such as"),
        ("seed: !!int xx", "tags such as"),
        ("[" * 20_000, "nested deeper than"),
        ("a: " + "{b: " * 20_000, "nested deeper than"),
        ("? [1, 2]\n: 3", "a key must be a plain word"),
        ("a: 1\n---\nb: 2", "only one document"),
        ("a:\n\t- b", "not valid YAML"),
        ("a: [1", "not valid YAML"),
        ("a: 'x", "not valid YAML"),
        ("a: \x00", "not valid YAML"),
        ('name: "\\ud800"', "surrogate"),
        ("terrain: {cfa: 1" + "0" * 400 + "}", "expected a finite number"),
        ("seed: " + "9" * 5000, "expected an integer"),
    ],
)
def test_traps_give_one_clear_line(text: str, fault: str) -> None:
    lines = problems(text)
    assert len(lines) == 1
    assert fault in lines[0]
    assert lines[0].startswith("s.yaml")
    assert len(lines[0]) < 200


@pytest.mark.parametrize("text", ["", "# nothing\n", "\ufeffseed: 0", "---\n", "{}", "seed: +0"])
def test_empty_means_defaults(text: str, tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_text(text, "utf-8")
    assert load_model(path, Scenario) == Scenario()


def test_billion_laughs_are_refused_quickly() -> None:
    bomb = "a: &a [x, x]\n" + "".join(
        f"{chr(98 + i)}: &{chr(98 + i)} [*{chr(97 + i)}, *{chr(97 + i)}]\n" for i in range(20)
    )
    assert "anchors" in problems(bomb)[0]


def test_overrides_win_and_text_is_yaml() -> None:
    scenario = parse_model(
        "seed: 1\nterrain: {cfa: 0.5, layers: [{scale_m: 2}]}",
        "s.yaml",
        Scenario,
        {
            "seed": 3,
            "terrain.cfa": "1e-1",
            "terrain.start_m": "[1, 2]",
            "terrain.layers.0.scale_m": np.float64(5),
            "mode": "guarded",
        },
    )
    assert (scenario.seed, scenario.terrain.cfa, scenario.mode) == (3, 0.1, "guarded")
    assert scenario.terrain.start_m == (1.0, 2.0)
    assert scenario.terrain.layers == (Layer(scale_m=5.0),)


@pytest.mark.parametrize(
    ("key", "value", "line"),
    [
        ("terrain.cfa", "lots", "--set terrain.cfa: expected a number, got 'lots'"),
        ("terrain.cfa", float("nan"), "--set terrain.cfa: expected a finite number, got nan"),
        ("terrain.cfaa", 1, "--set terrain.cfaa: unknown key, did you mean 'cfa'?"),
        ("terain.cfa", 1, "--set terain.cfa: terain: unknown key, did you mean 'terrain'?"),
        ("seed.x", 1, "--set seed.x: 'seed' has no part 'x'"),
        ("terrain.layers.0.scale_m", 1, "--set terrain.layers.0.scale_m: 'terrain.layers' has no"),
        ("", 1, "--set : expected a key such as terrain.cfa"),
        ("seed", "[1", "--set seed: not valid YAML"),
        ("seed", "*a", "--set seed: anchors and aliases"),
        ("seed", object(), "--set seed: cannot use a object as a value"),
    ],
)
def test_override_faults_name_the_override(key: str, value: object, line: str) -> None:
    (found,) = problems("seed: 1\nterrain: {layers: []}", **{key: value})
    assert found.startswith(line)


def test_unreadable_files_give_one_line(tmp_path: Path) -> None:
    (tmp_path / "latin.yaml").write_bytes(b"name: \xff")
    (tmp_path / "big.yaml").write_bytes(b" " * (4 * 1024 * 1024 + 1))
    for name, fault in {
        "missing.yaml": "no such file",
        ".": "not a file",
        "latin.yaml": "not UTF-8",
        "big.yaml": "larger than",
        "nul\0.yaml": "",
    }.items():
        with pytest.raises(ConfigError) as caught:
            load_model(tmp_path / name, Scenario)
        assert len(caught.value.problems) == 1
        assert fault in str(caught.value)


texts = st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=20) | st.sampled_from(
    ["1e3", "yes", "012", "12:30", "null", "~", "true", "-", "# x", " x ", "a: b", "1.", ".5", "&a"]
)


@given(
    name=texts,
    seed=st.integers(-(2**70), 2**70),
    cfa=st.none() | st.floats(allow_nan=False, allow_infinity=False),
    scales=st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=3),
    tables=st.dictionaries(texts, st.floats(-1, 1), max_size=3),
)
def test_dump_loads_back_equal(
    name: str, seed: int, cfa: float | None, scales: list[float], tables: dict[str, float]
) -> None:
    layers = tuple(Layer(scale_m=scale) for scale in scales)
    scenario = Scenario(name=name, seed=seed, terrain=Ground(cfa=cfa, layers=layers), tables=tables)
    text = dump_model(scenario)
    assert parse_model(text, "dump", Scenario) == scenario
    assert dump_model(parse_model(text, "dump", Scenario)) == text


@given(st.text(max_size=60))
def test_no_text_escapes_as_another_error(text: str) -> None:
    with contextlib.suppress(ConfigError):
        parse_model(text, "s.yaml", Scenario)
