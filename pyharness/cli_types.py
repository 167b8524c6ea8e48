# SPDX-License-Identifier: Apache-2.0
"""Kinds of options, and how faults name them."""

from collections.abc import Mapping
from typing import Any

import click

from pyharness.errors import HarnessError
from sim.errors import SimError


class Numbers(click.ParamType):  # type: ignore[type-arg]
    """Numbers separated by commas, e.g. `-40,0,0`."""

    name = "numbers"

    def __init__(self, names: str) -> None:
        self.names = names
        self.count = names.count(",") + 1

    def get_metavar(self, *_: Any, **__: Any) -> str:
        """Return what the help shows."""
        return self.names

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> list[float]:
        """Read the text."""
        try:
            numbers = [float(part) for part in str(value).split(",")]
        except ValueError:
            numbers = []
        if len(numbers) != self.count:
            self.fail(f"expected {self.names}, got {value!r}", param, ctx)
        return numbers


class Assignment(click.ParamType):  # type: ignore[type-arg]
    """`key=value`."""

    name = "key=value"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, str]:
        """Split the text."""
        key, sign, text = str(value).partition("=")
        if not sign or not key:
            self.fail(f"expected key=value, got {value!r}", param, ctx)
        return key, text


def as_options(error: SimError, options: Mapping[str, Any]) -> HarnessError:
    """Name the option in a message about a key that an option gave."""
    text = str(error)
    for key, value in options.items():
        name = key.removesuffix("_file")
        if value is not None:
            text = text.replace(f"--set {name}:", f"--{name.replace('_', '-')}:")
    return HarnessError(text)
