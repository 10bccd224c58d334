#!/usr/bin/env bash
# Runs a command in a bare Debian, as root: `scripts/in_bare_debian.sh [--suite trixie] FOLDER COMMAND...`, by default in Debian
# 12 (bookworm). The command starts in /try, a copy of FOLDER, and finds nothing but what debootstrap installs. It gets this
# machine's Debian mirror, proxy and certificates. The bare Debian is made once, in build/bare-debian-SUITE; each run gets a copy,
# build/bare-debian-SUITE-run, which stays until the next run.
set -euo pipefail
cd "$(dirname "$0")/.."

suite=bookworm
if [[ $1 == --suite ]]; then suite=$2; shift 2; fi
[[ $(id -u) -eq 0 ]] || { echo "in_bare_debian: needs root, for chroot" >&2; exit 1; }
if ! command -v debootstrap >/dev/null; then
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends debootstrap >/dev/null
fi
# The mirrors of this machine, which may run another Debian, hold every suite.
own=$(. /etc/os-release && echo "$VERSION_CODENAME")
mirrors() { apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' "Codename: $own$1" 'Created-By: Packages' 2>/dev/null | sort -u; }
bare=$PWD/build/bare-debian-$suite root=$PWD/build/bare-debian-$suite-run
if [[ ! -e $bare/complete ]]; then
  rm -rf "$bare"
  mirror=$(mirrors '' | head -1)
  debootstrap --variant=minbase "$suite" "$bare" ${mirror:+"$mirror"} >/dev/null
  for part in -updates -security; do
    for mirror in $(mirrors $part); do echo "deb $mirror $suite$part main" >>"$bare/etc/apt/sources.list"; done
  done
  touch "$bare/complete"
fi

rm -rf "$root"
cp -a "$bare" "$root"
cp -a "$1" "$root/try"
chmod a+rx "$root/try"
shift
cp /etc/resolv.conf "$root/etc/"
apt-config dump | grep -E '^Acquire::(http|https|Check)' >"$root/etc/apt/apt.conf.d/machine" || true
mkdir -p "$root/usr/local/share/ca-certificates"
cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/" 2>/dev/null || true
# Mounts and processes end with the command.
exec unshare --mount --pid --fork --kill-child --root="$root" --wd=/try --mount-proc \
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive \
  ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
  bash -c 'mount -t tmpfs tmpfs /dev/shm && mount -t devpts devpts /dev/pts && exec "$@"' bash "$@"
