// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain_trees.h"

#include <cmath>

namespace spherechain::paper {
namespace {

using Bits = std::vector<std::uint64_t>;

// Bit of a pair a <= b; a sphere with itself has one too.
constexpr std::size_t node_bit(std::size_t a, std::size_t b) { return b * (b + 1) / 2 + a; }

// A parent's radius is larger by this share. The distance of two centres, computed in float, is off by less than four
// roundings (2^-24 each). That holds for a parent and its child, and for the two spheres of a test. So 32 roundings
// leave no pair out whose spheres touch by spheres_touch().
constexpr float kGrowth = 1 + 32 * 0x1p-24F;

// Parents also touch where the test has no answer, as of spheres that are not finite.
bool may_touch(const Sphere& p, const Sphere& q) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, s = p.radius + q.radius;
  return !((dx * dx + dy * dy) + dz * dz > s * s);
}

// Around the middle of the box of `count` spheres, at least one.
Sphere enclosing_sphere(const Sphere* spheres, std::size_t count) {
  if (count == 1) return spheres[0];
  const Sphere& first = spheres[0];
  float low[3] = {first.x - first.radius, first.y - first.radius, first.z - first.radius};
  float high[3] = {first.x + first.radius, first.y + first.radius, first.z + first.radius};
  for (std::size_t i = 1; i < count; ++i) {
    const Sphere& s = spheres[i];
    const float center[3] = {s.x, s.y, s.z};
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], center[k] - s.radius);
      high[k] = std::max(high[k], center[k] + s.radius);
    }
  }
  Sphere out{0.5F * (low[0] + high[0]), 0.5F * (low[1] + high[1]), 0.5F * (low[2] + high[2]), 0};
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = spheres[i].x - out.x, dy = spheres[i].y - out.y, dz = spheres[i].z - out.z;
    out.radius = std::max(out.radius, std::sqrt((dx * dx + dy * dy) + dz * dz) + spheres[i].radius);
  }
  out.radius *= kGrowth;
  return out;
}

// Level 0: the asset's pairs in the trees' order, and each sphere with itself.
Bits skipped_leaves(const AssetView& asset, const std::vector<std::uint32_t>& order,
                    const std::vector<RestPair>& rest_pairs) {
  Bits out(words_for(node_bit(0, order.size())));
  for (std::size_t b = 0; b < order.size(); ++b) {
    for (std::size_t a = 0; a <= b; ++a) {
      const std::size_t i = std::min(order[a], order[b]), j = std::max(order[a], order[b]);
      if (i == j || test_bit(asset.ignored(), ignored_bit(i, j))) set_bit({out.data(), out.size()}, node_bit(a, b));
    }
  }
  for (const RestPair& pair : rest_pairs) set_bit({out.data(), out.size()}, node_bit(pair.a, pair.b));
  return out;
}

// Rest pairs of spheres, as places in the trees. Ignored pairs are no rest pairs.
std::vector<RestPair> rest_pairs_in_order(const AssetView& asset, Radius radius,
                                          const std::vector<std::uint32_t>& order) {
  const auto nowhere = static_cast<std::uint32_t>(order.size());
  std::vector<std::uint32_t> place(asset.spheres().size, nowhere);
  for (std::uint32_t i = 0; i < nowhere; ++i) place[order[i]] = i;
  std::vector<RestPair> out;
  for (const RestPair& pair : asset.rest_pairs(radius)) {
    const auto [a, b] = std::minmax(place[pair.a], place[pair.b]);
    if (b != nowhere && !test_bit(asset.ignored(), ignored_bit(pair.a, pair.b))) out.push_back({a, b, pair.rest_scale});
  }
  return out;
}

Bits skipped_parents(const std::vector<std::uint32_t>& first_child, const Bits& below) {
  const std::size_t count = first_child.size() - 1;
  const auto is_skipped = [&](std::size_t a, std::size_t b) {
    for (std::size_t j = first_child[b]; j < first_child[b + 1]; ++j) {
      for (std::size_t i = first_child[a]; i < first_child[a + 1] && i <= j; ++i) {
        if (!test_bit({below.data(), below.size()}, node_bit(i, j))) return false;
      }
    }
    return true;
  };
  Bits out(words_for(node_bit(0, count)));
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t a = 0; a <= b; ++a) {
      if (is_skipped(a, b)) set_bit({out.data(), out.size()}, node_bit(a, b));
    }
  }
  return out;
}

}  // namespace

