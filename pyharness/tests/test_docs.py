# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness._build.make_docs import DOCS, pages


@pytest.mark.parametrize("name", pages())
def test_pages_made_from_the_c_tables_are_current(name):
    assert (DOCS / name).read_text(encoding="utf-8") == pages()[name], "run make docs"


@pytest.mark.parametrize("name", pages())
def test_the_index_names_every_page(name):
    assert f"({name})" in (DOCS / "README.md").read_text(encoding="utf-8")
