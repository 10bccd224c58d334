// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/score_clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "baker/play/target.h"
#include "baker/score/limmt.h"
#include "baker/score/star_rate.h"

namespace spherechain::baker {
namespace {

constexpr int kStep = 10;       // the rate of STaR and nearness are taken in every tenth frame
constexpr double kNear = 0.02;  // heights between a hand or foot and the skin that it touches
constexpr double kDeep = 10;    // mm

struct Metric {
  std::string_view name;
  bool is_share = false;
};
constexpr std::array<Metric, 22> kMetrics{{{"fault_frames", true},
                                           {"depth_percent_p50"},
                                           {"depth_percent_p95"},
                                           {"depth_percent_max"},
                                           {"deeper_than_1cm", true},
                                           {"swallowed_area_percent"},
                                           {"volume_percent"},
                                           {"intersecting_faces"},
                                           {"inside_seconds"},
                                           {"events_per_minute"},
                                           {"star_penetration_rate", true},
                                           {"far_pairs_50"},
                                           {"far_pairs_40"},
                                           {"voxel_volume", true},
                                           {"voxel_volume_fine", true},
                                           {"limmt"},
                                           {"hand_acceleration"},
                                           {"foot_acceleration"},
                                           {"jerk"},
                                           {"joint_shift_percent"},
                                           {"contacts_kept", true},
                                           {"contacts_lost", true}}};

bool counts(PenetrationClass kind) { return kind >= SC_CLASS_PENETRATION; }

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[at == 0 ? 0 : at - 1];
}

double mean(double sum, std::size_t count) { return count > 0 ? sum / static_cast<double>(count) : 0; }

// The volume that a skin bounds, from its middle.
double volume_of(const Mesh& mesh) {
  const Vec3 middle = surface_centroid(mesh);
  double out = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    out += (triangle_centroid(mesh, t) - middle).dot(triangle_cross(mesh, t)) / 6;
  return std::abs(out);
}

// Sums over the frames of a clip.
struct Sums {
  double area = 0, volume = 0, voxels = 0, fine_voxels = 0;
  std::array<double, 2> far_pairs{};
  std::size_t faces = 0;
  StarCount star;
};

struct Contacts {
  std::vector<double> depths;  // of the deepest fault of each frame, in % of the height; 0: none
  std::vector<double> mm;
  std::vector<int> pairs;  // of parts with a fault
  std::size_t inside = 0;  // frames in which a part is inside another
};

Contacts contacts_of(const ClipEvents& found, const ClipFrames& clip, double height, double mm) {
  const auto frames = static_cast<std::size_t>(clip.count);
  Contacts out{std::vector<double>(frames, 0), std::vector<double>(frames, 0), std::vector<int>(frames, 0), 0};
  std::vector<char> is_inside(frames, 0);
  for (const FramePenetration& one : found.penetrations) {
    if (!counts(one.found.kind)) continue;
    const auto f = static_cast<std::size_t>(one.frame);
    const double depth = double{one.found.measures.depth};
    out.depths[f] = std::max(out.depths[f], 100 * depth / height);
    out.mm[f] = std::max(out.mm[f], mm * depth);
    ++out.pairs[f];
    if (one.found.kind == SC_CLASS_INSIDE) is_inside[f] = 1;
  }
  out.inside = static_cast<std::size_t>(std::count(is_inside.begin(), is_inside.end(), 1));
  return out;
}

std::vector<char> near_ends(const std::array<double, kLimbs>& distances, double height) {
  std::vector<char> out;
  for (const double d : distances) out.push_back(d < kNear * height ? 1 : 0);
  return out;
}

// The share of the ends near the body in the reference that are near it here, too.
std::optional<double> kept_share(const ClipPlaces& here, const ClipPlaces& reference) {
  std::size_t all = 0, kept = 0;
  for (std::size_t f = 0; f < std::min(here.end_near.size(), reference.end_near.size()); ++f) {
    for (std::size_t e = 0; e < reference.end_near[f].size(); ++e) {
      if (reference.end_near[f][e] == 0) continue;
      ++all;
      kept += here.end_near[f][e] != 0 ? 1 : 0;
    }
  }
  if (all == 0) return {};
  return static_cast<double>(kept) / static_cast<double>(all);
}

// Against the first joint: where the character stands does not count.
Track from_root(Track joints) {
  for (std::vector<Vec3>& frame : joints) {
    const Vec3 root = frame.empty() ? Vec3(Vec3::Zero()) : frame[0];
    for (Vec3& place : frame) place -= root;
  }
  return joints;
}

Track part_of(const Track& joints, const std::vector<std::size_t>& which) {
  Track out;
  for (const std::vector<Vec3>& frame : joints) {
    out.emplace_back();
    for (const std::size_t j : which) out.back().push_back(frame[j]);
  }
  return out;
}

}  // namespace

