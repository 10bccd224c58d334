#!/usr/bin/env bash
# A library on some machines by GNU parallel: parallel.sh LIBRARY SHARDS OUT [OPTION...]. HOSTS names the machines
# ("a,b,c", with the tool, the library and OUT in common); without it this one does all.
set -euo pipefail
library=$1 shards=$2 out=$3
shift 3
mkdir -p "$out"
parallel ${HOSTS:+-S "$HOSTS"} --retries 3 --joblog "$out/jobs.log" \
  spherechain check "$library" --shard "{}/$shards" -o "$out/{}" --cache "$out/cache" --jobs 1 "$@" ::: $(seq "$shards")
spherechain check --merge $(seq -f "$out/%g" "$shards") -o "$out/report" --json "$out/check.json"
