# SPDX-License-Identifier: Apache-2.0
"""try.py ENV: installs the wheel beside this file into the virtual environment and uses it as its user would; then the
archive, as who has no Python. try_linux runs it in fresh systems."""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

here = Path(__file__).resolve().parent
programs = Path(sys.argv[1]) / "bin"
models = sorted((here / "models").glob("*.nl"))
contacts = sorted((here / "contact").glob("*.hdf5"))


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, text=True, stdout=subprocess.PIPE, **options).stdout


def pip(*what):
    run(programs / "pip", "install", "--no-index", "--find-links", here / "wheels", *what)


def try_program(place):
    """The program and pathampl that lie in this folder, with every sample."""
    version = run(place / "perp", "--version")
    assert "GNU General Public License" not in version, version
    for model in models:
        assert "Solved" in run(place / "perp", "solve", model)
    for problem in contacts:
        assert "Solved" in run(place / "perp", "contact", problem)
    answer = here / "models" / "energy.sol"
    answer.unlink(missing_ok=True)
    run(place / "pathampl", answer.with_suffix(""))
    assert answer.exists()
    return f"{version.splitlines()[0]}, {len(models)} .nl files, {len(contacts)} of contact, pathampl"


started = time.monotonic()
pip(*here.glob("wheels/perp-*.whl"))
print(f"tried: pip install with numpy and scipy, all of them files here, in {time.monotonic() - started:.1f} s")
print("tried: the program of the wheel:", try_program(programs))

blocks = re.findall(r"^```python\n(.*?)^```", (here / "python.md").read_text(encoding="utf-8"), re.M | re.S)
(here / "examples.py").write_text("\n".join(blocks), encoding="utf-8")
run(programs / "python", here / "examples.py")
print(f"tried: the {len(blocks)} examples of docs/python.md")

path_library = """
import ctypes, pathlib, perp
path = ctypes.CDLL(pathlib.Path(perp.__file__).with_name("libperp_path.so"))
path.Path_Version.restype = ctypes.c_char_p
print(path.Path_Version().decode())
"""
assert run(programs / "python", "-c", path_library).startswith("Path ")
print("tried: libperp_path.so of the wheel")

pip("pyomo")
market = """
import pyomo.environ as pyo
import perp.pyomo
from pyomo.mpec import Complementarity, complements
m = pyo.ConcreteModel()
m.x = pyo.Var(bounds=(0, None), initialize=1)
m.c = Complementarity(expr=complements(m.x >= 0, 2 * m.x - 3 >= 0))
for solver in "perp", "path":
    m.x.value = 1
    pyo.SolverFactory(solver).solve(m)
    assert abs(m.x.value - 1.5) < 1e-8, (solver, m.x.value)
"""
run(programs / "python", "-c", market, env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"})
print("tried: Pyomo, by the solvers perp and path")

(archive,) = here.glob("perp-*.tar.gz")
place = here / "a place with spaces, ä and ß"
shutil.rmtree(place, ignore_errors=True)
shutil.unpack_archive(archive, place)
(prefix,) = place.iterdir()
print("tried: the program of the archive:", try_program(prefix / "bin"))

link = here / "perp"  # the flags of pkg-config are words
link.unlink(missing_ok=True)
link.symlink_to(prefix)
os.environ["PKG_CONFIG_PATH"] = str(link / "lib" / "pkgconfig")
flags = run("pkg-config", "--cflags", "--libs", "perp-c").split()
run("gcc", "-std=c99", "-Wall", "-Werror", here / "from_c.c", *flags, f"-Wl,-rpath,{link / 'lib'}", "-o", here / "from_c")
assert "x = 0.618034 1.61803" in run(here / "from_c")
print("tried: a program in C, linked with the archive's libperp.so by pkg-config")
