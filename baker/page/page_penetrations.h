// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "baker/page/base64.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Lists of a frame each, one after another: all entries, and how many each frame has.
template <typename T>
class FrameLists {
 public:
  void add(const std::vector<T>& list) {
    counts_.push_back(static_cast<std::uint32_t>(list.size()));
    entries_.insert(entries_.end(), list.begin(), list.end());
  }
  nlohmann::ordered_json json() const { return {{"counts", base64(counts_)}, {"entries", base64(entries_)}}; }
  std::size_t bytes() const { return entries_.size() * sizeof(T); }

 private:
  std::vector<std::uint32_t> counts_;
  std::vector<T> entries_;
};

// The part that goes in, the other one, class, depth in mm, direction out, the deepest point of the part, the share
// that is visible or -1, volume in ml or -1, the share that is inside, 1 where it comes out again.
using PenetrationEntry = std::array<float, 14>;
inline std::vector<PenetrationEntry> entries_of(const std::vector<Penetration>& penetrations, double mm) {
  std::vector<PenetrationEntry> out;
  for (const Penetration& p : penetrations) {
    const double ml = p.measures.volume >= 0 ? std::pow(mm / 10, 3) * double{p.measures.volume} : -1;
    const spherechain::Vec3 &d = p.direction, &at = p.deepest.position;
    out.push_back({static_cast<float>(p.part), static_cast<float>(p.other), static_cast<float>(p.kind),
                   static_cast<float>(mm * double{p.measures.depth}), d.x, d.y, d.z, at.x, at.y, at.z,
                   p.measures.visible, static_cast<float>(ml), p.measures.swallowed,
                   static_cast<float>(p.measures.through)});
  }
  return out;
}

}  // namespace spherechain::baker
