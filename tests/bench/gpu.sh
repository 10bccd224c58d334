#!/usr/bin/env bash
# Everything that only a GPU can show, on a machine that has one: the kernels' tests, goal P5 with large assets,
# the paper's Figure 16, and compute-sanitizer's four tools. Under ten minutes, building included; the figures come first,
# for the tools take longest. Stops at the first thing wrong, and says what that was. Results go to out/gpu (or $OUT);
# docs/gpu.md says what was reached.
#   tests/bench/gpu.sh [DATA [BIN]]
# DATA: a folder that spherechain_gpu_data wrote on a machine with the baker's packages; without it, it is made here.
# BIN: a folder with the programs below, built elsewhere; without it they are built here, for this machine's GPU.
# Building needs a CUDA toolkit, CMake, Ninja and, of scripts/packages.txt, those under "asset" and "runtime", doctest, CLI11
# and nlohmann-json.
set -euo pipefail
cd "$(dirname "$0")/../.."

data=${1:-out/gpu_data}
bin=${2:-build/gpu/bin}
out=${OUT:-out/gpu}
programs=(test_cuda_emulated test_cuda_host test_cuda_device spherechain_bench_gpu spherechain_figure16)
mkdir -p "$out"
PATH=$PATH:/usr/local/cuda/bin

now="nothing yet"
step() {
  now=$*
  echo "== $now (after $SECONDS s)"
}
trap 'status=$?; [[ $status == 0 ]] || echo "gpu.sh: STOPPED, exit $status: $now" >&2' EXIT

if [[ $# -lt 2 ]]; then
  baker=OFF
  if [[ ! -e $data/human.poses ]]; then
    baker=ON
    programs+=(spherechain_gpu_data)
  fi
  step "building, what it says in $out/build.txt"
  cmake -S . -B build/gpu -G Ninja -DCMAKE_BUILD_TYPE=Release -DSPHERECHAIN_CUDA=ON -DSPHERECHAIN_VIEWER=OFF \
    -DCMAKE_CUDA_ARCHITECTURES="${SPHERECHAIN_CUDA_ARCHITECTURES:-native}" -DSPHERECHAIN_BAKER=$baker >"$out/build.txt" 2>&1 ||
    { tail -20 "$out/build.txt"; exit 1; }
  cmake --build build/gpu --target "${programs[@]}" >>"$out/build.txt" 2>&1 || { tail -40 "$out/build.txt"; exit 1; }
  if [[ $baker == ON ]]; then
    step "characters and poses, to $data"
    "$bin/spherechain_gpu_data" -o "$data"
  fi
fi

step "the machine"
{
  date -u
  nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader || echo "  no nvidia-smi here"
  echo "registers, stack and shared memory of the crowd's kernels:"
  cuobjdump --dump-resource-usage "$bin/spherechain_bench_gpu" 2>/dev/null | grep -A1 run_ || echo "  no cuobjdump here"
} | tee "$out/machine.txt"

step "the kernels' tests, on the CPU and on the device"
"$bin/test_cuda_emulated" | tee "$out/tests.txt"
"$bin/test_cuda_host" | tee -a "$out/tests.txt"
"$bin/test_cuda_device" | tee -a "$out/tests.txt"

step "goal P5"
"$bin/spherechain_bench_gpu" "$data" | tee "$out/crowd.txt"
step "the paper's Figure 16"
"$bin/spherechain_figure16" --data "$data" --json "$out/figure16.json" | tee "$out/figure16.txt"

# All cases but the square root of every float, which is none of theirs.
for tool in memcheck synccheck initcheck racecheck; do
  step "compute-sanitizer $tool"
  timeout "${SANITIZER_SECONDS:-100}" compute-sanitizer --tool "$tool" --error-exitcode 9 "$bin/test_cuda_device" "-tce=*square root*" \
    >"$out/$tool.txt" 2>&1 || { status=$?; tail -20 "$out/$tool.txt"; exit "$status"; }
  grep "test cases" "$out/$tool.txt"
  tail -1 "$out/$tool.txt"
  grep -q "test cases: *[1-9]" "$out/$tool.txt" || { echo "no case ran"; exit 1; }
  grep -qE "SUMMARY: 0 (errors|hazards displayed)" "$out/$tool.txt" || { echo "something was found, of whatever level"; exit 1; }
done
step "done: nothing wrong"
