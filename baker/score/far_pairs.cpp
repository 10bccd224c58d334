// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/far_pairs.h"

#include <algorithm>

namespace spherechain::baker {
namespace {

// Triangles on joined vertices: a seam of the texture is no edge of the skin.
std::vector<std::array<Index, 3>> neighbours_of(const ScoredSkin& skin) {
  Mesh mesh{skin.rest, skin.triangles};
  for (Triangle& t : mesh.triangles) {
    for (Index& v : t) v = skin.joined[v];
  }
  return triangle_neighbours(mesh);
}

std::uint64_t key_of(Index a, Index b) { return std::uint64_t{a} << 32 | b; }

}  // namespace

FarPairs::FarPairs(const ScoredSkin& skin)
    : neighbours_(neighbours_of(skin)), walked_in_(skin.triangles.size(), 0), steps_(skin.triangles.size(), 0) {}

void FarPairs::walk(Index from, const std::vector<Index>& to) {
  ++walks_;
  walked_in_[from] = walks_;
  steps_[from] = 0;
  std::vector<Index> queue{from};
  for (std::size_t q = 0; q < queue.size(); ++q) {
    const int steps = steps_[queue[q]] + 1;
    if (steps == kSteps[0]) break;
    for (const Index n : neighbours_[queue[q]]) {
      if (n == kNoIndex || walked_in_[n] == walks_) continue;
      walked_in_[n] = walks_;
      steps_[n] = static_cast<std::uint8_t>(steps);
      queue.push_back(n);
    }
  }
  for (const Index t : to) known_[key_of(from, t)] = walked_in_[t] == walks_ ? steps_[t] : std::uint8_t{kSteps[0]};
}

std::array<std::size_t, 2> FarPairs::count(const std::vector<TriangleContact>& contacts) {
  std::array<std::size_t, 2> out{};
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const Index from = contacts[first].triangle_a;
    std::vector<Index> unknown;
    for (end = first; end < contacts.size() && contacts[end].triangle_a == from; ++end) {
      if (!known_.contains(key_of(from, contacts[end].triangle_b))) unknown.push_back(contacts[end].triangle_b);
    }
    if (!unknown.empty()) walk(from, unknown);
    for (std::size_t c = first; c < end; ++c) {
      const int steps = known_.at(key_of(from, contacts[c].triangle_b));
      for (std::size_t k = 0; k < kSteps.size(); ++k) out[k] += steps >= kSteps[k] ? 1 : 0;
    }
  }
  return out;
}

}  // namespace spherechain::baker
