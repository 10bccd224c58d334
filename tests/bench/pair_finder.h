// SPDX-License-Identifier: GPL-3.0-or-later
// Who competes for goals P1 and P2: the pairs of a pose, out of its spheres.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spherechain/asset.h"
#include "spherechain/types.h"

namespace spherechain::bench {

// What the pairs found are. All leave out the pairs that the asset ignores, by the means that the library has for it.
enum class Found {
  kExactly,   // the runtime's pairs, its rule for near pairs included
  kInChains,  // those of them that some chain holds
  kTouching,  // the spheres that touch, by the library's own arithmetic
  kBoxes,     // the spheres whose boxes touch, and maybe some more: a test of the spheres is still to come
};

class PairFinder {
 public:
  virtual ~PairFinder() = default;
  // This is what is timed: from an array of spheres to an array of pairs, or of bits. Buffers are made before.
  virtual void find(const Sphere* spheres) = 0;
  // Of the last find(), in any order.
  virtual std::vector<Pair> pairs() const = 0;

  const std::string name;
  const Found found;

 protected:
  PairFinder(std::string name, Found found) : name(std::move(name)), found(found) {}
};

// Peers keep theirs in this: room for all pairs, so that none ever allocates for them.
class PairList {
 public:
  explicit PairList(const Asset& asset) : asset_(asset) { pairs_.reserve(asset.spheres().size * asset.spheres().size); }
  void clear() { pairs_.clear(); }
  bool is_ignored(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
    const std::size_t bit = std::size_t{high} * (high - 1) / 2 + low;
    return ((asset_.ignored()[bit / 64] >> (bit % 64)) & 1U) != 0;
  }
  void add(std::uint32_t a, std::uint32_t b) { pairs_.push_back(a < b ? Pair{a, b} : Pair{b, a}); }
  const std::vector<Pair>& pairs() const { return pairs_; }

 private:
  const Asset& asset_;
  std::vector<Pair> pairs_;
};

using PairFinders = std::vector<std::unique_ptr<PairFinder>>;

// The runtime's: lists, bits, counts; M2 and M1.
PairFinders runtime_finders(const Asset& asset);
PairFinders bullet_finders(const Asset& asset);
PairFinders cgal_finders(const Asset& asset);
PairFinders embree_finders(const Asset& asset);
PairFinders fcl_finders(const Asset& asset);
PairFinders ode_finders(const Asset& asset);

}  // namespace spherechain::bench
