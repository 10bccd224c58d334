// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/events/find_events.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "baker/motion/same_pose.h"
#include "baker/play/hidden_joints.h"

namespace spherechain::baker {
namespace {

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

// A fault is worse than a contact that is none, however deep; and one that is a fault by itself is worse than one that
// only follows a fault.
std::tuple<PenetrationClass, bool, float> severity(const Penetration& found) {
  return {is_fault(found.kind) ? found.kind : static_cast<PenetrationClass>(SC_CLASS_REST), found.fault_depth > 0,
          found.measures.depth};
}

TrianglePair triangles_of(const TriangleContact& contact) {
  return contact.part_a <= contact.part_b ? TrianglePair{contact.triangle_a, contact.triangle_b}
                                          : TrianglePair{contact.triangle_b, contact.triangle_a};
}

}  // namespace

EventFinder::EventFinder(const AnimatedAsset& animated, Target target, const BodyFrame& axes)
    : animated_(animated),
      player_(animated.asset(), target),
      parts_(body_parts_of(animated.asset())),
      mm_(mm_per_unit(animated.asset())),
      axes_(axes) {}

// Finds every frame's contacts, and measures them quickly.
void EventFinder::look(const ClipFrames& clip, const std::function<void(int, const Deformation&)>& observe,
                       ClipEvents& out) {
  HiddenJoints hidden(animated_);
  Deformation first;
  for (int i = 0; i < clip.count; ++i) {
    Deformation deformation = animated_.deformation(clip.first + i);
    observe(i, deformation);
    const SkinPose skin(animated_, deformation);
    player_.set_pose(skin.pose());
    const Span<const TriangleContact> found_now = player_.triangles();
    const std::vector<TriangleContact> contacts(found_now.begin(), found_now.end());
    const std::size_t before = out.penetrations.size();
    for (const Penetration& found : player_.measure_quickly(nullptr, i > 0)) {
      out.penetrations.push_back({i, found});
      float& visible = out.penetrations.back().found.measures.visible;
      if (visible == 1 && !is_fault(found.kind)) visible = -1;  // nobody looked
    }
    out.contacts.resize(out.penetrations.size());
    for (const TriangleContact& contact : contacts) {
      std::size_t m = before;
      while (!are_of(out.penetrations[m].found, contact.part_a, contact.part_b)) ++m;
      if (is_shown(out.penetrations[m].found.kind)) out.contacts[m].push_back(triangles_of(contact));
    }
    if (animated_.frame_at(clip.first + i).between == 0) hidden.add(deformation);
    if (i == clip.count - 1) out.loops = clip.count > 2 && same_pose(first, deformation, axes_);
    if (i == 0) first = std::move(deformation);
  }
  out.unseen = unseen_text(hidden, clip);
}

// Measures a penetration in full: with its volume, and where it is no fault along many directions.
void EventFinder::measure(const ClipFrames& clip, FramePenetration& penetration, std::vector<TrianglePair>& triangles) {
  const SkinPose skin(animated_, animated_.deformation(clip.first + penetration.frame));
  player_.set_pose(skin.pose());
  triangles.clear();
  for (const TriangleContact& contact : player_.triangles()) {
    if (are_of(penetration.found, contact.part_a, contact.part_b)) triangles.push_back(triangles_of(contact));
  }
  penetration.found = player_.measure_parts(penetration.found.part, penetration.found.other).value();
}

// An event has class and depth of its worst frame, and no frame is worse than that one. Frames between others never
// take a touch away: they make an event worse, or leave it as it is.
void EventFinder::find_worst(const ClipFrames& clip, ClipEvents& found, EventSpan& span) {
  const auto penetration = [&](std::size_t m) -> Penetration& { return found.penetrations[m].found; };
  std::vector<std::size_t> whole, between;
  for (const std::size_t m : span.penetrations) {
    const bool lies_between = animated_.frame_at(clip.first + found.penetrations[m].frame).between > 0;
    (lies_between ? between : whole).push_back(m);
  }
  const auto worst_of = [&](const std::vector<std::size_t>& all) {
    return *std::max_element(all.begin(), all.end(), [&](auto l, auto r) {  // of equal ones the first in the clip
      return severity(penetration(l)) != severity(penetration(r)) ? severity(penetration(l)) < severity(penetration(r))
                                                                  : l > r;
    });
  };
  span.deepest = worst_of(whole.empty() ? between : whole);
  if (!whole.empty() && !between.empty()) {
    const std::size_t other = worst_of(between);
    const bool may_take_over =
        is_fault(penetration(other).kind) || penetration(other).kind == penetration(span.deepest).kind;
    if (may_take_over && severity(penetration(other)) > severity(penetration(span.deepest))) span.deepest = other;
  }
  measure(clip, found.penetrations[span.deepest], found.contacts[span.deepest]);
  const Penetration& worst = penetration(span.deepest);
  for (const std::size_t m : span.penetrations) {
    penetration(m).measures.depth = std::min(penetration(m).measures.depth, worst.measures.depth);
    penetration(m).kind = std::min(penetration(m).kind, worst.kind);
  }
}

Event EventFinder::event_of(const ClipFrames& clip, const ClipEvents& found, const EventSpan& span) const {
  const Penetration& worst = found.penetrations[span.deepest].found;
  Event event;
  event.parts = {parts_.parts[worst.part].name, parts_.parts[worst.other].name};
  event.kind = worst.kind;
  const int deepest = found.penetrations[span.deepest].frame;
  event.from = animated_.number(clip.first + span.from);
  event.to = animated_.number(clip.first + span.to);
  event.deepest = animated_.number(clip.first + deepest);
  event.first_place = span.from;
  event.place = deepest;
  event.depth_mm = mm_ * double{worst.measures.depth};
  event.depth_percent = 100 * double{worst.measures.depth} / animated_.frame().height;
  if (worst.measures.volume >= 0) event.volume_ml = std::pow(mm_ / 10, 3) * double{worst.measures.volume};
  event.swallowed = std::round(1e4 * double{worst.measures.swallowed}) / 1e4;
  event.passes_through = worst.measures.through != 0;
  event.direction = to_vec3(worst.direction);
  event.point = to_vec3(worst.deepest.position);
  if (!is_fault(worst.kind)) return event;
  const int length = span.from <= span.to ? span.to - span.from + 1 : clip.count - span.from + span.to + 1;
  event.depths_mm.assign(static_cast<std::size_t>(length), 0);
  for (const std::size_t m : span.penetrations) {
    const auto& [frame, penetration] = found.penetrations[m];
    if (!is_fault(penetration.kind)) continue;
    const int at = frame >= span.from ? frame - span.from : frame - span.from + clip.count;
    event.depths_mm[static_cast<std::size_t>(at)] = static_cast<float>(mm_ * double{penetration.measures.depth});
  }
  return event;
}

ClipEvents EventFinder::find(const ClipFrames& clip, const std::function<void(int, const Deformation&)>& observe) {
  ClipEvents out;
  look(clip, observe, out);
  std::vector<double> numbers;
  for (int i = 0; i < clip.count; ++i) numbers.push_back(animated_.number(clip.first + i));
  out.spans = join_events(out.penetrations, numbers, out.loops);
  for (EventSpan& span : out.spans) {
    find_worst(clip, out, span);
    out.events.push_back(event_of(clip, out, span));
  }
  return out;
}

}  // namespace spherechain::baker
