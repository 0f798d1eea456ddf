# SPDX-License-Identifier: Apache-2.0
"""What a campaign shows: which methods are compared on which pairs, profiles, robustness, and careful sentences.

A pair is a problem and a start. Performance profile (Dolan & More, Math. Prog. 91 (2002) 201): the share of pairs p
with t_ps <= tau min_s t_ps; data profile (More & Wild, SIAM J. Optim. 20 (2009) 172): with t_ps <= alpha u_p, where
u_p = n_p + 1 for evaluations of F, else 1. Ties count for all; a pair that nobody solved stays in the denominator.

A lead counts as clear only if an exact sign test of the pairs on which two methods differ rejects equal chances at 5 %,
and if it is more than ROUNDING of the pairs.
"""

import math
from collections import Counter
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from .campaign import count
from .cells import settle
from .files import number, read_campaign, read_cells

MEASURES = {"seconds": "time", "F_evals": "evaluations of F", "factorizations": "factorizations"}
FLOOR = {"iterations": 1, "F_evals": 1, "factorizations": 1, "seconds": 1e-3}  # costs below count as this
FLOOR_OF_CONTACT = {**FLOOR, "seconds": 1e-6}  # most problems of contact are solved within a millisecond
# Effect of another BLAS or processor on the difference of two methods: of 403 pairs smooth solves 384 to 390, others
# vary by at most 2 (bench/results/collection.md): 6 and 2 together.
ROUNDING = 0.02


class Data:
    """The methods, problems and cells of a campaign; arrays have a row for each method, a column for each pair.

    Pairs that not every method has finished are left out; `cells` has their cells, too.
    """

    def __init__(self, folder):
        self.campaign = read_campaign(folder)
        cells, self.dropped = read_cells(folder)
        self.contact = self.campaign.get("contact", False)
        self.floor = FLOOR_OF_CONTACT if self.contact else FLOOR
        self.least_time = f"{1e3 * self.floor['seconds']:g} ms"
        self.methods = [m["label"] for m in self.campaign["methods"]]
        self.problems = {p["name"]: p for p in self.campaign["problems"]}
        self.pairs = [(p, s) for p in self.problems.values() for s in range(1, p["starts"] + 1)]
        wanted = {(m, p["name"], s) for p, s in self.pairs for m in self.methods}
        self.dropped += [f"{' '.join(map(str, key))}: not of this campaign" for key in sorted(cells.keys() - wanted)]
        self.cells, self.unfinished = [cells[key] for key in sorted(wanted & cells.keys())], len(wanted - cells.keys())
        for cell in self.cells:
            # As cells.csv prints them, so that whatever is computed from here can be computed from there.
            cell["seconds"], cell["natural"] = float(f"{cell['seconds']:.6g}"), float(cell["natural"])
            cell["curve"] = [float(v) for v in cell["curve"]]
        settle(self.campaign, self.cells)
        self.pairs = [(p, s) for p, s in self.pairs if all((m, p["name"], s) in cells for m in self.methods)]
        at = [(m, k) for m in range(len(self.methods)) for k in range(len(self.pairs))]
        self.table = {(m, k): cells[self.methods[m], self.pairs[k][0]["name"], self.pairs[k][1]] for m, k in at}
        self.classes_of = np.array([p["class"] for p, _ in self.pairs])
        self.with_solution = np.array([p["solvable"] for p, _ in self.pairs], bool)
        self.affine = np.array([p["affine"] for p, _ in self.pairs], bool)
        self.solved = self.array(lambda c: c["outcome"] == "solved")
        self.after = self.array(lambda c: "solved" in (c["outcome"], c["outcome_after_restarts"]))
        self.refused = self.array(lambda c: c["outcome"] == "not-applicable")
        self.raw = {measure: self.array(lambda c: number(c[measure]), float) for measure in FLOOR}
        costs = {key: np.maximum(of, self.floor[key]) for key, of in self.raw.items() if not np.isnan(of).all()}
        self.cost = {key: np.where(self.solved, costs[key], math.inf) for key in MEASURES if key in costs}

    def array(self, value, kind=bool):
        shape = len(self.methods), len(self.pairs)
        return np.array([value(self.table[at]) for at in np.ndindex(shape)], kind).reshape(shape)

    def count(self, m, pairs):
        return int(self.solved[m, pairs].sum())

    def solvable(self, wanted=True):
        return np.flatnonzero(self.with_solution == wanted)

    def classes(self):
        return sorted(set(self.classes_of[self.with_solution].tolist()))