const std::vector<std::string>& metric_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Metric& metric : kMetrics) out.emplace_back(metric.name);
    return out;
  }();
  return names;
}

bool is_share(const std::string& name) {
  return std::any_of(kMetrics.begin(), kMetrics.end(),
                     [&](const Metric& metric) { return metric.is_share && metric.name == name; });
}

ClipScorer::ClipScorer(const AnimatedAsset& animated, std::set<std::string> asked)
    : animated_(animated),
      asked_(std::move(asked)),
      subject_(score_subject(animated)),
      finder_(animated, choose_target("auto"), subject_.frame),
      player_(animated.asset(), choose_target("auto")),
      swallowed_(subject_.skin),
      voxels_(subject_.skin.rest, subject_.skin.triangles),
      area_(surface_area({subject_.skin.rest, subject_.skin.triangles})),
      volume_(volume_of({subject_.skin.rest, subject_.skin.triangles})) {
  if (is_asked("far_pairs_50") || is_asked("far_pairs_40")) far_.emplace(subject_.skin);
}

void ClipScorer::add_places(int frame, const Deformation& deformation, const std::vector<Vec3>* positions,
                            ClipPlaces& to) const {
  to.joints.emplace_back();
  for (std::size_t bone = 0; bone < subject_.joints.joint_of_bone().size(); ++bone)
    to.joints.back().push_back(subject_.joints.place_of(deformation, bone));
  if (frame % kStep == 0 && positions != nullptr && subject_.has_limbs)
    to.end_near.push_back(near_ends(ends_from_body(subject_.skin, *positions), subject_.height));
}

ClipPlaces ClipScorer::places(const ClipFrames& clip) const {
  ClipPlaces out;
  for (int f = 0; f < clip.count; ++f) {
    const Deformation deformation = animated_.deformation(clip.first + f);
    const std::vector<Vec3> positions = f % kStep == 0 ? animated_.positions(deformation) : std::vector<Vec3>();
    add_places(f, deformation, &positions, out);
  }
  return out;
}

