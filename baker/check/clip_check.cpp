// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/clip_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "baker/check/events.h"
#include "baker/page/base64.h"
#include "baker/page/page_axes.h"
#include "baker/page/page_motion.h"
#include "baker/page/page_penetrations.h"
#include "baker/play/hidden_joints.h"
#include "baker/report/json_text.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kSampleSize = 1500;

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

// A fault is worse than a contact that is none, however deep.
std::pair<PenetrationClass, float> severity(const Penetration& found) {
  return {is_fault(found.kind) ? found.kind : static_cast<PenetrationClass>(SC_CLASS_REST), found.measures.depth};
}

bool is_shown(PenetrationClass kind) { return is_fault(kind) || kind == SC_CLASS_TOUCH; }

}  // namespace

bool same_pose(const Deformation& first, const Deformation& last, const BodyFrame& axes) {
  if (first.bones.empty() || first.morphs != last.morphs) return false;
  constexpr double kSame = 0.002;  // of the height
  const Affine moved = last.bones[0] * first.bones[0].inverse();
  for (std::size_t b = 0; b < first.bones.size(); ++b) {
    for (const double y : {0.0, 1.0}) {
      for (const double x : {-0.5, 0.5}) {
        const Vec3 p = axes.origin + axes.height * (y * axes.up + x * axes.left);
        if (!((moved * (first.bones[b] * p) - last.bones[b] * p).norm() < kSame * axes.height)) return false;
      }
    }
  }
  return true;
}

struct ClipChecker::Frames {
  std::vector<FramePenetration> meetings;        // by frame, then by parts
  std::vector<std::vector<Triangles>> contacts;  // of a meeting that is shown: the triangles that intersect
  PageMotion motion;
  HiddenJoints hidden;
  bool loops = false;
  std::vector<EventSpan> spans;
};

ClipChecker::ClipChecker(const AnimatedAsset& animated, Target target)
    : animated_(animated),
      player_(animated.asset(), target),
      parts_(body_parts_of(animated.asset())),
      mm_(mm_per_unit(animated.asset())),
      axes_(page_axes(animated)),
      picture_(animated.character().source_positions, animated.character().source_triangles, axes_) {
  animated.check_clusters();
}

// A motion may bring weights that the one before had not.
void ClipChecker::take_sample() {
  const std::vector<Vec3>& rest = animated_.character().source_positions;
  if (sample_weights_.empty() != animated_.weights().empty()) sample_.clear();
  if (!sample_.empty()) return;
  const std::size_t step = std::max<std::size_t>(1, rest.size() / kSampleSize);
  for (std::size_t v = 0; v < rest.size(); v += step) {
    sample_.push_back(rest[v]);
    if (!animated_.weights().empty()) sample_weights_.push_back(animated_.weights()[v]);
  }
}

ClipChecker::Triangles ClipChecker::triangles_of(const TriangleContact& contact) {
  return contact.part_a <= contact.part_b ? Triangles{contact.triangle_a, contact.triangle_b}
                                          : Triangles{contact.triangle_b, contact.triangle_a};
}

// Every frame's contacts, measured quickly.
ClipChecker::Frames ClipChecker::look(const ClipFrames& clip, const Progress& progress) {
  take_sample();
  Frames out{{}, {}, PageMotion(animated_.character(), axes_), HiddenJoints(animated_), false, {}};
  Deformation first;
  for (int i = 0; i < clip.count; ++i) {
    progress(i, clip.count);
    Deformation deformation = animated_.deformation(clip.first + i);
    const SkinPose skin(animated_, deformation);
    player_.set_pose(skin.pose());
    const Span<const TriangleContact> found_now = player_.triangles();
    const std::vector<TriangleContact> contacts(found_now.begin(), found_now.end());
    const std::size_t before = out.meetings.size();
    for (const Penetration& found : player_.measure_quickly()) {
      out.meetings.push_back({i, found});
      float& visible = out.meetings.back().found.measures.visible;
      if (visible == 1 && !is_fault(found.kind)) visible = -1;  // nobody looked
    }
    out.contacts.resize(out.meetings.size());
    for (const TriangleContact& contact : contacts) {
      std::size_t m = before;
      while (!are_of(out.meetings[m].found, contact.part_a, contact.part_b)) ++m;
      if (is_shown(out.meetings[m].found.kind)) out.contacts[m].push_back(triangles_of(contact));
    }
    out.motion.add(deformation, deformation.positions.empty() ? deform(sample_, sample_weights_, deformation.bones)
                                                              : deformation.positions);
    if (animated_.frame_at(clip.first + i).between == 0) out.hidden.add(deformation);
    if (i == clip.count - 1) out.loops = clip.count > 2 && same_pose(first, deformation, axes_);
    if (i == 0) first = std::move(deformation);
  }
  return out;
}