def false_claim(cell):
    return cell["outcome"] in ("false-convergence", "false-infeasible")


def given_cfunction(method):
    """The C-function that a method was given, with the value of its parameter; "" if none was given."""
    options = dict(option.partition("=")[::2] for option in method["options"])
    return " ".join(options[name] for name in ("cfunction", "cfunction_parameter") if options.get(name))


def without_cfunction(method):
    return ":".join([method["name"], *(o for o in method["options"] if not o.startswith("cfunction"))])


# Comparisons.


@dataclass
class Comparison:
    id: str
    title: str
    methods: list  # most solved first, then least sum of log(time)
    pairs: list
    subject: list = field(default_factory=list)  # the methods for some problems only that it is about
    profiles: dict = field(default_factory=dict)  # by measure: {"methods", "left_out", "performance", "data"}

    def name(self, data, m):
        if not self.id.startswith("cfunctions"):
            return data.methods[m]
        method = data.campaign["methods"][m]
        return given_cfunction(method) or method["in_force"].get("cfunction", "") + " (default)"


def steps(values):
    """[(x, how many are at most x)] of the finite ones."""
    x, n = np.unique(values[np.isfinite(values)], return_counts=True)
    return list(zip(x.tolist(), n.cumsum().tolist()))


def reached(profile, x):
    return max((n for at, n in profile if at <= x), default=0)


def performance_profiles(costs):
    costs = np.array(costs, float)
    with np.errstate(invalid="ignore"):  # inf / inf where nobody has solved the pair
        return [steps(row) for row in costs / costs.min(0)] if costs.size else [[] for _ in costs]


def data_profiles(costs, units):
    return [steps(row) for row in np.array(costs, float) / np.array(units, float)]


def profiles(data, methods, pairs):
    """{measure: of whom it is known, of whom not, and their profiles}."""
    found = {}
    for measure, cost in data.cost.items():
        known = [m for m in methods if not np.isnan(cost[m, pairs]).any()]
        units = [data.pairs[p][0]["n"] + 1 if measure == "F_evals" else 1 for p in pairs]
        costs = cost[np.ix_(known, pairs)]
        found[measure] = {"methods": known, "left_out": [m for m in methods if m not in known]}
        found[measure] |= {"performance": performance_profiles(costs), "data": data_profiles(costs, units)}
    return found


def kind_of(data, m):
    """For all problems, for some (affine ones, or those that an external program takes), or a given C-function."""
    method, refused, nonlinear = data.campaign["methods"][m], data.refused[m], ~data.affine
    if given_cfunction(method):
        return "variant"
    some = (refused & data.with_solution).any() if method["external"] else nonlinear.any() and refused[nonlinear].all()
    return "some" if some else "general"


def comparisons(data):
    kinds, found, methods = [kind_of(data, m) for m in range(len(data.methods))], [], data.campaign["methods"]
    general, some, variants = (
        [m for m, of in enumerate(kinds) if of == kind] for kind in ("general", "some", "variant")
    )
    general = general if general or some else variants

    def add(identity, title, methods, subject=()):
        asked = list(subject) or methods
        if pairs := np.flatnonzero(data.with_solution & ~data.refused[asked].all(0)).tolist():
            times = {m: data.cost["seconds"][m, pairs] for m in methods}
            times = {m: of[np.isfinite(of)] for m, of in times.items()}
            methods = sorted(methods, key=lambda m: (-len(times[m]), np.log(times[m]).sum(), data.methods[m]))
            found.append(Comparison(identity, title, methods, pairs, list(subject), profiles(data, methods, pairs)))

    if data.contact:
        exact = [m for m, of in enumerate(methods) if of["exact"]]
        if exact:
            add("general", "Coulomb's exact law", exact)
        if len(exact) < len(methods):
            add("all", "All variants, each by its own law", range(len(methods)))
        return found
    if general:
        add("general", "Methods for all problems", general)
    if some:
        add("some", "Methods for some problems only, beside those for all", some + general, some)
    for k, base in enumerate(dict.fromkeys(without_cfunction(methods[m]) for m in variants), 1):
        same = [m for m in range(len(methods)) if without_cfunction(methods[m]) == base]
        mine = [m for m in same if m in variants]
        given = [given_cfunction(methods[m]) for m in mine]
        mine += [m for m in same if m not in mine and methods[m]["in_force"].get("cfunction", "") not in given]
        if len(mine) > 1:
            add(f"cfunctions-{k}", f"C-functions in {base}", mine)
    return found


