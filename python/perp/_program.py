# SPDX-License-Identifier: Apache-2.0
"""The program perp by the name pathampl, under which Pyomo and others call PATH: a wheel can hold no link to it."""

import os
import subprocess
import sys


def pathampl() -> None:
    """Becomes the program that was installed beside this command."""
    program = os.path.join(os.path.dirname(os.path.abspath(sys.argv[0])), "perp")
    command = ["pathampl", *sys.argv[1:]]
    if os.name == "nt":  # where a process that becomes another has ended for who waits for it
        sys.exit(subprocess.call(command, executable=program + ".exe"))
    os.execv(program, command)
