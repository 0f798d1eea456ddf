# SPDX-License-Identifier: Apache-2.0
"""What a campaign shows: which methods are compared on which pairs, profiles, robustness, and careful sentences.

A pair is a problem and a start. Performance profile (Dolan & More, Math. Prog. 91 (2002) 201): the share of pairs p with
t_ps <= tau min_s t_ps; data profile (More & Wild, SIAM J. Optim. 20 (2009) 172): with t_ps <= alpha u_p, u_p = n_p + 1 for
evaluations of F, else 1. Ties count for all; a pair that nobody solved stays in the denominator.

A lead counts as clear only if an exact sign test of the pairs on which two methods differ rejects equal chances at 5 %,
and if it is more than ROUNDING of the pairs.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass, field

from .campaign import count, read_campaign, read_cells
from .cells import KEYS, key, settle

MEASURES = {"seconds": "time", "F_evals": "evaluations of F", "factorizations": "factorizations"}
FLOOR = {"seconds": 1e-3, "F_evals": 1, "factorizations": 1}  # costs below count as this: there is nothing to compare
FEW_PAIRS = 5
# What another BLAS or processor does to the difference of two methods: of 403 pairs smooth solves 384 to 390, others vary
# by at most 2 (bench/results/collection.md): 6 and 2 together.
ROUNDING = 0.02
SYSTEMS_1997 = ("proxi", "path", "smooth", "miles", "nesqp", "qpcomp", "semicomp", "semismooth")
AHEAD_1997 = 3
PUBLISHED = "-1997"  # ends the names of presets that are as published
SOURCE_1997 = "Billups, Dirkse & Ferris, Comput. Optim. Appl. 7 (1997) 3"


class Data:
    """The methods, problems and cells of a campaign folder; methods and pairs by their index."""

    def __init__(self, campaign, cells, dropped):
        self.campaign, self.dropped = campaign, list(dropped)
        self.methods = [m["label"] for m in campaign["methods"]]
        self.problems = {p["name"]: p for p in campaign["problems"]}
        self.pairs = [(p, s) for p in self.problems.values() for s in range(1, p["starts"] + 1)]
        method = {label: m for m, label in enumerate(self.methods)}
        pair = {(p["name"], s): k for k, (p, s) in enumerate(self.pairs)}
        self.cells, self.table = [], {}
        for k in sorted(cells):
            if k[0] in method and k[1:] in pair:
                cell = cells[k]
                # As cells.csv prints them, so that whatever is computed from here can be computed from there.
                cell["seconds"] = float(f"{cell['seconds']:.6g}")
                cell["natural"] = float(cell["natural"])
                cell["curve"] = [float(v) for v in cell["curve"]]
                self.cells.append(cell)
                self.table[method[k[0]], pair[k[1:]]] = cell
            else:
                self.dropped.append(f"{k[0]} on {k[1]} from start {k[2]}: not of this campaign")
        settle(campaign, self.cells)

    @classmethod
    def read(cls, folder):
        return cls(read_campaign(folder), *read_cells(folder, key, KEYS))

    def at(self, m, p):
        return self.table.get((m, p))

    def solved(self, m, p):
        cell = self.table.get((m, p))
        return cell is not None and cell["outcome"] == "solved"

    def count(self, m, pairs):
        return sum(self.solved(m, p) for p in pairs)

    def solvable(self, wanted=True):
        return [p for p, (problem, _) in enumerate(self.pairs) if problem["solvable"] == wanted]

    def classes(self, solvable=True):
        return sorted({self.pairs[p][0]["class"] for p in self.solvable(solvable)})

    def labels(self, methods):
        return [self.methods[m] for m in methods]


def false_claim(cell):
    return cell["outcome"] in ("false-convergence", "false-infeasible")


def applies(cell):
    return cell["outcome"] != "not-applicable"


def option(method, name):
    return next((o.partition("=")[2] for o in reversed(method["options"]) if o.partition("=")[0] == name), "")


def given_cfunction(method):
    """The C-function that a method was given, with the value of its parameter; "" if none was given."""
    return " ".join(v for v in (option(method, "cfunction"), option(method, "cfunction_parameter")) if v)


def without_cfunction(method):
    return ":".join([method["name"], *(o for o in method["options"] if not o.startswith("cfunction"))])


# Comparisons.


@dataclass
class Comparison:
    id: str
    title: str
    note: str
    methods: list  # most solved first, then least sum of log(time)
    pairs: list
    subject: list = field(default_factory=list)  # the methods for some problems only that it is about
    unfinished: int = 0
    profiles: dict = field(default_factory=dict)  # by measure: {"methods", "left_out", "performance", "data"}

    def name(self, data, m):
        if not self.id.startswith("cfunctions"):
            return data.methods[m]
        method = data.campaign["methods"][m]
        return given_cfunction(method) or method["in_force"].get("cfunction", "") + " (default)"


def cost(cell, measure):
    """Infinite where not solved; None where it is not known."""
    if cell["outcome"] != "solved":
        return math.inf
    value = cell[measure]
    return None if value is None or not 0 <= value < math.inf else max(value, FLOOR[measure])


def steps(values):
    """[(x, how many are at most x)] of the finite ones."""
    result, total = [], 0
    for x, n in sorted(Counter(v for v in values if v < math.inf).items()):
        total += n
        result.append((x, total))
    return result


def reached(profile, x):
    return max((n for at, n in profile if at <= x), default=0)


def performance_profiles(costs):
    least = [min(column) for column in zip(*costs)]
    return [steps(t / best if t < math.inf else t for t, best in zip(row, least)) for row in costs]


def data_profiles(costs, units):
    return [steps(t / unit for t, unit in zip(row, units)) for row in costs]


def finish(data, c):
    """Keeps the pairs that all have finished, orders the methods, makes the profiles."""
    c.methods = [m for m in c.methods if any(data.at(m, p) for p in c.pairs)]
    finished = [p for p in c.pairs if c.methods and all(data.at(m, p) for m in c.methods)]
    c.unfinished, c.pairs = len(c.pairs) - len(finished), finished

    def rank(m):
        times = [math.log(max(data.at(m, p)["seconds"], FLOOR["seconds"])) for p in c.pairs if data.solved(m, p)]
        return len(c.pairs) - len(times), sum(times), data.methods[m]

    c.methods.sort(key=rank)
    for measure in MEASURES:
        rows = {m: [cost(data.at(m, p), measure) for p in c.pairs] for m in c.methods}
        known = [m for m in c.methods if None not in rows[m]]
        units = [data.pairs[p][0]["n"] + 1 if measure == "F_evals" else 1 for p in c.pairs]
        costs = [rows[m] for m in known]
        c.profiles[measure] = {
            "methods": known,
            "left_out": [m for m in c.methods if m not in known],
            "performance": performance_profiles(costs) if c.pairs else [[] for _ in known],
            "data": data_profiles(costs, units),
        }
    return c


def plain_method(data, name):
    same = (m for m, method in enumerate(data.campaign["methods"]) if method["name"] == name and not method["options"] and not method["external"])
    return next(same, None)


def systems(data, suffix=""):
    return [m for name in SYSTEMS_1997 if (m := plain_method(data, name + suffix)) is not None]


def comparisons(data):
    kinds = {"general": [], "affine": [], "external": [], "variants": []}
    for m, method in enumerate(data.campaign["methods"]):
        cells = [(data.pairs[p][0], data.at(m, p)) for p in range(len(data.pairs)) if data.at(m, p)]
        nonlinear = [cell for problem, cell in cells if not problem["affine"]]
        refuses = any(problem["solvable"] and not applies(cell) for problem, cell in cells)
        kind = "general"
        if given_cfunction(method):
            kind = "variants"
        elif method["external"]:
            kind = "external" if refuses else "general"
        elif nonlinear and not any(map(applies, nonlinear)):
            kind = "affine"
        kinds[kind].append(m)
    general, affine, external, variants = kinds.values()
    if not general and not affine and not external:
        general = variants

    def pairs_of(methods):
        return [p for p in data.solvable() if any(data.at(m, p) is None or applies(data.at(m, p)) for m in methods)]

    found = []

    def add(identity, title, note, methods, subject=()):
        found.append(Comparison(identity, title, note, list(methods), pairs_of(list(subject) or methods), list(subject)))

    if general:
        note = "On every pair of a problem with a solution and a start. A method has not solved what it does not apply to."
        add("general", "Methods for all problems", note, general)
    if affine:
        note = f"On the pairs to which at least one of the {len(affine)} applies that are for affine problems, F(x) = M x + q, only. A method has not solved what it does not apply to."
        add("affine", "Methods for affine problems, beside those for all problems", note, affine + general, affine)
    if external:
        note = "On the pairs that an external program was given."
        add("external", "External programs, beside the methods for all problems", note, external + general, external)
    for suffix, identity, words, more in (
        ("", "lecture", "", "here Perp's presets of these names, with what was added since"),
        (PUBLISHED, "published", ", as published", "without what was added since"),
    ):
        eight = systems(data, suffix)
        if 2 <= len(eight) < len(general):
            add(identity, f"The systems of the comparison of 1997{words}", f"{SOURCE_1997}; {more}.", eight)
    for base in dict.fromkeys(without_cfunction(data.campaign["methods"][m]) for m in variants):
        identity = "cfunctions-" + re.sub(r"[^A-Za-z0-9]+", "-", base)
        while any(c.id == identity for c in found):
            identity += "-2"
        mine = [m for m in variants if without_cfunction(data.campaign["methods"][m]) == base]
        given = [given_cfunction(data.campaign["methods"][m]) for m in mine]
        for m, method in enumerate(data.campaign["methods"]):
            if without_cfunction(method) == base and not given_cfunction(method) and method["in_force"].get("cfunction", "") not in given:
                mine.append(m)
        if len(mine) > 1:
            add(identity, f"C-functions in {base}", "The same method; nothing differs but its C-function.", mine)
    return [finish(data, c) for c in found]


# A comparison in one line a method.


@dataclass
class Row:
    method: int
    solved: int
    after: int  # with restarts
    quickest: int
    within_two: int
    fewest_F: int
    means: dict  # geometric, over the common pairs: iterations and the measures; NaN if not known


@dataclass
class Summary:
    rows: list
    pairs: int
    common: int


def geometric(values, floor):
    if not values or None in values:
        return math.nan
    return math.exp(sum(math.log(max(v, floor)) for v in values) / len(values))


def summary(data, c):
    def lead(measure, m, within):
        of = c.profiles[measure]
        return reached(of["performance"][of["methods"].index(m)], within) if m in of["methods"] else 0

    rows = []
    for m in c.methods:
        after = sum(data.at(m, p)["outcome_after_restarts"] == "solved" or data.solved(m, p) for p in c.pairs)
        leads = lead("seconds", m, 1), lead("seconds", m, 2), lead("F_evals", m, 1)
        rows.append(Row(m, data.count(m, c.pairs), after, *leads, {}))
    most = max((row.solved for row in rows), default=0)
    # Others would leave too few common pairs.
    part = [row.method for row in rows if most > 0 and 4 * row.solved >= 3 * most]
    common = [p for p in c.pairs if part and all(data.solved(m, p) for m in part)]
    for row in rows:
        for measure in ("iterations", *MEASURES):
            values = [data.at(row.method, p)[measure] for p in common] if row.method in part else []
            row.means[measure] = geometric(values, FLOOR.get(measure, 1))
    return Summary(rows, len(c.pairs), len(common))


def clear(data, pairs, a, b):
    """(is the difference of two methods clear?, is it more than rounding may make?)."""
    only_a = sum(data.solved(a, p) and not data.solved(b, p) for p in pairs)
    only_b = sum(data.solved(b, p) and not data.solved(a, p) for p in pairs)
    beyond = abs(only_a - only_b) > ROUNDING * len(pairs)
    return beyond and sign_test(only_a, only_b) < 0.05, beyond


def sign_test(a, b):
    """Exact, two-sided (McNemar): 2 P(X <= min(a, b)), X ~ B(a + b, 1/2)."""
    return min(1.0, 2 * sum(math.comb(a + b, k) for k in range(min(a, b) + 1)) / 2 ** (a + b))


# Robustness, as the comparison of 1997 prints it, and problems without a solution.


def failures(data, m, pairs):
    """(pairs it applies to, failures, those left after restarts, pairs it does not apply to, unfinished)."""
    cells = [data.at(m, p) for p in pairs]
    mine = [cell for cell in cells if cell and applies(cell)]
    failed = [cell for cell in mine if cell["outcome"] != "solved"]
    left = [cell for cell in failed if cell["outcome_after_restarts"] != "solved"]
    return len(mine), len(failed), len(left), sum(bool(c) and not applies(c) for c in cells), cells.count(None)


def robustness(data):
    """[(method, total, [of each class])], those that apply to all pairs first, then by failures."""
    by_class = [[p for p in data.solvable() if data.pairs[p][0]["class"] == cls] for cls in data.classes()]
    rows = []
    for m in range(len(data.methods)):
        rows.append((m, failures(data, m, data.solvable()), [failures(data, m, pairs) for pairs in by_class]))
    return sorted(rows, key=lambda row: (row[1][3] > 0, row[1][1] + row[1][4], row[1][2], data.methods[row[0]]))


UNSOLVABLE = ("infeasible", "honest", "wrong", "broken", "not_applicable", "unfinished")


def unsolvable(data):
    """[(method, {how its runs ended: how many})] on problems without a solution."""
    words = {
        "infeasible": "infeasible", "crashed": "broken", "garbage": "broken", "failed": "honest", "time-limit": "honest",
        "memory-limit": "honest", "not-applicable": "not_applicable",
    }  # fmt: skip
    rows = []
    for m in range(len(data.methods) if data.solvable(False) else 0):
        cells = [data.at(m, p) for p in data.solvable(False)]
        counts = Counter(words.get(cell["outcome"], "wrong") if cell else "unfinished" for cell in cells)
        rows.append((m, {word: counts[word] for word in UNSOLVABLE}))
    return sorted(rows, key=lambda row: (row[1]["wrong"], row[1]["broken"], -row[1]["infeasible"], data.methods[row[0]]))


# Sentences.


def listed(names):
    if len(names) < 2:
        return names[0] if names else "none"
    shown = 3 if len(names) > 5 else len(names) - 1
    return f"{', '.join(names[:shown])} and {f'{len(names) - shown} others' if len(names) > 5 else names[-1]}"


def verb(n, infinitive):
    return f"{infinitive}s" if n == 1 else infinitive


def percent(n, of):
    """Never 100 % or 0 % unless it is that."""
    if of == 0:
        return "-"
    return f"{100 * n // of} %" if n in (0, of) else f"{min(max(100 * n / of, 0.1), 99.9):.1f} %"


def of_pairs(n, pairs):
    return f"{n} of {count(pairs, 'pair')} ({percent(n, pairs)})"


def top(methods, value):
    """(those with the most, the most, those with the next most, the next most)."""
    values = {m: value(m) for m in methods}
    most = max(values.values(), default=0)
    following = max((v for v in values.values() if v < most), default=0)
    return [m for m in methods if values[m] == most], most, [m for m in methods if values[m] == following < most], following


def scope(data):
    campaign, cells = data.campaign, len(data.methods) * len(data.pairs)
    text = f"{count(len(data.methods), 'method')} on {count(len(campaign['problems']), 'problem')}: {count(len(data.pairs), 'pair')} of a problem and a start, {count(cells, 'run')}."
    if not data.cells:
        return text + " None of them is finished: nothing can be said yet."
    if len(data.cells) < cells:
        text += f" {cells - len(data.cells)} of them are not finished: what follows is provisional, and counts the pairs only that all methods compared have finished."
    return text


def most_solved(data, c):
    first, most, second, following = top(c.methods, lambda m: data.count(m, c.pairs))
    pairs = len(c.pairs)
    if most == 0:
        return f"No method solves any of the {count(pairs, 'pair')} with a solution."
    if len(c.methods) == 1:
        return f"{data.methods[c.methods[0]]} solves {of_pairs(most, pairs)} of a problem with a solution and a start."
    if not second:
        who = "Both" if len(c.methods) == 2 else f"All {len(c.methods)}"
        return f"{who} methods solve as many, {of_pairs(most, pairs)}."
    text = f"{listed(data.labels(first))} {verb(len(first), 'solve')} the most: {of_pairs(most, pairs)} with a solution; next {verb(len(second), 'come')} {listed(data.labels(second))} with {following}."
    close = [m for m in c.methods if data.count(m, c.pairs) < most and not clear(data, c.pairs, first[0], m)[0]]
    if close:
        text += f" Not clearly behind {'them' if len(first) > 1 else 'it'}: {listed(data.labels(close))}."
    least = min(data.count(m, c.pairs) for m in c.methods)
    if least < following:
        text += f" Fewest: {listed(data.labels([m for m in c.methods if data.count(m, c.pairs) == least]))} with {least}."
    return text


def subject_counts(data, c, whose):
    counts = [f"{data.methods[m]} {data.count(m, c.pairs)}" for m in c.methods if m in c.subject]
    return f" {whose}: {', '.join(counts)}." if counts else ""


def cheapest(data, c):
    rows = {row.method: row for row in summary(data, c).rows}
    if len(c.methods) < 2 or not any(row.solved for row in rows.values()):
        return ""

    def lead(name):
        first, most, _, _ = top(c.methods, lambda m: getattr(rows[m], name))
        return listed(data.labels(first)), most, len(first)

    (quick, on, n), (within, within_on, _), (fewest, fewest_on, k) = lead("quickest"), lead("within_two"), lead("fewest_F")
    text = f"Quickest most often {'is' if n == 1 else 'are'} {quick} (on {on}; times below 1 ms are ties), within twice the least time most often {within} (on {within_on})"
    return text + (f"; the fewest evaluations of F most often {verb(k, 'need')} {fewest} (on {fewest_on})." if fewest_on else ".")


def of_class(data, c, pairs, cls):
    first, most, second, following = top(c.methods, lambda m: data.count(m, pairs))
    if most == 0:
        return f"{cls}: none (0 of {len(pairs)})"
    if not second:
        return f"{cls}: all alike ({most} of {len(pairs)})"
    text = f"{cls}: {listed(data.labels(first))}{' alone' if len(first) == 1 else ''} ({most} of {len(pairs)}"
    if len(first) == 1:
        lead = "" if clear(data, pairs, first[0], second[0])[0] else ": no clear lead"
        text += f", next {listed(data.labels(second))} {following}{lead}"
    return text + ")"


def by_class(data, c):
    if len(data.classes()) < 2:
        return ""  # all is said
    judged, few = [], []
    for cls in data.classes():
        pairs = [p for p in c.pairs if data.pairs[p][0]["class"] == cls]
        if len(pairs) < FEW_PAIRS:
            few.append(cls)
        else:
            judged.append(of_class(data, c, pairs, cls))
    parts = [f"The most are solved in {'; '.join(judged)}."] if judged else []
    return " ".join(parts + ([f"Fewer than {FEW_PAIRS} pairs, too few to tell: {', '.join(few)}."] if few else []))


def cfunction_words(data, c):
    first, most, second, following = top(c.methods, lambda m: data.count(m, c.pairs))
    if most == 0:
        return "None solves anything."

    def names(methods):
        return listed([c.name(data, m) for m in methods])

    if second:
        lead = "" if clear(data, c.pairs, first[0], second[0])[0] else " (no clear lead)"
        text = f"{names(first)} {verb(len(first), 'solve')} the most, {of_pairs(most, len(c.pairs))}; next {verb(len(second), 'come')} {names(second)} with {following}{lead}"
    else:
        text = f"All {len(c.methods)} solve as many, {of_pairs(most, len(c.pairs))}"
    all_ = summary(data, c)
    known = [row for row in all_.rows if not math.isnan(row.means["F_evals"])]
    if all_.common < FEW_PAIRS or len(known) < 2:
        return text + "."
    least, largest = (pick(known, key=lambda row: row.means["F_evals"]) for pick in (min, max))
    who = "all" if len(known) == len(all_.rows) else f"the best {len(known)} all"
    text += f". On the {count(all_.common, 'pair')} that {who} solve "
    if largest.means["F_evals"] < 1.05 * least.means["F_evals"]:
        return text + "their evaluations of F differ by less than 5 %."
    return text + f"{c.name(data, least.method)} needs the fewest evaluations of F (geometric mean {least.means['F_evals']:.3g}), {c.name(data, largest.method)} the most ({largest.means['F_evals']:.3g})."


def ranking_1997(data, suffix):
    """Does the order of the comparison of 1997, proxi, path and smooth ahead of the others, show here?"""
    ahead = [m for name in SYSTEMS_1997[:AHEAD_1997] if (m := plain_method(data, name + suffix)) is not None]
    behind = [m for name in SYSTEMS_1997[AHEAD_1997:] if (m := plain_method(data, name + suffix)) is not None]
    pairs = [p for p in data.solvable() if all(data.at(m, p) for m in ahead + behind)]
    if not ahead or not behind or not pairs:
        return ""
    more = same = fewer = clearly_more = clearly_fewer = 0
    for a in ahead:
        for b in behind:
            sure, beyond = clear(data, pairs, a, b)
            lead = data.count(a, pairs) > data.count(b, pairs)
            more, same, fewer = more + (beyond and lead), same + (not beyond), fewer + (beyond and not lead)
            clearly_more, clearly_fewer = clearly_more + (sure and lead), clearly_fewer + (sure and not lead)
    verdict = "its ranking holds by and large" if more > fewer else "its ranking does not show in these data" if more == fewer else "these data turn its ranking round"
    if clearly_more == 0 and clearly_fewer == 0:
        verdict = "no difference between them is clear on these data"
    elif fewer == 0 and same == 0:
        verdict = "its ranking holds on these data"
    elif fewer == 0 and more > 0:
        verdict = "its ranking holds on these data, with ties"
    order = sorted(ahead + behind, key=lambda m: -data.count(m, pairs))
    counts = ", ".join(f"{data.methods[m]} {data.count(m, pairs)}" for m in order)
    text = f"The comparison of 1997 ({SOURCE_1997}) puts {listed(data.labels(ahead))} ahead of {listed(data.labels(behind))}: {verdict}. Solved of {count(len(pairs), 'pair')}: {counts}."
    duels = len(ahead) * len(behind)
    if duels > 1:
        text += f" Taken two by two, the former solve more pairs than the latter in {more} of {duels} comparisons ({clearly_more} clearly), as many (but for rounding) in {same}, fewer in {fewer} ({clearly_fewer} clearly)."
    return text + ("" if suffix else " These are this program's presets, with what was added since: presolve, rescalings, restarts by other methods.")


def without_solution(data):
    methods, all_pairs = range(len(data.methods)), data.solvable(False)
    pairs = [p for p in all_pairs if all(data.at(m, p) for m in methods)]
    claims = sum(data.at(m, p) is not None and data.at(m, p)["outcome"] == "false-convergence" for m in methods for p in all_pairs)
    if not pairs:
        return ""
    first, most, _, _ = top(methods, lambda m: sum(data.at(m, p)["outcome"] == "infeasible" for p in pairs))
    text = f"No method recognises any of the {count(len(pairs), 'pair')}"
    if most:
        text = f"{listed(data.labels(first))} {verb(len(first), 'recognise')} the most: {most} of {count(len(pairs), 'pair')}"
    return text + (f"; {count(claims, 'cell claims', 'cells claim')} a solution." if claims else "; none claims a solution.")


def false_claims(data):
    wrong = Counter(cell["method"] for cell in data.cells if false_claim(cell))
    if not wrong:
        return "No method claimed what is not so."
    names = [f"{label} {wrong[label]}" for label in data.methods if wrong[label]]
    return f"{count(sum(wrong.values()), 'cell claims', 'cells claim')} what is not so: {listed(names)}."


def findings(data, all_comparisons):
    """[(topic, sentences)] in the order of their weight; nothing is said of methods that were not run."""
    found = [("What ran", scope(data))]
    if not data.cells:
        return found
    for c in (c for c in all_comparisons if c.pairs):
        if c.id == "general":
            found += [("Most solved", most_solved(data, c)), ("Least cost", cheapest(data, c)), ("Class by class", by_class(data, c))]
        elif c.id == "affine":
            found.append(("Affine problems", most_solved(data, c) + subject_counts(data, c, "The methods for affine problems")))
        elif c.id == "external":
            found.append(("Where external programs ran", most_solved(data, c) + subject_counts(data, c, "The external programs")))
        elif c.id.startswith("cfunctions"):
            found.append((c.title, cfunction_words(data, c)))
    found += [("The ranking of 1997", ranking_1997(data, "")), ("The ranking of 1997, as published", ranking_1997(data, PUBLISHED))]
    found += [("Problems without a solution", without_solution(data)), ("False claims", false_claims(data))]
    return [(topic, text) for topic, text in found if text]