def summary(data, c):
    """{method: {column of the table: value}}; means are geometric, over the pairs that all with a mean solve."""

    def lead(measure, m, within):
        of = c.profiles.get(measure, {"methods": ()})
        return reached(of["performance"][of["methods"].index(m)], within) if m in of["methods"] else 0

    def mean(measure, m):
        if m not in part or not common:
            return math.nan
        values = np.maximum(data.raw[measure][m, common], data.floor[measure])
        return float(np.exp(np.log(values).mean()))

    solved = {m: data.count(m, c.pairs) for m in c.methods}
    # Others would leave too few common pairs.
    part = [m for m in c.methods if solved[m] and 4 * solved[m] >= 3 * max(solved.values())]
    common = [p for p in c.pairs if part and data.solved[part, p].all()]
    return {m: {
        "solved": solved[m], "pairs": len(c.pairs), "with_restarts": int(data.after[m, c.pairs].sum()),
        "quickest": lead("seconds", m, 1), "within_two": lead("seconds", m, 2), "fewest_F": lead("F_evals", m, 1),
        "common": len(common), **{f"mean_{measure}": mean(measure, m) for measure in FLOOR},
    } for m in c.methods}  # fmt: skip


def clear(data, pairs, a, b):
    """Is the difference of two methods more than chance and rounding may make?"""
    A, B = data.solved[a, pairs], data.solved[b, pairs]
    only_a, only_b = int((A & ~B).sum()), int((B & ~A).sum())
    return abs(only_a - only_b) > ROUNDING * len(pairs) and sign_test(only_a, only_b) < 0.05


def sign_test(a, b):
    """Exact, two-sided (McNemar): 2 P(X <= min(a, b)), X ~ B(a + b, 1/2)."""
    return min(1.0, 2 * sum(math.comb(a + b, k) for k in range(min(a, b) + 1)) / 2 ** (a + b))


# Robustness, as the comparison of 1997 prints it.


def robustness(data):
    """[(method, total, [of each class])], those that apply to all pairs first, then by failures. Numbers are of pairs
    that it applies to, failures, those left after restarts, pairs that it does not apply to."""

    def failures(m, pairs):
        mine = ~data.refused[m, pairs]
        failed, left = mine & ~data.solved[m, pairs], mine & ~data.after[m, pairs]
        return tuple(int(v.sum()) for v in (mine, failed, left, ~mine))

    solvable = data.solvable()
    by_class = [solvable[data.classes_of[solvable] == cls] for cls in data.classes()]
    rows = [(m, failures(m, solvable), [failures(m, pairs) for pairs in by_class]) for m in range(len(data.methods))]
    return sorted(rows, key=lambda row: (row[1][3] > 0, row[1][1], row[1][2], data.methods[row[0]]))


# Judgement by Coulomb's law of solutions by other laws.

LAWS = ["variant", "judged by", "solved", "infeasible", "solved by", "error", "largest"]


def laws(data):
    """Rows with the columns of LAWS; the error is Siconos' metric, its median over the solved."""
    rows = []
    for m, of in enumerate(data.campaign["methods"]):
        mine = [cell for (k, _), cell in data.table.items() if k == m]
        solved = [cell for cell in mine if cell["outcome"] == "solved"]
        errors, by = [number(cell["siconos"]) for cell in solved], Counter(cell["solved_by"] for cell in solved)
        infeasible, law = sum(cell["outcome"] == "infeasible" for cell in mine), "Coulomb" if of["exact"] else "its own"
        steps = ", ".join(f"{name} {n}" for name, n in by.most_common())
        found = (median(errors), max(errors)) if errors else (math.nan, math.nan)
        rows.append([of["label"], law, len(solved), infeasible, steps, *found])
    return rows


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


