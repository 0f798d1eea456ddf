# SPDX-License-Identifier: Apache-2.0
"""Pyomo's models with complementarity, solved by the program perp.

    import pyomo.environ as pyo
    import perp.pyomo                                # registers the solver
    results = pyo.SolverFactory("perp").solve(m)

docs/pyomo.md says what it does with each kind of condition.
"""

from perp.pyomo._equilibrium import Agent, Equilibrium, equilibrium
from perp.pyomo._explain import Answer, Explanation
from perp.pyomo._expression import ModelError
from perp.pyomo._solver import Perp

__all__ = ["Agent", "Answer", "Equilibrium", "Explanation", "ModelError", "Perp", "equilibrium"]
