// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "spherechain/detect.h"
#include "spherechain/refit.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::baker {

// What one method found in a frame and what it cost.
struct Detection {
  std::size_t tests, pairs, raw_pairs;  // pairs: each once; raw: as the paper counts M1's, repeats over chains included
  double us;                            // median of a few runs
};

// The runtime's refit of the whole asset.
std::vector<Sphere> refit_spheres(const Asset& asset, const std::vector<float>& positions, RadiusKind radius);

struct FrameResult {
  double refit_us = 0;
  std::optional<Detection> m1, m2;
};

// The runtime as a game uses it: buffers made once, then a refit and a detection a frame.
class Player {
 public:
  Player(const Asset& asset, RadiusKind radius, bool m1, bool m2, Target target);

  // `positions` are the deformed source vertices.
  FrameResult run(const std::vector<float>& positions);

  // Takes a frame that was computed elsewhere for its last one. Returns M2's part of it, `us` as given.
  Detection take(std::vector<Sphere> spheres, const std::vector<Pair>& pairs, double us);

  // The pairs of spheres whose skins intersect, whether the spheres touch or not, and what finding them costs. The
  // asset must have leaves.
  struct SkinDetection {
    std::vector<Pair> pairs;
    double us;  // median of a few runs
  };
  SkinDetection detect_skin(const std::vector<float>& positions);

  // The same for the triangles that intersect: numbers of the source's.
  struct TriangleDetection {
    std::vector<TrianglePair> pairs;
    double us;
  };
  TriangleDetection detect_triangles(const std::vector<float>& positions);

  // Of the last frame: the refitted spheres, and the pairs the last method found (M1 and M2 report the same, but that
  // M1 leaves out pairs in no common chain).
  const std::vector<Sphere>& spheres() const { return spheres_; }
  Span<const Pair> pairs() const { return {pairs_.data(), pair_count_}; }

 private:
  Detection detect(Method method);
  template <typename Job>
  Job skin_job(const std::vector<float>& positions, TriangleContactContext& context);

  const Asset& asset_;
  RadiusKind radius_;
  bool m1_, m2_;
  Target target_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> words_, contact_words_;
  std::size_t pair_count_ = 0;
};

}  // namespace spherechain::baker
