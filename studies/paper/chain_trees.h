// SPDX-License-Identifier: GPL-3.0-or-later
// Trees of spheres over chains of spheres, the hierarchy that the paper leaves to future work: binary, quad, oct.
#pragma once

#include <cstdint>
#include <vector>

#include "studies/plain_detection.h"

namespace spherechain::paper {

// Spheres in the order of their chain. No sphere is in two runs, so trees over runs meet every pair once; the chains of
// Table 1 share limbs, and trees over them would meet a limb's pairs three times.
using Runs = std::vector<std::vector<std::uint32_t>>;

// A run for each region: a limb from the torso outwards, the torso upwards, left before right.
Runs region_runs(const AssetView& asset);

// A tree for each run. A parent stands for up to `branching` neighbours of the level below and encloses their spheres.
// All trees are of one height: where a level of a run has one sphere only, those above repeat it. Rest pairs, most of
// which touch, are tested one by one, as in the product.
class ChainTrees {
 public:
  struct Level {
    std::vector<Sphere> spheres;             // run after run; level 0: the runs' own spheres
    std::vector<std::uint32_t> first_child;  // in the level below; one more than spheres; level 0: none
    // Bit b(b+1)/2 + a, a <= b: every pair of a sphere below a and one below b is ignored or a rest pair.
    std::vector<std::uint64_t> skipped;
  };

  // Every sphere is in one run, or is left out of the test.
  ChainTrees(const AssetView& asset, Radius radius, const Runs& runs, std::size_t branching);

  // Bottom up; every frame, before all_pairs().
  void refit(const Sphere* spheres);

  // Finds the same pairs as PlainDetection::all_pairs() in the spheres of the last refit. test_count counts the tests
  // of two spheres, parents included.
  PlainResult all_pairs() const;

  const std::vector<Level>& levels() const { return levels_; }  // the last one has the roots

 private:
  void add_parents(const std::vector<std::size_t>& run_sizes, std::size_t branching);
  void descend(std::size_t level, std::uint32_t a, std::uint32_t b, PlainResult& out) const;
  void report(std::uint32_t a, std::uint32_t b, float rest_scale, PlainResult& out) const;

  std::vector<std::uint32_t> order_;  // the sphere of each of level 0
  std::vector<RestPair> rest_pairs_;  // of places in level 0
  std::vector<Level> levels_;
};

}  // namespace spherechain::paper
