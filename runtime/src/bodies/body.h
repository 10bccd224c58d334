// SPDX-License-Identifier: MIT
#pragma once

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/filter.h"
#include "runtime/src/bodies/model.h"
#include "runtime/src/penetrations/penetration_jobs.h"
#include "spherechain/body.h"

namespace spherechain {

// A pose that was given, in memory of the body.
struct GivenPose {
  float *bones = nullptr, *morph_weights = nullptr;
  sc_pose pose{};  // points there; to vertices of the caller's
  bool is_given = false;
};

}  // namespace spherechain

struct sc_body {
  const sc_model* model;
  sc_allocator allocator;
  spherechain::Block block;  // this, and what the pointers below point into
  spherechain::GivenPose now, before;
  std::uint64_t* scratch;
  std::size_t scratch_words;
  spherechain::Span<sc_sphere> spheres;
  spherechain::Span<sc_pair> sphere_pairs;  // that overlap
  spherechain::Span<sc_part_contact> parts;
  spherechain::Span<sc_pair> contact_spheres;
  spherechain::Span<sc_triangle_contact> triangles;
  std::uint64_t* part_pairs;                          // a bit for each two parts, as of a contact job
  spherechain::Span<sc_penetration> penetrations[2];  // of the last question, and of the one before
  spherechain::Span<sc_step_contact> steps;
  spherechain::Span<std::uint16_t> inside[2];  // of each probe, and of the other body's: the part that holds it
  spherechain::Span<sc_sphere> other_spheres;  // the other body's
  bool has_spheres;                            // of this pose, with that radius
  sc_radius spheres_radius;
  sc_contacts contacts;  // of the last question
  bool has_contacts;     // they are all of this body with itself, in this pose and that scope
  sc_scope contacts_scope;
  spherechain::Filter filter;  // of the query that is being answered
};

namespace spherechain {

inline const AssetView& asset_of(const sc_body& body) { return view_of(body.model->asset); }

// As sc_set_pose(). `in_asset_order`: the bones are in the asset's order already.
Status take_pose(sc_body& body, const sc_pose& pose, const sc_transform* place, bool in_asset_order);

// As sc_find_penetrations() without `full`, but a fault of the query's `previous` is measured along its direction
// alone, where that is no detour. `ignored_parts` may be given without `other`: these are then not looked at for being
// inside another part.
Status find_along(sc_body& body, const sc_body* other, const sc_query& query, sc_penetrations& found);

// The body as jobs take it.
inline JobBody side_of(const sc_body& body, const std::uint64_t* ignored_parts) {
  return {&body.model->asset, body.now.pose, body.model->skin_table, ignored_parts};
}

}  // namespace spherechain
