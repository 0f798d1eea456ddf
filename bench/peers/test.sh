#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# One driver on small models through `perp-compare`: the judge has to call every answer solved, and a wrong option has to
# come back as a failure with its reason; with OPTION_NOT_TAKEN no model is for the driver.
# usage: [OPTION_NOT_TAKEN=key=value] test.sh PERP DRIVER FOLDER MODEL.nl...
set -eu
perp=$1 driver=$2 out=$3
shift 3
problems=$(IFS=,; echo "$*")
rm -rf "$out"
"$(dirname "$perp")/perp-compare" --program "$perp" --problems "$problems" --methods none --external peer="'$driver' tol={tol}" --external wrong="'$driver' tol=zero" \
  --external refuses="'$driver' ${OPTION_NOT_TAKEN:-tol=zero}" --time-limit 30 --out "$out" >"$out.log" 2>&1 || { cat "$out.log"; exit 1; }
solved=$(grep -c '^peer,[^,]*,1,solved,' "$out/outcomes.csv" || true)
failed=$(grep -c '^wrong,[^,]*,1,failed,' "$out/outcomes.csv" || true)
inapplicable=$(grep -c '^refuses,[^,]*,1,not-applicable,solve_result_num 590,' "$out/outcomes.csv" || true)
[ -n "${OPTION_NOT_TAKEN:-}" ] || inapplicable=$#
if [ "$solved" -ne $# ] || [ "$failed" -ne $# ] || [ "$inapplicable" -ne $# ] || ! grep -q 'tol=zero: not a positive number' "$out/cells.csv"; then
  cat "$out/cells.csv"
  exit 1
fi
