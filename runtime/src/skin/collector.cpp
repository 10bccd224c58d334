// SPDX-License-Identifier: MIT
#include "skin/collector.h"

#include <cfloat>
#include <utility>

#include "asset/status.h"
#include "pairs/pair_bits.h"
#include "simd/arithmetic.h"

namespace spherechain {
void ContactCollector::begin_spheres(Pair spheres) {
  end_spheres();
  current_ = spheres;
}

void ContactCollector::end_spheres() {
  if (touch_) {
    spheres_.add(current_);
  }
  touch_ = false;
}

bool ContactCollector::share_a_position(const Candidate& candidate) const {
  const auto weld = [&](std::size_t cluster, std::size_t triangle, std::size_t corner) {
    const std::size_t place = surface_.corners[3 * triangle + corner];
    return surface_.welds[surface_.cluster_vertices[surface_.clusters[cluster].first_vertex + place]];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t own = weld(candidate.cluster_a, candidate.triangle_a, i);
    for (std::size_t j = 0; j < 3; ++j) {
      if (own == weld(candidate.cluster_b, candidate.triangle_b, j)) {
        return true;
      }
    }
  }
  return false;
}

// The box is of corners alone: the same in whatever order contacts are found.
void ContactCollector::add_parts(std::uint32_t a, std::uint32_t b, const Candidate& candidate) {
  const std::size_t low = std::min(a, b), high = std::max(a, b);
  const std::size_t place = low * part_table_.part_count - low * (low + 1) / 2 + high;
  PartContact& contact = part_table_.contacts[place];
  std::uint64_t& word = part_table_.seen[place / 64];
  const std::uint64_t bit = std::uint64_t{1} << (place % 64);
  if ((word & bit) == 0) {
    word |= bit;
    contact = {static_cast<std::uint32_t>(low),
               static_cast<std::uint32_t>(high),
               0,
               {FLT_MAX, FLT_MAX, FLT_MAX},
               {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  }
  ++contact.triangle_pairs;
  for (const TriangleCorners* triangle : {&candidate.a, &candidate.b}) {
    for (const Vec3& p : triangle->p) {
      contact.low = {std::min(contact.low.x, p.x), std::min(contact.low.y, p.y), std::min(contact.low.z, p.z)};
      contact.high = {std::max(contact.high.x, p.x), std::max(contact.high.y, p.y), std::max(contact.high.z, p.z)};
    }
  }
}

bool ContactCollector::decide(const Candidate& candidate) {
  const TriangleCorners *a = &candidate.a, *b = &candidate.b;
  // Neighbours first: of them the exact test would need its exact arithmetic.
  if (share_a_position(candidate)) {
    return false;
  }
  if (!candidate.meets && !triangles_intersect(*a, *b)) {
    return false;
  }
  TriangleContact contact{};
  contact.triangle_a = surface_.triangles[candidate.triangle_a];
  contact.triangle_b = surface_.triangles[candidate.triangle_b];
  contact.sphere_a = surface_.clusters[candidate.cluster_a].sphere;
  contact.sphere_b = surface_.clusters[candidate.cluster_b].sphere;
  contact.part_a = surface_.parts[candidate.triangle_a];
  contact.part_b = surface_.parts[candidate.triangle_b];
  if (contact.triangle_b < contact.triangle_a) {
    std::swap(contact.triangle_a, contact.triangle_b);
    std::swap(contact.sphere_a, contact.sphere_b);
    std::swap(contact.part_a, contact.part_b);
    std::swap(a, b);
  }
  const Span<Pair>& rest = surface_.rest_contacts;
  if (std::binary_search(rest.begin(), rest.end(), Pair{contact.triangle_a, contact.triangle_b})) {
    return false;
  }
  touch_ = true;
  if (spheres_only_) {
    return true;
  }
  add_parts(contact.part_a, contact.part_b, candidate);
  if (triangles_.is_wanted()) {
    const Segment segment = crossing_segment(*a, *b);
    contact.from = segment.from;
    contact.to = segment.to;
  }
  triangles_.add(contact);
  return true;
}

// The table is in order: parts by the first, then the second.
std::size_t ContactCollector::list_parts() const {
  std::size_t count = 0;
  for (std::size_t w = 0; w < part_table_.word_count; ++w) {
    for (std::uint64_t word = part_table_.seen[w]; word != 0; word &= word - 1, ++count) {
      if (count < parts_.size) {
        parts_[count] = part_table_.contacts[64 * w + lowest_bit(word)];
      }
    }
  }
  return count;
}

Status ContactCollector::finish(SkinContactJob& job) {
  end_spheres();
  triangles_.finish();
  spheres_.finish();
  job.part_count = list_parts();
  job.sphere_count = spheres_.count();
  job.triangle_count = triangles_.count();
  if (parts_.size > 0 && job.part_count > parts_.size) {
    return refuse(SC_OVERFLOW, SC_FIELD_PARTS);
  }
  return spheres_.overflowed()     ? refuse(SC_OVERFLOW, SC_FIELD_SPHERES)
         : triangles_.overflowed() ? refuse(SC_OVERFLOW, SC_FIELD_TRIANGLES)
                                   : done();
}

}  // namespace spherechain
