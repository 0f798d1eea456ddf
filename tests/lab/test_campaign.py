# SPDX-License-Identifier: Apache-2.0
"""Campaigns: what is booked, what stays open, and what a kill -9, a full disk and a killed judge leave behind."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import LAB, PROGRAM, ROOT, cells, command, compare, script, sol, start, wrapper, writes

SMALL = ("--problems", "class:tiny", "--methods", "path,semismooth:max_iterations=3", "--starts", "2", "--jobs", "2")


def outcomes(folder):
    return (Path(folder) / "outcomes.csv").read_text()


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """The same campaign in one go."""
    folder = tmp_path_factory.mktemp("whole") / "out"
    run = compare(*SMALL, "--out", folder)
    assert run.returncode == 0, run.stderr
    return folder


def test_says_what_was_solved_and_leaves_the_files(whole):
    names = {"campaign.json", "cells.jsonl", "cells.csv", "outcomes.csv", "report.html", "report.json", "findings.txt"}
    assert names <= set(os.listdir(whole))
    assert not (whole / "work").exists()
    # Three iterations are too few for semismooth on some of the class, and path solves all of it (docs/tutorial.md).
    made = cells(whole)
    assert all(c["outcome"] == "solved" for c in made if c["method"] == "path")
    assert {c["outcome"] for c in made if c["method"] != "path"} == {"solved", "failed"}
    assert all(c["natural"] <= 1e-6 for c in made if c["outcome"] == "solved")


# Nothing lost, nothing booked that was not seen. Catches lines that a kill tears, cells that run twice, and cells of a
# process that died with the campaign: the outcomes are those of the campaign that nobody has disturbed.
def test_kill_9_at_a_hundred_moments(tmp_path, whole):
    chance, out = random.Random(1), tmp_path / "out"
    for _ in range(100):
        run = start(*SMALL, "--resume", "--out", out)
        time.sleep(chance.uniform(0, 0.6))
        run.kill()
        run.wait()
        run.stderr.close()
        if (out / "cells.jsonl").exists() and len(cells_whole(out)) == len(cells(whole)):
            shutil.rmtree(out)  # it was complete: begin anew, so that a hundred moments differ
    run = compare(*SMALL, "--resume", "--out", out)
    assert run.returncode == 0, run.stderr
    assert outcomes(out) == outcomes(whole)
    keys = [(c["method"], c["problem"], c["start"]) for c in cells(out)]
    assert len(keys) == len(set(keys))


def cells_whole(folder):
    return [line for line in (folder / "cells.jsonl").read_bytes().split(b"\n") if line.endswith(b'"}')]


# A disk that is full at some line of the journal: the line is cut off, its cell is open, and --resume does the rest.
# Catches a campaign that books a crash, or a torn line before a whole one.
@pytest.mark.parametrize("blocks", [1, 2, 4])
def test_full_disk(tmp_path, whole, blocks):
    out = tmp_path / "out"
    limited = ["bash", "-c", f'ulimit -f {blocks}; trap "" XFSZ; exec "$@"', "bash", *command("compare", *SMALL, "--out", out)]
    run = subprocess.run(limited, capture_output=True, text=True, timeout=240, check=False)
    assert run.returncode in (2, 4), run.stderr
    assert "File too large" in run.stderr
    if (out / "cells.jsonl").exists():
        assert all(c["outcome"] in ("solved", "failed") for c in cells(out))
    again = compare(*SMALL, "--resume", "--out", out)
    assert again.returncode == 0, again.stderr
    assert outcomes(out) == outcomes(whole)


# A judge that is killed, that says nothing, and that finds no room: no verdict is no outcome. Catches right answers
# that become false claims.
@pytest.mark.parametrize("how", ["kill -9 $$", "exit 3", "exit 2", "echo '{'; exit 0"])
def test_killed_judge(tmp_path, whole, how):
    out = tmp_path / "out"
    wrong = wrapper(tmp_path / "perp", f'if [ "$1" = judge ]; then {how}; fi')
    words = ("--problems", "kojshin,josephy", "--methods", "path", "--out", out)
    run = compare(*words, "--program", wrong)
    assert run.returncode == 4
    assert "a cell stays open: the judge of" in run.stderr
    assert cells(out) == []
    again = compare("--resume", "--out", out)
    assert again.returncode == 0, again.stderr
    assert {c["outcome"] for c in cells(out)} == {"solved"}


# A method that somebody kills from outside is no crash of the method; one that dies by its own fault is.
@pytest.mark.parametrize(("how", "code", "booked"), [("kill -9 $$", 4, []), ("kill -TERM $$", 4, []), ("kill -SEGV $$", 0, ["crashed"]), ("exit 3", 0, ["crashed"])])
def test_killed_method(tmp_path, how, code, booked):
    out = tmp_path / "out"
    wrong = wrapper(tmp_path / "perp", f'if [ "$1" = solve ]; then {how}; fi')
    run = compare("--problems", "kojshin", "--methods", "path", "--starts", "1", "--program", wrong, "--out", out)
    assert run.returncode == code, run.stderr
    assert [c["outcome"] for c in cells(out)] == booked


# The judge's word counts: a program that claims a point with a residual of 9 (perp judge kojshin) makes a false claim.
def test_outcomes_of_peers(tmp_path):
    model = ROOT / "data" / "models" / "cournot.nl"
    size = json.loads(subprocess.run([PROGRAM, "judge", model, "--json", "-"], capture_output=True, check=False).stdout)["own_variables"]
    values = "\n".join(["0"] * size)
    text = sol(values, 0).replace("\n1\n0\n1\n1\n", f"\n1\n0\n{size}\n{size}\n")
    peers = {
        "wrong": writes(text),
        "gone": "exit 1",
        "killed": "kill -SEGV $$",
        "torn": writes(text[:-9]),
        "sizes": writes(sol("0", 0)),
        "failed": writes(text.replace("objno 0 0", "objno 0 510")),
        "refuses": writes(text.replace("objno 0 0", "objno 0 590")),
        "denies": writes(text.replace("objno 0 0", "objno 0 200")),
        "slow": "sleep 60 & sleep 60",
        "right": f"exec '{PROGRAM}' \"$@\"",
    }
    words = [w for name, body in peers.items() for w in ("--external", f"{name}={script(tmp_path / name, body)}")]
    run = compare("--problems", model, "--methods", "path", *words, "--time-limit", "2", "--out", tmp_path / "out")
    assert run.returncode == 0, run.stderr
    assert {c["method"]: c["outcome"] for c in cells(tmp_path / "out")} == {
        "path": "solved", "wrong": "false-convergence", "gone": "garbage", "killed": "crashed", "torn": "garbage", "sizes": "garbage",
        "failed": "failed", "refuses": "not-applicable", "denies": "failed", "slow": "time-limit", "right": "solved",
    }  # fmt: skip


# What a program leaves running dies with it, and with the campaign, whatever session it has made for itself.
@pytest.mark.parametrize("end", ["itself", "limit", "kill"])
def test_nothing_is_left_running(tmp_path, end):
    note = tmp_path / "pid"
    wait = "sleep 300" if end != "itself" else "true"
    peer = script(tmp_path / "peer", f"setsid sh -c 'echo $$ > {note}.new; mv {note}.new {note}; exec sleep 300' &\nwhile [ ! -e {note} ]; do sleep 0.01; done\n{wait}")
    run = start("--problems", ROOT / "data" / "models" / "cournot.nl", "--methods", "none", "--external", f"p={peer}", "--time-limit", "2", "--out", tmp_path / "out")
    while not note.exists():
        time.sleep(0.01)
    if end == "kill":
        run.kill()
    run.communicate(timeout=60)
    pid = int(note.read_text())
    for _ in range(200):
        state = Path(f"/proc/{pid}/stat")
        if not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.05)
    os.kill(pid, signal.SIGKILL)
    pytest.fail("the peer's child lives on")


# Perturbed starts bring kojshin's failures of three iterations to an end, and are the same in every run.
def test_restarts(tmp_path):
    words = ("--problems", "kojshin", "--methods", "josephy:max_iterations=4", "--restarts", "20", "--jobs", "1")
    for folder in ("a", "b"):
        assert compare(*words, "--out", tmp_path / folder).returncode == 0
    made = cells(tmp_path / "a")
    assert any(c["restarts"] > 0 for c in made)
    assert outcomes(tmp_path / "a") == outcomes(tmp_path / "b")
    assert all(c["restarts"] == 0 for c in made if c["outcome"] == "solved")
    assert all(0 < c["restarts"] <= 20 for c in made if c["outcome"] != "solved")


def test_limits(tmp_path):
    out = tmp_path / "out"
    slow = wrapper(tmp_path / "perp", 'if [ "$1" = solve ]; then exec sleep 60; fi')
    assert compare("--problems", "kojshin", "--methods", "path", "--starts", "1", "--time-limit", "0.5", "--program", slow, "--out", out).returncode == 0
    assert [c["outcome"] for c in cells(out)] == ["time-limit"]
    fat = wrapper(tmp_path / "fat", f'if [ "$1" = solve ]; then exec {sys.executable} -c "x = bytearray(300 << 20); import time; time.sleep(60)"; fi')
    out = tmp_path / "out2"
    assert compare("--problems", "kojshin", "--methods", "path", "--starts", "1", "--memory-limit", "100", "--program", fat, "--out", out).returncode == 0
    assert [c["outcome"] for c in cells(out)] == ["memory-limit"]


# Four shards joined have the outcomes of the campaign in one go; a shard that is missing is said to be.
def test_shards(tmp_path, whole):
    parts = [tmp_path / f"part{k}" for k in range(1, 4)]
    for k, part in enumerate(parts, 1):
        assert compare(*SMALL, "--shard", f"{k}/3", "--out", part).returncode == 0
    joined = subprocess.run(command("report", *parts, "--out", tmp_path / "joined"), capture_output=True, text=True, check=False)
    assert joined.returncode == 0, joined.stderr
    assert outcomes(tmp_path / "joined") == outcomes(whole)
    two = subprocess.run(command("report", *parts[:2], "--out", tmp_path / "two"), capture_output=True, text=True, check=False)
    assert "shard 3/3 is missing" in two.stderr
    twice = subprocess.run(command("report", parts[0], parts[0], "--out", tmp_path / "twice"), capture_output=True, text=True, check=False)
    assert twice.returncode == 2
    assert "both hold shard 1/3" in twice.stderr


def test_baseline(tmp_path, whole):
    lines = outcomes(whole).replace("semismooth:max_iterations=3,billups,1,failed", "semismooth:max_iterations=3,billups,1,solved")
    assert lines != outcomes(whole)
    (tmp_path / "b.csv").write_text(lines)
    for base, code in ((whole / "outcomes.csv", 0), (tmp_path / "b.csv", 1)):
        run = compare(*SMALL, "--baseline", base, "--out", tmp_path / f"out-{base.name}")
        assert run.returncode == code, run.stderr
    assert "1 solved there and not here" in run.stdout


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("--problems", "kojshinn"), "Did you mean 'kojshin'?"),
        (("--problems", "class:nowhere"), "It has the classes"),
        (("--problems", "nowhere.nl"), "there is no file"),
        (("--methods", "pth"), "Did you mean 'path'?"),
        (("--methods", "path:crash_methd=none"), "crash_method"),
        (("--methods", "cfunctions:rho=-1"), "rho"),
        (("--problems", "kojshin,"), "an item is empty"),
        (("--starts", "0"), "--starts: '0'"),
        (("--tol", "7"), "a number from"),
        (("--shard", "4/3"), "no K/N"),
        (("--external", "path=cat"), "a method of perp's own"),
        (("--external", "p=nowhere"), "no program that can be run"),
        (("--resume",), "there is no campaign"),
        (("--program", "nowhere"), "there is no program"),
    ],
)
def test_refuses_before_anything_runs(tmp_path, words, why):
    run = compare(*words, "--out", tmp_path / "out")
    assert run.returncode == 2
    assert why in run.stderr
    assert not (tmp_path / "out").exists()


def test_resume_asks_for_the_same(tmp_path, whole):
    run = compare("--resume", "--tol", "1e-9", "--out", whole)
    assert run.returncode == 2
    assert "tol: 1e-06 there, 1e-09 here" in run.stderr
    run = compare("--resume", "--methods", "path", "--out", whole)
    assert run.returncode == 2
    assert "methods: path,semismooth:max_iterations=3 there, path here" in run.stderr
    assert "holds a campaign" in compare(*SMALL, "--out", whole).stderr


# A file is known by its content: what has changed is another problem.
def test_resume_with_a_file_that_has_changed(tmp_path):
    model = tmp_path / "model.nl"
    shutil.copyfile(ROOT / "data" / "models" / "cournot.nl", model)
    words = ("--problems", model, "--methods", "path", "--out", tmp_path / "out")
    assert compare(*words).returncode == 0
    assert compare("--resume", *words).returncode == 0
    model.write_text(model.read_text() + "\n")
    assert "crc of model.nl" in compare("--resume", *words).stderr
    model.unlink()
    assert "there is no file" in compare("--resume", *words[-2:]).stderr


# A file that perp refuses is no reason to run nothing, and none to begin anew.
def test_refused_files_are_left_out(tmp_path):
    shutil.copyfile(ROOT / "data" / "models" / "cournot.nl", tmp_path / "good.nl")
    (tmp_path / "bad.nl").write_text("no model\n")
    words = ("--problems", tmp_path / "*.nl", "--methods", "path", "--out", tmp_path / "out")
    run = compare(*words)
    assert run.returncode == 0, run.stderr
    assert "bad.nl is left out" in run.stderr
    assert compare(*words, "--resume").returncode == 0
    assert {c["problem"] for c in cells(tmp_path / "out")} == {"good.nl"}


# The baseline's classes of outcomes from the collection: what has no solution is proven so, or honestly not solved.
def test_problems_without_a_solution(tmp_path):
    run = compare("--problems", "infeasible-own,feasible-unsolvable-own", "--methods", "lemke,path", "--starts", "1", "--out", tmp_path / "out")
    assert run.returncode == 0, run.stderr
    assert {c["outcome"] for c in cells(tmp_path / "out")} <= {"infeasible", "failed", "not-applicable"}
    assert "Of problems that have no solution" in run.stdout


# The contact comparison on the same engine: solved by its own law, open where it is killed, resumed. W of outer:4 has
# zeros on the diagonal, for which psor is not made. What a polygon that is not turned calls solved is exact here by luck,
# as the boxes slide towards one of its corners.
def test_contact(tmp_path):
    out, sliding = tmp_path / "out", ROOT / "data" / "contact" / "incline-3-sliding.hdf5"
    words = ("contact", sliding, "stack:3", "--variants", "glocker,outer:4+psor,inner:8,inner:16", "--out", out)
    wrong = wrapper(tmp_path / "perp", 'case "$*" in *"--formulation inner:8"*) kill -9 $$;; esac')
    run = compare(*words, "--program", wrong)
    assert run.returncode == 4
    assert len(cells(out)) == 6
    run = compare("contact", "--resume", "--out", out)
    assert run.returncode == 0, run.stderr
    outcome = {(c["method"], Path(c["problem"]).name): c["outcome"] for c in cells(out)}
    assert outcome["glocker+auto", sliding.name] == outcome["inner:8", "stack:3"] == "solved"
    assert outcome["outer:4+psor", "stack:3"] == "not-applicable"
    error = {c["method"]: c["siconos"] for c in cells(out) if c["problem"] == str(sliding)}
    assert error["glocker+auto"] <= 1e-8 and error["inner:8"] <= 1e-12
    refused = compare("contact", "nowhere.hdf5", "--out", tmp_path / "no")
    assert refused.returncode == 2
    assert "nowhere.hdf5" in refused.stderr


# Seconds beyond the limit, a message that a process leaves, and one that hangs.
def test_contact_limits(tmp_path):
    for body, outcome in (("kill -SEGV $$", "crashed"), ("exec sleep 60", "time-limit")):
        wrong = wrapper(tmp_path / "perp", f'case "$*" in *--formulation*) {body};; esac')
        words = ("contact", "stack:3", "--variants", "glocker", "--time-limit", "0.01", "--program", wrong)
        run = compare(*words, "--out", tmp_path / outcome)
        assert run.returncode == 0, run.stderr
        assert [c["outcome"] for c in cells(tmp_path / outcome)] == [outcome]


# Friction turned towards a corner by up to pi / K: the errors of polygons fall at least like 1/K (contact/README.md).
# By hand: inner polygons never leave the cone, outer ones miss no dissipation.
def test_facets(tmp_path):
    sliding = ROOT / "data" / "contact" / "incline-3-sliding.hdf5"
    words = ("facets", sliding, "stack:3", "--facets", "16,4", "--svg", tmp_path / "f.svg", "--json", tmp_path / "f.json")
    run = compare(*words)
    assert run.returncode == 0, run.stderr
    study = json.loads((tmp_path / "f.json").read_text())
    assert [p["counts"] for p in study["problems"]] == [True, False]
    assert study["powers"]["inner"]["natural"] < -1
    assert study["powers"]["outer"]["cone"] < -1
    assert study["powers"]["inner"]["cone"] is None and study["powers"]["outer"]["slip"] is None
    assert [(line["polygon"], line["facets"], line["solved"]) for line in study["lines"]] == [(side, K, 6) for side in ("inner", "outer") for K in (4, 16)]
    assert len(study["runs"]) == 2 * 2 * 2 * 3
    assert f"in the disk (inner:K): falls like K^{study['powers']['inner']['natural']:.2f}" in (tmp_path / "f.svg").read_text()
    wrong = wrapper(tmp_path / "perp", 'case "$*" in *"--formulation outer:16"*) kill -9 $$;; esac')
    run = compare(*words, "--program", wrong)
    assert run.returncode == 4
    assert "outer:16" in run.stderr and "signal 9" in run.stderr
    for refused, why in ((("--facets", "2"), "from 3 to 1000"), (("--facets", "4", "--svg", sliding), "ends in .svg")):
        run = compare("facets", sliding, *refused)
        assert run.returncode == 2
        assert why in run.stderr


def test_ball(tmp_path):
    run = compare("ball", "--svg", tmp_path / "b.svg", "--facets", "4", "--load", "1", "--cycles", "1")
    assert run.returncode == 0, run.stderr
    assert "law: stays at rest" in (tmp_path / "b.svg").read_text()
    run = compare("ball", "--facets", "6,8", "--load", "1", "--cycles", "1")  # of Acary's: 6 facets hold this load, 8 do not
    drift = {words[0]: float(words[-1]) for line in run.stdout.splitlines() if (words := line.split()) and ":" in words[0]}
    assert drift["inner:6"] < 1e-12 < 1e-2 < drift["inner:8"]


def test_forces(tmp_path):
    sliding = ROOT / "data" / "contact" / "incline-3-sliding.hdf5"
    for flags, slipping in (([], "slip: 12"), (["--formulation", "inner:6", "--rotation", "0.3"], "slip: 9")):
        run = compare("forces", sliding, "--svg", tmp_path / "r.svg", *flags)
        assert run.returncode == 0, run.stderr
        assert slipping in (tmp_path / "r.svg").read_text()
    assert compare("forces", "nowhere.dat", "--svg", tmp_path / "no.svg").returncode == 2
    assert compare("forces", sliding, "--svg", sliding).returncode == 2  # a problem is not written over


# Catches an option that the man page does not have, and one that is no more.
@pytest.mark.parametrize(("words", "section"), [("compare", "compare"), ("compare contact", "compare contact"), ("compare facets", "compare facets"), ("report", "report")])
def test_man_page(words, section):
    page = (ROOT / "app" / "perp-compare.1").read_text().split(f"\n.Ss perp-{section}\n")[1].split("\n.S")[0]
    run = subprocess.run(command(*words.split(), "--help"), capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "1000"})
    assert set(re.findall(r"^\.It Fl -([a-z-]+)", page, re.M)) == set(re.findall(r"^  --([a-z-]+)", run.stdout, re.M))


# Completion at the keyboard: flags of each command, names of the collection behind a comma.
@pytest.mark.parametrize(
    ("line", "some"),
    [
        ("perp-compare --re", {"--restarts", "--resume"}),
        ("perp-compare contact --t", {"--tol", "--time-limit"}),
        ("perp-compare facets --f", {"--facets", "--form"}),
        ("perp-compare con", {"contact"}),
        ("perp-compare --problems kojshin,jose", {"kojshin,josephy"}),
        ("perp-compare --methods path,nes", {"path,nesqp"}),
        ("perp-report --o", {"--out"}),
    ],
)
def test_completion(tmp_path, line, some):
    for name in ("compare", "report"):
        script(tmp_path / f"perp-{name}", f"exec '{sys.executable}' '{LAB}' {name} \"$@\"")
    (tmp_path / "perp").symlink_to(PROGRAM)
    code = f"source '{ROOT}/app/perp.bash'; COMP_WORDS=({line}) COMP_CWORD={len(line.split()) - 1}; _perp_lab; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    run = subprocess.run(["bash", "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert some <= set(run.stdout.split()), run.stderr
