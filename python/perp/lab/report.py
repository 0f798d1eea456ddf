# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign: DIR/report.html, one page that needs nothing else, and the numbers beside it as CSV and JSON."""

import io
import json
import math
import os
import re
from pathlib import Path

from .campaign import count, csv_text, pretty, to_json, write_files
from .cells import KEYS, OUTCOMES, with_tolerance
from .findings import (
    MEASURES, UNSOLVABLE, Data, comparisons, false_claim, findings, given_cfunction, percent, robustness, summary, unsolvable,
)  # fmt: skip

COLOURS = ("#0072B2", "#D55E00", "#000000", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ("-", (0, (4.5, 2)), (0, (1.3, 1.5)), (0, (6, 1.5, 1.3, 1.5)))
MARKERS = ("o", "s", "^", "D", "v", "o", "+", "x")
RING = "M13.6 6a3.4 3.4 0 1 0 6.8 0a3.4 3.4 0 1 0 -6.8 0Z"
SHAPES = (  # the same markers for the page, about (17, 6)
    RING, "M13.8 2.8h6.4v6.4h-6.4Z", "M13 9h8l-4 -7.4Z", "M17 1.6l4.4 4.4l-4.4 4.4l-4.4 -4.4Z", "M13 3h8l-4 7.4Z", RING,
    "M13.4 6h7.2M17 2.4v7.2", "M14 3l6 6m0 -6l-6 6",
)  # fmt: skip
CSV_COLUMNS = (*KEYS[:12], "restarts", "outcome_after_restarts", "seconds", "peak_mb", "message")
TIMELESS = 14  # columns that do not depend on time and memory


# Pictures.


def figure(name, width=5.6, height=4.1, panels=None):
    """matplotlib's figure, whose SVG keeps text as text; ids differ by `name`, so that pictures can stand in one page."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": name, "font.size": 9.5, "font.family": "DejaVu Sans"})
    matplotlib.rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "axes.titlesize": 10.5})
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    return made, made.subplots(*(panels or (1, 1)), squeeze=panels is None)


def line_style(style):
    colour, hollow = COLOURS[style % 7], style % 8 == 5
    return {
        "color": colour, "linestyle": DASHES[style % 4], "marker": MARKERS[style % 8], "markersize": 5.5, "linewidth": 1.7,
        "markerfacecolor": "white" if hollow else colour, "markeredgecolor": colour,
    }  # fmt: skip


def svg_of(made, inline=True):
    text = io.StringIO()
    made.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    if not inline:
        return svg
    svg = re.sub(r' id="(?:figure|patch|axes|text|line2d|xtick|ytick|matplotlib\.axis|legend|LineCollection|PathCollection)_\d+"', "", svg)
    svg = re.sub(r'(<svg [^>]*?) width="[^"]*pt"', r"\1", svg[svg.index("<svg") :], count=1)
    return re.sub(r'(<svg [^>]*?) height="[^"]*pt"', r"\1", svg, count=1)


def profile_chart(name, title, x, curves, total, ratios):
    """Steps over a logarithmic axis; curves: (id, style, is it in colour?, [(x, how many)])."""
    made, axes = figure(name)
    ends = [at for _, _, _, profile in curves for at, _ in profile]
    low = 1 if ratios else min(ends, default=1)
    high = max(max(ends, default=1), low * (2 if ratios else 10))
    high *= (high / low) ** 0.05
    axes.set_xscale("log", base=2 if ratios else 10)
    for identity, style, coloured, profile in reversed(curves):  # the first on top
        xs, ys = [low], [0]
        for at, n in profile:
            xs, ys = xs + [max(at, low)], ys + [n]
        xs, ys = xs + [high], ys + [ys[-1]]
        shares = [100 * y / max(total, 1) for y in ys]
        span = max(1, len(xs) // 5)
        (line,) = axes.step(xs, shares, where="post", markevery=(style % span, span), **line_style(style))
        line.set_gid(identity)
        line.set_zorder(3 if coloured else 2)
    axes.set(xlim=(low, high), ylim=(0, 103), title=title, xlabel=x, ylabel="share of the pairs")
    plain_ticks(axes.xaxis)
    axes.yaxis.set_major_formatter(lambda v, _: f"{v:.0f} %")
    axes.grid(color="#e2e2e2")
    svg = svg_of(made)
    for identity, _, coloured, _ in curves:
        svg = svg.replace(f'<g id="{identity}">', f'<g id="{identity}" class="curve{"" if coloured else " muted"}">')
    return svg


def plain_ticks(axis):
    from matplotlib.ticker import NullFormatter

    axis.set_major_formatter(lambda v, _: f"{v:g}")
    axis.set_minor_formatter(NullFormatter())


def parameter_chart(data, c):
    """The share of pairs solved over the parameter of the C-function; "" where no function has two values."""
    curves, all_ = {}, summary(data, c)
    for row in all_.rows:
        name, _, value = given_cfunction(data.campaign["methods"][row.method]).partition(" ")
        try:
            if float(value) > 0:
                curves.setdefault(name, []).append((float(value), 100 * row.solved / max(all_.pairs, 1)))
        except ValueError:
            continue
    curves = {name: sorted(points) for name, points in curves.items() if len(points) > 1}
    if not curves:
        return ""
    made, axes = figure(f"{c.id}-parameter", height=4.6)
    axes.set_xscale("log")
    for style, (name, points) in enumerate(curves.items()):
        axes.plot(*zip(*points), label=name, **line_style(style))
    axes.set(xlabel="parameter of the C-function", ylabel="solved", title=f"Solved of {all_.pairs} pairs, by the parameter")
    axes.yaxis.set_major_formatter(lambda v, _: f"{v:.0f} %")
    plain_ticks(axes.xaxis)
    axes.grid(color="#e2e2e2")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=8.5)
    return svg_of(made)


# Pieces of the page.


def column(header, tip="", is_number=True):
    return {"header": header, "tip": tip, "number": is_number}


def cell(text, key=None, css="", tip=""):
    return {"text": str(text), "key": key, "css": css, "tip": tip}


def count_cell(n, css=""):
    return cell(n, css="none" if n == 0 else css)


def number_cell(value, digits=3):
    return cell("-", css="none") if not math.isfinite(value) else cell(f"{value:.{digits}g}", key=value)


def table(caption, columns, rows, css="", foot=None):
    return {"table": {"caption": caption, "columns": columns, "rows": rows, "css": css, "foot": foot}}


def text(words, css=""):
    return {"text": words, "css": css}


def html_page(**context):
    """The page of the template; what it is given is escaped but for charts, data, css and js."""
    import jinja2

    folder = Path(__file__).resolve().parent
    environment = jinja2.Environment(autoescape=True, loader=jinja2.FileSystemLoader(folder), trim_blocks=False)
    static = {name: (folder / f"page.{name}").read_text(encoding="utf-8") for name in ("css", "js")}
    return environment.get_template("page.html.j2").render(shapes=SHAPES, **static, **context)


def machine_words(machine):
    return f"{machine['cpu']}, {count(machine['cores'], 'core')}, {machine['memory_mb']} MiB, {machine['system']}"


def false_claims_blocks(data):
    wrong = [c for c in data.cells if false_claim(c)]
    if not wrong:
        fine = "No false claims: no run says solved where the judge says no, and none says infeasible where a solution is known."
        return [text(fine, "fine")] if data.cells else []
    converged = sum(c["outcome"] == "false-convergence" for c in wrong)
    head = f"\u26a0 False claims: {count(converged, 'run says', 'runs say')} solved where the judge's residual is above the tolerance, {count(len(wrong) - converged, 'says', 'say')} infeasible although a solution is known."
    names = ("method", "problem", "start", "what it is", "it said", "judge's residual", "message")
    columns = [column(name, is_number=name in ("start", "judge's residual")) for name in names]

    def row(c):
        residual = "no point" if math.isnan(c["natural"]) else f"{c['natural']:.1e}"
        return [cell(c["method"]), cell(c["problem"]), cell(c["start"]), cell(c["outcome"], css="bad"), cell(c["status"]), cell(residual, key=c["natural"]), cell(c["message"])]

    return [text(head, "alarm"), table("False claims", columns, [row(c) for c in wrong])]


def robustness_section(data):
    rows = robustness(data)
    extra = [(name, tip, k) for name, tip, k in (("not for it", "pairs that the method does not apply to", 3), ("unfinished", "", 4)) if any(row[1][k] for row in rows)]

    def failures(of, css=""):
        pairs, failed, after = of[:3]
        words = "-" if pairs == 0 else f"{failed} ({after})" if failed else "0"
        tip = f"{pairs - failed} of {pairs} ({percent(pairs - failed, pairs)}) solved"
        return cell(words, failed + after / (pairs + 1), f"{css} {'' if failed else 'none'}", tip)

    lines = []
    for m, total, classes in rows:
        share = cell(percent(total[0] - total[1], total[0]), key=(total[0] - total[1]) / max(total[0], 1))
        lines.append([cell(data.methods[m]), failures(total, "total"), share, *map(failures, classes), *(count_cell(total[k]) for *_, k in extra)])
    columns = [column("method", is_number=False), column("total"), column("solved"), *map(column, data.classes()), *(column(*e[:2]) for e in extra)]
    sizes = [sum(data.pairs[p][0]["class"] == cls for p in data.solvable()) for cls in data.classes()]
    foot = [cell(words) for words in ("pairs", len(data.solvable()), "", *sizes, *("" for _ in extra))]
    restarts = data.campaign["restarts"]
    how = f"After a failure a method starts again from up to {count(restarts, 'perturbed point')}." if restarts else "This campaign had no restarts, so that both numbers are the same."
    words = f"How many pairs of a problem that has a solution and a start a method did not solve, by class of problems, as Billups, Dirkse & Ferris (1997) print them: 3 (1) are three failures from the published starts, one of them still after restarts. {how} A point that is a solution but was not claimed as one counts as a failure. Shares are of the pairs a method applies to."
    blocks = [text(words), table("Failures by method and class; in parentheses: left after restarts", columns, lines, "dense", foot)]
    return {"id": "robustness", "title": "Robustness", "short": "Robustness", "blocks": blocks}


def unsolvable_section(data):
    tips = ("says that there is none: best", "says that it has not solved it, or came to a limit: right", "claims a solution", "crashed, or wrote what cannot be read", "", "")
    rows = unsolvable(data)
    shown = [(name, tip) for k, (name, tip) in enumerate(zip(UNSOLVABLE, tips)) if k < 4 or any(row[1][name] for row in rows)]
    columns = [column("method", is_number=False), *(column(name.replace("_", " "), tip) for name, tip in shown)]
    lines = [[cell(data.methods[m]), *(count_cell(of[name], "bad" if name == "wrong" else "") for name, _ in shown)] for m, of in rows]
    proven = ", ".join(f"{p['name']} (by {p['denied_by']})" for p in data.campaign["problems"] if p.get("denied_by"))
    words = f"{count(len(data.solvable(False)), 'pair')}. The best answer is that there is no solution (infeasible). Any other end that does not claim one is right, too (honest)."
    words += f" Not known before, proven in this campaign: {proven}." if proven else ""
    blocks = [text(words), table("Problems without a solution: how the runs ended", columns, lines)]
    return {"id": "unsolvable", "title": "Problems without a solution", "short": "Without a solution", "blocks": blocks}


def chart(data, c, measure, ratios, style):
    of, coloured, cost = c.profiles[measure], in_colour(c), MEASURES[measure]
    unit = {"seconds": "seconds", "F_evals": "(n + 1) evaluations of F, n the number of variables", "factorizations": "factorizations"}[measure]
    kind = "performance" if ratios else "data"
    curves = [(f"{c.id}-{measure}-{kind}-m{m}", style(c, m), m in coloured, profile) for m, profile in zip(of["methods"], of[kind])]
    x = f"tau: within tau times the least {'time' if measure == 'seconds' else 'number'}" if ratios else f"budget: {unit}"
    return profile_chart(f"{c.id}-{measure}-{kind}", f"{kind.capitalize()} profile: {cost}", x, curves, len(c.pairs), ratios)


def in_colour(c):
    """Eight: those that solve most, five of them of the subject if there is one."""
    chosen = [m for m in c.methods if m in c.subject][:5]
    return set(chosen + [m for m in c.methods if m not in chosen][: 8 - len(chosen)])


def comparison_section(data, c, style):
    words = f"{c.note} {count(len(c.pairs), 'pair')}."
    if c.unfinished:
        words += f" {count(c.unfinished, 'pair is', 'pairs are')} left out, as not every method has finished {'it' if c.unfinished == 1 else 'them'}."
    section = {"id": c.id, "title": c.title, "short": "", "blocks": [text(words, "note")]}
    if not c.pairs:
        section["blocks"].append(text("Nothing to compare yet."))
        return section
    coloured = in_colour(c)
    if len(c.methods) > len(coloured):
        which = "those of either kind that solve most" if c.subject else "the eight that solve most"
        section["blocks"].append(text(f"In colour: {which}. Press a name to change that; rest on it to bring it out.", "note"))
    tabs = []
    for measure, title in MEASURES.items():
        left_out = ", ".join(data.labels(c.profiles[measure]["left_out"]))
        charts = [chart(data, c, measure, ratios, style) for ratios in (True, False)]
        tabs.append({"title": title, "charts": charts, "note": left_out and f"Left out, as this cost of theirs is not known: {left_out}."})
    legend = [{"m": m, "style": style(c, m), "name": c.name(data, m), "on": m in coloured} for m in c.methods]
    section["blocks"].append({"id": c.id, "legend": legend, "tabs": tabs})
    if c.id.startswith("cfunctions") and (picture := parameter_chart(data, c)):
        section["blocks"].append({"html": f"<figure>{picture}</figure>"})
    section["blocks"] += summary_blocks(data, c)
    return section


def summary_blocks(data, c):
    all_ = summary(data, c)
    tips = {
        "solved": "pairs", "share": "", "with restarts": "pairs solved by the run or one of its restarts",
        "quickest": "pairs on which no method takes less time", "within 2x": "pairs on which it takes at most twice the least time",
        "fewest F": "pairs on which no method evaluates F less often", "iterations*": "", "F*": "", "factorizations*": "", "seconds*": "",
    }  # fmt: skip
    columns = [column("C-function" if c.id.startswith("cfunctions") else "method", is_number=False)]
    rows = []
    for row in all_.rows:
        counts = map(count_cell, (row.after, row.quickest, row.within_two, row.fewest_F))
        means = [number_cell(row.means[key], 2 if key == "seconds" else 3) for key in ("iterations", "F_evals", "factorizations", "seconds")]
        share = cell(percent(row.solved, all_.pairs), key=row.solved)
        rows.append([cell(c.name(data, row.method)), count_cell(row.solved), share, *counts, *means])
    words = f"Of {count(all_.pairs, 'pair')}. * geometric mean over the {count(all_.common, 'pair')} that all methods with a mean solve. These are the methods that solve at least three quarters of what the best solves. What is below 1 counts as 1, times below 1 ms as 1 ms."
    return [table(f"{c.title}: in numbers", columns + [column(*item) for item in tips.items()], rows), text(words, "note")]


PROFILES = "Performance profile (Dolan & Mor\u00e9 2002): the share of pairs that a method solves within tau times the least cost of all methods shown. At tau = 1 a method is the best, and ties count for all; far to the right stands what it solves at all. Data profile (Mor\u00e9 & Wild 2009): the share that it solves within a budget. Pairs that nobody solved stay in the denominator. Times below 1 ms count as 1 ms, 0 evaluations or factorizations as 1: below that there is nothing to compare."
CFUNCTIONS = "A complementarity function, C-function for short, phi(a, b) is 0 exactly where a >= 0, b >= 0 and a b = 0. Methods that solve equations use one to write the problem as equations. Here the same method runs with one C-function after the other; 'perp cfunctions' has their formulas."
OUTCOME_WORDS = "Times, iterations and evaluations are of the run from the start itself, not of restarts; an external program's time is that of its process. Outcomes: solved: claimed, and the judge agrees. solved-to-rounding: not to the tolerance, but as far as double arithmetic goes, by the method and the judge; it is not counted as solved. failed: the method says so itself. false-convergence: claimed, and the judge disagrees. unclaimed: a solution that the method does not call one. time-limit, memory-limit, crashed: as they say. garbage: an external program's answer that cannot be read. not-applicable: no problem for this method. infeasible: rightly, there is no solution, as is known or as one of Perp's methods has proven while nobody found one. false-infeasible: although a solution is known or another method has found one."
FILES = "Beside this page: cells.csv and cells.json (all runs), curves.csv, methods.csv, pairs.csv, profiles.csv, summary.csv, robustness.csv, unsolvable.csv, false_claims.csv, report.json, findings.txt. Everything here can be computed from cells.csv, curves.csv, pairs.csv and methods.csv."
JUDGE = "The natural residual of a point x is max_i |x_i - mid(l_i, x_i - F_i(x), u_i)|, where l and u are the bounds and mid is the middle one of three numbers; it is 0 at a solution and nowhere else"


def how(data):
    c = data.campaign
    rows = [
        ("when", c["date"]), ("program", f"perp {c['version']}"), ("libraries", ", ".join(c["libraries"])),
        ("machine", machine_words(c["machine"])), ("command", " ".join(c["command_line"])),
        ("tolerance", f"{c['tol']:g} on the natural residual of the problem as given, evaluated outside of the method"),
        ("limits of a run", f"{c['time_limit']:g} s, {c['memory_limit_mb']} MiB; each in a process of its own, {c['jobs']} at a time"),
        ("restarts", f"{c['restarts']} at most, seed {c['seed']}"),
        ("starts", "all of each problem" if c["starts"] == "all" else f"at most {c['starts']} of each problem"),
    ]  # fmt: skip
    return rows + [(f"external {m['label']}", with_tolerance(m["command"], c["tol"])) for m in c["methods"] if m["external"]]


def page(data, all_comparisons, found):
    shared = list(dict.fromkeys([m for c in all_comparisons for m in c.methods] + list(range(len(data.methods)))))
    styles = {m: k for k, m in enumerate(shared)}

    def style(c, m):
        """C-functions and the systems of 1997 have styles of their own, so that they differ most."""
        own = c.id.startswith("cfunctions") or c.id in ("lecture", "published")
        return c.methods.index(m) if own else styles[m]

    sections = [robustness_section(data)] + ([unsolvable_section(data)] if data.solvable(False) else [])
    sections.append({"id": "profiles", "title": "Profiles", "short": "Profiles", "blocks": [text(PROFILES)]})
    headed = False
    for c in all_comparisons:
        if c.id.startswith("cfunctions") and not headed:
            sections.append({"id": "cfunctions", "title": "C-functions", "short": "C-functions", "blocks": [text(CFUNCTIONS)]})
            headed = True
        sections.append(comparison_section(data, c, style))
    c = data.campaign
    reading = f"A problem asks for x between bounds l and u with F_i(x) >= 0 where x_i = l_i, F_i(x) <= 0 where x_i = u_i, and F_i(x) = 0 between. A pair is a problem and one of its starting points. A method has solved a pair if it says so and if a judge, another process, finds a natural residual of at most {c['tol']:g}. {JUDGE}."
    title = f"Comparison of {count(len(data.methods), 'method')} on {count(len(c['problems']), 'problem')}"
    after = [text(OUTCOME_WORDS), text(FILES)]
    if data.dropped:
        after.append(text(f"{count(len(data.dropped), 'line')} of cells.jsonl left out: {'; '.join(data.dropped)}"))
    return html_page(
        title=title, sub=f"{c['date']} \u00b7 perp {c['version']} \u00b7 {machine_words(c['machine'])}",
        before=[text(reading), *false_claims_blocks(data)], findings=found, sections=sections, how=how(data), after=after,
        curve_legend=[{"m": m, "style": styles[m], "name": data.methods[m]} for m in shared], data=script_data(data, styles),
    )  # fmt: skip


def script_data(data, styles):
    """The cells for the page's script; the curve as round(100 log10(natural residual)), what is not known null."""

    def known(value):
        return None if value is None or math.isnan(value) else to_json(float(value))

    def log(value):
        return None if math.isnan(value) else round(100 * math.log10(min(max(value, 1e-300), 1e300)))

    problems = list(data.problems)
    place = {name: k for k, name in enumerate(problems)}
    rows, most, shown = [], 0, None
    for (m, p), c in sorted(data.table.items()):
        counts = [c[name] for name in KEYS[7:12]]
        outcomes = [OUTCOMES.index(c["outcome"]), OUTCOMES.index(c["outcome_after_restarts"])]
        rows.append([m, place[c["problem"]], c["start"], *outcomes, c["status"], known(c["natural"]), *counts, c["restarts"], known(c["seconds"]), known(c["peak_mb"]), c["message"], [log(v) for v in c["curve"]]])
    for p, (problem, start) in enumerate(data.pairs):
        curves = sum(len(data.at(m, p)["curve"]) > 1 for m in range(len(data.methods)) if data.at(m, p))
        if curves > most:
            most, shown = curves, [place[problem["name"]], start]
    answer = {
        "tol": data.campaign["tol"], "methods": data.methods, "styles": [styles[m] for m in range(len(data.methods))], "shapes": SHAPES,
        "problems": [[p["name"], p["class"], p["n"]] for p in data.problems.values()], "outcomes": OUTCOMES, "shown": shown, "cells": rows,
    }  # fmt: skip
    return json.dumps(answer, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


# Files beside the page.


def plain(name, value):
    """A value in cells.csv."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        if math.isnan(value):
            return ""
        return f"{value:.6g}" if name == "seconds" else f"{value:.1f}" if name == "peak_mb" else to_json(value)
    return value


def cells_csv(cells, columns=CSV_COLUMNS):
    return csv_text([columns, *([plain(name, c[name]) for name in columns] for c in cells)])


def outcomes_csv(cells):
    """Columns that do not depend on time and memory; of what a limit has ended the outcome alone."""
    empty = {**dict.fromkeys(KEYS), "status": "", "claimed": False}
    kept = ("method", "problem", "start", "outcome", "restarts", "outcome_after_restarts")
    limits = ("time-limit", "memory-limit")
    shown = [{**empty, **{k: c[k] for k in kept}} if c["outcome"] in limits else c for c in cells]
    return cells_csv(shown, CSV_COLUMNS[:TIMELESS])


def records(names, rows):
    return [dict(zip(names, row)) for row in rows]


def data_files(data, all_comparisons, found):
    def yes(value):
        return "yes" if value else "no"

    ids = [c.id for c in all_comparisons]
    methods = [("method", "name", "options", "external", "cfunction", *ids)]
    for m, method in enumerate(data.campaign["methods"]):
        cfunction = given_cfunction(method) or method["in_force"].get("cfunction", "")
        methods.append((method["label"], method["name"], " ".join(method["options"]), yes(method["external"]), cfunction, *(yes(m in c.methods) for c in all_comparisons)))
    pairs = [("problem", "start", "class", "n", "nonzeros", "solvable", *ids)]
    for p, (problem, start) in enumerate(data.pairs):
        pairs.append((problem["name"], start, problem["class"], problem["n"], problem["nonzeros"], yes(problem["solvable"]), *(yes(p in c.pairs) for c in all_comparisons)))
    profiles = [("comparison", "kind", "cost", "method", "x", "count", "of")]
    summaries = [("comparison", "method", "solved", "pairs", "with_restarts", "quickest", "within_two", "fewest_F", "common", "mean_iterations", "mean_F_evals", "mean_factorizations", "mean_seconds")]
    for c in all_comparisons:
        for measure, of in c.profiles.items():
            for kind in ("performance", "data"):
                for m, profile in zip(of["methods"], of[kind]):
                    profiles += [(c.id, kind, measure, data.methods[m], x, n, len(c.pairs)) for x, n in profile or [(math.inf, 0)]]
        all_ = summary(data, c)
        for row in all_.rows:
            means = [row.means[key] for key in ("iterations", "F_evals", "factorizations", "seconds")]
            known = [None if math.isnan(v) else v for v in means]
            summaries.append((c.id, data.methods[row.method], row.solved, all_.pairs, row.after, row.quickest, row.within_two, row.fewest_F, all_.common, *known))
    robust = [("method", "class", "pairs", "failures", "after_restarts")]
    for m, total, classes in robustness(data):
        robust += [(data.methods[m], cls, *of[:3]) for cls, of in zip((*data.classes(), "total"), (*classes, total))]
    without = [("method", *UNSOLVABLE), *((data.methods[m], *of.values()) for m, of in unsolvable(data))]
    curves = [("method", "problem", "start", "point", "natural")]
    curves += [(c["method"], c["problem"], c["start"], k, plain("", v)) for c in data.cells for k, v in enumerate(c["curve"])]
    head = {"program": "perp", "version": data.campaign["version"], "schema": "perp/report/1", "date": data.campaign["date"]}
    parts = {"robustness": robust, "unsolvable": without, "summary": summaries, "profiles": profiles}
    whole = {**head, "findings": records(("topic", "text"), found), **{name: records(rows[0], rows[1:]) for name, rows in parts.items()}}
    tables = {"methods": methods, "pairs": pairs, **parts, "curves": curves}
    files = {f"{name}.csv": csv_text(to_json(rows)) for name, rows in tables.items()}
    files["false_claims.csv"] = cells_csv([c for c in data.cells if false_claim(c)])
    files["findings.txt"] = "".join(f"{topic}: {words}\n" for topic, words in found)
    files["report.json"] = pretty(whole)
    files["cells.csv"], files["outcomes.csv"] = cells_csv(data.cells), outcomes_csv(data.cells)
    lines = (json.dumps(to_json(c), separators=(",", ":"), ensure_ascii=False) for c in data.cells)
    files["cells.json"] = "[\n" + ",\n".join(lines) + "\n]\n" if data.cells else "[\n]\n"
    return files


def write_report(folder):
    """All files of the report, or none of them; the findings come back."""
    data = Data.read(folder)
    all_comparisons = comparisons(data)
    found = findings(data, all_comparisons)
    files = data_files(data, all_comparisons, found)
    files["report.html"] = page(data, all_comparisons, found)
    write_files([(os.path.join(folder, name), content) for name, content in files.items()])
    return found
