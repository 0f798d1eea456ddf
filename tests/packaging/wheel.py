# SPDX-License-Identifier: Apache-2.0
"""Tries the package perp where nothing but numpy and scipy is installed; scripts/wheel runs it in a fresh Debian."""

import numpy as np
import perp
from scipy import sparse

r = perp.solve(lambda x: x**3 - 8, np.zeros(1))
assert r.success and abs(r.x[0] - 2) < 1e-8, r
print("tried: a function")

n = 10_000
M = sparse.diags([-1.0, 2.5, -1.0], [-1, 0, 1], shape=(n, n), format="csc")
r = perp.lcp(M, np.linspace(-1, 1, n))
assert r.success, r
print("tried: an affine problem of", n, "variables")

r = perp.read_nl("cournot.nl").solve()
assert r.success, r
print("tried: an .nl file")

r = perp.contact.solve(sparse.eye(3, format="csc"), np.array([-1.0, 0.1, 0.0]), np.array([0.3]))
assert r.success, r
print("tried: a contact")

print("tried:", perp.contact.read("arch-9.hdf5"))
