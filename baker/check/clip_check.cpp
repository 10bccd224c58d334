// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/clip_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "check/events.h"
#include "page/base64.h"
#include "page/page_axes.h"
#include "page/page_motion.h"
#include "page/page_penetrations.h"
#include "report/json_text.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kSampleSize = 1500;

std::vector<double> sizes_of(const BodyParts& parts, const Character& character) {
  std::vector<double> out(parts.parts.size(), 0);
  for (std::size_t t = 0; t < parts.of_triangle.size(); ++t) {
    if (parts.of_triangle[t] >= out.size()) continue;
    const Triangle& triangle = character.source_triangles[t];
    const Vec3& a = character.source_positions[triangle[0]];
    out[parts.of_triangle[t]] +=
        (character.source_positions[triangle[1]] - a).cross(character.source_positions[triangle[2]] - a).norm();
  }
  return out;
}

// Whether two poses are the same, wherever the character stands: its first bone says where.
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

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

struct ClipChecker::Frames {
  std::vector<PartMeeting> meetings;
  FrameLists<std::array<std::uint32_t, 2>> contacts;  // triangles of faults and touches
  FrameLists<PenetrationEntry> penetrations;
  PageMotion motion;
  bool loops = false;
  std::vector<EventSpan> spans;
  std::vector<Event> events;  // of the spans
};

ClipChecker::ClipChecker(const AnimatedAsset& animated, Target target)
    : animated_(animated),
      player_(animated.asset(), target),
      parts_(parts_of(animated.asset())),
      areas_(sizes_of(parts_, animated.character())),
      mm_(mm_per_unit(animated.asset())),
      axes_(page_axes(animated)),
      picture_(animated.character().source_triangles, axes_) {
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

ClipChecker::Frames ClipChecker::look(const ClipFrames& clip) {
  take_sample();
  Frames out{{}, {}, {}, PageMotion(animated_.character(), axes_), false, {}, {}};
  Deformation first;
  for (int i = 0; i < clip.count; ++i) {
    Deformation deformation = animated_.deformation(clip.first + i);
    std::vector<Penetration> found;
    std::vector<std::array<std::uint32_t, 2>> triangles;
    const auto run = [&](const sc_pose& pose) {
      const std::vector<TriangleContact>& contacts = player_.find(pose);
      found = player_.measure(pose, i > 0);
      for (const TriangleContact& contact : contacts) {
        const auto [a, b] = std::minmax(contact.part_a, contact.part_b);
        const auto of = std::find_if(found.begin(), found.end(), [&, a = a, b = b](const Penetration& p) {
          return p.part_a == a && p.part_b == b;
        });
        if (of == found.end() || !(is_fault(of->kind) || of->kind == SC_CLASS_TOUCH)) continue;
        triangles.push_back({contact.triangle_a, contact.triangle_b});
      }
    };
    if (moved_by_bones(animated_.asset(), deformation)) {
      run(BonePose(animated_.asset(), deformation).pose());
    } else {
      const std::vector<float> positions = pack(animated_.positions(deformation));
      sc_pose pose;
      pose.vertices = positions.data();
      pose.vertex_count = positions.size() / 3;
      run(pose);
    }
    for (const Penetration& p : found) {
      const double ml = p.is_closed != 0 ? std::pow(mm_ / 10, 3) * double{p.volume} : -1;
      out.meetings.push_back({i, p.part_a, p.part_b, p.kind, mm_ * double{p.depth}, ml, to_vec3(p.direction),
                              to_vec3(p.deepest_b.position)});
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& l, const auto& r) { return l.depth > r.depth; });
    out.contacts.add(triangles);
    out.penetrations.add(entries_of(found, mm_));
    out.motion.add(deformation, deformation.positions.empty() ? deform(sample_, sample_weights_, deformation.bones)
                                                              : deformation.positions);
    if (i == clip.count - 1) out.loops = clip.count > 2 && same_pose(first, deformation, axes_);
    if (i == 0) first = std::move(deformation);
  }
  return out;
}

// A hand is in a thigh, a foot in a shin: what hangs farther out is in the other; of two alike the smaller.
std::pair<int, double> ClipChecker::rank(std::uint32_t part) const {
  int joints = 0;
  for (int p = parts_.parts[part].parent; p >= 0; p = parts_.parts[static_cast<std::size_t>(p)].parent) ++joints;
  return {joints, -areas_[part]};
}

Event ClipChecker::event_of(const Frames& frames, const EventSpan& span, const ClipFrames& clip) {
  const PartMeeting& worst = frames.meetings[span.deepest];
  Event event;
  event.parts = {parts_.parts[worst.part_a].name, parts_.parts[worst.part_b].name};
  event.inside = rank(worst.part_a) > rank(worst.part_b) ? 0 : 1;
  event.kind = worst.kind;
  event.from = span.from;
  event.to = span.to;
  event.deepest = worst.frame;
  event.depth_mm = worst.depth_mm;
  event.depth_percent = 100 * worst.depth_mm / (mm_ * animated_.frame().height);
  event.volume_ml = worst.volume_ml;
  event.direction = worst.direction;
  event.point = worst.point;
  if (!is_fault(worst.kind)) return event;
  const int length = span.from <= span.to ? span.to - span.from + 1 : clip.count - span.from + span.to + 1;
  event.depths_mm.assign(static_cast<std::size_t>(length), 0);
  for (const PartMeeting& m : frames.meetings) {
    if (m.part_a != worst.part_a || m.part_b != worst.part_b || !is_fault(m.kind)) continue;
    const int at = m.frame >= span.from ? m.frame - span.from : m.frame - span.from + clip.count;
    if (event.is_at(m.frame)) event.depths_mm[static_cast<std::size_t>(at)] = static_cast<float>(m.depth_mm);
  }
  return event;
}

