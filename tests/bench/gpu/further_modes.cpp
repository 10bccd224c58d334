// SPDX-License-Identifier: MIT
#include "further_modes.h"

#include "device_crowd.h"
#include "split_spheres.h"

namespace spherechain::bench {
namespace {

PosedAsset read(const std::string& folder, const std::string& name) {
  PosedAsset posed;
  std::string error;
  if (!read_posed_asset(folder, name, posed, error)) {
    std::fprintf(stderr, "spherechain_bench_gpu: %s\n", error.c_str());
    std::exit(3);
  }
  return posed;
}

// A launch that is checked now and measured later.
bool add(DeviceCrowd& crowd, const char* text, bool from_bones, unsigned outputs, std::size_t instances,
         std::vector<Contestant>& all) {
  all.push_back({text,
                 [&crowd, from_bones, outputs, instances] { crowd.enqueue(from_bones, outputs, instances); },
                 static_cast<double>(crowd.bytes_moved(from_bones, outputs)),
                 {}});
  return crowd.runs_right(from_bones, outputs);
}

double pairs_tested(const AssetView& asset) {
  const std::size_t n = asset.spheres().size;
  return static_cast<double>(n * (n - 1) / 2 - asset.ignored_count());
}

double mean_count(const Reference& reference) {
  double sum = 0;
  for (const std::uint32_t count : reference.counts) {
    sum += count;
  }
  return sum / static_cast<double>(reference.counts.size());
}

}  // namespace

bool bench_large(const std::string& folder, const std::string& name, std::uint32_t parts, const Ceilings& ceilings) {
  constexpr std::size_t kLarge = 4096, kPoses = 64;
  const PosedAsset whole = read(folder, name);
  const Reference reference_of_whole = reference_of(whole, SC_RADIUS_FIT);
  const SplitAsset split(whole.asset, parts);
  PosedAsset posed;
  posed.asset = split.asset();
  posed.poses.pose_count = std::min(kPoses, whole.poses.pose_count);
  Reference reference;
  for (std::size_t i = 0; i < posed.poses.pose_count; ++i) {
    const auto first =
        reference_of_whole.spheres.begin() +
        static_cast<std::ptrdiff_t>(i * whole.poses.pose_count / posed.poses.pose_count * whole.view().spheres().size);
    const std::vector<Sphere> spheres =
        split.split({first, first + static_cast<std::ptrdiff_t>(whole.view().spheres().size)});
    reference.spheres.insert(reference.spheres.end(), spheres.begin(), spheres.end());
  }
  const double begin = seconds();
  detect(posed, SC_RADIUS_FIT, reference);
  const double cpu = (seconds() - begin) * 1e9 / static_cast<double>(posed.poses.pose_count);
  DeviceCrowd crowd(posed, reference, SC_RADIUS_FIT, kLarge);
  std::vector<Contestant> all;
  if (!add(crowd, "large: spheres in, counts out", false, DeviceCrowd::kCounts, kLarge, all) ||
      !add(crowd, "large: spheres in, counts and bits out", false, DeviceCrowd::kCounts | DeviceCrowd::kBits, kLarge,
           all)) {
    return false;
  }
  measure(all, kLarge);
  std::printf("\n%s in parts: %zu spheres, %.1f pairs, %zu characters, blocks of %.1f MB in ", name.c_str(),
              posed.view().spheres().size, mean_count(reference), kLarge,
              static_cast<double>(crowd.block_bytes()) / 1e6);
  if (crowd.scratch_blocks() == 0) {
    std::printf("shared memory\n");
  } else {
    std::printf("scratch, %zu at once\n", crowd.scratch_blocks());
  }
  print_table(all, pairs_tested(posed.view()), ceilings);
  std::printf("  the CPU, 1 core: %.0f ns a character\n", cpu);
  return true;
}

}  // namespace spherechain::bench
