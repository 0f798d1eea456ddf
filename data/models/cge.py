# SPDX-License-Identifier: Apache-2.0
"""General equilibria of a small open economy in Mathiesen's format, calibrated to a random balanced social accounting
matrix: nested CES production, Armington imports, CET exports, households with CES or linear expenditure systems, taxes
and, on request, rationing. See ../README.md."""

from draw import Draw
from nlwriter import Model, exp, log, total

ARMINGTON, TRANSFORM, TOP, FACTORS = 2.5, 2.0, 0.4, ("labour", "capital", "land")


def ces(prices, shares, elasticity):
    """Unit cost in calibrated share form, 1 at prices 1."""
    if elasticity == 1:
        return exp(total(share * log(price) for price, share in zip(prices, shares)))
    power = 1 - elasticity
    return total(share * price**power for price, share in zip(prices, shares)) ** (1 / power)


class Economy:
    """A balanced social accounting matrix at prices 1: what everybody buys, sells and pays."""

    def __init__(self, sectors, households, seed, inputs=5):
        draw = Draw(seed)
        self.goods, self.homes = list(range(1, sectors + 1)), list(range(1, households + 1))
        G, H = self.goods, self.homes
        self.X = {}  # intermediates (good, sector)
        for j in G:
            for i in draw.sample(G, min(inputs, sectors)):
                self.X[i, j] = draw.integer(2, 20)
        self.V = {(f, j): draw.integer(5, 60) for j in G for f in FACTORS if f != "land" or j % 3 == 0}
        self.factor_tax = {j: draw.pick((0, 0.1, 0.2, 0.4)) for j in G}  # on capital
        self.output_tax = {j: draw.pick((0, 0.05, 0.1)) for j in G}
        self.value_elasticity = {j: draw.pick((0.4, 0.8, 1, 1.3)) for j in G}
        self.inputs = {j: [i for i in G if (i, j) in self.X] for j in G}
        self.factors = {j: [f for f in FACTORS if (f, j) in self.V] for j in G}
        self.tariff = {i: draw.pick((0, 0.1, 0.25, 0.6)) for i in G}
        self.sales_tax = {i: draw.pick((0, 0.05, 0.2)) for i in G}

        self.value = {j: sum(self.V[f, j] * self.gross(f, j) for f in self.factors[j]) for j in G}
        self.materials = {j: sum(self.X[i, j] for i in self.inputs[j]) for j in G}
        self.Y = {j: (self.value[j] + self.materials[j]) / (1 - self.output_tax[j]) for j in G}
        self.exports = {j: draw.real(0.05, 0.4) * self.Y[j] for j in G}
        self.home = {j: self.Y[j] - self.exports[j] for j in G}
        used = {i: sum(self.X.get((i, j), 0) for j in G) for i in G}
        self.M = {}  # imports without tariff
        for i in G:
            least = (used[i] + 20 - self.home[i]) / (1 + self.tariff[i])
            self.M[i] = max(draw.real(0.05, 0.5) * self.home[i], least)
        self.A = {i: self.home[i] + self.M[i] * (1 + self.tariff[i]) for i in G}
        self.C, self.public, self.invested = {}, {}, {}
        for i in G:
            left = self.A[i] - used[i]
            self.public[i] = left * draw.pick((0, 0, 0.1, 0.4))
            self.invested[i] = left * draw.pick((0, 0, 0.2, 0.4))
            left -= self.public[i] + self.invested[i]
            buyers = draw.sample(H, draw.integer((households + 1) // 2, households))
            weights = [draw.integer(1, 9) for _ in buyers]
            for h, weight in zip(buyers, weights):  # what is bought, net of the tax on sales
                self.C[i, h] = left * weight / sum(weights)
        self.bought = {h: [i for i in G if (i, h) in self.C] for h in H}
        self.spent = {h: sum(self.C[i, h] * (1 + self.sales_tax[i]) for i in self.bought[h]) for h in H}

        def split(amount):
            weights = [draw.integer(1, 9) for _ in H]
            return {h: amount * weight / sum(weights) for h, weight in zip(H, weights)}

        self.saved = split(sum(self.invested.values()))
        self.owned = {f: split(sum(self.V.get((f, j), 0) for j in G)) for f in FACTORS}
        self.foreign = split(sum(self.M.values()) - sum(self.exports.values()))
        self.transfer = {
            h: self.spent[h] + self.saved[h] - sum(self.owned[f][h] for f in FACTORS) - self.foreign[h] for h in H
        }
        self.revenue = sum(self.public.values()) + sum(self.transfer.values())
        self.home_elasticity = {h: draw.pick((0.5, 1, 1.5)) for h in H}
        self.linear_home = {h: h % 2 == 0 for h in H}  # linear expenditure system
        self.committed = {(i, h): draw.real(0.1, 0.6) * amount for (i, h), amount in self.C.items()}

    def gross(self, factor, sector):
        """What a unit of the factor costs its user at the benchmark."""
        return 1 + (self.factor_tax[sector] if factor == "capital" else 0)


class Shock:
    """What changes from the benchmark; the defaults change nothing."""

    def __init__(self, free_trade=False, output_tax=1.0, world_price=0.0, labour=1.0, wage_floor=None, quota=None,
                 carbon=None, backstop=None, keep_public=False, seed=1):
        self.free_trade, self.output_tax, self.labour = free_trade, output_tax, labour
        self.world_price = world_price  # world prices change by up to this fraction, at random
        self.wage_floor = wage_floor  # of the real wage: unemployment is its complement
        self.quota = quota  # on imports of every fourth good, a fraction of the benchmark's
        self.carbon = carbon  # cap on the use of good 1, a fraction of the benchmark's
        self.backstop = backstop  # cost of another technology for goods 1 and 2, which needs no materials
        self.keep_public = keep_public  # a multiplier of the sales taxes keeps real public demand
        self.draw = Draw(seed)


def cge(name, sectors, households, shock=None, scaled=True, ones=False, spread=1, lowest=1e-4, seed=1):
    """scaled: quantities and incomes in units of the benchmark. The start is the benchmark, or, if `ones`, 1 everywhere;
    each entry is then multiplied by a random number between 1/spread and spread."""
    e, s = Economy(sectors, households, seed), shock or Shock()
    G, H = e.goods, e.homes
    m = Model(name)
    level = {}
    draw = Draw(seed)

    def away():
        factor = draw.real(1, spread)
        return factor if draw.chance(0.5) else 1 / factor

    def quantity(label, amount, lower=0.0):
        """A variable in units of the benchmark if scaled; level[v] * v is the amount either way."""
        v = m.variable(label, lower=lower, start=(1 if scaled or ones else amount) * away())
        level[v] = amount if scaled else 1.0
        return v

    def price(label):
        return m.variable(label, lower=lowest, start=away())

    Y = {j: quantity(f"output[{j}]", e.Y[j]) for j in G}
    A = {i: quantity(f"supply[{i}]", e.A[i]) for i in G}
    pd = {j: price(f"price_home[{j}]") for j in G}
    pa = {i: price(f"price[{i}]") for i in G}
    w = {f: price(f"price[{f}]") for f in FACTORS}
    exchange = m.variable("exchange_rate", lower=1, upper=1, start=1)  # numeraire
    investment = quantity("investment", sum(e.invested.values()))
    p_investment = price("price[investment]")
    income = {h: quantity(f"income[{h}]", e.spent[h] + e.saved[h], lowest) for h in H}
    welfare = {h: quantity(f"welfare[{h}]", e.spent[h]) for h in H if not e.linear_home[h]}
    living = {h: price(f"price[welfare,{h}]") for h in welfare}
    revenue = m.variable("revenue", start=1 if ones else e.revenue)
    no_jobs = m.variable("unemployment", lower=0, upper=0.9, start=0) if s.wage_floor else 0
    limited = [i for i in G if i % 4 == 0] if s.quota else []
    premium = {i: m.variable(f"premium[{i}]", lower=0, start=0) for i in limited}
    permit = m.variable("permit", lower=0, start=0) if s.carbon else 0
    other = {i: m.variable(f"other_output[{i}]", lower=0, start=0) for i in ((1, 2) if s.backstop else ())}
    multiplier = m.variable("tax_multiplier", lower=-0.5, upper=10, start=0) if s.keep_public else 0

    # Prices that users pay, and what they use of everything when they work at amount 1.
    world = {i: 1 + s.draw.real(-s.world_price, s.world_price) if s.world_price else 1 for i in G}
    user = {(i, j): pa[i] + (permit if i == 1 else 0) for i, j in e.X}
    factor = {
        (f, j): w[f] * ((1 + e.factor_tax[j]) / e.gross(f, j) if f == "capital" else 1) for f, j in e.V
    }
    tax_out = {j: min(0.5, e.output_tax[j] * s.output_tax) for j in G}
    tariff = {i: 0 if s.free_trade else e.tariff[i] for i in G}
    landed = {i: exchange * world[i] * ((1 + tariff[i] + premium.get(i, 0)) / (1 + e.tariff[i])) for i in G}
    final = {i: pa[i] * ((1 + e.sales_tax[i] * (1 + multiplier)) / (1 + e.sales_tax[i])) for i in G}
    materials_of, factors_of, home_of, exported, imported, bought = {}, {}, {}, {}, {}, {}
    for j in G:
        net = e.value[j] + e.materials[j]
        bundle = ces([user[i, j] for i in e.inputs[j]], [e.X[i, j] / e.materials[j] for i in e.inputs[j]], 1)
        sigma = e.value_elasticity[j]
        shares = [e.V[f, j] * e.gross(f, j) / e.value[j] for f in e.factors[j]]
        added = ces([factor[f, j] for f in e.factors[j]], shares, sigma)
        cost = ces((bundle, added), (e.materials[j] / net, e.value[j] / net), TOP)
        for i in e.inputs[j]:
            materials_of[i, j] = e.X[i, j] / e.Y[j] * (cost / bundle) ** TOP * (bundle / user[i, j])
        for f in e.factors[j]:
            factors_of[f, j] = e.V[f, j] / e.Y[j] * (cost / added) ** TOP * (added / factor[f, j]) ** sigma
        sold = ces((pd[j], exchange * world[j]), (e.home[j] / e.Y[j], e.exports[j] / e.Y[j]), -TRANSFORM)
        home_of[j] = e.home[j] / e.Y[j] * (pd[j] / sold) ** TRANSFORM
        exported[j] = e.exports[j] / e.Y[j] * (exchange * world[j] / sold) ** TRANSFORM
        margin = (1 - e.output_tax[j]) * cost - (1 - tax_out[j]) * sold
        m.complement(f"profit[{j}]", level[Y[j]] * margin, Y[j])
        abroad = e.M[j] * (1 + e.tariff[j])
        mixed = ces((pd[j], landed[j]), (e.home[j] / e.A[j], abroad / e.A[j]), ARMINGTON)
        bought[j] = e.home[j] / e.A[j] * (mixed / pd[j]) ** ARMINGTON
        imported[j] = e.M[j] / e.A[j] * (mixed / landed[j]) ** ARMINGTON
        m.complement(f"profit_supply[{j}]", level[A[j]] * (mixed - pa[j]), A[j])
    made = {j: level[Y[j]] * Y[j] for j in G}
    supplied = {i: level[A[i]] * A[i] for i in G}
    for i, extra in other.items():  # capital and labour only, no tax
        unit = s.backstop * exp(0.5 * log(w["labour"]) + 0.5 * log(w["capital"]))
        m.complement(f"profit_other[{i}]", e.Y[i] * (unit - pd[i]), extra)

    consumed = {i: [] for i in G}
    for h in H:
        real_income = income[h] * level[income[h]]
        free = real_income - e.saved[h] * p_investment
        if e.linear_home[h]:
            committed = {i: e.committed[i, h] for i in e.bought[h]}
            base = {i: e.C[i, h] * (1 + e.sales_tax[i]) for i in e.bought[h]}
            over = {i: base[i] - committed[i] * (1 + e.sales_tax[i]) for i in e.bought[h]}
            rest = free - total(committed[i] * (1 + e.sales_tax[i]) * final[i] for i in e.bought[h])
            for i in e.bought[h]:
                share = over[i] / sum(over.values()) / (1 + e.sales_tax[i])
                consumed[i].append(committed[i] + share * rest / final[i])
        else:
            sigma = e.home_elasticity[h]
            shares = [e.C[i, h] * (1 + e.sales_tax[i]) / e.spent[h] for i in e.bought[h]]
            unit = ces([final[i] for i in e.bought[h]], shares, sigma)
            enjoyed = level[welfare[h]] * welfare[h]
            for i in e.bought[h]:
                consumed[i].append(e.C[i, h] / e.spent[h] * enjoyed * (unit / final[i]) ** sigma)
            m.complement(f"profit_welfare[{h}]", level[welfare[h]] * (unit - living[h]), welfare[h])
            m.complement(f"welfare[{h}]", enjoyed - free / living[h], living[h])
        endowed = {f: e.owned[f][h] * (s.labour if f == "labour" else 1) for f in FACTORS}
        earned = total(endowed[f] * w[f] * ((1 - no_jobs) if f == "labour" else 1) for f in FACTORS)
        earned = earned + e.foreign[h] * exchange + e.transfer[h] * exchange
        m.complement(f"budget[{h}]", real_income - earned, income[h])

    government = sum(e.public.values())
    purse = revenue - sum(e.transfer.values()) * exchange
    invested = investment * level[investment]
    for i in G:
        goods = total(materials_of[i, j] * made[j] for j in G if (i, j) in materials_of)
        public = e.public[i] / government * purse / pa[i] if e.public[i] else 0
        built = e.invested[i] / sum(e.invested.values()) * invested if e.invested[i] else 0
        m.complement(f"market[{i}]", supplied[i] - goods - total(consumed[i]) - public - built, pa[i])
        extra = e.Y[i] * other[i] if i in other else 0
        m.complement(f"market_home[{i}]", home_of[i] * made[i] + extra - bought[i] * supplied[i], pd[i])
    unit = total(e.invested[i] / sum(e.invested.values()) * pa[i] for i in G if e.invested[i])
    m.complement("profit[investment]", level[investment] * (unit - p_investment), investment)
    m.complement("market[investment]", invested - sum(e.saved.values()), p_investment)
    for f in FACTORS:
        owned = sum(e.owned[f].values()) * (s.labour * (1 - no_jobs) if f == "labour" else 1)
        use = total(factors_of[f, j] * made[j] for j in G if (f, j) in factors_of)
        if f != "land":
            partner = w["capital" if f == "labour" else "labour"]
            for i in other:  # Shephard's lemma for s.backstop sqrt(w_L w_K)
                use = use + 0.5 * s.backstop * e.Y[i] * other[i] * (partner / w[f]) ** 0.5
        m.complement(f"market[{f}]", owned - use, w[f])
    trade = total(exported[j] * world[j] * made[j] - imported[j] * world[j] * supplied[j] for j in G)
    m.complement("trade", trade + sum(e.foreign.values()), exchange)

    burnt = total(materials_of[1, j] * made[j] for j in G if (1, j) in materials_of)
    sales = {j: total((home_of[j] * pd[j], exported[j] * exchange * world[j])) for j in G}
    collected = [tax_out[j] * sales[j] * made[j] for j in G if tax_out[j]]
    collected += [e.factor_tax[j] * w["capital"] * factors_of["capital", j] * made[j] for j in G if e.factor_tax[j]]
    for i in G:
        duty = tariff[i] + premium.get(i, 0)
        if i in premium or duty:
            collected.append(duty * exchange * world[i] * imported[i] * supplied[i])
        if e.sales_tax[i]:
            collected.append(e.sales_tax[i] * (1 + multiplier) * pa[i] * total(consumed[i]))
    if s.carbon:
        collected.append(permit * burnt)
        m.complement("emissions", s.carbon * sum(e.X.get((1, j), 0) for j in G) - burnt, permit)
    m.equation("treasury", revenue - total(collected))
    if s.wage_floor:
        basket = total(e.A[i] / sum(e.A.values()) * pa[i] for i in G)
        m.complement("wage_floor", w["labour"] - s.wage_floor * basket, no_jobs)
    for i in premium:
        m.complement(f"quota[{i}]", s.quota * e.M[i] - imported[i] * supplied[i], premium[i])
    if s.keep_public:
        basket = total(e.public[i] / government * pa[i] for i in G if e.public[i])
        m.complement("public", purse - government * basket, multiplier)
    return m
