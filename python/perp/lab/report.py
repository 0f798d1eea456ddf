# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign: DIR/report.html, one page that needs nothing else, and its numbers as CSV and JSON."""

import csv
import io
import math
import re
from collections import Counter
from pathlib import Path

from .campaign import count
from .cells import KEYS, outcome_counts, with_tolerance
from .contact import FACTS
from .files import compact, pretty, write_files
from .findings import (
    FLOOR, LAWS, MEASURES, Data, comparisons, false_claim, findings, given_cfunction, laws, percent,
    robustness, summary,
)  # fmt: skip

# Okabe's and Ito's colours without yellow.
COLOURS = ("#0072B2", "#D55E00", "#000000", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ((), (4.5, 2), (1.3, 1.5), (6, 1.5, 1.3, 1.5))
MARKERS = dict(zip("os^Dvh+x", "\u25cf\u25a0\u25b2\u25c6\u25bc\u2b22+\u00d7"))  # matplotlib's, and as text
IN_COLOUR = 8  # curves of a chart; the others are grey until they are asked for


# Pictures.


def figure(name, width=5.6, height=4.1, shape=(1, 1)):
    """matplotlib's figure, whose SVG keeps text as text; ids differ by `name`, as pictures stand in one page."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": name, "font.size": 9.5, "axes.titlesize": 10.5})
    matplotlib.rcParams.update({"font.family": "DejaVu Sans", "axes.spines.top": False, "axes.spines.right": False})
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    return made, made.subplots(*shape)


def line_style(k):
    """For matplotlib; style_of() is the same for the page."""
    style = {"color": COLOURS[k % 7], "linestyle": (0, DASHES[k % 4] or None), "marker": list(MARKERS)[k % 8]}
    return {**style, "markersize": 5.5, "linewidth": 1.7}


def style_of(k):
    dash = " ".join(f"{2 * d:g}" for d in DASHES[k % 4])
    return {"colour": COLOURS[k % 7], "dash": dash, "marker": list(MARKERS.values())[k % 8]}


def svg_of(made, inline=True):
    text = io.StringIO()
    made.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    # Ids of matplotlib's own are the same in all pictures.
    return re.sub(r' id="[a-zA-Z0-9.]+_\d+"', "", svg[svg.index("<svg") :]) if inline else svg


def grid_and_ticks(axes):
    """A light grid, plain numbers on the x axis, percent on the y axis."""
    from matplotlib.ticker import NullFormatter

    axes.grid(color="#e2e2e2")
    axes.xaxis.set_major_formatter(lambda v, _: f"{v:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_formatter(lambda v, _: f"{v:.0f} %")


def profile_chart(data, c, measure, kind, style, coloured):
    """Steps over a logarithmic axis; style(c, m) numbers the style of a method, those of `coloured` are in colour."""
    of, ratios, name = c.profiles[measure], kind == "performance", f"{c.id}-{measure}-{kind}"
    profiles = {m: profile for m, profile in zip(of["methods"], of[kind])}
    made, axes = figure(name)
    ends = [at for profile in profiles.values() for at, _ in profile]
    low = 1 if ratios else min(ends, default=1)
    high = max([low * (2 if ratios else 10), *ends])
    high *= (high / low) ** 0.05
    for m, profile in reversed(profiles.items()):  # the first on top
        xs, ys = [low, *(max(at, low) for at, _ in profile), high], [0, *(100 * n / len(c.pairs) for _, n in profile)]
        span, k = max(1, len(xs) // 5), style(c, m)
        (line,) = axes.step(xs, [*ys, ys[-1]], where="post", markevery=(k % span, span), **line_style(k))
        line.set(gid=f"{name}-m{m}", zorder=3 if m in coloured else 2)
    axes.set_xscale("log", base=2 if ratios else 10)
    budget = "(n + 1) evaluations of F, n the number of variables" if measure == "F_evals" else measure
    x = f"tau: within tau times the least {MEASURES[measure]}" if ratios else f"budget: {budget}"
    title = f"{kind.capitalize()} profile: {MEASURES[measure]}"
    axes.set(xlim=(low, high), ylim=(0, 103), title=title, xlabel=x, ylabel="share of the pairs")
    grid_and_ticks(axes)
    svg = svg_of(made)
    for m in profiles:
        colour = "" if m in coloured else " muted"
        svg = svg.replace(f'<g id="{name}-m{m}">', f'<g id="{name}-m{m}" class="curve{colour}">')
    return svg


def parameter_chart(data, c):
    """The share of pairs solved over the parameter of the C-function; "" where no function has two values."""
    curves, pairs = {}, len(c.pairs)
    for m in c.methods:
        name, _, value = given_cfunction(data.campaign["methods"][m]).partition(" ")
        if re.fullmatch(r"[\d.]+(e-?\d+)?", value) and float(value) > 0:
            curves.setdefault(name, []).append((float(value), 100 * data.count(m, c.pairs) / pairs))
    curves = {name: sorted(points) for name, points in curves.items() if len(points) > 1}
    if not curves:
        return ""
    made, axes = figure(f"{c.id}-parameter", height=4.6)
    axes.set_xscale("log")
    for style, (name, points) in enumerate(curves.items()):
        axes.plot(*zip(*points), label=name, **line_style(style))
    axes.set(xlabel="parameter of the C-function", ylabel="solved", title=f"Solved of {pairs} pairs, by the parameter")
    grid_and_ticks(axes)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=8.5)
    return svg_of(made)


# Pieces of the page: what its template shows.


def cell(value, key=None, css="", tip=""):
    """`key` is what it is sorted by, unless that is its text. What is 0 or not known is pale."""
    if isinstance(value, float):
        value, key = ("-", None) if math.isnan(value) else (f"{value:.3g}", value)
    return {"text": str(value), "key": key, "css": f"{css} none" if value in (0, "-") else css, "tip": tip}


def table(caption, tips, rows, css="", foot=None, words=()):
    """tips: {header: what it means}; rows: of values or cells. The first column and those of `words` are no numbers."""
    words = {next(iter(tips)), *words}
    columns = [{"header": name, "tip": tip, "number": name not in words} for name, tip in tips.items()]
    *rows, foot = [[one if isinstance(one, dict) else cell(one) for one in row] for row in [*rows, foot or ()]]
    return {"table": {"caption": caption, "columns": columns, "rows": rows, "css": css, "foot": foot}}


def section(identity, title, *blocks, **more):
    return {"id": identity, "title": title, "blocks": blocks, **more}


def html_page(**context):
    """The page of the template; what it is given is escaped but for charts and data."""
    import jinja2

    folder = Path(__file__).resolve().parent
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.loader = jinja2.FileSystemLoader(folder)
    static = {name: (folder / f"page.{name}").read_text(encoding="utf-8") for name in ("css", "js")}
    return environment.get_template("page.html.j2").render(style_of=style_of, **static, **context)


def machine_words(machine):
    return f"{machine['cpu']}, {count(machine['cores'], 'core')}, {machine['memory_mb']} MiB, {machine['system']}"


def robustness_section(data):
    rows, classes, pairs, restarts = robustness(data), data.classes(), data.solvable(), data.campaign["restarts"]
    partial = any(total[3] for _, total, _ in rows)

    def failures(of, css=""):
        pairs, failed, after = of[:3]
        words = "-" if pairs == 0 else f"{failed} ({after})" if failed and restarts else failed
        tip = f"{pairs - failed} of {pairs} ({percent(pairs - failed, pairs)}) solved"
        return cell(words, failed + after / (pairs + 1), css, tip)

    lines = []
    for m, total, by_class in rows:
        share = cell(percent(total[0] - total[1], total[0]), (total[0] - total[1]) / max(total[0], 1))
        lines.append([data.methods[m], failures(total, "total"), share, *map(failures, by_class), *total[3:] * partial])
    tips = dict.fromkeys(("method", "total", "solved", *classes), "")
    tips |= {"not for it": "pairs that the method does not apply to"} if partial else {}
    sizes = [int((data.classes_of[pairs] == cls).sum()) for cls in classes]
    foot = ["pairs", len(pairs), "", *sizes, *[""] * partial]
    caption = "Failures by method and class" + ("; in parentheses: left after restarts" if restarts else "")
    return section("robustness", "Robustness", table(caption, tips, lines, "dense", foot), restarts=restarts)


def unsolvable_section(data):
    cells = [cell for cell in data.cells if not data.problems[cell["problem"]]["solvable"]]
    occur, counts = outcome_counts(data.campaign, cells)
    rows = [[label, *numbers] for label, numbers in counts.items()]
    block = table("How the runs ended", dict.fromkeys(("method", *occur), ""), rows)
    proven = ", ".join(f"{p['name']} (by {p['denied_by']})" for p in data.problems.values() if p.get("denied_by"))
    pairs = count(len(data.solvable(False)), "pair")
    return section("unsolvable", "Problems without a solution", block, pairs=pairs, proven=proven)


def comparison_section(data, c, style):
    words = f"{c.note} {count(len(c.pairs), 'pair')}."
    coloured = sorted(c.methods, key=lambda m: m not in c.subject)[:IN_COLOUR]  # of either those that solve most
    if len(c.methods) > len(coloured):
        words += f" {IN_COLOUR} are in colour. Press a name to change that; rest on it to bring it out."
    charts = []
    for measure, of in c.profiles.items():
        pictures = [profile_chart(data, c, measure, kind, style, coloured) for kind in ("performance", "data")]
        left_out = ", ".join(data.methods[m] for m in of["left_out"])
        charts.append({"title": MEASURES[measure], "charts": pictures, "left_out": left_out})
    legend = [{"m": m, "style": style(c, m), "name": c.name(data, m), "on": m in coloured} for m in c.methods]
    parameters = {"picture": parameter_chart(data, c) if c.id.startswith("cfunctions") else ""}
    blocks = [{"text": words}, {"legend": legend, "charts": charts}, parameters, *summary_blocks(data, c)]
    return section(c.id, c.title, *blocks, part=True)


SUMMARY = {
    "method": "", "solved": "pairs", "pairs": "of the comparison",
    "with_restarts": "pairs solved by the run or one of its restarts",
    "quickest": "pairs on which no method takes less time",
    "within_two": "pairs on which it takes at most twice the least time",
    "fewest_F": "pairs on which no method evaluates F less often", "common": "pairs that all methods with a mean solve",
    **{f"mean_{name}": "geometric, over the common pairs" for name in FLOOR},
}  # fmt: skip


def summary_blocks(data, c):
    rows = [[data.methods[m], *row.values()] for m, row in summary(data, c).items()]
    words = "Means are of the methods that solve at least three quarters of what the best solves. What is below 1 "
    words += f"counts as 1, times below {data.least_time} as that."
    return [table(f"{c.title}: in numbers", SUMMARY, rows), {"text": words}]


def laws_section(data):
    block = table("Variants and their laws", LAWS, laws(data), words=("judged by", "solved by"))
    return section("laws", "By Coulomb's law", block)


def how(data):
    c = data.campaign
    rows = {
        "program": f"perp {c['version']}",
        "machine": machine_words(c["machine"]), "command": " ".join(c["command_line"]),
        "tolerance": f"{c['tol']:g}",
        "limits of a run": f"{c['time_limit']:g} s, {c['memory_limit_mb']} MiB; each in a process of its own, "
        f"{c['jobs']} at a time",
    }  # fmt: skip
    if not data.contact:
        rows["tolerance"] += " on the natural residual of the problem as given, evaluated outside of the method"
        rows["restarts"] = f"{c['restarts']} at most, seed {c['seed']}"
        rows["starts"] = "all of each problem" if c["starts"] == "all" else f"at most {c['starts']} of each problem"
    external = [m for m in c["methods"] if m["external"]]
    return rows | {f"external {m['label']}": with_tolerance(m["command"], c["tol"]) for m in external}


def page(data, all_comparisons, found):
    shared = list(dict.fromkeys([m for c in all_comparisons for m in c.methods] + list(range(len(data.methods)))))

    def style(c, m):
        """C-functions have styles of their own, so that they differ most."""
        return c.methods.index(m) if c.id.startswith("cfunctions") else shared.index(m)

    sections = [robustness_section(data)] + ([unsolvable_section(data)] if len(data.solvable(False)) else [])
    sections += [laws_section(data)] if data.contact else []
    sections.append(section("profiles", "Profiles"))
    for c in all_comparisons:
        if c.id.startswith("cfunctions") and all(s["id"] != "cfunctions" for s in sections):
            sections.append(section("cfunctions", "C-functions"))
        sections.append(comparison_section(data, c, style))
    c = data.campaign
    sizes = f"{count(len(data.methods), 'method')} on {count(len(data.problems), 'problem')}"
    title = f"Contact with friction: {sizes}" if data.contact else f"Comparison of {sizes}"
    sub = f"{c['date']} \u00b7 perp {c['version']} \u00b7 {machine_words(c['machine'])}"
    legend = [{"m": m, "style": k, "name": data.methods[m], "on": k < IN_COLOUR} for k, m in enumerate(shared)]
    dropped = f"{count(len(data.dropped), 'line')} of cells.jsonl left out: {'; '.join(data.dropped)}"
    return html_page(
        contact=data.contact, floor=data.least_time, title=title, sub=sub, tol=c["tol"], findings=found, how=how(data),
        wrong=sum(map(false_claim, data.cells)), dropped=dropped if data.dropped else "", sections=sections,
        all_methods=legend, data=script_data(data, shared),
    )  # fmt: skip


def script_data(data, shared):
    """The cells for the page's script, as cells.csv has them; the curves as round(100 log10(natural residual))."""

    def log(value):
        return None if math.isnan(value) else round(100 * math.log10(min(max(value, 1e-300), 1e300)))

    def shown_value(name, value):
        short = name in ("natural", "siconos", "rr9118") and isinstance(value, float) and 0 < value < math.inf
        return f"{value:.1e}" if short else plain(name, value)

    problems = ((c, data.problems[c["problem"]]) for c in data.cells)
    cells = [{**c, "class": problem["class"], "n": problem["n"]} for c, problem in problems]
    all_columns = CONTACT_COLUMNS if data.contact else CSV_COLUMNS
    others = [name for name in all_columns[2:] if name not in ("claimed", "command")]
    usual = ("method", "problem", "class", "n", *others)
    told = [name for name in usual if data.campaign["restarts"] or "restarts" not in name]
    columns = [name for name in told if any(plain(name, c[name]) not in ("", None, 0) for c in cells)]
    rows = [[shown_value(name, c[name]) for name in columns] for c in cells]
    curves = [[log(v) for v in c["curve"]] for c in data.cells]
    drawn = Counter(p for (_, p), c in sorted(data.table.items(), key=lambda item: item[0][1]) if len(c["curve"]) > 1)
    shown = [data.pairs[p] for p, _ in drawn.most_common(1)]  # of those with most curves the first
    answer = {
        "tol": data.campaign["tol"], "columns": columns, "rows": rows,
        "curves": curves, "styles": {data.methods[m]: style_of(k) for k, m in enumerate(shared)},
        "shown": [f"{problem['name']} from start {start}" for problem, start in shown],
    }  # fmt: skip
    return compact(answer).replace("<", "\\u003c")


# Files beside the page.

CSV_COLUMNS = KEYS[:-1]  # without the curve
CONTACT_COLUMNS = (*CSV_COLUMNS, *FACTS)
TIMELESS = 14  # columns that do not depend on time and memory


def plain(name, value):
    """A value in cells.csv."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, float):
        return value
    digits = {"seconds": ".6g", "peak_mb": ".1f"}.get(name, "")
    return "" if math.isnan(value) else f"{value:{digits}}".removesuffix(".0")


def cells_csv(cells, columns):
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([columns, *([plain(k, c[k]) for k in columns] for c in cells)])
    return out.getvalue()


def outcomes_csv(cells):
    """Columns that do not depend on time and memory; of what a limit has ended the outcome alone."""
    empty = {**dict.fromkeys(KEYS), "status": "", "claimed": False}
    kept = ("method", "problem", "start", "outcome", "restarts", "outcome_after_restarts")
    limits = ("time-limit", "memory-limit")
    shown = [{**empty, **{k: c[k] for k in kept}} if c["outcome"] in limits else c for c in cells]
    return cells_csv(shown, CSV_COLUMNS[:TIMELESS])


def report_json(data, all_comparisons, found):
    """The findings, and the numbers of the charts and of the tables beside them."""
    made = {"program": "perp", "version": data.campaign["version"], "schema": "perp/report/1"}
    made |= {"date": data.campaign["date"], "findings": [{"topic": topic, "text": text} for topic, text in found]}
    summaries, profiles = [], []
    for c in all_comparisons:
        for m, row in summary(data, c).items():
            known = {key: None if math.isnan(value) else value for key, value in row.items()}
            summaries.append({"comparison": c.id, "method": data.methods[m], **known})
        for measure, of in c.profiles.items():
            for kind in ("performance", "data"):
                which = {"comparison": c.id, "kind": kind, "cost": measure}
                profiles += [
                    {**which, "method": data.methods[m], "x": x, "count": n, "of": len(c.pairs)}
                    for m, profile in zip(of["methods"], of[kind])
                    for x, n in profile or [(math.inf, 0)]
                ]
    return pretty({**made, "summary": summaries, "profiles": profiles})


def write_report(folder):
    """All files of the report, or none of them; the findings come back."""
    data = Data(folder)
    all_comparisons = comparisons(data)
    found = findings(data, all_comparisons)
    files = {
        "cells.csv": cells_csv(data.cells, CONTACT_COLUMNS if data.contact else CSV_COLUMNS),
        "outcomes.csv": outcomes_csv(data.cells),
        "findings.txt": "".join(f"{topic}: {words}\n" for topic, words in found),
        "report.json": report_json(data, all_comparisons, found),
        "report.html": page(data, all_comparisons, found),
    }
    write_files(folder, files)
    return found
