// SPDX-License-Identifier: MIT
#include "check_crowds.h"

#include <algorithm>
#include <filesystem>

#include "device_crowd.h"

namespace spherechain::bench {
namespace {

const char* name_of(CrowdKind kind) {
  return kind == CrowdKind::kFit ? "fit" : kind == CrowdKind::kDetect ? "detect" : "cover";
}

}  // namespace

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
  std::printf("%-24s %6s %8s %8s %10s  against the CPU: spheres or balls, counts, bits, list\n", "character", "poses",
              "spheres", "radius", "pairs");
  for (const std::string& name : names) {
    PosedAsset posed;
    std::string error;
    if (!read_posed_asset(folder, name, posed, error)) {
      std::fprintf(stderr, "spherechain_bench_gpu: %s\n", error.c_str());
      std::exit(3);
    }
    if (posed.poses.pose_count == 0) {
      continue;
    }
    for (const CrowdKind kind : {CrowdKind::kFit, CrowdKind::kDetect, CrowdKind::kCovers}) {
      if (kind == CrowdKind::kCovers && posed.asset.leaf_count() == 0) {
        continue;
      }
      const Reference reference = reference_of(posed, kind);
      DeviceCrowd crowd(posed, reference, kind, posed.poses.pose_count);
      const unsigned outputs = DeviceCrowd::kCounts | DeviceCrowd::kBits | DeviceCrowd::kBounds |
                               (kind == CrowdKind::kCovers ? DeviceCrowd::kLeaves : DeviceCrowd::kList);
      bool is_right = crowd.runs_right(true, outputs | DeviceCrowd::kSpheres);
      if (kind != CrowdKind::kCovers) {
        is_right &= crowd.runs_right(false, outputs);
      }
      std::size_t pairs = 0;
      for (const std::uint32_t count : reference.counts) {
        pairs += count;
      }
      std::printf("%-24s %6zu %8zu %8s %10zu  %s\n", name.c_str(), posed.poses.pose_count, posed.asset.spheres().size,
                  name_of(kind), pairs, is_right ? "equal, bit for bit" : "DIFFERENT");
      all_right &= is_right;
    }
  }
  return all_right;
}

}  // namespace spherechain::bench
