// SPDX-License-Identifier: MIT
// Goal P5: crowds on the GPU, against the CPU, a neighbour's mapping and what the device can do at most. One command,
// one table: spherechain_bench_gpu FOLDER, a folder that spherechain_gpu_data wrote. Every figure is of one run, passes
// in random order, pairs and spheres compared with the CPU's first.
#include <algorithm>
#include <atomic>
#include <set>
#include <string>
#include <thread>

#include "ceilings.h"
#include "check_crowds.h"
#include "contestants.h"
#include "device_crowd.h"
#include "further_modes.h"
#include "runtime/src/base/pair_bits.h"
#include "spherechain/cuda.h"

namespace {

using namespace spherechain;
using namespace spherechain::bench;

// Bones in, counts and bits out, on the CPU. Nanoseconds an instance.
class HostCrowd {
 public:
  HostCrowd(const PosedAsset& posed, std::size_t instances, std::size_t threads)
      : threads_(threads), scratch_(sc_crowd_scratch_words(&posed.asset, 4 * threads)) {
    const std::size_t size = posed.poses.bone_count * kMatrixFloats;
    matrices_.resize(instances * size);
    for (std::size_t i = 0; i < instances; ++i) {
      std::copy_n(posed.poses.matrices_of(i % posed.poses.pose_count), size, &matrices_[i * size]);
    }
    counts_.resize(instances);
    bits_.resize(instances * sc_pair_words(&posed.asset));
    job_.asset = &posed.asset;
    job_.pose.bones = matrices_.data();
    job_.pose.bone_count = posed.poses.bone_count;
    job_.pose.bone_layout = SC_ROWS_3X4;
    job_.scratch = scratch_.data();
    job_.scratch_words = scratch_.size();
    job_.task_count = 4 * threads;
    job_.parallel_for = run_on_threads;
    job_.user = &threads_;
    job_.counts = counts_.data();
    job_.bits = bits_.data();
  }

  double time(std::size_t instances) {
    job_.instance_count = instances;
    job_.count_capacity = instances;
    job_.bit_words = instances * (bits_.size() / counts_.size());
    const double begin = seconds();
    if (job_.run() != SC_OK) {
      std::exit(1);
    }
    return (seconds() - begin) * 1e9 / static_cast<double>(instances);
  }

 private:
  static void run_on_threads(void* user, std::size_t count, void (*task)(void*, std::size_t), void* data) {
    const std::size_t threads = *static_cast<std::size_t*>(user);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t i = next++; i < count; i = next++) {
        task(data, i);
      }
    };
    std::vector<std::thread> others;
    for (std::size_t t = 1; t < threads; ++t) {
      others.emplace_back(work);
    }
    work();
    for (std::thread& other : others) {
      other.join();
    }
  }

  std::size_t threads_;
  std::vector<std::uint64_t> scratch_, bits_;
  std::vector<float> matrices_;
  std::vector<std::uint32_t> counts_;
  CrowdJob job_;
};

Ceilings measure_ceilings(int multiprocessors) {
  constexpr std::size_t kBytes = std::size_t{1} << 31;
  DeviceArray<char> from(kBytes), to(kBytes);
  DeviceArray<float> sink(1);
  DeviceClock clock;
  Times copy, multiply;
  double operations = 0;
  for (int pass = 0; pass < 9; ++pass) {
    clock.start();
    must(cudaMemcpyAsync(to.data(), from.data(), kBytes, cudaMemcpyDeviceToDevice));
    copy.add(clock.stop());
    clock.start();
    operations = enqueue_multiply_adds(multiprocessors, sink.data());
    must(cudaGetLastError());
    multiply.add(clock.stop());
  }
  return {2.0 * kBytes / copy.least() * 1e3, operations / multiply.least() * 1e3};
}

// A character's, where nothing is worked out twice. By moments: a Gram matrix for each pair of bones, of which a sphere
// takes sixteen figures, and its centre.
std::size_t refit_multiply_adds(const AssetView& asset) {
  const MomentTables& tables = asset.moment_tables();
  std::set<std::pair<std::uint16_t, std::uint16_t>> pairs;
  for (const BonePair& pair : tables.pairs) {
    pairs.emplace(pair.a, pair.b);
  }
  return pairs.size() * 48 + tables.moments.size * 16 + tables.bones.size * 12;
}

