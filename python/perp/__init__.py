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

from typing import Any

from perp import contact
from perp._batch import BatchResult, batch
from perp._dense import DenseResult, DenseSolver
from perp._functions import Float32Warning
from perp._games import BimatrixEquilibria, FiniteGame, MixedEquilibrium, NashSubset, bimatrix, finite_game, read_nfg
from perp._library import FileError, LibraryError, OptionError
from perp._lq import LqEquilibrium, lq_game
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
    read_matrix,
    read_nl,
)
from perp._result import (
    AllSolutions,
    Answer,
    Change,
    Demand,
    Explanation,
    FoundSolution,
    Inspection,
    Interrupted,
    JacobianCheck,
    Log,
    Result,
    Sensitivity,
    SolutionWarning,
    Verified,
)
from perp._solve import KeptSolver, explain, lcp, mcp_affine, sensitivity, solve, solve_all, verify
from perp._trace import Curve, TraceEvent, trace
from perp._vi import ViResult, vi

__version__: str

__all__ = [
    "AllSolutions",
    "Answer",
    "BatchResult",
    "BimatrixEquilibria",
    "Change",
    "CollectionEntry",
    "Curve",
    "Demand",
    "DenseResult",
    "DenseSolver",
    "Explanation",
    "FileError",
    "FiniteGame",
    "Float32Warning",
    "FoundSolution",
    "Inspection",
    "Interrupted",
    "JacobianCheck",
    "KeptSolver",
    "LibraryError",
    "Log",
    "LqEquilibrium",
    "Method",
    "MixedEquilibrium",
    "NashSubset",
    "Option",
    "OptionError",
    "Problem",
    "Result",
    "Sensitivity",
    "SolutionWarning",
    "TraceEvent",
    "Verified",
    "ViResult",
    "__version__",
    "affine_problem",
    "batch",
    "bimatrix",
    "collection",
    "collection_entries",
    "contact",
    "explain",
    "finite_game",
    "lcp",
    "lq_game",
    "mcp_affine",
    "methods",
    "options",
    "plot",
    "problem",
    "read_matrix",
    "read_nfg",
    "read_nl",
    "sensitivity",
    "solve",
    "solve_all",
    "trace",
    "verify",
    "vi",
]


def __getattr__(name: str) -> Any:
    """__version__, that of the library."""
    if name != "__version__":
        raise AttributeError(f"module 'perp' has no attribute {name!r}")
    from perp import _library

    return _library.lib.perp_version().decode()