Runs region_runs(const AssetView& asset) {
  Runs out(asset.region_count());
  for (std::uint32_t i = 0; i < asset.spheres().size; ++i) out[asset.spheres()[i].region].push_back(i);
  return out;
}

ChainTrees::ChainTrees(const AssetView& asset, Radius radius, const Runs& runs, std::size_t branching) {
  std::vector<std::size_t> run_sizes;
  for (const auto& run : runs) {
    if (!run.empty()) run_sizes.push_back(run.size());
    order_.insert(order_.end(), run.begin(), run.end());
  }
  rest_pairs_ = rest_pairs_in_order(asset, radius, order_);
  levels_.push_back({std::vector<Sphere>(order_.size()), {}, skipped_leaves(asset, order_, rest_pairs_)});
  while (levels_.back().spheres.size() > run_sizes.size()) {
    add_parents(run_sizes, branching);
    for (std::size_t& size : run_sizes) size = (size + branching - 1) / branching;
  }
}

void ChainTrees::add_parents(const std::vector<std::size_t>& run_sizes, std::size_t branching) {
  Level level;
  std::size_t begin = 0;
  for (const std::size_t size : run_sizes) {
    for (std::size_t i = 0; i < size; i += branching) {
      level.first_child.push_back(static_cast<std::uint32_t>(begin + i));
    }
    begin += size;
  }
  level.spheres.resize(level.first_child.size());
  level.first_child.push_back(static_cast<std::uint32_t>(begin));
  level.skipped = skipped_parents(level.first_child, levels_.back().skipped);
  levels_.push_back(std::move(level));
}

void ChainTrees::refit(const Sphere* spheres) {
  for (std::size_t i = 0; i < order_.size(); ++i) levels_[0].spheres[i] = spheres[order_[i]];
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    const Sphere* const below = levels_[l - 1].spheres.data();
    Level& level = levels_[l];
    for (std::size_t i = 0; i < level.spheres.size(); ++i) {
      const std::size_t first = level.first_child[i];
      level.spheres[i] = enclosing_sphere(below + first, level.first_child[i + 1] - first);
    }
  }
}

PlainResult ChainTrees::all_pairs() const {
  PlainResult out;
  out.test_count = rest_pairs_.size();
  for (const RestPair& pair : rest_pairs_) report(pair.a, pair.b, pair.rest_scale, out);
  const std::size_t top = levels_.size() - 1;
  const auto roots = static_cast<std::uint32_t>(levels_[top].spheres.size());
  for (std::uint32_t a = 0; a < roots; ++a) {
    for (std::uint32_t b = a; b < roots; ++b) descend(top, a, b, out);
  }
  std::sort(out.pairs.begin(), out.pairs.end());
  return out;
}

void ChainTrees::descend(std::size_t level, std::uint32_t a, std::uint32_t b, PlainResult& out) const {
  const Level& here = levels_[level];
  if (a != b) {
    ++out.test_count;
    if (!may_touch(here.spheres[a], here.spheres[b])) return;
  }
  if (test_bit({here.skipped.data(), here.skipped.size()}, node_bit(a, b))) return;
  if (level == 0) {
    report(a, b, 1, out);
    return;
  }
  for (std::uint32_t i = here.first_child[a]; i < here.first_child[a + 1]; ++i) {
    for (std::uint32_t j = a == b ? i : here.first_child[b]; j < here.first_child[b + 1]; ++j) {
      descend(level - 1, i, j, out);
    }
  }
}

void ChainTrees::report(std::uint32_t a, std::uint32_t b, float rest_scale, PlainResult& out) const {
  if (!spheres_touch(levels_[0].spheres[a], levels_[0].spheres[b], rest_scale)) return;
  out.pairs.push_back({std::min(order_[a], order_[b]), std::max(order_[a], order_[b])});
}

}  // namespace spherechain::paper
