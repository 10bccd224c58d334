#!/usr/bin/env bash
# Everything that only a GPU can show, on a machine that has one: the kernels' tests, compute-sanitizer's four tools, goal
# P5 and the paper's Figure 16. Under ten minutes, building included. Results go to out/gpu; docs/gpu.md says what was
# reached.
#   tests/bench/gpu.sh [DATA]
# DATA is a folder that spherechain_gpu_data wrote on a machine with the baker's packages; without it, it is made here.
# Needs a CUDA toolkit, CMake, Ninja and the packages under "asset" and "runtime" of scripts/packages.txt, doctest, CLI11 and
# nlohmann-json.
set -euo pipefail
cd "$(dirname "$0")/../.."

data=${1:-out/gpu_data}
build=build/gpu
out=out/gpu
mkdir -p "$out"
baker=OFF
if [[ ! -e $data/human.poses ]]; then
  baker=ON
fi
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSPHERECHAIN_CUDA=ON \
  -DCMAKE_CUDA_ARCHITECTURES="${SPHERECHAIN_CUDA_ARCHITECTURES:-native}" -DSPHERECHAIN_BAKER=$baker -DSPHERECHAIN_VIEWER=OFF >"$out/configure.log"
targets=(test_cuda_emulated test_cuda_device spherechain_bench_gpu spherechain_figure16)
if [[ $baker == ON ]]; then
  targets+=(spherechain_gpu_data)
fi
cmake --build "$build" --target "${targets[@]}"
if [[ $baker == ON ]]; then
  "$build/bin/spherechain_gpu_data" -o "$data"
fi

{
  nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader
  nvcc --version | tail -2
  echo "== kernels: registers, stack and shared memory beyond what a launch asks for"
  cuobjdump --dump-resource-usage "$build/bin/spherechain_bench_gpu" 2>/dev/null | grep -A1 run_crowd || echo "no cuobjdump"
} | tee "$out/machine.txt"

echo "== the kernels' tests, on the CPU and on the device"
"$build/bin/test_cuda_emulated"
"$build/bin/test_cuda_device"
for tool in memcheck racecheck initcheck synccheck; do
  echo "== compute-sanitizer $tool"
  compute-sanitizer --tool "$tool" --error-exitcode 9 "$build/bin/test_cuda_device" \
    -tce="*square root*,*is filled*,*refused*" >"$out/$tool.txt" 2>&1 || { tail -20 "$out/$tool.txt"; exit 1; }
  tail -1 "$out/$tool.txt"
done

echo "== goal P5"
"$build/bin/spherechain_bench_gpu" "$data" | tee "$out/crowd.txt"
echo "== the paper's Figure 16"
"$build/bin/spherechain_figure16" --data "$data" --json "$out/figure16.json" | tee "$out/figure16.txt"
