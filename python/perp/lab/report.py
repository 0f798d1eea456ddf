# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign: DIR/report.html, one page that needs nothing else, and its numbers as CSV and JSON."""

import csv
import io
import math
import re
from collections import Counter
from pathlib import Path

from .campaign import count
from .cells import COUNTS, FACTS, KEYS, outcome_counts, with_tolerance
from .files import compact, pretty, write_files
from .findings import (
    LAWS, MEASURES, Data, comparisons, false_claim, findings, given_cfunction, laws, percent, robustness, summary,
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
    matplotlib.rcParams.update({"axes.grid": True, "grid.color": "#e2e2e2"})
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


def plain_ticks(axes):
    """Plain numbers on the x axis, percent on the y axis."""
    from matplotlib.ticker import NullFormatter

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
    plain_ticks(axes)
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
    plain_ticks(axes)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=8.5)
    return svg_of(made)


# Pieces of the page: what its template shows.


def cell(value, key=None, css="", tip=""):
    """`key` is what it is sorted by, unless that is its text. What is 0 or not known is pale."""
    if isinstance(value, float):
        value, key = ("-", None) if math.isnan(value) else (f"{value:.3g}", value)
    return {"text": str(value), "key": key, "css": f"{css} none" if value in (0, "-") else css, "tip": tip}


def table(caption, headers, rows, css="", foot=None):
    """Rows are of values or cells. The first column and those of words are no numbers."""
    words = {*headers[:1], "judged by", "solved by"}
    columns = [{"header": name, "number": name not in words} for name in headers]
    *rows, foot = [[one if isinstance(one, dict) else cell(one) for one in row] for row in [*rows, foot or ()]]
    return {"caption": caption, "columns": columns, "rows": rows, "css": css, "foot": foot}


def robustness_table(data):
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
    headers = ["method", "total", "solved", *classes, *["not for it"] * partial]
    sizes = [int((data.classes_of[pairs] == cls).sum()) for cls in classes]
    foot = ["pairs", len(pairs), "", *sizes, *[""] * partial]
    caption = "Failures by method and class" + ("; in parentheses: left after restarts" if restarts else "")
    return table(caption, headers, lines, "dense", foot)


def unsolvable_table(data):
    cells = [cell for cell in data.cells if not data.problems[cell["problem"]]["solvable"]]
    occur, counts = outcome_counts(data.campaign, cells)
    return table("How the runs ended", ["method", *occur], [[label, *numbers] for label, numbers in counts.items()])


def shown_comparison(data, c, style):
    coloured = sorted(c.methods, key=lambda m: m not in c.subject)[:IN_COLOUR]  # of either those that solve most
    charts, rows = [], summary(data, c)
    for measure, of in c.profiles.items():
        pictures = [profile_chart(data, c, measure, kind, style, coloured) for kind in ("performance", "data")]
        left_out = ", ".join(data.methods[m] for m in of["left_out"])
        charts.append({"title": MEASURES[measure], "pictures": pictures, "left_out": left_out})
    legend = [{"m": m, "style": style(c, m), "name": c.name(data, m), "on": m in coloured} for m in c.methods]
    numbers = [[data.methods[m], *row.values()] for m, row in rows.items()]
    numbers = table(f"{c.title}: in numbers", ["method", *rows[c.methods[0]]], numbers)
    parameters = parameter_chart(data, c) if c.id.startswith("cfunctions") else ""
    return {"of": c, "legend": legend, "charts": charts, "parameters": parameters, "numbers": numbers}


