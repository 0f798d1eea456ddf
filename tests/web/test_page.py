# SPDX-License-Identifier: Apache-2.0
"""The page that `scripts/portable web` builds, from the disk in Chromium; PERP_WEB is the folder with it."""

import csv
import io
import json
import os
import random
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
MODELS = ROOT / "data" / "models"
PAGE = Path(os.environ["PERP_WEB"]) / "page" / "index.html"

sys.path.insert(0, str(ROOT / "tests" / "support"))
sys.path.insert(0, str(ROOT / "packaging" / "portable"))
import check  # noqa: E402
from browser import CUT, browser  # noqa: E402, F401  (the fixture)

ENTER, TAB = "\ue007", "\ue004"
SOLVED = "document.getElementById('status').textContent.match(/ after [0-9.]+ s[.]/)"
TABLE = "return [...document.querySelectorAll('#table tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))"
SAVED = """const kept = URL.createObjectURL;
  URL.createObjectURL = (blob) => { blob.text().then((text) => { window.saved = text; }); return kept(blob); };
  document.getElementById('save-FORM').click(); URL.createObjectURL = kept;"""


@pytest.fixture(params=[1280, 400])
def page(browser, request):
    browser.open(PAGE, request.param)
    browser.wait_for("document.getElementById('version').textContent")
    yield browser
    assert browser.errors() == []
    assert [line for line in browser.run(CUT) if not line.startswith("scrolls")] == []
    loaded = browser.run("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    assert [name for name in loaded if not name.startswith(("file:", "blob:", "data:"))] == []  # nothing of a network


def text(page, element):
    return page.run(f"return document.getElementById('{element}').innerText")


def take_example(page, title):
    page.run(f"[...document.querySelectorAll('#examples button')].find((b) => b.innerText.startsWith('{title}')).click()")
    page.wait_for("!document.getElementById('solve').disabled && document.getElementById('structure').textContent")


def solve(page):
    page.run("document.getElementById('solve').click()")
    page.wait_for(SOLVED)


def saved(page, form):
    page.run("window.saved = ''; " + SAVED.replace("FORM", form))
    page.wait_for("window.saved")
    return page.run("return window.saved")


def check_values(page, model):
    """The table, and what is saved, beside the solution that data/models/reference.py has computed by other means."""
    known = json.loads((MODELS / f"{model}.sol.json").read_text())
    rows = page.run(TABLE)
    shown = {row[0]: float(row[2]) for row in rows}
    assert {name: shown[name] for name in known} == pytest.approx(known, rel=1e-5, abs=1e-5)
    written = {row["variable"]: float(row["value"]) for row in csv.DictReader(io.StringIO(saved(page, "csv")))}
    assert {name: written[name] for name in known} == pytest.approx(known, rel=1e-6, abs=1e-6)
    result = json.loads(saved(page, "json"))
    assert result["schema"] == "perp/solve/1" and result["residual"]["natural"] <= 1e-8
    assert {entry["name"]: entry["value"] for entry in result["variables"]} == pytest.approx(written)


def test_an_example(page):
    take_example(page, "cournot")
    assert "5 variables" in text(page, "structure")
    page.run("document.getElementById('prove').click()")
    solve(page)
    assert "exactly one solution" in text(page, "facts")
    page.run("document.getElementById('way-part').open = true")
    page.wait_for("document.getElementById('way').naturalWidth > 0")
    assert text(page, "outcome").startswith("Solved: ")
    assert "Major Iteration Log" in page.run("return document.getElementById('log').textContent")
    assert page.run("return document.querySelectorAll('#plot circle').length") >= 4
    check_values(page, "cournot")


DROP = """const carried = new DataTransfer();
  carried.items.add(new File([CONTENT], 'dropped.nl'));
  document.dispatchEvent(new DragEvent('drop', { dataTransfer: carried, bubbles: true, cancelable: true }));"""


def test_a_drop(page):
    page.run(DROP.replace("CONTENT", json.dumps((MODELS / "harberger.nl").read_text())))
    page.wait_for("document.getElementById('structure').textContent.startsWith('dropped.nl: 14 variables')")
    solve(page)
    assert text(page, "outcome").startswith("Solved: ")


def test_files(page):
    page.choose_files("files", [MODELS / f"energy.{ending}" for ending in ("nl", "row", "col")])
    page.wait_for("document.getElementById('structure').textContent.includes('37 variables')")
    solve(page)
    check_values(page, "energy")


# Coulomb's law: the numbers of contacts in each state are those of data/contact/README.md; by forces, 1 stands.
def test_contact(page):
    take_example(page, "spheres-15")
    solve(page)
    assert text(page, "outcome").startswith("Solved")
    rows = page.run(TABLE)
    states = [row[1] for row in rows]
    assert (len(rows), states.count("open")) == (37, 3)
    for row in rows:
        mu, r_N, r_T, u_N = (float(row[k]) for k in (2, 3, 4, 5))
        assert r_T <= mu * r_N * (1 + 1e-6) + 1e-9 and min(r_N, u_N) == pytest.approx(0, abs=1e-6)


# F_1 + F_2 is a negative constant: no x has both >= 0 (collection: infeasible-own).
def test_infeasible(page):
    take_example(page, "infeasible-own")
    solve(page)
    assert text(page, "outcome").startswith("Infeasible")
    assert "rows F[1] and F[2] contradict each other" in text(page, "explanation")
    assert "no solution" in text(page, "table-title")


def test_damaged(page, tmp_path):
    whole = (MODELS / "cournot.nl").read_bytes()
    (tmp_path / "damaged.nl").write_bytes(whole[: len(whole) // 2])
    page.choose_files("files", [tmp_path / "damaged.nl"])
    page.wait_for("document.getElementById('refused').textContent")
    assert text(page, "refused").startswith("damaged.nl:")
    assert page.run("return document.getElementById('solve').disabled")
    (tmp_path / "letter.txt").write_text("Dear reader,")
    page.choose_files("files", [tmp_path / "letter.txt"])
    page.wait_for("document.getElementById('refused').textContent.includes('letter.txt')")
    take_example(page, "cournot")  # as if nothing had been
    assert text(page, "refused") == ""


def write_lcp(folder, n):
    """x with M x + q = 0 at half of the places, M = A'A / n + 1, dense: monotone, and costly by least-index pivots."""
    numbers = random.Random(53)
    A = [[numbers.gauss(0, 1) for _ in range(n)] for _ in range(n)]
    M = [[sum(A[k][i] * A[k][j] for k in range(0, n, 8)) / n + (i == j) for j in range(n)] for i in range(n)]
    q = [numbers.gauss(0, 1) for _ in range(n)]
    (folder / "M.mtx").write_text(f"%%MatrixMarket matrix array real general\n{n} {n}\n" + "\n".join(repr(M[i][j]) for j in range(n) for i in range(n)) + "\n")
    (folder / "q.mtx").write_text(f"%%MatrixMarket matrix array real general\n{n} 1\n" + "\n".join(map(repr, q)) + "\n")
    return M, q


def test_matrices_and_stop(page, tmp_path):
    M, q = write_lcp(tmp_path, 60)
    page.choose_files("files", [tmp_path / "q.mtx", tmp_path / "M.mtx"])
    page.wait_for("document.getElementById('structure').textContent.includes('60 variables')")
    solve(page)
    values = [float(row["value"]) for row in csv.DictReader(io.StringIO(saved(page, "csv")))]
    F = [sum(a * x for a, x in zip(row, values)) + b for row, b in zip(M, q)]
    assert max(abs(min(x, f)) for x, f in zip(values, F)) <= 1e-8
    page.run("document.getElementById('method').value = 'enumeration'; document.getElementById('limit').value = '600'")
    page.run("document.getElementById('solve').click()")
    page.run("document.getElementById('stop').click()")
    page.wait_for("document.getElementById('status').textContent.startsWith('Stopped after')", 5)
    page.run("document.getElementById('method').value = 'auto'")
    solve(page)


# Without a mouse: the first example by its key, the button Solve by Tab from the method.
def test_keyboard(page):
    page.run("document.querySelector('#examples button').focus()")
    page.press([ENTER])
    page.wait_for("document.getElementById('structure').textContent && !document.getElementById('solve').disabled")
    page.run("document.getElementById('method').focus()")
    page.press([TAB, TAB, TAB, TAB])
    assert page.run("return document.activeElement.id") == "solve"
    page.press([ENTER])
    page.wait_for(SOLVED)


def test_everything_has_a_name(page):
    take_example(page, "cournot")
    solve(page)
    page.run("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
    nodes = page.devtools("Accessibility.getFullAXTree")["nodes"]
    controls = {"button", "textbox", "searchbox", "combobox", "region", "table", "img", "image", "figure"}
    nameless = [n["role"]["value"] for n in nodes if not n["ignored"] and n["role"]["value"] in controls and not n.get("name", {}).get("value")]
    assert nameless == []


def test_size():
    files = [path for path in PAGE.parent.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) <= 8e6


# Catches a page or package without the licence of a part.
@pytest.mark.parametrize("part", ["page", "npm"])
def test_licences(part):
    place = PAGE.parent.parent / part
    assert (place / "LICENSE").is_file() and (place / "NOTICE").is_file()
    for name in check.licences("WASI"):
        assert any((place / "licences" / name).iterdir()), name
