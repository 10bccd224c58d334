// SPDX-License-Identifier: GPL-3.0-or-later
// The contestants of goals P1 and P2: from a pose's spheres to the pairs that touch.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/pair_bits.h"

namespace spherechain::bench {

// Which pairs a contestant finds. All leave out the asset's ignored pairs, each in its library's own way.
enum class Found {
  kExactly,   // the runtime's pairs, its rule for rest pairs included
  kTouching,  // the spheres that touch, by the library's own arithmetic
  kBoxes,     // the spheres whose boxes touch, and maybe some more: a test of the spheres is still to come
};

class PairFinder {
 public:
  virtual ~PairFinder() = default;
  // This is what is timed: from an array of spheres to an array of pairs, or of bits. Buffers are made before.
  virtual void find(const Sphere* spheres) = 0;
  // Pairs of the last find(), in any order.
  virtual std::vector<Pair> pairs() const = 0;

  const std::string name;
  const Found found;

 protected:
  PairFinder(std::string name, Found found) : name(std::move(name)), found(found) {}
};

// Where peers keep their pairs. It has room for all of them, so that no peer allocates while it is timed.
class PairList {
 public:
  explicit PairList(const Asset& asset) : asset_(asset) {
    pairs_.reserve(view_of(asset).spheres().size * view_of(asset).spheres().size);
  }
  void clear() { pairs_.clear(); }
  bool is_ignored(std::uint32_t a, std::uint32_t b) const {
    return a < b ? test_bit(view_of(asset_).ignored(), ignored_bit(a, b))
                 : test_bit(view_of(asset_).ignored(), ignored_bit(b, a));
  }
  void add(std::uint32_t a, std::uint32_t b) { pairs_.push_back(a < b ? Pair{a, b} : Pair{b, a}); }
  const std::vector<Pair>& pairs() const { return pairs_; }

 private:
  const Asset& asset_;
  std::vector<Pair> pairs_;
};

using PairFinders = std::vector<std::unique_ptr<PairFinder>>;

// The runtime's: a list, bits, and a list without a prepared table.
PairFinders runtime_finders(const Asset& asset);
PairFinders bullet_finders(const Asset& asset);
PairFinders cgal_finders(const Asset& asset);
PairFinders embree_finders(const Asset& asset);
PairFinders fcl_finders(const Asset& asset);
PairFinders ode_finders(const Asset& asset);

}  // namespace spherechain::bench
