# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign: DIR/report.html, one page that needs nothing else, and its numbers as CSV and JSON."""

import io
import math
import re
from collections import Counter
from pathlib import Path

from .campaign import count
from .cells import COUNTS, KEYS, with_tolerance
from .files import compact, csv_text, pretty, to_json, write_files
from .findings import (
    FLOOR, MEASURES, UNSOLVABLE, Data, comparisons, false_claim, findings, given_cfunction, percent, robustness,
    summary, unsolvable,
)  # fmt: skip

# Okabe's and Ito's colours without yellow.
COLOURS = ("#0072B2", "#D55E00", "#000000", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ((), (4.5, 2), (1.3, 1.5), (6, 1.5, 1.3, 1.5))
MARKERS = dict(zip("os^Dvh+x", "\u25cf\u25a0\u25b2\u25c6\u25bc\u2b22+\u00d7"))  # matplotlib's, and as text
IN_COLOUR = 8  # curves of a chart; the others are grey until they are asked for


# Pictures.


def figure(name, width=5.6, height=4.1, panels=(1, 1)):
    """matplotlib's figure, whose SVG keeps text as text; ids differ by `name`, as pictures stand in one page."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": name, "font.size": 9.5, "axes.titlesize": 10.5})
    matplotlib.rcParams.update({"font.family": "DejaVu Sans", "axes.spines.top": False, "axes.spines.right": False})
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    return made, made.subplots(*panels, squeeze=panels == (1, 1))


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


def grid_and_ticks(axes, share="y"):
    """A light grid, plain numbers on the x axis, percent on the y axis if it is a share."""
    from matplotlib.ticker import NullFormatter

    axes.grid(color="#e2e2e2")
    axes.xaxis.set_major_formatter(lambda v, _: f"{v:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    if share:
        axes.yaxis.set_major_formatter(lambda v, _: f"{v:.0f} %")


def legend_below(axes):
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=8.5)


def profile_chart(name, title, x, curves, total, ratios, names=None, what="pairs"):
    """Steps over a logarithmic axis; curves: (id, style, is it in colour?, [(x, how many)]).

    names: of the styles, for a legend in a picture of its own.
    """
    made, axes = figure(name, height=4.1 + 0.11 * len(names or ()))
    ends = [at for _, _, _, profile in curves for at, _ in profile]
    low = 1 if ratios else min(ends, default=1)
    high = max([low * (2 if ratios else 10), *ends])
    high *= (high / low) ** 0.05
    axes.set_xscale("log", base=2 if ratios else 10)
    for identity, style, coloured, profile in reversed(curves):  # the first on top
        xs, ys = [low, *(max(at, low) for at, _ in profile), high], [0, *(100 * n / max(total, 1) for _, n in profile)]
        span = max(1, len(xs) // 5)
        (line,) = axes.step(xs, [*ys, ys[-1]], where="post", markevery=(style % span, span), **line_style(style))
        line.set(gid=identity, zorder=3 if coloured else 2, label=names[style] if names else None)
    axes.set(xlim=(low, high), ylim=(0, 103), title=title, xlabel=x, ylabel=f"share of the {what}")
    grid_and_ticks(axes)
    if names:
        legend_below(axes)
    svg = svg_of(made, inline=not names)
    for identity, _, coloured, _ in curves:
        svg = svg.replace(f'<g id="{identity}">', f'<g id="{identity}" class="curve{"" if coloured else " muted"}">')
    return svg


def parameter_chart(data, c):
    """The share of pairs solved over the parameter of the C-function; "" where no function has two values."""
    curves, pairs = {}, len(c.pairs)
    for m in c.methods:
        name, _, value = given_cfunction(data.campaign["methods"][m]).partition(" ")
        if re.fullmatch(r"[\d.]+(e-?\d+)?", value) and float(value) > 0:
            curves.setdefault(name, []).append((float(value), 100 * data.count(m, c.pairs) / max(pairs, 1)))
    curves = {name: sorted(points) for name, points in curves.items() if len(points) > 1}
    if not curves:
        return ""
    made, axes = figure(f"{c.id}-parameter", height=4.6)
    axes.set_xscale("log")
    for style, (name, points) in enumerate(curves.items()):
        axes.plot(*zip(*points), label=name, **line_style(style))
    axes.set(xlabel="parameter of the C-function", ylabel="solved", title=f"Solved of {pairs} pairs, by the parameter")
    grid_and_ticks(axes)
    legend_below(axes)
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
    rows, classes, pairs = robustness(data), data.classes(), data.solvable()
    more = {"not for it": "pairs that the method does not apply to", "unfinished": ""}
    extra = {name: k for k, name in enumerate(more, 3) if any(total[k] for _, total, _ in rows)}

    def failures(of, css=""):
        pairs, failed, after = of[:3]
        words = "-" if pairs == 0 else f"{failed} ({after})" if failed else 0
        tip = f"{pairs - failed} of {pairs} ({percent(pairs - failed, pairs)}) solved"
        return cell(words, failed + after / (pairs + 1), css, tip)

    lines = []
    for m, total, by_class in rows:
        share = cell(percent(total[0] - total[1], total[0]), (total[0] - total[1]) / max(total[0], 1))
        others = [total[k] for k in extra.values()]
        lines.append([data.methods[m], failures(total, "total"), share, *map(failures, by_class), *others])
    tips = dict.fromkeys(("method", "total", "solved", *classes), "") | {name: more[name] for name in extra}
    sizes = [int((data.classes_of[pairs] == cls).sum()) for cls in classes]
    foot = ["pairs", len(pairs), "", *sizes, *[""] * len(extra)]
    made = table("Failures by method and class; in parentheses: left after restarts", tips, lines, "dense", foot)
    return section("robustness", "Robustness", made, restarts=data.campaign["restarts"])


def unsolvable_section(data, made):
    tips = {"method": "", **UNSOLVABLE}
    block = table("Problems without a solution: how the runs ended", tips, made["unsolvable"][1:])
    proven = ", ".join(f"{p['name']} (by {p['denied_by']})" for p in data.problems.values() if p.get("denied_by"))
    pairs = count(len(data.solvable(False)), "pair")
    return section("unsolvable", "Problems without a solution", block, pairs=pairs, proven=proven)


def chart(data, c, measure, kind, style, coloured):
    of, ratios = c.profiles[measure], kind == "performance"
    name = f"{c.id}-{measure}-{kind}"
    unit = {"F_evals": "(n + 1) evaluations of F, n the number of variables"}.get(measure, measure)
    least = "time" if measure == "seconds" else "number"
    x = f"tau: within tau times the least {least}" if ratios else f"budget: {unit}"
    curves = [(f"{name}-m{m}", style(c, m), m in coloured, profile) for m, profile in zip(of["methods"], of[kind])]
    return profile_chart(name, f"{kind.capitalize()} profile: {MEASURES[measure]}", x, curves, len(c.pairs), ratios)


def comparison_section(data, c, style, made):
    words = f"{c.note} {count(len(c.pairs), 'pair')}."
    if c.unfinished:
        them = "it" if c.unfinished == 1 else "them"
        words += f" {count(c.unfinished, 'pair is', 'pairs are')} left out, as not every method has finished {them}."
    if not c.pairs:
        return section(c.id, c.title, {"text": f"{words} Nothing to compare yet."}, part=True)
    coloured = sorted(c.methods, key=lambda m: m not in c.subject)[:IN_COLOUR]  # of either those that solve most
    if len(c.methods) > len(coloured):
        words += f" {IN_COLOUR} are in colour. Press a name to change that; rest on it to bring it out."
    charts = []
    for measure, title in MEASURES.items():
        left_out = ", ".join(data.labels(c.profiles[measure]["left_out"]))
        pictures = [chart(data, c, measure, kind, style, coloured) for kind in ("performance", "data")]
        charts.append({"title": title, "charts": pictures, "left_out": left_out})
    legend = [{"m": m, "style": style(c, m), "name": c.name(data, m), "on": m in coloured} for m in c.methods]
    parameters = {"picture": parameter_chart(data, c) if c.id.startswith("cfunctions") else ""}
    blocks = [{"text": words}, {"legend": legend, "charts": charts}, parameters, *summary_blocks(c, made)]
    return section(c.id, c.title, *blocks, part=True)


SUMMARY = {
    "method": "", "solved": "pairs", "pairs": "of the comparison",
    "with_restarts": "pairs solved by the run or one of its restarts",
    "quickest": "pairs on which no method takes less time",
    "within_two": "pairs on which it takes at most twice the least time",
    "fewest_F": "pairs on which no method evaluates F less often", "common": "pairs that all methods with a mean solve",
    **{f"mean_{name}": "geometric, over the common pairs" for name in FLOOR},
}  # fmt: skip


def summary_blocks(c, made):
    rows = [["-" if v is None else v for v in row[1:]] for row in made["summary"] if row[0] == c.id]
    words = (
        "Means are of the methods that solve at least three quarters of what the best solves. What is below 1 counts "
    )
    words += "as 1, times below 1 ms as 1 ms."
    return [table(f"{c.title}: in numbers", SUMMARY, rows), {"text": words}]


def how(data):
    c = data.campaign
    rows = {
        "program": f"perp {c['version']}",
        "machine": machine_words(c["machine"]), "command": " ".join(c["command_line"]),
        "tolerance": f"{c['tol']:g} on the natural residual of the problem as given, evaluated outside of the method",
        "limits of a run": f"{c['time_limit']:g} s, {c['memory_limit_mb']} MiB; each in a process of its own, "
        f"{c['jobs']} at a time",
        "restarts": f"{c['restarts']} at most, seed {c['seed']}",
        "starts": "all of each problem" if c["starts"] == "all" else f"at most {c['starts']} of each problem",
    }  # fmt: skip
    external = [m for m in c["methods"] if m["external"]]
    return rows | {f"external {m['label']}": with_tolerance(m["command"], c["tol"]) for m in external}


def page(data, all_comparisons, found, made):
    shared = list(dict.fromkeys([m for c in all_comparisons for m in c.methods] + list(range(len(data.methods)))))

    def style(c, m):
        """C-functions have styles of their own, so that they differ most."""
        return c.methods.index(m) if c.id.startswith("cfunctions") else shared.index(m)

    sections = [robustness_section(data)] + ([unsolvable_section(data, made)] if len(data.solvable(False)) else [])
    sections.append(section("profiles", "Profiles"))
    for c in all_comparisons:
        if c.id.startswith("cfunctions") and all(s["id"] != "cfunctions" for s in sections):
            sections.append(section("cfunctions", "C-functions"))
        sections.append(comparison_section(data, c, style, made))
    c, wrong = data.campaign, [c for c in data.cells if false_claim(c)]
    title = f"Comparison of {count(len(data.methods), 'method')} on {count(len(data.problems), 'problem')}"
    sub = f"{c['date']} \u00b7 perp {c['version']} \u00b7 {machine_words(c['machine'])}"
    converged = sum(c["outcome"] == "false-convergence" for c in wrong)
    claims = {"converged": converged, "infeasible": len(wrong) - converged}
    legend = [{"m": m, "style": k, "name": data.methods[m], "on": k < IN_COLOUR} for k, m in enumerate(shared)]
    dropped = f"{count(len(data.dropped), 'line')} of cells.jsonl left out: {'; '.join(data.dropped)}"
    return html_page(
        kind="methods", title=title, sub=sub, tol=c["tol"], any_cells=bool(data.cells), findings=found, how=how(data),
        claims=claims if wrong else None, dropped=dropped if data.dropped else "", sections=sections,
        all_methods=legend, data=script_data(data, shared),
    )  # fmt: skip


def script_data(data, shared):
    """The cells for the page's script, as cells.csv has them; the curves as round(100 log10(natural residual))."""

    def log(value):
        return None if math.isnan(value) else round(100 * math.log10(min(max(value, 1e-300), 1e300)))

    def shown_value(name, value):
        return f"{value:.1e}" if name == "natural" and 0 < value < math.inf else plain(name, value)

    problems = ((c, data.problems[c["problem"]]) for c in data.cells)
    cells = [{**c, "class": problem["class"], "n": problem["n"]} for c, problem in problems]
    usual = ("method", "problem", "class", "n", *(name for name in CSV_COLUMNS[2:] if name != "claimed"))
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

CSV_COLUMNS = (*KEYS[:7], *COUNTS, "restarts", "outcome_after_restarts", "seconds", "peak_mb", "message")
TIMELESS = 14  # columns that do not depend on time and memory


def plain(name, value):
    """A value in cells.csv."""
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


def tables(data, all_comparisons):
    """{name: rows, the header first} of what is computed from cells."""
    methods = [("method", "name", "options", "external", "cfunction", *(c.id for c in all_comparisons))]
    for m, of in enumerate(data.campaign["methods"]):
        cfunction = given_cfunction(of) or of["in_force"].get("cfunction", "")
        taking_part = (m in c.methods for c in all_comparisons)
        methods.append((of["label"], of["name"], " ".join(of["options"]), of["external"], cfunction, *taking_part))
    pairs = [("problem", "start", "class", "n", "nonzeros", "solvable", *(c.id for c in all_comparisons))]
    for p, (of, start) in enumerate(data.pairs):
        facts = of["name"], start, of["class"], of["n"], of["nonzeros"], of["solvable"]
        pairs.append((*facts, *(p in c.pairs for c in all_comparisons)))
    robust = [("method", "class", "pairs", "failures", "after_restarts")]
    for m, total, classes in robustness(data):
        robust += [(data.methods[m], cls, *of[:3]) for cls, of in zip((*data.classes(), "total"), (*classes, total))]
    without = [("method", *UNSOLVABLE), *((data.methods[m], *of.values()) for m, of in unsolvable(data))]
    numbers = ("solved", "pairs", "with_restarts", "quickest", "within_two", "fewest_F", "common")
    summaries = [("comparison", "method", *numbers, *(f"mean_{name}" for name in FLOOR))]
    profiles = [("comparison", "kind", "cost", "method", "x", "count", "of")]
    for c in all_comparisons:
        for m, row in summary(data, c).items():
            known = (None if isinstance(v, float) and math.isnan(v) else v for v in row.values())
            summaries.append((c.id, data.methods[m], *known))
        for measure, of in c.profiles.items():
            for kind in ("performance", "data"):
                for m, profile in zip(of["methods"], of[kind]):
                    which = c.id, kind, measure, data.methods[m]
                    profiles += [(*which, x, n, len(c.pairs)) for x, n in profile or [(math.inf, 0)]]
    curves = [("method", "problem", "start", "point", "natural")]
    for c in data.cells:
        curves += [(c["method"], c["problem"], c["start"], k, plain("", v)) for k, v in enumerate(c["curve"])]
    return {
        "robustness": robust, "unsolvable": without, "summary": summaries, "profiles": profiles, "methods": methods,
        "pairs": pairs, "curves": curves,
    }  # fmt: skip


def write_report(folder):
    """All files of the report, or none of them; the findings come back."""
    data = Data(folder)
    all_comparisons = comparisons(data)
    found, made = findings(data, all_comparisons), tables(data, all_comparisons)
    head = {"program": "perp", "version": data.campaign["version"], "schema": "perp/report/1"}
    head |= {"date": data.campaign["date"], "findings": [{"topic": topic, "text": text} for topic, text in found]}
    for name in ("robustness", "unsolvable", "summary", "profiles"):
        head[name] = [dict(zip(made[name][0], row)) for row in made[name][1:]]
    lines = ",\n".join(map(compact, data.cells))
    files = {
        **{f"{name}.csv": csv_text(rows) for name, rows in made.items()},
        "cells.csv": cells_csv(data.cells),
        "outcomes.csv": outcomes_csv(data.cells),
        "cells.json": f"[\n{lines}\n]\n" if lines else "[\n]\n",
        "findings.txt": "".join(f"{topic}: {words}\n" for topic, words in found),
        "report.json": pretty(head),
        "report.html": page(data, all_comparisons, found, made),
    }
    write_files(folder, files)
    return found
