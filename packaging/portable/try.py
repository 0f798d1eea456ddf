# SPDX-License-Identifier: Apache-2.0
"""try.py ENV: installs the wheel beside this file into the virtual environment and uses it as its user would."""

import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

programs = Path(sys.argv[1]) / "bin"
here = Path(__file__).resolve().parent


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, text=True, stdout=subprocess.PIPE, **options).stdout


started = time.monotonic()
run(programs / "pip", "install", "--no-index", "--find-links", here / "wheels", "perp")
print(f"tried: pip install in {time.monotonic() - started:.1f} s")

print("tried:", run(programs / "perp", "--version").splitlines()[0])
for model in sorted((here / "models").glob("*.nl")):
    run(programs / "perp", "solve", model)
for problem in sorted((here / "contact").glob("*.hdf5")):
    run(programs / "perp", "contact", problem)
print("tried: every sample by the program")

blocks = re.findall(r"^```python\n(.*?)^```", (here / "python.md").read_text(), re.M | re.S)
examples = here / "examples.py"
examples.write_text("\n".join(blocks))
run(programs / "python", examples)
print(f"tried: the {len(blocks)} examples of docs/python.md")

run(programs / "pip", "install", "--no-index", "--find-links", here / "wheels", "pyomo")
model = here / "market.py"
model.write_text("""
import pyomo.environ as pyo
import perp.pyomo
from pyomo.mpec import Complementarity, complements
m = pyo.ConcreteModel()
m.x = pyo.Var(bounds=(0, None), initialize=1)
m.c = Complementarity(expr=complements(m.x >= 0, 2 * m.x - 3 >= 0))
pyo.SolverFactory("perp").solve(m)
assert abs(m.x.value - 1.5) < 1e-8, m.x.value
""")
run(programs / "python", model)
print("tried: Pyomo")

(archive,) = here.glob("perp-*.tar.gz")
shutil.unpack_archive(archive, here / "unpacked")
(program,) = (here / "unpacked").glob("*/bin/perp")
run(program, "solve", here / "models" / "cournot.nl")
run(program.with_name("pathampl"), here / "models" / "energy.nl", "-AMPL")
assert (here / "models" / "energy.sol").exists()
print("tried: the archive")
