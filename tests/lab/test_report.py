# SPDX-License-Identifier: Apache-2.0
"""The report: profiles, sentences, .sol files, and the page as a browser shows it."""

import csv
import json
import math
import re
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT, compare, sol
from perp.lab import cells as lab_cells
from perp.lab import findings
from perp.lab.files import cell_line
from perp.lab.report import write_report

sys.path.insert(0, str(ROOT / "tests" / "support"))
from browser import CUT, browser  # noqa: E402, F401  (the fixture)


@pytest.fixture(scope="session")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "out"
    methods = "path,proxi,miles,semicomp,lemke,semismooth,semismooth:max_iterations=2,cfunctions"
    run = compare("--problems", "class:tiny,class:lcp,-*-500,-*-1000,infeasible-own", "--methods", methods, "--starts", "1", "--restarts", "1", "--out", folder)
    assert run.returncode == 0, run.stderr
    return folder


# The example of Dolan and More's definition worked out by hand: ties count for both, an unsolved pair stays.
def test_profiles():
    inf = math.inf
    rho = findings.performance_profiles([[1, 4, inf, inf], [2, 4, 1, inf]])
    assert rho == [[(1, 2)], [(1, 2), (2, 3)]]
    assert findings.reached(rho[1], 1.5) == 2
    assert findings.data_profiles([[6, 3, inf]], [2, 3, 1]) == [[(1, 1), (3, 2)]]


# 2 P(X <= 1), X ~ B(8, 1/2) = 2 (1 + 8) / 256; equal numbers say nothing.
def test_sign_test():
    assert findings.sign_test(1, 7) == pytest.approx(18 / 256)
    assert findings.sign_test(5, 5) == 1
    assert findings.sign_test(0, 0) == 1


def test_words():
    assert findings.listed(list("abcdef")) == "a, b, c and 3 others"
    assert findings.listed(["a", "b"]) == "a and b"
    assert findings.percent(999, 1000) == "99.9 %"
    assert findings.percent(9999, 10000) == "99.9 %"  # never 100 % unless it is
    assert findings.percent(3, 3) == "100 %"


def test_sol_files():
    assert lab_cells.read_sol(sol("7", 0).encode(), 1) == ("peer", 0, [7.0])
    assert lab_cells.read_sol(b"\xef\xbb\xbf" + sol("7", 100).encode(), 1)[1] == 100
    for wrong in (b"", b"\n", sol("7", 0).encode()[:-1], sol("x", 0).encode(), sol("7", 0).replace("objno", "obj").encode(), sol("7", 0).replace("3\n1", "30\n1").encode()):
        with pytest.raises(lab_cells.Garbage):
            lab_cells.read_sol(wrong, 1)
    with pytest.raises(lab_cells.Garbage):
        lab_cells.read_sol(sol("7", 0).encode(), 2)


def test_starts():
    point = {"x": [0.0, 5.0, "inf"], "lower": [0.0, "-inf", 1.0], "upper": [1.0, "inf", 2.0]}
    first = lab_cells.perturbed(point, "1 p 1", 1)
    assert first == lab_cells.perturbed(point, "1 p 1", 1) != lab_cells.perturbed(point, "2 p 1", 1)
    assert 0 <= first[0] <= 0.1 and abs(first[1] - 5) <= 0.6 and first[2] == 2
    model = (ROOT / "data" / "models" / "cournot.nl").read_text()
    n = int(model.splitlines()[1].split()[0])
    changed = lab_cells.nl_with_start(model, [float(k) for k in range(n)])
    assert f"\nx{n}\n0 0.0\n" in changed


