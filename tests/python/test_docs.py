# SPDX-License-Identifier: Apache-2.0
"""The examples of README.md and of pages of docs/, run in turn as a reader would; and what the package says of its types."""

import inspect
import re

import perp
import pytest
from pages import ROOT, run_examples


@pytest.mark.parametrize(
    "page, least",
    [
        ("README.md", 1),
        ("docs/python.md", 6),
        ("docs/vi.md", 1),
        ("docs/batch.md", 2),
        ("docs/trace.md", 2),
        ("docs/contact/derivatives.md", 1),
    ],
)
def test_examples(page, least):
    run_examples(page, least)


@pytest.mark.parametrize("name", perp.__all__)
def test_everything_says_what_it_is(name):
    what = getattr(perp, name)
    assert name == "__version__" or inspect.getdoc(what), name


def test_arguments_have_shapes_in_words():
    contact = (perp.contact.solve, perp.contact.Problem.sensitivity)
    for function in (perp.solve, perp.lcp, perp.sensitivity, perp.Problem.F, *contact):
        assert re.search(r"shape \(", inspect.getdoc(function)), function


def test_types_are_told():
    assert (ROOT / "python" / "perp" / "py.typed").exists()
    for name in perp.__all__:
        what = getattr(perp, name)
        if inspect.isfunction(what):
            assert set(inspect.signature(what).parameters) <= set(what.__annotations__), name


def test_the_version_is_that_of_cmake():
    assert f"project(perp VERSION {perp.__version__}" in (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
