// SPDX-License-Identifier: MIT
#include "bone_checks.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>

#include "sphere_chains_generated.h"
#include "spherechain/bone_tables.h"

namespace spherechain {
namespace {

using Floats = flatbuffers::Array<float, kPivotLanes>;
using Counts = flatbuffers::Vector<std::uint32_t>;

bool lanes_are_valid(const Floats& lanes, std::uint32_t used) {
  for (std::uint32_t lane = 0; lane < kPivotLanes; ++lane) {
    if (lane < used ? !std::isfinite(lanes.Get(lane)) : lanes.Get(lane) != 0.0F) {
      return false;
    }
  }
  return true;
}

bool check_packed(const schema::Asset& root, Message& message) {
  const bool has_vertices = root.pivot_vertices() != nullptr;
  const bool has_packed = root.packed_pivots() != nullptr;
  if (!has_vertices || !has_packed) {
    return has_vertices == has_packed || message.wrong("pivot_vertices: missing, or packed_pivots is");
  }
  const auto& vertices = *root.pivot_vertices();
  const auto& packed = *root.packed_pivots();
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (vertices.Get(i) >= root.source()->vertex_count()) {
      return message.wrong("pivot_vertices[%" PRIu32 "]: %" PRIu32 " is past the %" PRIu32 " vertices of the source", i,
                           vertices.Get(i), root.source()->vertex_count());
    }
    if (i > 0 && vertices.Get(i) <= vertices.Get(i - 1)) {
      return message.wrong("pivot_vertices[%" PRIu32 "]: not above the one before it", i);
    }
  }
  if (packed.size() != root.pivots()->size()) {
    return message.wrong("packed_pivots: %" PRIu32 " of them, but %" PRIu32 " pivots", packed.size(),
                         root.pivots()->size());
  }
  for (std::uint32_t i = 0; i < packed.size(); ++i) {
    const schema::Pivot& pivot = *root.pivots()->Get(i);
    const schema::Pivot& same = *packed.Get(i);
    const auto is_same = [&](std::uint32_t corner, std::uint32_t wanted) {
      return corner < vertices.size() && vertices.Get(corner) == wanted;
    };
    if (!is_same(same.a(), pivot.a()) || !is_same(same.b(), pivot.b()) || !is_same(same.c(), pivot.c()) ||
        same.weight() != pivot.weight()) {
      return message.wrong("packed_pivots[%" PRIu32 "]: not the pivot of that number", i);
    }
  }
  return true;
}

bool check_bones(const schema::BoneRefit& refit, Message& message) {
  if (refit.bones()->size() == 0) {
    return message.wrong("bone_refit.bones: none");
  }
  for (std::uint32_t i = 0; i < refit.bones()->size(); ++i) {
    const schema::Bone& bone = *refit.bones()->Get(i);
    const schema::Matrix* matrix = bone.inverse_bind();
    if (matrix == nullptr) {
      return message.wrong("bone_refit.bones[%" PRIu32 "].inverse_bind: missing", i);
    }
    const float* elements = matrix->elements()->data();
    if (!std::all_of(elements, elements + 12, [](float element) { return std::isfinite(element); })) {
      return message.wrong("bone_refit.bones[%" PRIu32 "].inverse_bind: not finite", i);
    }
    if (bone.is_rest() && i + 1 != refit.bones()->size()) {
      return message.wrong("bone_refit.bones[%" PRIu32 "].is_rest: not the last bone", i);
    }
  }
  return true;
}

bool has_size(std::uint32_t size, std::uint64_t wanted, const char* name, const char* of, Message& message) {
  return size == wanted ||
         message.wrong("bone_refit.%s: %" PRIu32 " of them, but %" PRIu64 " %s", name, size, wanted, of);
}

// Refit by moments does not read what moves the pivots: all of it may be left out.
bool has_pivots(const schema::Asset& root, const schema::BoneRefit& refit) {
  return root.refit() != schema::Refit::moments || refit.weights()->size() != 0;
}

bool check_weights(const schema::Asset& root, const schema::BoneRefit& refit, Message& message) {
  const bool are_there = has_pivots(root, refit);
  std::uint64_t groups = 0;
  for (const schema::Sphere* sphere : *root.spheres()) {
    groups += are_there ? (sphere->pivot_count() + kPivotLanes - 1) / kPivotLanes : 0;
  }
  if (!has_size(refit.weights()->size(), groups, "weights", "groups of pivots", message) ||
      !has_size(refit.term_counts()->size(), groups, "term_counts", "groups of pivots", message)) {
    return false;
  }
  if (!are_there) {
    return true;
  }
  std::uint32_t group = 0;
  for (const schema::Sphere* sphere : *root.spheres()) {
    for (std::uint32_t first = 0; first < sphere->pivot_count(); first += kPivotLanes, ++group) {
      const Floats& weights = *refit.weights()->Get(group)->values();
      for (std::uint32_t lane = 0; lane < kPivotLanes; ++lane) {
        const std::uint32_t k = first + lane;
        const float wanted = k < sphere->pivot_count() ? root.pivots()->Get(sphere->first_pivot() + k)->weight() : 0.0F;
        if (weights.Get(lane) != wanted) {
          return message.wrong("bone_refit.weights[%" PRIu32 "]: not those of the pivots", group);
        }
      }
    }
  }
  return true;
}

// The counts of one table's runs in another, one run after another.
bool check_runs(const Counts& counts, std::uint32_t least, std::uint32_t total, const char* name, Message& message) {
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < counts.size(); ++i) {
    if (counts.Get(i) < least) {
      return message.wrong("bone_refit.%s[%" PRIu32 "]: below %" PRIu32, name, i, least);
    }
    sum += counts.Get(i);
  }
  return sum == total || message.wrong("bone_refit.%s: they add up to %" PRIu64 ", not to %" PRIu32, name, sum, total);
}

