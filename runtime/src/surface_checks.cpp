// SPDX-License-Identifier: MIT
#include "surface_checks.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <limits>

#include "sphere_chains_generated.h"
#include "spherechain/surface.h"

namespace spherechain {
namespace {

using Lanes = flatbuffers::Array<float, kLeafLanes>;
constexpr std::uint32_t kLanes = kLeafLanes;
constexpr std::uint32_t kSlots = kSlotLanes;
using Numbers = flatbuffers::Vector<std::uint32_t>;

bool has_size(std::uint64_t size, std::uint64_t wanted, const char* name, const char* of, Message& message) {
  return size == wanted || message.wrong("surface.%s: %" PRIu64 " of them, but %" PRIu64 " %s", name, size, wanted, of);
}

bool wrong_at(const char* name, std::uint32_t i, const char* what, Message& message) {
  return message.wrong("surface.%s[%" PRIu32 "]: %s", name, i, what);
}

bool is_finite(const schema::Vec3& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

// Whether a leaf's run of `count` starts where the last one ended, at `next`, and ends in the table; moves `next` on.
bool take_run(std::uint64_t first, std::uint64_t count, std::uint64_t size, std::uint64_t& next) {
  const bool follows = first == next;
  next += count;
  return follows && next <= size;
}

// Whether `used` lanes are finite and at least `least`, and the spare ones 0.
bool lanes_are_valid(const Lanes& lanes, std::uint32_t used, float least) {
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const float value = lanes.Get(lane);
    if (lane < used ? !(std::isfinite(value) && value >= least) : value != 0.0F) {
      return false;
    }
  }
  return true;
}

constexpr float kLowest = std::numeric_limits<float>::lowest();

bool ball_is_valid(const schema::BallLanes& balls, std::uint32_t used) {
  return lanes_are_valid(*balls.x(), used, kLowest) && lanes_are_valid(*balls.y(), used, kLowest) &&
         lanes_are_valid(*balls.z(), used, kLowest) && lanes_are_valid(*balls.radius(), used, 0.0F);
}

bool box_is_valid(const schema::BoxLanes& boxes, std::uint32_t used) {
  return lanes_are_valid(*boxes.x(), used, kLowest) && lanes_are_valid(*boxes.y(), used, kLowest) &&
         lanes_are_valid(*boxes.z(), used, kLowest) && lanes_are_valid(*boxes.half_x(), used, 0.0F) &&
         lanes_are_valid(*boxes.half_y(), used, 0.0F) && lanes_are_valid(*boxes.half_z(), used, 0.0F) &&
         lanes_are_valid(*boxes.radius(), used, 0.0F);
}

// `count` numbers from `first` on are below `limit` and ascend.
bool check_run(const Numbers& numbers, std::uint32_t first, std::uint32_t count, std::uint32_t limit, const char* name,
               Message& message) {
  for (std::uint32_t i = first; i < first + count; ++i) {
    if (numbers.Get(i) >= limit) {
      return message.wrong("surface.%s[%" PRIu32 "]: %" PRIu32 " is past the %" PRIu32, name, i, numbers.Get(i), limit);
    }
    if (i > first && numbers.Get(i) <= numbers.Get(i - 1)) {
      return wrong_at(name, i, "not above the one before it", message);
    }
  }
  return true;
}

std::uint32_t bone_count(const schema::Asset& root) {
  return root.bone_refit() == nullptr ? 0 : root.bone_refit()->bones()->size();
}

std::uint32_t morph_count(const schema::Asset& root) {
  return root.bone_refit() == nullptr ? 0 : root.bone_refit()->morphs()->size();
}

bool check_vertices(const schema::Asset& root, Message& message) {
  const schema::Surface& surface = *root.surface();
  const std::uint32_t count = surface.source_vertices()->size();
  if (!has_size(surface.welds()->size(), count, "welds", "source_vertices", message)) {
    return false;
  }
  for (std::uint32_t v = 0; v < count; ++v) {
    if (surface.source_vertices()->Get(v) >= root.source()->vertex_count()) {
      return message.wrong("surface.source_vertices[%" PRIu32 "]: %" PRIu32 " is past the %" PRIu32
                           " vertices of the source",
                           v, surface.source_vertices()->Get(v), root.source()->vertex_count());
    }
    const std::uint32_t weld = surface.welds()->Get(v);
    if (weld > v || surface.welds()->Get(weld) != weld) {
      return wrong_at("welds", v, "not the lowest vertex of its place", message);
    }
  }
  return true;
}

bool check_slots(const schema::Surface& surface, std::uint32_t l, std::uint32_t slots, Message& message) {
  const schema::Leaf& leaf = *surface.leaves()->Get(l);
  const float* positions = surface.slot_positions()->data() + std::size_t{3} * leaf.first_slot();
  if (!std::all_of(positions, positions + std::size_t{3} * slots, [](float p) { return std::isfinite(p); })) {
    return wrong_at("leaves", l, "a position in its slots is not finite", message);
  }
  const float* weights = surface.slot_weights()->data() + leaf.first_weight();
  if (!std::all_of(weights, weights + std::size_t{slots} * leaf.bone_count(),
                   [](float w) { return w >= 0.0F && w <= 1.0F; })) {
    return wrong_at("leaves", l, "a weight in its slots is not from 0 to 1", message);
  }
  return true;
}

bool check_morphs(const schema::Asset& root, const schema::Leaf& leaf, std::uint32_t slots, Message& message) {
  const auto& morphs = *root.surface()->slot_morphs();
  for (std::uint32_t i = leaf.first_morph(); i < leaf.first_morph() + leaf.morph_count(); ++i) {
    const schema::SlotMorph& morph = *morphs.Get(i);
    if (morph.target() >= morph_count(root)) {
      return message.wrong("surface.slot_morphs[%" PRIu32 "].target: %" PRIu32 " is past the %" PRIu32 " morph targets",
                           i, morph.target(), morph_count(root));
    }
    if (morph.slot() >= slots || !is_finite(morph.delta())) {
      return wrong_at("slot_morphs", i, "its slot is past the leaf's, or its delta not finite", message);
    }
    if (i > leaf.first_morph() &&
        (morph.target() < morphs.Get(i - 1)->target() ||
         (morph.target() == morphs.Get(i - 1)->target() && morph.slot() <= morphs.Get(i - 1)->slot()))) {
      return wrong_at("slot_morphs", i, "not sorted, or there twice", message);
    }
  }
  return true;
}

bool check_corners(const schema::Surface& surface, const schema::Leaf& leaf, Message& message) {
  for (std::uint32_t t = leaf.first_triangle(); t < leaf.first_triangle() + leaf.triangle_count(); ++t) {
    const unsigned a = surface.corners()->Get(3 * t);
    const unsigned b = surface.corners()->Get(3 * t + 1);
    const unsigned c = surface.corners()->Get(3 * t + 2);
    if (std::max({a, b, c}) >= leaf.vertex_count() || a == b || b == c || c == a) {
      return message.wrong("surface.corners: triangle %" PRIu32 " has a corner that its leaf has not, or one twice", t);
    }
  }
  return true;
}

// Where the next leaf's runs start.
struct Next {
  std::uint64_t vertex = 0, bone = 0, slot = 0, weight = 0, morph = 0;
};

bool check_leaf(const schema::Asset& root, std::uint32_t l, Next& next, Message& message) {
  const schema::Surface& surface = *root.surface();
  const schema::Leaf& leaf = *surface.leaves()->Get(l);
  if (leaf.vertex_count() == 0 || leaf.vertex_count() > kMaxLeafVertices || leaf.reserved() != 0) {
    return wrong_at("leaves", l, "its vertex_count is not 1 to 255, or reserved is not 0", message);
  }
  if ((leaf.bone_count() > 0) != (bone_count(root) > 0)) {
    return wrong_at("leaves", l, "it hangs on no bone, or there are none", message);
  }
  const std::uint32_t slots = (leaf.vertex_count() + kSlots - 1) / kSlots * kSlots;
  if (!take_run(leaf.first_vertex(), leaf.vertex_count(), surface.leaf_vertices()->size(), next.vertex) ||
      !take_run(leaf.first_bone(), leaf.bone_count(), surface.leaf_bones()->size(), next.bone) ||
      !take_run(leaf.first_slot(), slots, surface.slot_positions()->size() / 3, next.slot) ||
      !take_run(leaf.first_weight(), std::uint64_t{slots} * leaf.bone_count(), surface.slot_weights()->size(),
                next.weight) ||
      !take_run(leaf.first_morph(), leaf.morph_count(), surface.slot_morphs()->size(), next.morph)) {
    return wrong_at("leaves", l, "a run of it does not start where the last leaf's ends, or is past the end", message);
  }
  return check_run(*surface.leaf_vertices(), leaf.first_vertex(), leaf.vertex_count(),
                   surface.source_vertices()->size(), "leaf_vertices", message) &&
         check_run(*surface.leaf_bones(), leaf.first_bone(), leaf.bone_count(), bone_count(root), "leaf_bones",
                   message) &&
         check_slots(surface, l, slots, message) && check_morphs(root, leaf, slots, message) &&
         check_corners(surface, leaf, message);
}

bool check_leaves(const schema::Asset& root, Message& message) {
  const schema::Surface& surface = *root.surface();
  if (!has_size(surface.corners()->size(), std::uint64_t{3} * root.triangles()->size(), "corners",
                "that the triangles have", message)) {
    return false;
  }
  const std::uint32_t count = surface.leaves()->size();
  std::uint32_t l = 0;
  Next next;
  for (std::uint32_t s = 0; s < root.spheres()->size(); ++s) {
    const schema::Sphere& sphere = *root.spheres()->Get(s);
    const std::uint64_t end = std::uint64_t{sphere.first_triangle()} + sphere.triangle_count();
    for (std::uint64_t triangle = sphere.first_triangle(); triangle < end; ++l) {
      if (l == count || surface.leaves()->Get(l)->sphere() != s || surface.leaves()->Get(l)->triangle_count() == 0 ||
          surface.leaves()->Get(l)->first_triangle() != triangle ||
          triangle + surface.leaves()->Get(l)->triangle_count() > end) {
        return message.wrong("surface.leaves[%" PRIu32 "]: the leaves do not tile the triangles of sphere %" PRIu32, l,
                             s);
      }
      if (!check_leaf(root, l, next, message)) {
        return false;
      }
      triangle += surface.leaves()->Get(l)->triangle_count();
    }
  }
  return has_size(count, l, "leaves", "that spheres have", message) &&
         has_size(surface.leaf_vertices()->size(), next.vertex, "leaf_vertices", "that the leaves have", message) &&
         has_size(surface.leaf_bones()->size(), next.bone, "leaf_bones", "that the leaves have", message) &&
         has_size(surface.slot_positions()->size(), 3 * next.slot, "slot_positions", "that the leaves have", message) &&
         has_size(surface.slot_weights()->size(), next.weight, "slot_weights", "that the leaves have", message) &&
         has_size(surface.slot_morphs()->size(), next.morph, "slot_morphs", "that the leaves have", message);
}

// The lanes of a group that stand for leaves.
std::uint32_t lanes_of(const schema::Surface& surface, std::uint32_t group) {
  return std::min(kLanes, surface.leaves()->size() - kLanes * group);
}

// A group's entries each, one group after another, that name bones or morph targets.
template <typename IsValid>
bool check_groups(const Numbers& counts, const Numbers& names, std::uint32_t limit, const char* counts_name,
                  const char* names_name, const IsValid& is_valid, Message& message) {
  std::uint64_t next = 0;
  for (std::uint32_t group = 0; group < counts.size(); ++group) {
    const auto first = static_cast<std::uint32_t>(next);
    next += counts.Get(group);
    if (next > names.size()) {
      return wrong_at(counts_name, group, "its entries are past the end", message);
    }
    if (!check_run(names, first, counts.Get(group), limit, names_name, message)) {
      return false;
    }
    for (auto i = first; i < next; ++i) {
      if (!is_valid(group, i)) {
        return wrong_at(names_name, i, "its lanes are not finite, below 0, or a spare one is not 0", message);
      }
    }
  }
  return has_size(names.size(), next, names_name, "that the groups have", message);
}

bool check_cover(const schema::Asset& root, Message& message) {
  const schema::Surface& surface = *root.surface();
  const std::uint32_t groups = (surface.leaves()->size() + kLanes - 1) / kLanes;
  if (!has_size(surface.leaf_balls()->size(), groups, "leaf_balls", "groups of leaves", message) ||
      !has_size(surface.cover_term_counts()->size(), bone_count(root) == 0 ? 0 : groups, "cover_term_counts",
                "groups of leaves that move", message) ||
      !has_size(surface.cover_terms()->size(), surface.cover_term_bones()->size(), "cover_terms", "cover_term_bones",
                message) ||
      !has_size(surface.cover_morphs()->size(), surface.cover_morph_targets()->size(), "cover_morphs",
                "cover_morph_targets", message)) {
    return false;
  }
  if (surface.cover_morph_counts()->size() != 0 &&
      !has_size(surface.cover_morph_counts()->size(), groups, "cover_morph_counts", "groups of leaves", message)) {
    return false;
  }
  for (std::uint32_t group = 0; group < groups; ++group) {
    if (!ball_is_valid(*surface.leaf_balls()->Get(group), lanes_of(surface, group))) {
      return wrong_at("leaf_balls", group, "not finite, a radius below 0, or a spare lane that is not 0", message);
    }
  }
  const auto term_is_valid = [&](std::uint32_t group, std::uint32_t i) {
    const schema::CoverTerm& term = *surface.cover_terms()->Get(i);
    return lanes_are_valid(*term.weights(), lanes_of(surface, group), 0.0F) &&
           lanes_are_valid(*term.deviations(), lanes_of(surface, group), 0.0F);
  };
  const auto morph_is_valid = [&](std::uint32_t group, std::uint32_t i) {
    return ball_is_valid(*surface.cover_morphs()->Get(i), lanes_of(surface, group));
  };
  return check_groups(*surface.cover_term_counts(), *surface.cover_term_bones(), bone_count(root), "cover_term_counts",
                      "cover_term_bones", term_is_valid, message) &&
         check_groups(*surface.cover_morph_counts(), *surface.cover_morph_targets(), morph_count(root),
                      "cover_morph_counts", "cover_morph_targets", morph_is_valid, message);
}

bool check_boxes(const schema::Surface& surface, Message& message) {
  if (surface.leaf_boxes() == nullptr) {
    return true;
  }
  const std::uint32_t groups = surface.leaf_balls()->size();
  if (!has_size(surface.leaf_boxes()->size(), groups, "leaf_boxes", "groups of leaves", message)) {
    return false;
  }
  for (std::uint32_t group = 0; group < groups; ++group) {
    if (!box_is_valid(*surface.leaf_boxes()->Get(group), lanes_of(surface, group))) {
      return wrong_at("leaf_boxes", group, "not finite, an extent below 0, or a spare lane that is not 0", message);
    }
  }
  return true;
}

// Where the next outline's runs start.
struct NextOutline {
  std::uint64_t bone = 0, point = 0, weight = 0;
};

bool check_outline(const schema::Asset& root, std::uint32_t s, std::uint32_t leaf, NextOutline& next,
                   Message& message) {
  const schema::Surface& surface = *root.surface();
  const schema::Outline& outline = *surface.outlines()->Get(s);
  const bool has_leaves = root.spheres()->Get(s)->triangle_count() > 0;
  if (outline.first_leaf() != leaf || (outline.bone_count() > 0) != has_leaves ||
      (outline.point_count() > 0) != has_leaves || outline.point_count() % kOutlineLanes != 0) {
    return wrong_at("outlines", s,
                    "not where its leaves start, or its counts are not those of a sphere with, or without", message);
  }
  if (!take_run(outline.first_bone(), outline.bone_count(), surface.outline_bones()->size(), next.bone) ||
      !take_run(outline.first_point(), outline.point_count(), surface.outline_points()->size() / 3, next.point) ||
      !take_run(outline.first_weight(), std::uint64_t{outline.bone_count()} * outline.point_count(),
                surface.outline_weights()->size(), next.weight)) {
    return wrong_at("outlines", s, "a run of it does not start where the last one's ends, or is past the end", message);
  }
  if (!is_finite(outline.center()) || !(std::isfinite(outline.radius()) && outline.radius() >= 0.0F) ||
      !(std::isfinite(outline.slack()) && outline.slack() >= 0.0F)) {
    return wrong_at("outlines", s, "its center, radius or slack is not finite, or below 0", message);
  }
  for (std::uint32_t i = outline.first_bone(); i < next.bone; ++i) {
    const schema::OutlineBone& bone = *surface.outline_bones()->Get(i);
    const float off[4] = {bone.x(), bone.y(), bone.z(), bone.w()};
    if (bone.bone() >= bone_count(root) ||
        !std::all_of(off, off + 4, [](float v) { return std::isfinite(v) && v >= 0.0F; })) {
      return wrong_at("outline_bones", i, "past the bones, or a figure of it is not finite, or below 0", message);
    }
  }
  return true;
}

bool check_outlines(const schema::Asset& root, Message& message) {
  const schema::Surface& surface = *root.surface();
  const bool all = surface.outlines() != nullptr && surface.outline_bones() != nullptr &&
                   surface.outline_points() != nullptr && surface.outline_weights() != nullptr;
  if (!all) {
    return (surface.outlines() == nullptr && surface.outline_bones() == nullptr &&
            surface.outline_points() == nullptr && surface.outline_weights() == nullptr) ||
           message.wrong("surface.outlines: some of their four tables are missing");
  }
  const std::uint32_t count = root.spheres()->size();
  if (!has_size(surface.outlines()->size(), count, "outlines", "spheres", message)) {
    return false;
  }
  std::uint32_t leaf = 0;
  NextOutline next;
  for (std::uint32_t s = 0; s < count; ++s) {
    if (!check_outline(root, s, leaf, next, message)) {
      return false;
    }
    while (leaf < surface.leaves()->size() && surface.leaves()->Get(leaf)->sphere() == s) {
      ++leaf;
    }
  }
  const float* points = surface.outline_points()->data();
  const float* weights = surface.outline_weights()->data();
  if (!std::all_of(points, points + surface.outline_points()->size(), [](float p) { return std::isfinite(p); })) {
    return message.wrong("surface.outline_points: one is not finite");
  }
  if (!std::all_of(weights, weights + surface.outline_weights()->size(),
                   [](float w) { return w >= 0.0F && w <= 1.0F; })) {
    return message.wrong("surface.outline_weights: one is not from 0 to 1");
  }
  return has_size(surface.outline_bones()->size(), next.bone, "outline_bones", "that the outlines have", message) &&
         has_size(surface.outline_points()->size(), 3 * next.point, "outline_points", "that the outlines have",
                  message) &&
         has_size(surface.outline_weights()->size(), next.weight, "outline_weights", "that the outlines have", message);
}

bool check_rest_contacts(const schema::Asset& root, Message& message) {
  const auto* pairs = root.surface()->rest_contacts();
  if (pairs == nullptr) {
    return true;
  }
  for (std::uint32_t i = 0; i < pairs->size(); ++i) {
    const TrianglePair pair{pairs->Get(i)->a(), pairs->Get(i)->b()};
    if (pair.a >= pair.b || pair.b >= root.source()->triangle_count()) {
      return wrong_at("rest_contacts", i, "a is not below b, or b is past the source's triangles", message);
    }
    if (i > 0 && !(TrianglePair{pairs->Get(i - 1)->a(), pairs->Get(i - 1)->b()} < pair)) {
      return wrong_at("rest_contacts", i, "not sorted, or there twice", message);
    }
  }
  return true;
}

}  // namespace

bool surface_values_are_valid(const schema::Asset& root, Message& message) {
  return root.surface() == nullptr ||
         (check_vertices(root, message) && check_leaves(root, message) && check_cover(root, message) &&
          check_boxes(*root.surface(), message) && check_outlines(root, message) && check_rest_contacts(root, message));
}

}  // namespace spherechain
