// SPDX-License-Identifier: MIT
// A response's memory, and what it knows of the character before its first frame.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/penetrations/rule.h"
#include "runtime/src/response/response.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_response_def, allocator);

namespace {

constexpr double kBudget = 1.05, kBudgetMost = 2;  // radians

std::size_t lay_out(sc_response& response, std::size_t joints, std::uint64_t* words) {
  WordMemory memory(words);
  const AssetView& asset = asset_of(*response.body);
  const std::size_t parts = asset.part_count();
  sc_response* self = nullptr;
  memory.take(self, 1);
  memory.take(response.parents, joints);
  memory.take(response.order, joints);
  memory.take(response.joint_of_part, parts);
  memory.take(response.turning_of_part, parts);
  memory.take(response.part_pairs, words_for(parts * parts));
  memory.take(response.resting_parts, words_for(parts));
  memory.take(response.apart_pairs, words_for(parts * kMaxPartCount));
  memory.take(response.joints, joints);
  memory.take(response.animated, joints);
  memory.take(response.world, joints);
  memory.take(response.bones, 12 * asset.bone_count());
  return memory.used();
}

bool ends_with(const char* name, const char* end) {
  const std::size_t size = std::strlen(name), wanted = std::strlen(end);
  return size >= wanted && std::strcmp(name + size - wanted, end) == 0;
}

// How easily a body part turns if the caller does not say.
double mobility_of(const char* name) {
  constexpr double kOfHand = 0.3;
  return ends_with(name, " upper arm") || ends_with(name, " forearm") ? 1 : ends_with(name, " hand") ? kOfHand : 0;
}

// A turn by an angle up to 2 has this length (see turn_of), with the same bits everywhere.
double length_of_turn(double angle) {
  const double quarter = angle / 4, s = quarter * quarter,
               tangent = quarter * (1 + s / 3 + 2 * s * s / 15 + 17 * s * s * s / 315);
  return 4 * tangent / (1 - tangent * tangent);
}

// Adds a joint that turns. False where a figure is out of range, or they are too many.
bool add_turning(sc_response& response, std::uint32_t joint, double mobility, double budget) {
  const auto end = response.turning + response.turning_count;
  if (mobility == 0 || std::any_of(response.turning, end, [&](const TurningJoint& t) { return t.joint == joint; })) {
    return true;
  }
  if (response.turning_count == kTurningMost || !(mobility > 0 && mobility <= 1) ||
      !(budget >= 0 && budget <= kBudgetMost)) {
    return false;
  }
  TurningJoint& added = response.turning[response.turning_count++];
  added = TurningJoint{};
  added.joint = joint;
  added.mobility = mobility;
  added.budget = length_of_turn(budget);
  return true;
}

bool add_all_turning(sc_response& response, const sc_response_def& def) {
  const auto budget = [&](std::uint32_t joint) { return def.budget == nullptr ? kBudget : double{def.budget[joint]}; };
  const sc_asset& asset = response.body->model->asset;
  for (std::uint32_t part = 0; def.mobility == nullptr && part < response.joint_of_part.size; ++part) {
    const std::uint32_t joint = response.joint_of_part[part];
    if (joint != SC_NO_JOINT &&
        !add_turning(response, joint, mobility_of(sc_asset_part(&asset, part).name), budget(joint))) {
      return false;
    }
  }
  for (std::uint32_t joint = 0; def.mobility != nullptr && joint < def.joint_count; ++joint) {
    if (!add_turning(response, joint, double{def.mobility[joint]}, budget(joint))) {
      return false;
    }
  }
  return true;
}

// A joint at rest. False where no bone says where it is.
bool at_rest(const sc_model& model, std::uint32_t joint, Affine& out) {
  const std::size_t bones = view_of(model.asset).bone_count();
  for (std::size_t b = 0; b < bones; ++b) {
    if ((model.joint_of_bone == nullptr ? b : model.joint_of_bone[b]) == joint) {
      return invert(affine_of_rows(sc_asset_bone(&model.asset, b).inverse_bind), out);
    }
  }
  return false;
}

// The axis about which an elbow is bent at rest, in its parent's axes; zero where it is straight or not known.
Double3 hinge_at_rest(const sc_response& response, const TurningJoint& elbow) {
  constexpr double kStraight = 0.02;  // a sine
  const sc_model& model = *response.body->model;
  const std::uint32_t parent = response.parents[elbow.joint];
  Affine above, own, below, axes;
  if (parent == SC_NO_JOINT || !at_rest(model, elbow.above, above) || !at_rest(model, elbow.joint, own) ||
      !at_rest(model, elbow.below, below) || !at_rest(model, parent, axes)) {
    return {0, 0, 0};
  }
  Double3 upper = place_of(own) - place_of(above), lower = place_of(below) - place_of(own);
  if (!normalize(upper) || !normalize(lower)) {
    return {0, 0, 0};
  }
  Double3 across = cross(upper, lower);
  const double sine = length(across);
  across = into(axes_of(axes), across);
  return sine > kStraight && normalize(across) ? across : Double3{0, 0, 0};
}

// The first joint below another; SC_NO_JOINT: there is none.
std::uint32_t child_of(const sc_response& response, std::uint32_t joint) {
  const auto found = std::find(response.parents.begin(), response.parents.end(), joint);
  return found == response.parents.end() ? SC_NO_JOINT : static_cast<std::uint32_t>(found - response.parents.begin());
}

// Finds arms: a forearm that hangs on an upper arm, and the hand on it. The hand may have no skin of its own.
void find_arms(sc_response& response) {
  const sc_asset& asset = response.body->model->asset;
  const std::size_t parts = response.joint_of_part.size;
  for (std::size_t forearm = 0; forearm < parts; ++forearm) {
    const std::int32_t upper = sc_asset_part(&asset, forearm).parent;
    if (!ends_with(sc_asset_part(&asset, forearm).name, " forearm") || upper < 0 ||
        response.joint_of_part[forearm] == SC_NO_JOINT) {
      continue;
    }
    const std::uint32_t shoulder = response.joint_of_part[static_cast<std::size_t>(upper)],
                        elbow = response.joint_of_part[forearm];
    std::uint32_t wrist = child_of(response, elbow);
    for (std::size_t hand = 0; hand < parts; ++hand) {
      const sc_part of_hand = sc_asset_part(&asset, hand);
      const bool is_its = ends_with(of_hand.name, " hand") && of_hand.parent == static_cast<std::int32_t>(forearm);
      wrist = is_its && response.joint_of_part[hand] != SC_NO_JOINT ? response.joint_of_part[hand] : wrist;
    }
    for (std::size_t t = 0; t < response.turning_count; ++t) {
      TurningJoint& joint = response.turning[t];
      joint.wrist = joint.joint == shoulder || joint.joint == elbow || joint.joint == wrist ? wrist : joint.wrist;
      if (joint.joint == elbow) {
        joint.above = shoulder;
        joint.below = wrist;
        joint.hinge = joint.is_given ? joint.hinge : hinge_at_rest(response, joint);
      }
    }
  }
}

// The turning joints that move a part, a bit each.
std::uint32_t turning_of(const sc_response& response, std::size_t part) {
  std::uint32_t out = 0;
  for (std::uint32_t joint = response.joint_of_part[part]; joint != SC_NO_JOINT; joint = response.parents[joint]) {
    for (std::uint32_t t = 0; t < response.turning_count; ++t) {
      out |= response.turning[t].joint == joint ? 1U << t : 0U;
    }
  }
  return out;
}

// Does the joint of this part turn?
bool turns(const sc_response& response, std::size_t part) {
  return std::any_of(response.turning, response.turning + response.turning_count,
                     [&](const TurningJoint& t) { return t.joint == response.joint_of_part[part]; });
}

void find_pairs(sc_response& response, const sc_response_def& def) {
  const sc_asset& asset = response.body->model->asset;
  const std::size_t parts = response.joint_of_part.size;
  std::fill(response.part_pairs.begin(), response.part_pairs.end(), std::uint64_t{0});
  std::fill(response.resting_parts.begin(), response.resting_parts.end(), std::uint64_t{0});
  for (std::size_t a = 0; a < parts; ++a) {
    response.turning_of_part[a] = turning_of(response, a);
    response.resting_parts[a / 64] |= std::uint64_t{response.turning_of_part[a] == 0} << a % 64;
  }
  for (std::size_t a = 0; a < parts; ++a) {
    for (std::size_t b = a + 1; b < parts; ++b) {
      const auto is_asked_as = [&](std::size_t bit) { return (def.part_pairs[bit / 64] >> bit % 64 & 1) != 0; };
      const bool are_joined = sc_asset_part(&asset, a).parent == static_cast<std::int32_t>(b) ||
                              sc_asset_part(&asset, b).parent == static_cast<std::int32_t>(a);
      // A thing in one hand does not make way for a thing in the other.
      const bool are_held = !turns(response, a) && !turns(response, b) && response.turning_of_part[a] != 0 &&
                            response.turning_of_part[b] != 0;
      const bool is_asked = response.turning_of_part[a] != response.turning_of_part[b] &&
                            (def.part_pairs == nullptr ? !are_joined && !are_held
                                                       : is_asked_as(a * parts + b) || is_asked_as(b * parts + a));
      response.part_pairs[(a * parts + b) / 64] |= std::uint64_t{is_asked} << (a * parts + b) % 64;
    }
  }
}

Status fill(sc_response& response, const sc_response_def& def) {
  std::copy_n(def.parents, def.joint_count, response.parents.data);
  if (!sort_joints({response.parents.data, response.parents.size}, response.order)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_PARENTS);
  }
  for (std::uint32_t part = 0; part < response.joint_of_part.size; ++part) {
    response.joint_of_part[part] = sc_get_part_joint(response.body->model, part);
  }
  if (!add_all_turning(response, def)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_JOINTS);
  }
  for (std::size_t t = 0; t < response.turning_count && def.hinges != nullptr; ++t) {
    TurningJoint& joint = response.turning[t];
    joint.is_given = true;
    joint.hinge = to_double(def.hinges[joint.joint]);
    if (!std::isfinite(dot(joint.hinge, joint.hinge))) {
      return refuse(SC_BAD_VALUE, SC_FIELD_JOINTS);
    }
    normalize(joint.hinge);
  }
  find_arms(response);
  find_pairs(response, def);
  return done();
}