// Measures a meeting in full: with its volume, and where it is no fault along many directions.
void ClipChecker::measure(const ClipFrames& clip, FramePenetration& meeting, std::vector<Triangles>& triangles) {
  const SkinPose skin(animated_, animated_.deformation(clip.first + meeting.frame));
  player_.set_pose(skin.pose());
  triangles.clear();
  for (const TriangleContact& contact : player_.triangles()) {
    if (are_of(meeting.found, contact.part_a, contact.part_b)) triangles.push_back(triangles_of(contact));
  }
  meeting.found = player_.measure_parts(meeting.found.part, meeting.found.other).value();
}

// An event has class and depth of its worst frame, and no frame is worse than that one. Frames between others never
// take a touch away: they make an event worse, or leave it as it is.
void ClipChecker::find_worst(Frames& frames, const ClipFrames& clip, EventSpan& span) {
  const auto found = [&](std::size_t m) -> Penetration& { return frames.meetings[m].found; };
  std::vector<std::size_t> whole, between;
  for (const std::size_t m : span.meetings) {
    const bool lies_between = animated_.frame_at(clip.first + frames.meetings[m].frame).between > 0;
    (lies_between ? between : whole).push_back(m);
  }
  const auto worst_of = [&](const std::vector<std::size_t>& all) {
    return *std::max_element(all.begin(), all.end(), [&](auto l, auto r) {  // of equal ones the first in the clip
      return severity(found(l)) != severity(found(r)) ? severity(found(l)) < severity(found(r)) : l > r;
    });
  };
  span.deepest = worst_of(whole.empty() ? between : whole);
  if (!whole.empty() && !between.empty()) {
    const std::size_t other = worst_of(between);
    const bool may_take_over = is_fault(found(other).kind) || found(other).kind == found(span.deepest).kind;
    if (may_take_over && severity(found(other)) > severity(found(span.deepest))) span.deepest = other;
  }
  measure(clip, frames.meetings[span.deepest], frames.contacts[span.deepest]);
  const Penetration& worst = found(span.deepest);
  for (const std::size_t m : span.meetings) {
    found(m).measures.depth = std::min(found(m).measures.depth, worst.measures.depth);
    found(m).kind = std::min(found(m).kind, worst.kind);
  }
}

Event ClipChecker::event_of(const Frames& frames, const EventSpan& span, const ClipFrames& clip) const {
  const Penetration& worst = frames.meetings[span.deepest].found;
  Event event;
  event.parts = {parts_.parts[worst.part].name, parts_.parts[worst.other].name};
  event.kind = worst.kind;
  const int deepest = frames.meetings[span.deepest].frame;
  event.from = animated_.number(clip.first + span.from);
  event.to = animated_.number(clip.first + span.to);
  event.deepest = animated_.number(clip.first + deepest);
  event.first_place = span.from;
  event.place = deepest;
  event.depth_mm = mm_ * double{worst.measures.depth};
  event.depth_percent = 100 * double{worst.measures.depth} / animated_.frame().height;
  if (worst.measures.volume >= 0) event.volume_ml = std::pow(mm_ / 10, 3) * double{worst.measures.volume};
  event.direction = to_vec3(worst.direction);
  event.point = to_vec3(worst.deepest.position);
  if (!is_fault(worst.kind)) return event;
  const int length = span.from <= span.to ? span.to - span.from + 1 : clip.count - span.from + span.to + 1;
  event.depths_mm.assign(static_cast<std::size_t>(length), 0);
  for (const std::size_t m : span.meetings) {
    const auto& [frame, found] = frames.meetings[m];
    if (!is_fault(found.kind)) continue;
    const int at = frame >= span.from ? frame - span.from : frame - span.from + clip.count;
    event.depths_mm[static_cast<std::size_t>(at)] = static_cast<float>(mm_ * double{found.measures.depth});
  }
  return event;
}

