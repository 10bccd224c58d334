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

# Completes build/release as far as the packages with the tool need it. The page of `view` holds the JavaScript package.
build_tool() {
  needs emcc emscripten
  cmake --preset release -D SPHERECHAIN_JAVASCRIPT=ON >/dev/null
  cmake --build --preset release --target spherechain spherechain_runtime javascript viewer >/dev/null
  [[ -e build/release/share/spherechain/viewer.html ]] || { echo "build/release has no page of view: the tool's packages would lack it" >&2; exit 1; }
}