class Lead:
    """Which methods have the most, and which the next most, of what is counted: solved pairs unless `value` says."""

    def __init__(self, data, c, value=None):
        self.values = {m: value(m) if value else data.count(m, c.pairs) for m in c.methods}
        self.most = max(self.values.values(), default=0)
        self.following = max((v for v in self.values.values() if v < self.most), default=0)
        self.first = [m for m, v in self.values.items() if v == self.most]
        self.second = [m for m, v in self.values.items() if v == self.following < self.most]
        self.names, self.next_names = (listed([c.name(data, m) for m in of]) for of in (self.first, self.second))


def scope(data):
    runs = len(data.cells) + data.unfinished
    pairs, cells = count(runs // max(len(data.methods), 1), "pair"), count(runs, "run")
    methods, problems = count(len(data.methods), "method"), count(len(data.problems), "problem")
    text = f"{methods} on {problems}: {pairs} of a problem and a start, {cells}."
    if data.unfinished:
        text += f" {data.unfinished} of them are not finished: what follows is provisional, and counts the pairs only "
        text += "that all methods have finished."
    return text


def most_solved(data, c):
    lead, pairs = Lead(data, c), len(c.pairs)
    if lead.most == 0:
        return f"No method solves any of the {count(pairs, 'pair')} with a solution."
    if len(c.methods) == 1:
        return f"{lead.names} solves {of_pairs(lead.most, pairs)} of a problem with a solution and a start."
    if not lead.second:
        who = "Both" if len(c.methods) == 2 else f"All {len(c.methods)}"
        return f"{who} methods solve as many, {of_pairs(lead.most, pairs)}."
    following = f"next {verb(len(lead.second), 'come')} {lead.next_names} with {lead.following}"
    most = f"{lead.names} {verb(len(lead.first), 'solve')} the most"
    text = f"{most}: {of_pairs(lead.most, pairs)} with a solution; {following}."
    fewer = [m for m in c.methods if lead.values[m] < lead.most]
    if close := [c.name(data, m) for m in fewer if not clear(data, c.pairs, lead.first[0], m)]:
        text += f" Not clearly behind {'them' if len(lead.first) > 1 else 'it'}: {listed(close)}."
    least = min(lead.values.values())
    if least < lead.following:
        text += f" Fewest: {listed([c.name(data, m) for m in fewer if lead.values[m] == least])} with {least}."
    counts = [f"{data.methods[m]} {lead.values[m]}" for m in c.subject if m in lead.values]
    return text + (f" {c.title.partition(',')[0]}: {', '.join(counts)}." if counts else "")


def cheapest(data, c):
    rows = summary(data, c)
    if len(c.methods) < 2 or not any(row["solved"] for row in rows.values()):
        return ""
    quick, fewest = (Lead(data, c, lambda m, name=name: rows[m][name]) for name in ("quickest", "fewest_F"))
    is_or_are, need = "is" if len(quick.first) == 1 else "are", verb(len(fewest.first), "need")
    text = f"Quickest most often {is_or_are} {quick.names} (on {quick.most}; times below {data.least_time} are ties)"
    more = f"; the fewest evaluations of F most often {need} {fewest.names} (on {fewest.most})"
    return text + (more if fewest.most else "") + "."


def false_claims(data):
    wrong = Counter(cell["method"] for cell in data.cells if false_claim(cell))
    if not wrong:
        return "No method claimed what is not so."
    names = [f"{label} {wrong[label]}" for label in data.methods if wrong[label]]
    return f"{count(sum(wrong.values()), 'cell claims', 'cells claim')} what is not so: {listed(names)}."


#: What is said of a comparison, by the first part of its id: topic and sentences.
OF_COMPARISONS = {
    "general": {"Most solved": most_solved, "Least cost": cheapest},
    "some": {"Where methods for some problems apply": most_solved},
    "cfunctions": {"": most_solved},
}


def findings(data, all_comparisons):
    """[(topic, sentences)] in the order of their weight; nothing is said of methods that were not run."""
    found = [("What ran", scope(data))]
    for c in all_comparisons:
        sentences = OF_COMPARISONS.get(c.id.partition("-")[0], {})
        found += [(topic or c.title, say(data, c)) for topic, say in sentences.items()]
    return [(topic, text) for topic, text in [*found, ("False claims", false_claims(data))] if text]
