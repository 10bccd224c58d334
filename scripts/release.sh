#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds all packages of a release into OUT and tries each as a stranger: `scripts/release.sh [--dirty] [--no-trials] [--twice] OUT`.
# It builds from a clean tree; with --dirty also from one that has changes. --twice builds each package again and compares the
# bytes. OUT gets the packages, SHA256SUMS and a bill of materials; files there that no earlier run wrote are never replaced.
# Each package has a builder, scripts/release/NAME.sh, and a trial, scripts/release/try/NAME.sh; where one says "skipped: why" and
# exits 77, the machine lacks something. Logs lie in build/release-log. Exits 1 if a step fails.
set -euo pipefail
caller=$PWD
cd "$(dirname "$0")/.."
. scripts/release/common.sh

dirty= trials=1 twice= out=
for argument in "$@"; do
  case $argument in
    --dirty) dirty=1 ;;
    --no-trials) trials= ;;
    --twice) twice=1 ;;
    -*) echo "release: $argument is no option: [--dirty] [--no-trials] [--twice] OUT" >&2; exit 2 ;;
    *)
      [[ -z $out ]] || { echo "release: pass one folder" >&2; exit 2; }
      out=$(cd "$caller" && realpath -m "$argument")
      ;;
  esac
done
[[ -n $out ]] || { echo "release: pass the folder for the packages" >&2; exit 2; }
changes=$(git status --porcelain)
if [[ -n $changes && -z $dirty ]]; then
  echo "release: the tree is not clean (--dirty goes on nevertheless):" >&2
  head -5 <<<"$changes" >&2
  exit 1
fi

stage=$PWD/build/release-out logs=$PWD/build/release-log
rm -rf "$stage" "$logs"
mkdir -p "$stage" "$logs" "$out"
declare -A made tried
failed=

files_in() { (cd "$1" && find . -type f -printf '%P\n' | sort); }

# step NAME COMMAND...: runs a command with its output in a log, and prints a line. Sets `result`: done, "skipped: ..." or failed.
step() {
  local name=$1 from=$SECONDS code=0
  shift
  "$@" >"$logs/$name.log" 2>&1 </dev/null || code=$?
  result=done
  if [[ $code -eq 77 ]]; then
    result=$(grep '^skipped: ' "$logs/$name.log" | tail -1 || echo "skipped: it does not say why")
  elif [[ $code -ne 0 ]]; then
    result=failed failed=1
  fi
  printf '%-24s %5d s  %s\n' "$name" $((SECONDS - from)) "$result"
  [[ $result != failed ]] || tail -15 "$logs/$name.log" | sed 's/^/    /'
}

for builder in scripts/release/*.sh; do
  name=$(basename "$builder" .sh)
  [[ $name != *common ]] || continue  # sourced by the others
  before=$(files_in "$stage")
  step "$name" "$builder" "$stage"
  tried[$name]=$result
  made[$name]=$(comm -13 <(echo "$before") <(files_in "$stage"))
  if [[ $result == done && -n $twice ]]; then
    mkdir -p "$stage.2"
    step "$name, again" "$builder" "$stage.2"
    for file in ${made[$name]}; do
      cmp "$stage/$file" "$stage.2/$file" || failed=1
    done
    rm -rf "$stage.2"
  fi
done
step bill python3 scripts/release/bill.py "$stage"

# Files of an earlier run are those that its SHA256SUMS lists.
if [[ -e $out/SHA256SUMS ]]; then
  (cd "$out" && sha256sum --check --quiet SHA256SUMS >/dev/null 2>&1) || { echo "release: $out: files differ from its SHA256SUMS, so they stay. The packages lie in $stage" >&2; exit 1; }
  (cd "$out" && cut -c 67- SHA256SUMS | xargs -d '\n' rm -f -- && rm SHA256SUMS)
fi
for file in $(files_in "$stage"); do
  [[ ! -e $out/$file ]] || { echo "release: $out/$file is from elsewhere, so it stays. The packages lie in $stage" >&2; exit 1; }
done
cp -r "$stage"/. "$out/"

names=$(printf '%s\n' "${!made[@]}" | sort)
for name in $names; do
  [[ -n ${made[$name]} ]] || continue
  tried[$name]="not tried"
  if [[ -n $trials && -x scripts/release/try/$name.sh ]]; then
    step "try $name" "scripts/release/try/$name.sh" "$out"
    tried[$name]=${result/done/tried}
  fi
done

echo
printf '%-62s %10s  %s\n' package bytes trial
for name in $names; do
  [[ -n ${made[$name]} ]] || printf '%-62s %10s  %s\n' "($name)" - "${tried[$name]}"
  for file in ${made[$name]}; do
    printf '%-62s %10d  %s\n' "$file" "$(stat -c %s "$out/$file")" "${tried[$name]}"
  done
done
echo "$out: $(files_in "$stage" | wc -l) files after $SECONDS s"
[[ -z $failed ]]
