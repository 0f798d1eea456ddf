#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The campaign of the baseline: campaign.sh PERP DIR [PROBLEMS [options of perp-compare]]. perp-compare is beside PERP. DIR is made anew.
set -eu
perp=$1 dir=$2
problems=${3:-class:tiny,class:economics,class:games,class:chemical,class:lcp,class:kkt,-*-500,-*-1000}
shift 2
[ $# -eq 0 ] || shift
rm -rf "$dir"
exec "$(dirname "$perp")/perp-compare" --program "$perp" "--problems=$problems" --starts 1 --methods presets --time-limit 10 --memory-limit 1000 --out "$dir" "$@"
