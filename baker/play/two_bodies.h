// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "play/asset_file.h"
#include "spherechain/bodies.h"

namespace spherechain::baker {

// The runtime's exact contacts of two bodies, pose after pose, and what they measure. Both assets must have clusters.
class TwoBodies {
 public:
  TwoBodies(const OpenAsset& a, const OpenAsset& b, Target target);

  // Triangles of a's and of b's that intersect: source numbers. The list holds until the next call.
  const std::vector<TriangleContact>& find(const sc_pose& a, const sc_pose& b);
  // What find() found in those poses. `is_next`: they follow those measured last.
  const std::vector<Penetration>& measure(const sc_pose& a, const sc_pose& b, bool is_next);

 private:
  // With what both jobs have.
  template <typename Job>
  Job job(const sc_pose& a, const sc_pose& b);

  const OpenAsset &a_, &b_;
  Target target_;
  std::vector<std::uint64_t> scratch_;
  std::vector<TriangleContact> contacts_;
  std::vector<Penetration> penetrations_, before_;
  std::size_t part_count_ = 0;
};

}  // namespace spherechain::baker
