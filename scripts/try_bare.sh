#!/usr/bin/env bash
# Tries the README's two commands in a bare Debian, on a clean clone of what is committed: shows whether scripts/packages.txt lists
# all. `scripts/try_bare.sh bookworm` (Debian 12) or `trixie` (13), as root, takes an hour; `scripts/try_bare.sh SUITE COMMAND...` tries
# other commands, each one word for a shell in the clone. The clone stays in build/bare-debian-SUITE-run/try until the next run.
set -euo pipefail
cd "$(dirname "$0")/.."

suite=${1:?usage: try_bare.sh SUITE [COMMAND...]}
shift
[[ $# -gt 0 ]] || set -- scripts/demo.sh scripts/test.sh
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
git clone --quiet . "$folder/clone"
scripts/in_bare_debian.sh --suite "$suite" "$folder/clone" bash -euo pipefail -c 'for command; do echo "\$ $command"; bash -euo pipefail -c "$command"; done' bash "$@"
# Where something is missing, a test may be skipped instead of failing.
echo "Skipped tests say:"
grep -aih '^skipped: ' build/bare-debian-$suite-run/try/build/*/Testing/Temporary/LastTest.log | sort | uniq -c || true
