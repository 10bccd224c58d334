// SPDX-License-Identifier: MIT
#include "contact_collector.h"

#include <cmath>

#include "arithmetic.h"

namespace spherechain {
namespace {

bool is_finite(const TriangleCorners& t) {
  bool finite = true;
  for (const Vec3& p : t.p) {
    finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  return finite;
}

}  // namespace

void begin_spheres(ContactCollector& collector, Pair spheres) { collector.begin_spheres(spheres); }
bool decide(ContactCollector& collector, const Candidate& candidate) { return collector.decide(candidate); }

void ContactCollector::begin_spheres(Pair spheres) {
  end_spheres();
  current_.spheres = spheres;
}

void ContactCollector::end_spheres() {
  if (current_.count > 0) {
    sphere_contacts_.add(current_);
    spheres_.add(current_.spheres);
  }
  current_ = {};
}

bool ContactCollector::share_a_position(const Candidate& candidate) const {
  const Surface& surface = asset_.surface();
  const auto weld = [&](std::size_t leaf, std::size_t triangle, std::size_t corner) {
    const std::size_t place = surface.corners[3 * triangle + corner];
    return surface.welds[surface.leaf_vertices[surface.leaves[leaf].first_vertex + place]];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t own = weld(candidate.leaf_a, candidate.triangle_a, i);
    for (std::size_t j = 0; j < 3; ++j) {
      if (own == weld(candidate.leaf_b, candidate.triangle_b, j)) {
        return true;
      }
    }
  }
  return false;
}

bool ContactCollector::decide(const Candidate& candidate) {
  const TriangleCorners *a = &candidate.a, *b = &candidate.b;
  // Neighbours first: of them the exact test would need its exact arithmetic.
  if (share_a_position(candidate)) {
    return false;
  }
  if (!candidate.meets && (!finite_triangles_intersect(*a, *b) || !is_finite(*a) || !is_finite(*b))) {
    return false;
  }
  TriangleContact contact{};
  contact.triangles = {asset_.triangles()[candidate.triangle_a], asset_.triangles()[candidate.triangle_b]};
  if (contact.triangles.b < contact.triangles.a) {
    std::swap(contact.triangles.a, contact.triangles.b);
    std::swap(a, b);
  }
  const Span<const TrianglePair> rest = asset_.surface().rest_contacts;
  if (std::binary_search(rest.begin(), rest.end(), contact.triangles)) {
    return false;
  }
  pairs_.add(contact.triangles);
  if (measures_) {
    contact.overlap = overlap_of(*a, *b);
    contacts_.add(contact);
    const float depth = contact.overlap.depth, deepest = current_.deepest.overlap.depth;
    if (current_.count == 0 || depth > deepest || (!(depth < deepest) && contact < current_.deepest)) {
      current_.deepest = contact;
    }
  }
  ++current_.count;
  return true;
}

void ContactCollector::finish() {
  end_spheres();
  pairs_.finish();
  contacts_.finish();
  sphere_contacts_.finish();
  spheres_.finish();
}

}  // namespace spherechain