// Rules excuse a fault by its parts, its class and its depth. So the worst that they leave is the deepest of its parts
// and class: each of those has a picture.
void ClipChecker::show(ClipCheck& out, const Frames& frames, const ClipFrames& clip) {
  const auto patches_at = [&](const Event& event, const PartMeeting& worst) {
    Patches patches;
    Vec3 sum = Vec3::Zero();
    double count = 0;
    const auto& list = frames.contacts.of(static_cast<std::size_t>(event.deepest));
    for (const auto& pair : list) {
      const std::array<std::uint8_t, 2> of{parts_.of_triangle[pair[0]], parts_.of_triangle[pair[1]]};
      if (std::min(of[0], of[1]) != worst.part_a || std::max(of[0], of[1]) != worst.part_b) continue;
      const std::size_t first = of[0] <= of[1] ? 0 : 1;
      patches.triangles[0].push_back(pair[first]);
      patches.triangles[1].push_back(pair[1 - first]);
      for (const std::uint32_t t : pair) {
        for (const Index v : animated_.character().source_triangles[t]) {
          sum += picture_.position(v);
          ++count;
        }
      }
    }
    patches.point = count > 0 ? Vec3(sum / count) : event.point;
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
    picture_.pose(animated_.positions(animated_.deformation(clip.first + event.deepest)));
    const Patches patches = patches_at(event, frames.meetings[frames.spans[i].deepest]);
    event.eye = picture_.find_eye(patches);
    if (deepest[{event.parts[0], event.parts[1], event.kind}] != &event) continue;
    event.picture = static_cast<int>(out.pictures.size());
    out.pictures.push_back(picture_.png(&patches, *event.eye));
  }
}

// Of faults alone, in the frames where they are one.
std::vector<HeatSpot> ClipChecker::heat_of(const std::vector<Event>& events, const Frames& frames) const {
  using Parts = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Parts, std::vector<std::uint32_t>> events_of;
  for (std::uint32_t e = 0; e < events.size(); ++e) {
    const PartMeeting& worst = frames.meetings[frames.spans[e].deepest];
    if (is_fault(events[e].kind)) events_of[{worst.part_a, worst.part_b}].push_back(e);
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, HeatSpot> spots;  // by event and triangle
  for (std::size_t m = 0; m < frames.meetings.size();) {
    const int frame = frames.meetings[m].frame;
    std::map<Parts, std::pair<std::uint32_t, float>> here;  // the event, and how deep it is
    for (; m < frames.meetings.size() && frames.meetings[m].frame == frame; ++m) {
      const PartMeeting& meeting = frames.meetings[m];
      const auto found = events_of.find({meeting.part_a, meeting.part_b});
      if (found == events_of.end() || !is_fault(meeting.kind)) continue;
      for (const std::uint32_t e : found->second) {
        if (events[e].is_at(frame)) here[found->first] = {e, static_cast<float>(meeting.depth_mm)};
      }
    }
    if (here.empty()) continue;
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> hot;
    for (const auto& pair : frames.contacts.of(static_cast<std::size_t>(frame))) {
      const std::uint32_t p = parts_.of_triangle[pair[0]], q = parts_.of_triangle[pair[1]];
      const auto found = here.find({std::min(p, q), std::max(p, q)});
      if (found == here.end()) continue;
      for (const std::uint32_t t : pair) hot[{found->second.first, t}] = found->second.second;
    }
    for (const auto& [place, depth] : hot) {
      HeatSpot& spot = spots.try_emplace(place, HeatSpot{place.first, place.second, 0, 0}).first->second;
      ++spot.frames;
      spot.depth_mm = std::max(spot.depth_mm, depth);
    }
  }
  std::vector<HeatSpot> out;
  for (const auto& [place, spot] : spots) out.push_back(spot);
  return out;
}

ClipCheck ClipChecker::check(std::size_t index) {
  const ClipFrames& clip = animated_.clips()[index];
  Frames frames = look(clip);
  frames.spans = join_events(frames.meetings, clip.count, frames.loops);
  ClipCheck out{{clip.count, clip.fps, frames.loops, {}}, {}, {}, {}};
  for (const EventSpan& span : frames.spans) out.result.events.push_back(event_of(frames, span, clip));
  out.heat = heat_of(out.result.events, frames);
  show(out, frames, clip);
  std::vector<std::uint32_t> numbers;
  std::vector<float> seconds;
  for (int i = 0; i < clip.count; ++i) {
    numbers.push_back(static_cast<std::uint32_t>(i));
    seconds.push_back(static_cast<float>(i / clip.fps));
  }
  out.page = json_text({{"frames",
                         {{"count", clip.count},
                          {"fps", clip.fps},
                          {"numbers", base64(numbers)},
                          {"seconds", base64(seconds)},
                          {"times", base64(seconds)},
                          {"contacts", frames.contacts.json()},
                          {"penetrations", frames.penetrations.json()}}},
                        {"motion", frames.motion.json(PageMotion::Still::kInMotion)}},
                       -1);
  return out;
}

}  // namespace spherechain::baker