// Rules excuse a fault by its parts, its class and its depth. So the worst that they leave is the deepest of its parts
// and class: each of those has a picture.
void ClipChecker::show(ClipCheck& out, const Frames& frames, const ClipFrames& clip) {
  const auto patches_of = [&](const Event& event, const std::vector<Triangles>& contacts) {
    Patches patches;
    Vec3 sum = Vec3::Zero();
    for (const Triangles& pair : contacts) {
      patches.triangles[0].push_back(pair[0]);
      patches.triangles[1].push_back(pair[1]);
      for (const std::uint32_t t : pair) {
        for (const Index v : animated_.character().source_triangles[t]) sum += picture_.position(v);
      }
    }
    patches.point = sum / (6 * static_cast<double>(contacts.size()));
    patches.way = event.direction;
    return patches;
  };
  picture_.pose(animated_.positions(animated_.deformation(clip.first)));
  out.pictures.push_back(picture_.png(nullptr, axes_.forward));
  std::map<std::tuple<std::string, std::string, PenetrationClass>, const Event*> deepest;
  for (const Event& event : out.result.events) {
    const Event*& known = deepest[{event.parts[0], event.parts[1], event.kind}];
    if (known == nullptr || event.depth_mm > known->depth_mm) known = &event;
  }
  for (std::size_t i = 0; i < out.result.events.size(); ++i) {
    Event& event = out.result.events[i];
    if (!is_fault(event.kind)) continue;
    picture_.pose(animated_.positions(animated_.deformation(clip.first + event.place)));
    const Patches patches = patches_of(event, frames.contacts[frames.spans[i].deepest]);
    event.eye = picture_.find_eye(patches);
    if (deepest[{event.parts[0], event.parts[1], event.kind}] != &event) continue;
    event.picture = static_cast<int>(out.pictures.size());
    out.pictures.push_back(picture_.png(&patches, *event.eye));
  }
}

// Sums up faults only, over the frames in which they are faults.
std::vector<HeatSpot> ClipChecker::heat_of(const Frames& frames) const {
  struct Heat {
    HeatSpot spot;
    int last;  // frame
  };
  std::vector<HeatSpot> out;
  for (std::uint32_t e = 0; e < frames.spans.size(); ++e) {
    std::map<std::uint32_t, Heat> heat;
    for (const std::size_t m : frames.spans[e].meetings) {
      const auto& [frame, found] = frames.meetings[m];
      if (!is_fault(found.kind)) continue;
      for (const Triangles& pair : frames.contacts[m]) {
        for (const std::uint32_t t : pair) {
          auto& [spot, last] = heat.try_emplace(t, Heat{{e, t, 0, 0}, -1}).first->second;
          spot.frames += last != frame ? 1 : 0;
          spot.depth_mm = std::max(spot.depth_mm, static_cast<float>(mm_ * double{found.measures.depth}));
          last = frame;
        }
      }
    }
    for (const auto& [triangle, one] : heat) out.push_back(one.spot);
  }
  return out;
}

ClipCheck ClipChecker::check(std::size_t index, const Progress& progress) {
  const ClipFrames& clip = animated_.clips()[index];
  Frames frames = look(clip, progress);
  std::vector<double> at;
  for (int i = 0; i < clip.count; ++i) at.push_back(animated_.number(clip.first + i));
  frames.spans = join_events(frames.meetings, at, frames.loops);
  for (EventSpan& span : frames.spans) find_worst(frames, clip, span);
  ClipCheck out;
  out.result.frames = clip.count - clip.between;
  out.result.between = clip.between;
  out.result.fps = clip.fps;
  out.result.loops = frames.loops;
  out.result.unseen = unseen_text(frames.hidden, clip);
  for (const EventSpan& span : frames.spans) out.result.events.push_back(event_of(frames, span, clip));
  out.heat = heat_of(frames);
  show(out, frames, clip);
  FrameLists<Triangles> contacts;
  FrameLists<PenetrationEntry> penetrations;
  for (std::size_t i = 0, m = 0; i < static_cast<std::size_t>(clip.count); ++i) {
    std::vector<Triangles> triangles;
    std::vector<Penetration> found;
    for (; m < frames.meetings.size() && frames.meetings[m].frame == static_cast<int>(i); ++m) {
      found.push_back(frames.meetings[m].found);
      if (is_shown(found.back().kind)) {
        triangles.insert(triangles.end(), frames.contacts[m].begin(), frames.contacts[m].end());
      }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& l, const auto& r) { return l.measures.depth > r.measures.depth; });
    contacts.add(triangles);
    penetrations.add(entries_of(found, mm_));
  }
  std::vector<float> numbers, seconds;
  for (int i = clip.first; i < clip.first + clip.count; ++i) {
    numbers.push_back(static_cast<float>(animated_.number(i)));
    seconds.push_back(static_cast<float>(animated_.number(i) / clip.fps));
  }
  out.page = json_text({{"frames",
                         {{"count", clip.count},
                          {"fps", clip.fps},
                          {"numbers", base64(numbers)},
                          {"seconds", base64(seconds)},
                          {"times", base64(seconds)},
                          {"contacts", contacts.json()},
                          {"penetrations", penetrations.json()}}},
                        {"motion", frames.motion.json(PageMotion::Still::kInMotion)}},
                       -1);
  return out;
}

}  // namespace spherechain::baker