// Entries name something that exists, ascending in each run.
bool check_names(const Counts& counts, const Counts& entries, std::uint32_t limit, const char* name, Message& message) {
  std::uint32_t i = 0;
  for (const std::uint32_t count : counts) {
    for (std::uint32_t left = count; left > 0; --left, ++i) {
      if (entries.Get(i) >= limit) {
        return message.wrong("bone_refit.%s[%" PRIu32 "]: %" PRIu32 " is past the %" PRIu32, name, i, entries.Get(i),
                             limit);
      }
      if (left < count && entries.Get(i) <= entries.Get(i - 1)) {
        return message.wrong("bone_refit.%s[%" PRIu32 "]: not above the one before it", name, i);
      }
    }
  }
  return true;
}

bool check_structure(const schema::BoneRefit& refit, Message& message) {
  const std::uint32_t terms = refit.terms()->size();
  const std::uint32_t morph_terms = refit.morph_terms()->size();
  if (!has_size(refit.term_bones()->size(), terms, "term_bones", "terms", message) ||
      !has_size(refit.morph_targets()->size(), morph_terms, "morph_targets", "morph terms", message) ||
      !has_size(refit.morph_term_counts()->size(), morph_terms == 0 ? 0 : terms, "morph_term_counts",
                "terms that morph", message)) {
    return false;
  }
  return check_runs(*refit.term_counts(), 1, terms, "term_counts", message) &&
         check_runs(*refit.morph_term_counts(), 0, morph_terms, "morph_term_counts", message) &&
         check_names(*refit.term_counts(), *refit.term_bones(), refit.bones()->size(), "term_bones", message) &&
         check_names(*refit.morph_term_counts(), *refit.morph_targets(), refit.morphs()->size(), "morph_targets",
                     message);
}

// Spare lanes must add nothing, on every machine.
bool check_lanes(const schema::Asset& root, const schema::BoneRefit& refit, Message& message) {
  std::uint32_t group = 0, term = 0, morph_term = 0;
  for (const schema::Sphere* sphere : *root.spheres()) {
    for (std::uint32_t first = 0; first < sphere->pivot_count(); first += kPivotLanes, ++group) {
      const auto used = std::min<std::uint32_t>(kPivotLanes, sphere->pivot_count() - first);
      for (const std::uint32_t end = term + refit.term_counts()->Get(group); term < end; ++term) {
        const schema::BoneTerm& t = *refit.terms()->Get(term);
        if (!lanes_are_valid(*t.x(), used) || !lanes_are_valid(*t.y(), used) || !lanes_are_valid(*t.z(), used) ||
            !lanes_are_valid(*t.w(), used)) {
          return message.wrong("bone_refit.terms[%" PRIu32 "]: not finite, or a spare lane is not 0", term);
        }
        const std::uint32_t morphs = refit.morph_term_counts()->size() == 0 ? 0 : refit.morph_term_counts()->Get(term);
        for (const std::uint32_t last = morph_term + morphs; morph_term < last; ++morph_term) {
          const schema::MorphTerm& m = *refit.morph_terms()->Get(morph_term);
          if (!lanes_are_valid(*m.x(), used) || !lanes_are_valid(*m.y(), used) || !lanes_are_valid(*m.z(), used)) {
            return message.wrong("bone_refit.morph_terms[%" PRIu32 "]: not finite, or a spare lane is not 0",
                                 morph_term);
          }
        }
      }
    }
  }
  return true;
}

}  // namespace

bool bone_values_are_valid(const schema::Asset& root, Message& message) {
  if (!check_packed(root, message)) {
    return false;
  }
  const schema::BoneRefit* refit = root.bone_refit();
  return refit == nullptr ||
         (check_bones(*refit, message) && check_weights(root, *refit, message) && check_structure(*refit, message) &&
          (!has_pivots(root, *refit) || check_lanes(root, *refit, message)));
}

}  // namespace spherechain
