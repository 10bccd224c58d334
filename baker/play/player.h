// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "play/asset_file.h"
#include "play/skin_player.h"

namespace spherechain::baker {

// The paper's two methods: chain by chain, and over all pairs, which is the product's.
enum class Method { kChains, kAllPairs };

// Result and cost of one method in a frame.
struct Detection {
  std::size_t tests, pairs, raw_pairs;  // pairs: each once; raw_pairs: with the repeats of pairs in several chains
  double us;                            // median of a few runs
};

// The runtime's refit of the whole asset.
std::vector<Sphere> refit_spheres(const OpenAsset& asset, const std::vector<float>& positions, Radius radius);

struct FrameResult {
  double refit_us = 0;
  std::optional<Detection> chains, all_pairs;
};

// The runtime as a game uses it: buffers made once, then a refit and a detection a frame.
class Player {
 public:
  Player(const OpenAsset& asset, Radius radius, bool chains, bool all_pairs, Target target);

  // `positions` are the deformed source vertices.
  FrameResult run(const std::vector<float>& positions);

  // Takes a frame that was computed elsewhere for its last one. Returns all_pairs' part of it, `us` as given.
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

  // Refitted spheres of the last frame, and the pairs that the last method found. Both methods report the same, but
  // chains leave out pairs in no common chain.
  const std::vector<Sphere>& spheres() const { return spheres_; }
  Span<const Pair> pairs() const { return {pairs_.data(), pair_count_}; }

 private:
  Detection detect(Method method);

  const OpenAsset& asset_;
  Radius radius_;
  bool chains_, all_pairs_;
  Target target_;
  SkinPlayer skin_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::unordered_map<std::uint32_t, std::uint32_t> sphere_of_;  // a source triangle -> its sphere
  std::size_t pair_count_ = 0;
};

}  // namespace spherechain::baker