// Does the goal's line, and says so.
void check_limit(const char* what, double value, const char* unit, bool is_met, const char* goal) {
  std::printf("  P5 %-58s %8.2f %s  goal: %s  %s\n", what, value, unit, goal, is_met ? "met" : "MISSED");
}

bool bench_character(const std::string& folder, const std::string& name, const Ceilings& ceilings, bool has_goals) {
  PosedAsset posed;
  std::string error;
  if (!read_posed_asset(folder, name, posed, error)) {
    std::fprintf(stderr, "spherechain_bench_gpu: %s\n", error.c_str());
    std::exit(3);
  }
  const Reference reference = reference_of(posed, SC_RADIUS_DETECT);
  DeviceCrowd crowd(posed, reference, SC_RADIUS_DETECT, kInstances);
  const AssetView& asset = posed.view();
  const std::size_t n = asset.spheres().size;

  std::vector<IndexPair> wanted;
  for (std::size_t b = 1; b < n; ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!test_bit(asset.ignored(), ignored_bit(a, b))) {
        wanted.push_back({static_cast<std::int16_t>(a), static_cast<std::int16_t>(b)});
      }
    }
  }
  const DeviceArray<IndexPair> pairs(wanted);
  const DeviceArray<Deepest> deepest(kInstances);

  using Crowd = DeviceCrowd;
  std::vector<Contestant> all;
  const auto add = [&](const char* text, bool from_bones, unsigned outputs) {
    all.push_back({text,
                   [&crowd, from_bones, outputs] { crowd.enqueue(from_bones, outputs, kInstances); },
                   static_cast<double>(crowd.bytes_moved(from_bones, outputs)),
                   {}});
    return crowd.runs_right(from_bones, outputs);
  };
  bool is_right = add("bones in, counts and bits out", true, Crowd::kCounts | Crowd::kBits);
  is_right &= add("bones in, counts out", true, Crowd::kCounts);
  is_right &= add("bones in, counts and list out", true, Crowd::kCounts | Crowd::kList);
  is_right &= add("bones in, counts, bits, spheres out", true, Crowd::kCounts | Crowd::kBits | Crowd::kSpheres);
  is_right &= add("spheres in, counts and bits out", false, Crowd::kCounts | Crowd::kBits);
  is_right &= add("spheres in, counts out", false, Crowd::kCounts);
  all.push_back({"spheres in, deepest pair out: a block a character",
                 [&] {
                   enqueue_block_a_character(crowd.spheres(), n, kInstances, pairs.data(), wanted.size(),
                                             deepest.data());
                   must(cudaGetLastError());
                 },
                 static_cast<double>(n * sizeof(Sphere) + sizeof(Deepest)),
                 {}});
  if (!is_right) {
    return false;
  }

  measure(all, kInstances);
  std::printf(
      "\n%s: %zu spheres, %zu bones, %zu pairs tested (%zu of them rest pairs), %zu characters in 1,024 poses\n",
      name.c_str(), n, asset.bone_count(), wanted.size(), asset.rest_pairs(SC_RADIUS_DETECT).size, kInstances);
  print_table(all, static_cast<double>(wanted.size()), ceilings);
  const double fused = all[0].times.median(), detect = all[4].times.median(), counts = all[5].times.median(),
               block = all[6].times.median();
  const auto least_operations = static_cast<double>(refit_multiply_adds(asset) + wanted.size() * 4);
  std::printf(
      "  multiply-adds of refit and pair tests alone: %.0f a character, %.3f ns at the device's ceiling (%.0f %% of "
      "the fused time)\n",
      least_operations, least_operations / ceilings.multiply_adds_a_second * 1e9,
      100 * least_operations / ceilings.multiply_adds_a_second * 1e9 / fused);
  if (has_goals) {
    check_limit("bones in, pairs out, fused", fused, "ns", fused <= 3, "at most 3");
    check_limit("spheres in, pairs out", detect, "ns", detect <= 1.5, "at most 1.5");
    check_limit("a block a character (cuRobo's mapping) over counts out", block / counts, "x ", block / counts >= 5,
                "at least 5");
    std::printf("     ... over counts and bits out, which that has not %16.2f x\n", block / detect);
  }

  DeviceClock clock;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  HostCrowd one_core(posed, 16384, 1), all_cores(posed, 16384, cores);
  Times one, many;
  for (int pass = 0; pass < 7; ++pass) {
    one.add(one_core.time(16384));
    many.add(all_cores.time(16384));
  }
  std::printf(
      "  the CPU's crowd job (%s), counts and bits: 1 core %.0f ns, %zu threads %.1f ns a character: %.0f and %.0f "
      "times the GPU's\n",
      sc_target_name(*sc_supported_targets(nullptr)), one.median(), cores, many.median(), one.median() / fused,
      many.median() / fused);

  std::printf("  %-12s %14s %24s %14s %14s   us a call, bones in, counts and bits out\n", "characters", "GPU, events",
              "GPU, launch to finish", "1 core", "all cores");
  for (std::size_t count = 1; count <= kInstances; count *= 4) {
    Times device, host, single, multiple;
    for (int pass = 0; pass < 21; ++pass) {
      clock.start();
      crowd.enqueue(true, Crowd::kCounts | Crowd::kBits, count);
      device.add(clock.stop() * 1e3);
      const double begin = seconds();
      crowd.enqueue(true, Crowd::kCounts | Crowd::kBits, count);
      must(cudaDeviceSynchronize());
      host.add((seconds() - begin) * 1e6);
      if (count <= 16384 && pass < 7) {
        single.add(one_core.time(count) * static_cast<double>(count) / 1e3);
        multiple.add(all_cores.time(count) * static_cast<double>(count) / 1e3);
      }
    }
    std::printf("  %-12zu %14.1f %24.1f", count, device.median(), host.median());
    if (!single.values.empty()) {
      std::printf(" %14.1f %14.1f", single.median(), multiple.median());
    }
    std::printf("\n");
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: spherechain_bench_gpu FOLDER (that spherechain_gpu_data wrote)\n");
    return 2;
  }
  if (cuda::check_device() != SC_OK) {
    std::fprintf(stderr, "spherechain_bench_gpu: no CUDA device: %s\n", cuda::last_device_error());
    return 1;
  }
  const std::vector<std::string> names = characters_in(argv[1]);
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (!has("human") || !has("body")) {
    std::fprintf(stderr,
                 "spherechain_bench_gpu: %s: has no human.poses and body.poses (spherechain_gpu_data -o FOLDER)\n",
                 argv[1]);
    return 3;
  }
  cudaDeviceProp properties{};
  must(cudaGetDeviceProperties(&properties, 0));
  int driver = 0;
  must(cudaDriverGetVersion(&driver));
  std::printf("%s, %d multiprocessors, CUDA driver %d.%d\n", properties.name, properties.multiProcessorCount,
              driver / 1000, driver % 1000 / 10);
  if (!check_crowds(names, argv[1])) {
    std::fprintf(stderr, "spherechain_bench_gpu: the GPU's results differ from the CPU's\n");
    return 1;
  }
  const Ceilings ceilings = measure_ceilings(properties.multiProcessorCount);
  std::printf("\nceilings: copy %.2f TB/s (read and written), %.1f T multiply-adds/s\n", ceilings.bytes_a_second / 1e12,
              ceilings.multiply_adds_a_second / 1e12);
  const bool is_right = bench_character(argv[1], "human", ceilings, true) &&
                        bench_character(argv[1], "body", ceilings, true) &&
                        bench_large(argv[1], "human", 14, ceilings) && bench_large(argv[1], "human", 4, ceilings);
  if (!is_right) {
    std::fprintf(stderr, "spherechain_bench_gpu: the GPU's results differ from the CPU's\n");
  }
  return is_right ? 0 : 1;
}