# Failures by class are those that cells.csv has, counted another way.
def test_robustness_follows_from_cells(campaign):
    with open(campaign / "cells.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["outcome"] != "not-applicable"]
    problems = {p["name"]: p for p in json.loads((campaign / "campaign.json").read_text())["problems"]}
    data = findings.Data(campaign)
    for m, total, classes in findings.robustness(data):
        for cls, (pairs, failures, after, _) in zip((*data.classes(), "total"), (*classes, total)):
            mine = [row for row in rows if row["method"] == data.methods[m] and problems[row["problem"]]["solvable"]]
            mine = [row for row in mine if cls in ("total", problems[row["problem"]]["class"])]
            failed = [row["outcome_after_restarts"] for row in mine if row["outcome"] != "solved"]
            assert (pairs, failures, after) == (len(mine), len(failed), len(failed) - failed.count("solved"))


# The last step of a profile is what the table says is solved.
def test_report_json(campaign):
    made = json.loads((campaign / "report.json").read_text())
    solved = {(row["comparison"], row["method"]): row["solved"] for row in made["summary"]}
    assert {key[0] for key in solved} == {"general", "some", "cfunctions-1"}
    last = {(row["comparison"], row["method"]): row["count"] for row in made["profiles"] if row["cost"] == "seconds"}
    assert last == solved


def test_journal_with_strange_lines(campaign, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(campaign, folder)
    lines = (folder / "cells.jsonl").read_bytes()
    (folder / "cells.jsonl").write_bytes(b"\xff\n" + lines.replace(b'"solved"', b'"failed"', 1) + b'{"cell":{"method')
    topics = dict(write_report(str(folder)))
    assert "1 of them are not finished" in topics["What ran"]
    page = (folder / "report.html").read_text()
    assert "3 lines of cells.jsonl left out" in page


# Catches charts and tables that a phone cuts off, and scripts that fail.
@pytest.mark.parametrize("width", [1280, 400])
def test_page_in_a_browser(browser, campaign, width):
    browser.open(campaign / "report.html", width)
    assert browser.errors() == []
    assert browser.run(CUT) == []
    assert browser.run("return document.querySelectorAll('#general .legend button').length") >= 6
    assert browser.run("return document.querySelectorAll('#general details svg g.curve').length") >= 6 * 6
    assert browser.run("return document.querySelectorAll('#cells-body tr').length") == 100
    browser.run("document.getElementById('cells-search').value = 'kojshin semicomp'; document.getElementById('cells-search').dispatchEvent(new Event('input'))")
    rows = browser.run("return [...document.querySelectorAll('#cells-body tr')].map((r) => r.textContent)")
    assert len(rows) == 1 and "semicomp" in rows[0]
    browser.run("document.querySelector('#cells-body button.show').click()")
    assert "kojshin" in browser.run("return document.getElementById('curves-title').textContent")
    assert browser.run("return document.querySelectorAll('#curves polyline').length") >= 1
    muted = "return document.querySelectorAll('#general g.muted').length"
    before = browser.run(muted)
    browser.run("document.querySelector('#general .legend button[aria-pressed=true]').click()")
    assert browser.run(muted) == before + 6
    browser.run("document.querySelector('#robustness thead button').click()")
    names = browser.run("return [...document.querySelectorAll('#robustness tbody th')].map((t) => t.textContent)")
    assert names == sorted(names)
    assert browser.errors() == []


@pytest.mark.parametrize("width", [1280, 400])
def test_contact_page_in_a_browser(browser, tmp_path, width):
    run = compare("contact", "stack:3", "incline:3", "--variants", "glocker,glocker+path,inner:8", "--out", tmp_path / "out")
    assert run.returncode == 0, run.stderr
    browser.open(tmp_path / "out" / "report.html", width)
    assert browser.errors() == []
    assert browser.run(CUT) == []
    assert browser.run("return document.querySelectorAll('#general g.curve').length") == 2 * 2
    assert browser.run("return document.querySelectorAll('#laws tbody tr').length") == 3
    assert browser.run("return document.querySelectorAll('#cells-body tr').length") == 2 * 3


# The page cannot be made to run what a message says.
def test_messages_are_text(campaign, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(campaign, folder)
    cell = json.loads((folder / "cells.jsonl").read_text().splitlines()[0])["cell"]
    cell["message"] = "</script><script>alert(1)</script><b>"
    cell["outcome"] = "false-convergence"
    with open(folder / "cells.jsonl", "ab") as journal:
        journal.write(cell_line(cell))
    write_report(str(folder))
    page = (folder / "report.html").read_text()
    assert "<script>alert" not in page
    assert "\\u003c/script>" in page  # in the data of the table of all runs
