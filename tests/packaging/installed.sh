#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tries the installed packages as their users would: installed.sh use | develop. scripts/package runs it in a fresh Debian.
set -euo pipefail
examples=/usr/share/perp/examples

# expect PATTERN COMMAND...: the command succeeds and prints the pattern.
expect() {
  local pattern=$1 output
  shift
  if ! output=$("$@" 2>&1) || ! grep -qE -- "$pattern" <<<"$output"; then
    printf 'failed: %s\nwithout: %s\n%s\n' "$*" "$pattern" "$output" >&2
    exit 1
  fi
  printf 'tried: %s\n' "${*//$'\n'/; }"
}

use() {
  local page
  expect 'Apache License' perp --version
  expect '^Solved' perp solve $examples/energy.nl
  expect '^Solved' perp contact $examples/arch-9.hdf5
  for page in perp pathampl perp-compare perp-report $(perp --help | awk '/^Subcommands:/ { on = 1; next } !NF { on = 0 } on { print "perp-" $1 }'); do
    expect '^NAME' man "$page"
  done
  expect '^usage: perp-compare' perp-compare --help
  cp $examples/cournot.nl /tmp/market.nl
  expect 'solution found' pathampl /tmp/market -AMPL
  expect '^solve' bash -ic 'source /usr/share/bash-completion/bash_completion; _completion_loader perp
    COMP_WORDS=(perp sol) COMP_CWORD=1; _perp; echo "${COMPREPLY[0]}"'
  expect '^Solved \[0.5 0. *\]' python3 -c 'import numpy as np, perp
r = perp.solve(lambda x: 2 * x - [1, -1], np.ones(2)); print(r.status.name if hasattr(r.status, "name") else r.status, r.x)'
  expect '^Path [0-9]' python3 -c 'import ctypes
path = ctypes.CDLL("libperp_path.so"); path.Path_Version.restype = ctypes.c_char_p; print(path.Path_Version().decode())'
}

develop() {
  cd /srv/consumer
  expect 'libperp\.so' cc -std=c99 from_c.c $(pkg-config --cflags --libs perp-c) -o /tmp/from_c -Wl,-t
  expect 'x = 0.618034 1.61803' /tmp/from_c
  expect 'Generating done' cmake -S . -B /tmp/consumer -G Ninja
  expect 'Linking' cmake --build /tmp/consumer
  expect 'x = 0.618034 +1.61803' /tmp/consumer/example
  expect '^Solved' /tmp/consumer/contact $examples/arch-9.hdf5 glocker+path
}

"${1:?use or develop}"
