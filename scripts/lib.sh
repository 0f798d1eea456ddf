# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# What quickstart and test share; sourced by them. Needs bash, and Debian's apt where packages are missing.
# shellcheck disable=SC2034  # the scripts that source this use them

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release
logs=$root/build/logs
jobs=$(nproc)
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}  # else it caches nothing that begins with precompiled headers

# The one list of Debian packages: to build the program, to test it as well, to make packages of it, to fuzz it.
build_packages=(g++ cmake ninja-build libeigen3-dev libsuitesparse-dev libgsl-dev libamplsolver-dev
  libmpfi-dev libcli11-dev nlohmann-json3-dev libfmt-dev)
test_packages=("${build_packages[@]}" libgtest-dev libgmock-dev libhdf5-dev libgmp-dev libmpfr-dev pkg-config python3
  python3-jsonschema gjh-asl-json python3-numpy python3-scipy python3-pytest python3-matplotlib python3-jinja2
  chromium chromium-driver dpkg-dev file)
package_packages=("${build_packages[@]}" dpkg-dev file gzip)
fuzz_packages=("${build_packages[@]}" clang llvm libclang-rt-14-dev)

fail() {
  printf '\nperp: %s\n' "$*" >&2
  exit 1
}

# step NAME COMMAND...: runs the command with its output in a log, and shows how far ninja or ctest is: on a terminal in
# place, else now and then. Says which step failed and how its log ends.
step() {
  local name=$1 log started=$SECONDS status=0 progress
  shift
  mkdir -p "$logs"
  log=$logs/${name// /-}.log
  printf '%-34s' "$name"
  : >"$log"
  show_progress "$log" "$name" &
  progress=$!
  "$@" >"$log" 2>&1 </dev/null || status=$?
  kill "$progress"
  wait "$progress" 2>/dev/null || true
  if [[ -t 1 ]]; then printf '\r\033[K%-34s' "$name"; fi
  if ((status != 0)); then
    printf 'FAILED after %d s\n\n' $((SECONDS - started))
    tail -n 60 "$log"
    fail "the step \"$name\" failed with status $status; all of its log: $log"
  fi
  printf '%4d s\n' $((SECONDS - started))
}

# show_progress LOG NAME: for ever, or until the script is gone. ninja says "[12/499]", ctest "12/2991 Test".
show_progress() {
  local at shown='' pause=30
  if [[ -t 1 ]]; then pause=1; fi
  while sleep "$pause" &>/dev/null && kill -0 $$ 2>/dev/null; do
    at=$(tail -c 4000 "$1" | grep -aoE '^\[[0-9]+/[0-9]+\]|^ *[0-9]+/[0-9]+ Test' | tail -n 1 | tr -d '[] Test') || true
    if [[ -z $at || $at == "$shown" ]]; then continue; fi
    shown=$at
    if [[ -t 1 ]]; then printf '\r\033[K%-34s%s' "$2" "$at"; else printf '%s ' "$at"; fi
  done
}

# Whatever of the given packages is not installed, one a line.
missing_packages() {
  local package
  for package in "$@"; do
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed* ]] || printf '%s\n' "$package"
  done
}

# What the build needs at least. Older systems are refused before anything is changed.
least_versions=(cmake 3.25 g++ 4:12 libeigen3-dev 3.4 libgsl-dev 2.7)

# check_versions PACKAGES...: of those that have a least version, what is installed, or what apt would install, is new enough.
check_versions() {
  local k package least has old=()
  for ((k = 0; k < ${#least_versions[@]}; k += 2)); do
    package=${least_versions[k]} least=${least_versions[k + 1]}
    [[ " $* " == *" $package "* ]] || continue
    has=$(dpkg-query -W -f='${Version}' "$package" 2>/dev/null) || has=
    [[ -n $has ]] || has=$(apt-cache policy "$package" 2>/dev/null | sed -n 's/^ *Candidate: //p')
    if [[ -n $has && $has != '(none)' ]] && dpkg --compare-versions "$has" lt "$least"; then
      old+=("$package ${has#*:} (at least ${least#*:})")
    fi
  done
  ((${#old[@]} == 0)) || fail "this system is too old to build Perp: $(printf '%s, ' "${old[@]}" | sed 's/, $//')." \
    "docs/install.md says how to use a file built elsewhere. Nothing was changed"
}

# A broken third-party source makes the update fail although Debian's own lists are there: let the installation decide.
apt_update() { "$@" apt-get -q update || printf 'apt-get update failed, going on with the lists there are\n'; }

# Installs the packages that are missing; silent if none is.
ensure_packages() {
  command -v dpkg-query >/dev/null ||
    fail "this is no Debian system. Install what corresponds to Debian's packages and build with" \
      "cmake --workflow --preset release (docs/install.md): $*"
  local missing become_root=()
  check_versions "$@"
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  if ((EUID != 0)); then
    local hint="as root: apt-get install ${missing[*]}"
    command -v sudo >/dev/null || fail "packages are missing, and this is neither root nor is there sudo. Run $hint"
    # Asks for the password here, where it can be seen, if one is needed and there is somebody to ask.
    sudo -n true 2>/dev/null || { [[ -t 0 ]] && sudo -v; } || fail "packages are missing and sudo refuses. Run $hint"
    become_root=(sudo)
  fi
  printf 'installing: %s\n' "${missing[*]}"
  local apt=("${become_root[@]}" env DEBIAN_FRONTEND=noninteractive)
  step "apt-get update" apt_update "${apt[@]}"
  check_versions "$@"  # by the lists that apt has now
  step "apt-get install" "${apt[@]}" apt-get -q install -y --no-install-recommends -o DPkg::Lock::Timeout=120 \
    "${missing[@]}"
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]} == 0)) || fail "still not installed: ${missing[*]}"
}

# configure_release OPTIONS...: the preset `release`, in build/release; files of a folder are compiled together, which
# takes half of the time.
configure_release() {
  # Not exported: the systems in which packages are tried have no ccache.
  if command -v ccache >/dev/null; then local -x CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  cd "$root" || return
  cmake --preset release -DCMAKE_UNITY_BUILD=ON "$@"
}
