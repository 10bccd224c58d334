// SPDX-License-Identifier: MIT
#include "check_crowds.h"

#include <algorithm>
#include <filesystem>

#include "device_crowd.h"

namespace spherechain::bench {
std::vector<std::string> characters_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    if (entry.path().extension() == ".poses") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool check_crowds(const std::vector<std::string>& names, const std::string& folder) {
  bool all_right = true;
  std::printf("%-24s %6s %8s %8s %10s  against the CPU: spheres, counts, bits, list\n", "character", "poses", "spheres",
              "radius", "pairs");
  for (const std::string& name : names) {
    PosedAsset posed;
    std::string error;
    if (!read_posed_asset(folder, name, posed, error)) {
      std::fprintf(stderr, "spherechain_bench_gpu: %s\n", error.c_str());
      std::exit(3);
    }
    if (posed.poses.pose_count == 0 || posed.view().refit_rule() != RefitRule::kMoments) {
      continue;
    }
    for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
      const Reference reference = reference_of(posed, radius);
      DeviceCrowd crowd(posed, reference, radius, posed.poses.pose_count);
      constexpr unsigned kOutputs = DeviceCrowd::kCounts | DeviceCrowd::kBits | DeviceCrowd::kList;
      bool is_right = crowd.runs_right(true, kOutputs | DeviceCrowd::kSpheres);
      is_right &= crowd.runs_right(false, kOutputs);
      std::size_t pairs = 0;
      for (const std::uint32_t count : reference.counts) {
        pairs += count;
      }
      std::printf("%-24s %6zu %8zu %8s %10zu  %s\n", name.c_str(), posed.poses.pose_count, posed.view().spheres().size,
                  radius == SC_RADIUS_FIT ? "fit" : "detect", pairs, is_right ? "equal, bit for bit" : "DIFFERENT");
      all_right &= is_right;
    }
  }
  return all_right;
}

}  // namespace spherechain::bench
