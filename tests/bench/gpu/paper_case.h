// SPDX-License-Identifier: MIT
// A character of Figure 16 in its two animations, and what a CPU finds in them and takes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "paper_threads.h"
#include "posed_asset.h"
#include "runtime/src/base/filter.h"
#include "split_spheres.h"

namespace spherechain::bench {

struct PaperAnimation {
  std::string name;
  std::vector<std::vector<Sphere>> frames;  // with fit radii
};

struct PaperCase {
  // NAME_arms and NAME_legs of `folder`; each sphere in `parts`. Throws std::runtime_error.
  PaperCase(const std::string& folder, const std::string& name, std::uint32_t parts);
  PaperCase(const PaperCase&) = delete;  // its tables point into it
  PaperCase& operator=(const PaperCase&) = delete;

  const Asset& asset() const { return split ? split->asset() : whole.asset; }
  const AssetView& view() const { return view_of(asset()); }

  std::string name;
  std::uint32_t parts;
  PosedAsset whole;
  std::unique_ptr<SplitAsset> split;  // null for one part
  std::vector<PaperAnimation> animations;
  std::unique_ptr<cuda_paper::Tables> tables;
};

// On one core: M1 by the paper's threads one after the other, M2 by sc_detect(), scalar.
enum class CpuMethod { kM1, kM2 };

// M1's overlaps, sorted, as they follow from M2's: each as often as there are chains that hold both spheres.
std::vector<ChainPair> chain_pairs_of(const AssetView& asset, const std::vector<ChainPair>& m2);

class CpuRunner {
 public:
  explicit CpuRunner(const PaperCase& paper_case);

  // Sorted by chain, then pair; M2's as of chain 0. Throws std::runtime_error where detection fails.
  std::vector<ChainPair> pairs(CpuMethod method, const std::vector<Sphere>& spheres);
  // Microseconds, detection alone. After pairs() of that method and at least as many pairs.
  double time(CpuMethod method, const std::vector<Sphere>& spheres);

 private:
  void run(CpuMethod method, const std::vector<Sphere>& spheres);

  const PaperCase& case_;
  std::vector<Pair> pairs_;             // M2's
  std::vector<ChainPair> chain_pairs_;  // M1's
  std::uint32_t found_ = 0;
};

}  // namespace spherechain::bench
