# SPDX-License-Identifier: MIT
# Sourced by the builders and trials of packages, from the repository's root.
version=$(sed -n 's/^project(spherechain VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
umask 022

# needs COMMAND PACKAGE...: installs Debian's packages where the command is missing.
needs() {
  local command=$1
  shift
  command -v "$command" >/dev/null && return
  [[ $(id -u) -eq 0 ]] || { echo "$command is missing: install $*" >&2; exit 1; }
  echo "Installing $*" >&2
  apt-get update -qq >&2
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

# skip WHY: a trial ends so where the machine lacks something.
skip() {
  echo "skipped: $1"
  exit 77
}

# unpack ARCHIVE: a trial's start. Sets `work`, a folder that is removed when the trial ends, and unpacks the archive there.
unpack() {
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  cmake -E chdir "$work" cmake -E tar xf "$(realpath -e "$1")"
}

# An asset of tests/golden. Its character has no contacts at rest, and contacts once an arm is turned into the body.
doll=$(find tests/golden -name doll.sphc | sort | head -1)

# write_tiny_asset FILE: an asset with contacts at rest. The programs in tests/package/stranger print `tiny_contacts` of it.
write_tiny_asset() {
  cmake --preset release >/dev/null
  cmake --build --preset release --target write_tiny_asset >/dev/null
  build/release/bin/write_tiny_asset "$1"
}
tiny_contacts="60 spheres, 175 pairs, 4 pairs of body parts"

# copy_notices FILE: runtime/copyright with the text of the Apache licence, which it only names by its path on Debian.
copy_notices() {
  { cat runtime/copyright; echo; cat /usr/share/common-licenses/Apache-2.0; } >"$1"
}

# exports_of DLL: the functions that a DLL exports, sorted.
exports_of() {
  objdump -p "$1" | sed -n '/Ordinal\/Name Pointer/,/^$/p' | awk '/\[/ && $NF !~ /Table$/ {print $NF}' | sort
}

# Completes build/release as far as the packages with the tool need it. The page of `view` holds the JavaScript package.
build_tool() {
  needs emcc emscripten
  cmake --preset release -D SPHERECHAIN_JAVASCRIPT=ON >/dev/null
  cmake --build --preset release --target spherechain spherechain_runtime javascript viewer >/dev/null
  [[ -e build/release/share/spherechain/viewer.html ]] || { echo "build/release has no page of view: the tool's packages would lack it" >&2; exit 1; }
}
