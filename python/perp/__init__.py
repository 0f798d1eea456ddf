# SPDX-License-Identifier: Apache-2.0
"""Mixed, nonlinear and affine complementarity problems, and contact with friction.

A mixed complementarity problem MCP(l, u, F) asks for x in [l, u], n entries, such that for every i

    l_i < x_i < u_i  =>  F_i(x)  = 0
    x_i = l_i        =>  F_i(x) >= 0        (free if l_i = u_i)
    x_i = u_i        =>  F_i(x) <= 0.

    import numpy as np, perp
    r = perp.solve(lambda x: x**3 - 8, x0=np.zeros(1))
    r.x, r.success, r.message

Arguments that make no sense raise ValueError or TypeError, whose text begins with the argument's name.
"""

from perp import contact
from perp._core import FileError, OptionError, __version__
from perp._plot import plot
from perp._problem import (
    CollectionEntry,
    Method,
    Option,
    Problem,
    affine_problem,
    collection,
    collection_entries,
    methods,
    options,
    problem,
    read_nl,
)
from perp._result import AllSolutions, FoundSolution, Inspection, Interrupted, JacobianCheck, Log, Result, Sensitivity, Verified
from perp._solve import lcp, mcp_affine, sensitivity, solve, solve_all, verify

__all__ = [
    "AllSolutions",
    "CollectionEntry",
    "FileError",
    "FoundSolution",
    "Inspection",
    "Interrupted",
    "JacobianCheck",
    "Log",
    "Method",
    "Option",
    "OptionError",
    "Problem",
    "Result",
    "Sensitivity",
    "Verified",
    "__version__",
    "affine_problem",
    "collection",
    "collection_entries",
    "contact",
    "lcp",
    "mcp_affine",
    "methods",
    "options",
    "plot",
    "problem",
    "read_nl",
    "sensitivity",
    "solve",
    "solve_all",
    "verify",
]
