// SPDX-License-Identifier: MIT
#include "runtime/src/contacts/collector.h"

#include <cfloat>
#include <utility>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"

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

// Neighbours first: of them the exact test would need its exact arithmetic.
bool ContactCollector::is_left_out(const Candidate& candidate) const {
  return are_one_ ? share_a_position(*a_.surface, {candidate.cluster_a, candidate.triangle_a},
                                     {candidate.cluster_b, candidate.triangle_b})
                  : a_.ignores(candidate.triangle_a) || b_.ignores(candidate.triangle_b);
}

bool ContactCollector::is_asked(const Candidate& candidate) const {
  if (part_pairs_ == nullptr) {
    return true;
  }
  const std::uint32_t a = a_.surface->parts[candidate.triangle_a], b = b_.surface->parts[candidate.triangle_b];
  const std::size_t place =
      are_one_ ? part_table_.place(std::min(a, b), std::max(a, b), true) : part_table_.place(a, b, false);
  return (part_pairs_[place / 64] >> place % 64 & 1) != 0;
}

// The box is of corners alone: the same in whatever order contacts are found.
void ContactCollector::add_parts(const TriangleContact& of, const Candidate& candidate) {
  const std::uint32_t low = are_one_ ? std::min(of.part_a, of.part_b) : of.part_a;
  const std::uint32_t high = are_one_ ? std::max(of.part_a, of.part_b) : of.part_b;
  bool is_new = false;
  PartContact& contact = part_table_.at(low, high, are_one_, is_new);
  if (is_new) {
    contact = {low, high, 0, {FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
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
  if (is_left_out(candidate) || !is_asked(candidate) || (!candidate.meets && !triangles_intersect(*a, *b))) {
    return false;
  }
  TriangleContact contact{};
  contact.triangle_a = a_.surface->triangles[candidate.triangle_a];
  contact.triangle_b = b_.surface->triangles[candidate.triangle_b];
  contact.sphere_a = a_.surface->clusters[candidate.cluster_a].sphere;
  contact.sphere_b = b_.surface->clusters[candidate.cluster_b].sphere;
  contact.part_a = a_.surface->parts[candidate.triangle_a];
  contact.part_b = b_.surface->parts[candidate.triangle_b];
  if (are_one_) {
    if (contact.triangle_b < contact.triangle_a) {
      std::swap(contact.triangle_a, contact.triangle_b);
      std::swap(contact.sphere_a, contact.sphere_b);
      std::swap(contact.part_a, contact.part_b);
      std::swap(a, b);
    }
    if (intersect_at_rest(*a_.surface, {contact.triangle_a, contact.triangle_b})) {
      return false;
    }
  }
  touch_ = true;
  if (spheres_only_) {
    return true;
  }
  add_parts(contact, candidate);
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

Status ContactCollector::finish(ContactCounts& counts) {
  end_spheres();
  triangles_.finish();
  spheres_.finish();
  counts = {list_parts(), spheres_.count(), triangles_.count()};
  if (parts_.size > 0 && counts.parts > parts_.size) {
    return refuse(SC_OVERFLOW, SC_FIELD_PARTS);
  }
  return spheres_.overflowed()     ? refuse(SC_OVERFLOW, SC_FIELD_SPHERES)
         : triangles_.overflowed() ? refuse(SC_OVERFLOW, SC_FIELD_TRIANGLES)
                                   : done();
}

}  // namespace spherechain
