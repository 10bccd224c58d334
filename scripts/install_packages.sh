#!/usr/bin/env bash
# Installs the Debian packages of packages.txt that are missing, after saying which. Does nothing where all are there.
set -euo pipefail
cd "$(dirname "$0")"

command -v dpkg-query >/dev/null || { echo "install_packages: no dpkg here; install by hand what scripts/packages.txt lists" >&2; exit 0; }
missing=()
while read -r package; do
  [[ -z $package || $package == \#* ]] && continue
  # Debian's Node would replace parts of one that came from elsewhere.
  [[ $package == nodejs || $package == npm ]] && command -v node >/dev/null && command -v npm >/dev/null && continue
  # Emscripten would bring Debian's.
  [[ $package == emscripten ]] && command -v node >/dev/null && ! dpkg-query -W -f='${db:Status-Status}' nodejs 2>/dev/null | grep -qx installed && continue
  dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done < packages.txt
[[ ${#missing[@]} -eq 0 ]] && exit 0

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || { echo "install_packages: neither root nor sudo; install these first: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