ClipScore ClipScorer::score(const ClipFrames& clip, const ClipPlaces* reference,
                            const std::function<void(int)>& progress) {
  ClipScore out{clip.name, clip.own_count, clip.fps, {}};
  ClipPlaces here;
  const double height = subject_.height, metre = 1000 / subject_.mm;
  const Vec3 up = subject_.frame.up, left = subject_.frame.left, forward = subject_.frame.forward;
  double ground = HUGE_VAL;
  for (const Triangle& t : subject_.skin.triangles) {
    for (const Index v : t) ground = std::min(ground, up.dot(subject_.skin.rest[v]));
  }
  const bool wants_star = is_asked("star_penetration_rate") && subject_.has_limbs,
             wants_coarse = is_asked("voxel_volume"), wants_fine = is_asked("voxel_volume_fine"),
             wants_limmt = is_asked("limmt");
  const Deformation at_rest;
  Sums sums;
  std::vector<LimmtFrame> limmt;
  const ClipEvents found = finder_.find(clip, [&](int f, const Deformation& deformation) {
    progress(f);
    const SkinPose pose(animated_, deformation);
    const std::vector<Vec3> positions = animated_.positions(deformation);
    add_places(f, deformation, reference == nullptr ? nullptr : &positions, here);
    player_.set_pose(pose.pose());
    const Span<const TriangleContact> listed = player_.triangles();
    const std::vector<TriangleContact> contacts(listed.begin(), listed.end());
    std::set<std::uint32_t> faces;
    for (const TriangleContact& contact : contacts) faces.insert({contact.triangle_a, contact.triangle_b});
    sums.faces += faces.size();
    if (far_) {
      const auto counts = far_->count(contacts);
      for (std::size_t k = 0; k < 2; ++k) sums.far_pairs[k] += static_cast<double>(counts[k]);
    }
    if (wants_coarse) sums.voxels += voxels_.share(positions, VoxelVolume::kCoarse);
    if (wants_fine) sums.fine_voxels += voxels_.share(positions, VoxelVolume::kFine);
    if (f % kStep == 0 && wants_star) {
      const StarCount star = count_star(subject_.skin, positions, posed_normals(subject_, deformation));
      sums.star.vertices += star.vertices;
      sums.star.inside += star.inside;
    }
    if (!wants_limmt) return;
    LimmtFrame now{subject_.joints.joints_of(deformation), {}, {}, {}, 0, 0};
    for (const std::size_t foot : subject_.ends[1]) {
      const Vec3 place = subject_.joints.place_of(deformation, foot), rest = subject_.joints.place_of(at_rest, foot);
      now.foot_heights.push_back(up.dot(place - rest) / metre);
      now.feet.push_back({left.dot(place) / metre, forward.dot(place) / metre});
    }
    const Vec3 root = here.joints.back().empty() ? Vec3(Vec3::Zero()) : here.joints.back().front();
    now.root = {root.x() / metre, root.y() / metre, root.z() / metre};
    double lowest = HUGE_VAL;
    for (const Triangle& t : subject_.skin.triangles) lowest = std::min(lowest, up.dot(positions[t[0]]));
    now.lowest = (lowest - ground) / metre;
    limmt.push_back(std::move(now));
  });
  const Contacts contacts = contacts_of(found, clip, height, subject_.mm);
  const auto frames = static_cast<std::size_t>(clip.count);
  if (is_asked("swallowed_area_percent") || is_asked("volume_percent")) {
    for (std::size_t f = 0; f < frames; ++f) {
      if (contacts.pairs[f] == 0) continue;
      const Deformation deformation = animated_.deformation(clip.first + static_cast<int>(f));
      const SkinPose pose(animated_, deformation);
      player_.set_pose(pose.pose());
      std::set<std::pair<std::uint32_t, std::uint32_t>> faulty;
      for (const FramePenetration& one : found.penetrations) {
        if (one.frame == static_cast<int>(f) && counts(one.found.kind))
          faulty.insert(std::minmax(one.found.part, one.found.other));
      }
      std::vector<TriangleContact> crossed, others;
      for (const TriangleContact& contact : player_.triangles()) {
        (faulty.contains(std::minmax(contact.part_a, contact.part_b)) ? crossed : others).push_back(contact);
      }
      const Swallowed inside = swallowed_.measure(animated_.positions(deformation), crossed, others);
      sums.area += inside.area;
      sums.volume += inside.volume;
    }
  }
  std::vector<double> deep;
  for (const double depth : contacts.depths) {
    if (depth > 0) deep.push_back(depth);
  }
  const bool has_limmt = !limmt.empty() && std::none_of(limmt.begin(), limmt.end(),
                                                        [](const LimmtFrame& one) { return one.joints.empty(); });
  for (std::size_t f = 0; f < limmt.size(); ++f) limmt[f].self_collisions = contacts.pairs[f];
  const auto share = [&](const std::vector<double>& values, double above) {
    return mean(static_cast<double>(std::count_if(values.begin(), values.end(), [&](double v) { return v > above; })),
                values.size());
  };
  const auto events = static_cast<double>(
      std::count_if(found.events.begin(), found.events.end(), [](const Event& event) { return counts(event.kind); }));
  const double seconds = static_cast<double>(frames) / clip.fps;
  const auto ends = [&](std::size_t k, int order) -> std::optional<double> {
    if (subject_.ends[k].empty() || clip.count <= order) return {};
    return mean_difference(part_of(here.joints, subject_.ends[k]), order, clip.fps) / metre;
  };
  if (reference != nullptr && std::abs(static_cast<int>(reference->joints.size()) - clip.count) > 1) {
    reference = nullptr;  // it is of another motion
  }
  const std::optional<double> kept = reference == nullptr ? std::nullopt : kept_share(here, *reference);
  const std::array<std::optional<double>, kMetrics.size()> values{
      share(contacts.depths, 0),
      quantile(deep, 0.5),
      quantile(deep, 0.95),
      quantile(deep, 1),
      share(contacts.mm, kDeep),
      100 * mean(sums.area, frames) / area_,
      100 * mean(sums.volume, frames) / volume_,
      mean(static_cast<double>(sums.faces), frames),
      static_cast<double>(contacts.inside) / clip.fps,
      clip.count > 1 ? std::optional(60 * events / seconds) : std::nullopt,
      wants_star ? std::optional(mean(static_cast<double>(sums.star.inside), sums.star.vertices)) : std::nullopt,
      mean(sums.far_pairs[0], frames),
      mean(sums.far_pairs[1], frames),
      mean(sums.voxels, frames),
      mean(sums.fine_voxels, frames),
      has_limmt && clip.count > 2 ? std::optional(limmt_score(limmt, clip.fps)) : std::nullopt,
      ends(0, 2),
      ends(1, 2),
      ends(0, 3),
      reference == nullptr
          ? std::nullopt
          : std::optional(100 * mean_distance(from_root(here.joints), from_root(reference->joints)) / height),
      kept,
      kept ? std::optional(1 - *kept) : std::nullopt};
  for (std::size_t m = 0; m < values.size(); ++m) {
    const std::string name(kMetrics[m].name);
    if (is_asked(name)) out.metrics.emplace_back(name, values[m]);
  }
  return out;
}

}  // namespace spherechain::baker
