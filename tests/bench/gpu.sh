#!/usr/bin/env bash
# Everything that only a GPU can show, on a machine that has one: the kernels' tests, compute-sanitizer's four tools, goal
# P5 and the paper's Figure 16. Under ten minutes, building included. Results go to out/gpu; docs/gpu.md says what was
# reached.
#   tests/bench/gpu.sh [DATA [BIN]]
# DATA: a folder that spherechain_gpu_data wrote on a machine with the baker's packages; without it, it is made here.
# BIN: a folder with the four programs below, built elsewhere; without it they are built here, for this machine's GPU.
# Building needs a CUDA toolkit, CMake, Ninja and, of scripts/packages.txt, those under "asset" and "runtime", doctest, CLI11
# and nlohmann-json.
set -euo pipefail
cd "$(dirname "$0")/../.."

data=${1:-out/gpu_data}
bin=${2:-build/gpu/bin}
out=out/gpu
programs=(test_cuda_emulated test_cuda_device spherechain_bench_gpu spherechain_figure16)
mkdir -p "$out"

if [[ $# -lt 2 ]]; then
  baker=OFF
  if [[ ! -e $data/human.poses ]]; then
    baker=ON
    programs+=(spherechain_gpu_data)
  fi
  cmake -S . -B build/gpu -G Ninja -DCMAKE_BUILD_TYPE=Release -DSPHERECHAIN_CUDA=ON -DSPHERECHAIN_VIEWER=OFF \
    -DCMAKE_CUDA_ARCHITECTURES="${SPHERECHAIN_CUDA_ARCHITECTURES:-native}" -DSPHERECHAIN_BAKER=$baker >"$out/configure.txt"
  cmake --build build/gpu --target "${programs[@]}"
  if [[ $baker == ON ]]; then
    "$bin/spherechain_gpu_data" -o "$data"
  fi
fi

{
  date -u
  nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader
  echo "registers, stack and shared memory of the crowd's kernels:"
  cuobjdump --dump-resource-usage "$bin/spherechain_bench_gpu" 2>/dev/null | grep -A1 run_crowd || echo "  no cuobjdump here"
} | tee "$out/machine.txt"

echo "== the kernels' tests, on the CPU and on the device"
"$bin/test_cuda_emulated"
"$bin/test_cuda_device"
for tool in memcheck racecheck initcheck synccheck; do
  echo "== compute-sanitizer $tool"
  compute-sanitizer --tool "$tool" --error-exitcode 9 "$bin/test_cuda_device" -tce="*square root*" >"$out/$tool.txt" 2>&1 ||
    { tail -20 "$out/$tool.txt"; exit 1; }
  tail -1 "$out/$tool.txt"
done

echo "== goal P5"
"$bin/spherechain_bench_gpu" "$data" | tee "$out/crowd.txt"
echo "== the paper's Figure 16"
"$bin/spherechain_figure16" --data "$data" --json "$out/figure16.json" | tee "$out/figure16.txt"