def page(data, all_comparisons, found):
    """The page of the template; what it is given is escaped but for charts and data."""
    import jinja2

    shared = list(dict.fromkeys([m for c in all_comparisons for m in c.methods] + list(range(len(data.methods)))))

    def style(c, m):
        """C-functions have styles of their own, so that they differ most."""
        return c.methods.index(m) if c.id.startswith("cfunctions") else shared.index(m)

    folder, methods = Path(__file__).resolve().parent, data.campaign["methods"]
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.loader = jinja2.FileSystemLoader(folder)
    static = {name: (folder / f"page.{name}").read_text("utf-8") for name in ("css", "js")}
    legend = [{"m": m, "style": k, "name": data.methods[m], "on": k < IN_COLOUR} for k, m in enumerate(shared)]
    external = [(m["label"], with_tolerance(m["command"], data.campaign["tol"])) for m in methods if m["external"]]
    return environment.get_template("page.html.j2").render(
        **static, style_of=style_of, count=count, data=data, campaign=data.campaign, findings=found, external=external,
        wrong=sum(map(false_claim, data.cells)), all_methods=legend, in_colour=IN_COLOUR,
        robustness=robustness_table(data), unsolvable=unsolvable_table(data),
        laws=data.contact and table("Variants and their laws", LAWS, laws(data)),
        comparisons=[shown_comparison(data, c, style) for c in all_comparisons], script=script_data(data, shared),
    )  # fmt: skip


def script_data(data, shared):
    """The cells for the page's script, as cells.csv has them; the curves as round(100 log10(natural residual))."""

    def log(value):
        return None if math.isnan(value) else round(100 * math.log10(min(max(value, 1e-300), 1e300)))

    def shown_value(name, value):
        short = name in ("natural", "siconos", "rr9118") and isinstance(value, float) and 0 < value < math.inf
        return f"{value:.1e}" if short else plain(name, value)

    cells = [{**data.problems[c["problem"]], **c} for c in data.cells]  # with the class of the problem and n
    usual = ("method", "problem", "class", "n", *(CONTACT_COLUMNS if data.contact else CSV_COLUMNS)[2:])
    told = [name for name in usual if name not in ("claimed", "command")]
    told = [name for name in told if data.campaign["restarts"] or "restarts" not in name]
    columns = [name for name in told if any(plain(name, c[name]) not in ("", None, 0) for c in cells)]
    rows = [[shown_value(name, c[name]) for name in columns] for c in cells]
    curves = [[log(v) for v in c["curve"]] for c in data.cells]
    drawn = Counter(p for (_, p), c in sorted(data.table.items(), key=lambda item: item[0][1]) if len(c["curve"]) > 1)
    shown = [data.pairs[p] for p, _ in drawn.most_common(1)]  # of those with most curves the first
    shown = [f"{problem['name']} from start {start}" for problem, start in shown]
    styles = {data.methods[m]: style_of(k) for k, m in enumerate(shared)}
    answer = {"columns": columns, "rows": rows, "curves": curves, "styles": styles, "shown": shown}
    return compact({"tol": data.campaign["tol"], **answer}).replace("<", "\\u003c")


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
    unsure = {**dict.fromkeys(("natural", *COUNTS)), "status": "", "claimed": False}
    shown = [{**c, **unsure} if c["outcome"] in ("time-limit", "memory-limit") else c for c in cells]
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
                which = {"comparison": c.id, "kind": kind, "cost": measure, "of": len(c.pairs)}
                for m, profile in zip(of["methods"], of[kind]):
                    steps = profile or [(math.inf, 0)]
                    profiles += [{**which, "method": data.methods[m], "x": x, "count": n} for x, n in steps]
    return pretty({**made, "summary": summaries, "profiles": profiles})


def write_report(folder):
    """All files of the report, or none of them; the findings come back."""
    data = Data(folder)
    all_comparisons = comparisons(data)
    found = findings(data, all_comparisons)
    write_files(folder, {
        "cells.csv": cells_csv(data.cells, CONTACT_COLUMNS if data.contact else CSV_COLUMNS),
        "outcomes.csv": outcomes_csv(data.cells),
        "findings.txt": "".join(f"{topic}: {words}\n" for topic, words in found),
        "report.json": report_json(data, all_comparisons, found),
        "report.html": page(data, all_comparisons, found),
    })  # fmt: skip
    return found
