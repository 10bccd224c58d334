// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "baker/play/asset_file.h"
#include "baker/play/skin_player.h"

namespace spherechain::baker {

// The pairs of spheres that touch in a frame, how many were tested, and the time that it took.
struct Detection {
  std::size_t tests, pairs;
  double us;  // median of a few runs
};

// The runtime's refit of the whole asset.
std::vector<Sphere> refit_spheres(const OpenAsset& asset, const std::vector<float>& positions, Radius radius);

struct FrameResult {
  double refit_us = 0;
  Detection all_pairs{};
};

// The runtime as a game uses it: buffers made once, then a refit and a detection a frame.
class Player {
 public:
  Player(const OpenAsset& asset, Radius radius, Target target);

  // `positions` are the deformed source vertices.
  FrameResult run(const std::vector<float>& positions);

  // Takes a frame that was computed elsewhere as its last one. Returns its detection, with `us` as given.
  Detection take(std::vector<Sphere> spheres, const std::vector<Pair>& pairs, double us);

  // Skin contacts: triangles that intersect, by their numbers in the source, and what finding them costs. The asset
  // must have clusters.
  struct TriangleDetection {
    std::vector<Pair> pairs;
    double us;                              // median of a few runs
    std::vector<Penetration> penetrations;  // deepest first
    double measure_us;                      // time to measure them
  };
  // `is_next`: this pose follows the last one in its clip, and directions may follow that one's.
  TriangleDetection detect_triangles(const sc_pose& pose, bool is_next);
  // The spheres that these triangles belong to: pairs a < b, sorted.
  std::vector<Pair> spheres_of(const std::vector<Pair>& triangles) const;

  // The last frame's refitted spheres, and their pairs that touch.
  const std::vector<Sphere>& spheres() const { return spheres_; }
  Span<const Pair> pairs() const { return {pairs_.data(), pair_count_}; }

 private:
  Detection detect();

  const OpenAsset& asset_;
  Radius radius_;
  Target target_;
  SkinPlayer skin_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::unordered_map<std::uint32_t, std::uint32_t> sphere_of_;  // a source triangle -> its sphere
  std::size_t pair_count_ = 0;
};

}  // namespace spherechain::baker
