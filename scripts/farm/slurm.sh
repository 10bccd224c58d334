#!/usr/bin/env bash
# A library on a Slurm cluster: slurm.sh LIBRARY SHARDS OUT [OPTION...]. OUT is on a file system that all nodes share.
set -euo pipefail
library=$1 shards=$2 out=$3
shift 3
mkdir -p "$out"
array=$(sbatch --parsable --array="1-$shards" --requeue --output="$out/%a.log" --wrap \
  "spherechain check '$library' --shard \$SLURM_ARRAY_TASK_ID/$shards -o '$out/'\$SLURM_ARRAY_TASK_ID --cache '$out/cache' --jobs \${SLURM_CPUS_PER_TASK:-1} $*")
sbatch --dependency="afterok:$array" --output="$out/merge.log" --wrap \
  "spherechain check --merge $(seq -f "'$out/%g'" -s ' ' "$shards") -o '$out/report' --json '$out/check.json'"