// The number of joints that a model's bones need.
std::size_t joints_of(const sc_model& model) {
  const std::size_t bones = view_of(model.asset).bone_count();
  std::size_t out = model.joint_of_bone == nullptr ? bones : 0;
  for (std::size_t b = 0; b < bones && model.joint_of_bone != nullptr; ++b) {
    out = model.joint_of_bone[b] == SC_NO_JOINT ? out : std::max<std::size_t>(out, model.joint_of_bone[b] + 1);
  }
  return out;
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_create_response(sc_body* body, const sc_response_def* given, sc_response** response) noexcept {
  if (response != nullptr) {
    *response = nullptr;
  }
  sc_response_def def{};
  const Status known = given == nullptr ? done() : read_struct(given, def);
  if (known != SC_OK) {
    return known;
  }
  if (body == nullptr || response == nullptr || def.parents == nullptr) {
    return refuse(SC_NULL, body == nullptr       ? SC_FIELD_BODIES
                           : response == nullptr ? SC_FIELD_OUTPUT
                                                 : SC_FIELD_PARENTS);
  }
  sc_response made{};
  made.body = body;
  made.rule = def.rule == nullptr ? sc_default_rule() : *def.rule;
  if (def.joint_count < joints_of(*body->model)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_JOINTS);
  }
  const Status rule = check_rule(def.rule);
  if (rule != SC_OK) {
    return rule;
  }
  const Status complete = choose_allocator(def.allocator, body->allocator, made.allocator);
  if (complete != SC_OK) {
    return complete;
  }
  if (!made.block.allocate(made.allocator, lay_out(made, def.joint_count, nullptr))) {
    return refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  }
  lay_out(made, def.joint_count, made.block.words);
  const Status status = fill(made, def);
  if (status != SC_OK) {
    made.block.release(made.allocator);
    return status;
  }
  *response = new (made.block.words) sc_response(made);
  return done();
}

void sc_destroy_response(sc_response* response) noexcept {
  if (response != nullptr) {
    Block block = response->block;
    const sc_allocator allocator = response->allocator;
    block.release(allocator);
  }
}

}  // extern "C"
