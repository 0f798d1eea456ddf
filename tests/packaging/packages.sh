#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages of a build tree and looks into them: packages.sh BUILD WORK CPACK. Catches files that are in no
# package, a program that needs the build tree, and, where lintian is installed, what breaks Debian's policy. Exit status 77:
# dpkg's tools are not installed. scripts/package --try installs them in a fresh system.
set -euo pipefail
build=$1 work=$2 cpack=$3
for tool in dpkg-deb dpkg-shlibdeps file; do
  command -v "$tool" >/dev/null || { printf 'skipped: %s is not installed\n' "$tool"; exit 77; }
done

fail() { printf '%s\n' "$*" >&2; exit 1; }

rm -rf "$work"
mkdir -p "$work"
"$cpack" --config "$build/CPackConfig.cmake" -B "$work" >"$work/cpack.log" 2>&1 || fail "$(cat "$work/cpack.log")"

# contents NAME PATTERN...: each pattern is the end of a file's name in the package.
contents() {
  local name=$1 list pattern deb
  shift
  deb=$(echo "$work/$name"_*.deb)
  [[ -f $deb ]] || fail "there is no package $name"
  list=$(dpkg-deb --contents "$deb")
  for pattern in "$@" "/doc/$name/copyright" "/doc/$name/changelog.gz"; do
    grep -qE -- "$pattern( -> .*)?$" <<<"$list" || fail "$name has no file $pattern:"$'\n'"$list"
  done
}
contents perp /bin/perp /bin/perp-compare /bin/perp-report /share/perp/lab/page.js /bin/pathampl /man1/perp.1.gz /man1/pathampl.1.gz /man1/perp-solve.1.gz /man1/perp-contact.1.gz \
  /man1/perp-compare.1.gz /man1/perp-report.1.gz /completions/perp /completions/perp-compare /completions/perp-report /schema/solve.json /examples/energy.nl /examples/energy.col /examples/arch-9.hdf5
contents libperp '/libperp\.so\.1' '/libperp\.so\.1\.[0-9]+'
contents libperp-dev /include/perp.h /include/perp/ncp/solve.hpp '/libperp\.so' '/libperp_ncp\.a' /perpConfig.cmake /perp.pc /perp-c.pc
contents libperp-path '/libperp_path\.so' '/libperp_path\.so\.1'
if [[ -d $build/python/perp ]]; then contents python3-perp /dist-packages/perp/__init__.py /dist-packages/perp/_library.py /py.typed; fi

dpkg-deb --extract "$work"/perp_*.deb "$work/root"
output=$(cd / && "$work/root/usr/bin/perp" solve "$work/root/usr/share/perp/examples/energy.nl") ||
  fail "perp of the package does not solve energy.nl:"$'\n'"$output"

if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error "$work"/*.deb || fail "lintian refuses"
fi
rm -rf "$work"
