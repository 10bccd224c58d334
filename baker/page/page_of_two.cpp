// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_of_two.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "baker/mesh/error.h"
#include "baker/page/base64.h"
#include "baker/page/fill_page.h"
#include "baker/page/from_runtime.h"
#include "baker/page/page_axes.h"
#include "baker/page/page_mesh.h"
#include "baker/page/page_motion.h"
#include "baker/page/page_penetrations.h"
#include "baker/play/skin_player.h"
#include "baker/play/target.h"
#include "baker/report/json_text.h"
#include "baker/report/report.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;
using Triangles = std::array<std::uint32_t, 2>;

constexpr double kApart = 1.05;  // between a character before and after a change, as a share of its width
constexpr std::array<const char*, 2> kColours{"#c9c2b6", "#8fb0cc"};

const ClipFrames& only_clip(const AnimatedAsset& animated, const char* option) {
  const std::vector<ClipFrames>& clips = animated.clips();
  const auto played = std::count_if(clips.begin(), clips.end(), [](const ClipFrames& clip) { return clip.count > 0; });
  if (played > 1) {
    throw Error(ExitCode::kUsage, fmt::format("{}: plays {} clips: name the one that two characters play ({})",
                                              animated.file(), played, option));
  }
  return clips.front();
}

// On the ground below the middle of its skin in the first frame.
Vec3 stand_of(const AnimatedAsset& animated, const BodyFrame& axes) {
  const std::vector<Vec3> p = animated.positions(animated.deformation(0));
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const auto& [a, b, c] : animated.character().source_triangles) {
    const double size = (p[b] - p[a]).cross(p[c] - p[a]).norm();
    sum += size / 3 * (p[a] + p[b] + p[c]);
    area += size;
  }
  const Vec3 middle = area > 0 ? Vec3(sum / area) : axes.origin;
  return middle - axes.up.dot(middle - axes.origin) * axes.up;
}

// From the second's space to the first's.
Affine place_of(const AnimatedAsset& first, const AnimatedAsset& second, const Place* place) {
  const double unit = mm_per_unit(second.asset()) / mm_per_unit(first.asset());
  Affine out = Affine::Identity();
  if (place == nullptr) {
    out.linear() *= unit;
    return out;
  }
  const BodyFrame to = page_axes(first), from = page_axes(second);
  Eigen::Matrix3d own, there;
  own << from.left, from.up, from.forward;
  there << to.left, to.up, to.forward;
  const double angle = place->degrees * std::numbers::pi / 180, metre = 1000 / mm_per_unit(first.asset());
  out.linear() = unit * there * Eigen::AngleAxisd(angle, Vec3::UnitY()) * own.transpose();
  const Vec3 step = metre * (place->left * to.left + place->forward * to.forward);
  const Vec3 stand = stand_of(first, to) + step;
  out.translation() = stand - out.linear() * stand_of(second, from);
  return out;
}

// Two characters as one that has both meshes.
class Both {
 public:
  Both(const AnimatedAsset& first, const AnimatedAsset& second, const Affine& place,
       const std::array<std::string, 2>& names)
      : first_(first), second_(second), place_(place), who_(names), parts_(page_parts(first.asset())) {
    const Character &a = first.character(), &b = second.character();
    vertices_ = static_cast<Index>(a.source_positions.size());
    triangles_ = static_cast<std::uint32_t>(a.source_triangles.size());
    names_ = parts_.names.size();
    character_.source_positions = a.source_positions;
    character_.source_triangles = a.source_triangles;
    character_.rig.morphs = a.rig.morphs;
    for (const Vec3& p : b.source_positions) character_.source_positions.push_back(place * p);
    for (Triangle t : b.source_triangles) {
      for (Index& v : t) v += vertices_;
      character_.source_triangles.push_back(t);
    }
    for (Morph morph : b.rig.morphs) {
      for (Index& v : morph.vertices) v += vertices_;
      for (Vec3& delta : morph.deltas) delta = place.linear() * delta;
      character_.rig.morphs.push_back(std::move(morph));
    }
    add_parts();
    bones_ = {first.deformation(0).bones.size(), second.deformation(0).bones.size()};
    weights_ = first.weights();
    weights_.resize(vertices_);
    std::vector<VertexWeights> others = second.weights();
    others.resize(b.source_positions.size());
    for (VertexWeights w : others) {
      for (Index& joint : w.joint) joint += static_cast<Index>(bones_[0]);
      weights_.push_back(w);
    }
  }

  const Character& character() const { return character_; }
  const std::vector<VertexWeights>& weights() const { return weights_; }
  const PageParts& parts() const { return parts_; }
  std::uint32_t first_triangle() const { return triangles_; }  // of the second
  std::size_t first_part() const { return names_; }

  // A frame's; in `own` each character's vertices, in the first's space.
  Deformation deformation(int frame, std::array<std::vector<Vec3>, 2>& own) const {
    const Deformation a = first_.deformation(frame);
    const Deformation b = second_.deformation(std::min(frame, second_.frame_count() - 1));
    own = {first_.positions(a), second_.positions(b)};
    for (Vec3& p : own[1]) p = place_ * p;
    Deformation out;
    if (!a.positions.empty() || !b.positions.empty()) {
      out.positions = own[0];
      out.positions.insert(out.positions.end(), own[1].begin(), own[1].end());
      return out;
    }
    // The second's vertices rest in their place already.
    const Affine back = place_.inverse();
    out.bones = a.bones;
    out.bones.resize(bones_[0], Affine::Identity());
    for (const Affine& bone : b.bones) out.bones.push_back(place_ * bone * back);
    out.bones.resize(bones_[0] + bones_[1], Affine::Identity());
    out.morphs = a.morphs;
    out.morphs.resize(first_.character().rig.morphs.size());
    out.morphs.insert(out.morphs.end(), b.morphs.begin(), b.morphs.end());
    out.morphs.resize(character_.rig.morphs.size());
    return out;
  }

  // Regions and spheres of both, as inspect_json() has one's.
  ordered_json inspect() const {
    const ordered_json a = ordered_json::parse(inspect_json(first_.asset()));
    const ordered_json b = ordered_json::parse(inspect_json(second_.asset()));
    ordered_json regions = ordered_json::array(), spheres = ordered_json::array();
    for (const ordered_json* of : {&a, &b}) {
      const bool is_second = of == &b;
      const std::string name = who_[is_second ? 1 : 0] + ": ";
      for (ordered_json region : of->at("regions")) {
        region["name"] = name + region["name"].get<std::string>();
        regions.push_back(std::move(region));
      }
      for (ordered_json sphere : of->at("spheres")) {
        sphere["id"] = spheres.size();
        sphere["region"] = name + sphere["region"].get<std::string>();
        if (is_second) move(sphere);
        spheres.push_back(std::move(sphere));
      }
    }
    return {{"source", {{"metres_per_unit", first_.asset()->info().metres_per_unit}}},
            {"regions", std::move(regions)},
            {"spheres", std::move(spheres)},
            {"chains", ordered_json::array()}};
  }

 private:
  void add_parts() {
    PageParts others = page_parts(second_.asset());
    if (names_ + others.names.size() >= kNoPart) {
      throw Error(ExitCode::kUsage,
                  fmt::format("{}, {}: have {} body parts; a page of two shows {} at most", first_.file(),
                              second_.file(), names_ + others.names.size(), kNoPart - 1));
    }
    for (std::string& name : parts_.names) name = who_[0] + ": " + name;
    for (const std::string& name : others.names) parts_.names.push_back(who_[1] + ": " + name);
    for (const std::uint8_t part : others.of_triangle) {
      parts_.of_triangle.push_back(part == kNoPart ? kNoPart : static_cast<std::uint8_t>(part + names_));
    }
  }
  void move(ordered_json& sphere) const {
    const double scale = std::cbrt(place_.linear().determinant());
    const std::vector<double> center = sphere["center"];
    sphere["center"] = to_json(Vec3(place_ * Vec3(center[0], center[1], center[2])));
    for (const char* radius : {"radius", "detect_radius"}) sphere[radius] = scale * sphere[radius].get<double>();
    for (ordered_json& pivot : sphere["pivots"]) {
      for (ordered_json& vertex : pivot["vertices"]) vertex = vertex.get<Index>() + vertices_;
    }
  }

  const AnimatedAsset &first_, &second_;
  Affine place_;
  std::array<std::string, 2> who_;
  Character character_;
  std::vector<VertexWeights> weights_;
  PageParts parts_;
  Index vertices_;
  std::uint32_t triangles_;
  std::size_t names_;
  std::array<std::size_t, 2> bones_;
};

// Contacts of a frame: within each of the two characters, and between them.
class Contacts {
 public:
  Contacts(const AnimatedAsset& first, const AnimatedAsset& second, const Both& both, bool they_meet)
      : they_meet_(they_meet),
        first_part_(static_cast<std::uint32_t>(both.first_part())),
        first_triangle_(both.first_triangle()),
        mm_(mm_per_unit(first.asset())),
        players_{SkinPlayer(first.asset(), choose_target("auto"), &second.asset()),
                 SkinPlayer(second.asset(), choose_target("auto"))} {}

  void find(const std::array<std::vector<Vec3>, 2>& positions, bool is_next) {
    triangles.clear();
    measured_.clear();
    const std::array<std::vector<float>, 2> packed{pack(positions[0]), pack(positions[1])};
    for (const std::uint32_t i : {0U, 1U}) {
      players_[i].set_pose(pose_of(packed[i]));
      add(players_[i].triangles(), i, i);
      add(players_[i].measure(is_next), i, i);
    }
    if (they_meet_) {
      add(players_[0].triangles(players_[1]), 0, 1);
      add(players_[0].measure(players_[1], is_next), 0, 1);
    }
    std::stable_sort(measured_.begin(), measured_.end(),
                     [](const Penetration& l, const Penetration& r) { return l.measures.depth > r.measures.depth; });
  }

  std::vector<Triangles> triangles;
  std::vector<PenetrationEntry> penetrations() const { return entries_of(measured_, mm_); }

 private:
  // Numbers of a and b are of those characters.
  void add(Span<const TriangleContact> contacts, std::uint32_t a, std::uint32_t b) {
    for (const TriangleContact& c : contacts) {
      triangles.push_back({c.triangle_a + a * first_triangle_, c.triangle_b + b * first_triangle_});
    }
  }
  void add(const std::vector<Penetration>& found, std::uint32_t a, std::uint32_t b) {
    for (Penetration p : found) {
      p.part += a * first_part_;
      p.other += b * first_part_;
      measured_.push_back(p);
    }
  }

  bool they_meet_;
  std::uint32_t first_part_, first_triangle_;
  double mm_;
  std::array<SkinPlayer, 2> players_;
  std::vector<Penetration> measured_;
};

// How far points are from an upright line through the middle of their box.
double reach_of(const std::vector<Vec3>& points, const Vec3& up) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  double out = 0;
  for (const Vec3& p : points) {
    const Vec3 arm = p - box.center();
    out = std::max(out, (arm - up.dot(arm) * up).norm());
  }
  return out;
}

// Who is who.
ordered_json two_colours(const Both& both) {
  std::vector<std::uint16_t> of(both.character().source_triangles.size(), 1);
  std::fill_n(of.begin(), both.first_triangle(), std::uint16_t{0});
  return {{"of", base64(of)},
          {"materials", {{{"colour", kColours[0]}}, {{"colour", kColours[1]}}}},
          {"pictures", ordered_json::array()}};
}

}  // namespace

std::string view_page_of_two(const AnimatedAsset& first, const AnimatedAsset& second, const Place* place,
                             const PageOptions& options, const std::function<void(int)>& progress) {
  const PageTemplate page(options.template_file);
  const ClipFrames& clip = only_clip(first, "--clip");
  only_clip(second, "--with-clip");
  first.check_clusters();
  second.check_clusters();
  const Affine placed = place_of(first, second, place);
  const Both both(first, second, placed, options.names);
  const BodyFrame axes = page_axes(first);
  const ordered_json clip_json{{"name", clip.name.empty() ? options.motion : clip.name},
                               {"first", 0},
                               {"count", first.frame_count()},
                               {"own_count", clip.own_count}};
  ordered_json data{{"title", options.title},
                    {"axes", axes_json(axes)},
                    {"parts", both.parts().names},
                    {"inspect", both.inspect()},
                    {"report", nullptr},
                    {"radius", options.radius == SC_RADIUS_FIT ? "fit" : "detect"},
                    {"clips", ordered_json::array({clip_json})},
                    {"look", two_colours(both)}};
  PageMotion motion(both.character(), axes);
  Contacts found(first, second, both, options.they_meet);
  FrameLists<Triangles> contacts;
  FrameLists<PenetrationEntry> penetrations;
  std::vector<float> numbers, seconds;
  const auto mesh = [&](const std::vector<Vec3>& rest) {
    return page_mesh(rest, both.character().source_triangles, both.weights(), both.parts(), {});
  };
  data["mesh"] = mesh(both.character().source_positions);
  if (!options.they_meet) {
    data["change"] = {{"triangle", both.first_triangle()},
                      {"part", both.first_part()},
                      {"events", ordered_json::parse(options.events)}};
  }
  const double still = static_cast<double>(page.size() + json_text(data, -1).size());
  double reach = 0;
  for (int i = 0; i < first.frame_count(); ++i) {
    progress(i);
    std::array<std::vector<Vec3>, 2> own;
    const Deformation deformation = both.deformation(i, own);
    found.find(own, i > 0);
    own[0].insert(own[0].end(), own[1].begin(), own[1].end());
    reach = std::max(reach, reach_of(own[0], axes.up));
    motion.add(deformation, own[0]);
    contacts.add(found.triangles);
    penetrations.add(found.penetrations());
    numbers.push_back(static_cast<float>(first.number(i)));
    seconds.push_back(static_cast<float>(first.frame_at(i).seconds));
    const std::size_t bytes = motion.bytes() + contacts.bytes() + penetrations.bytes();
    check_size(first, still, static_cast<double>(bytes) * 4 / 3 / (i + 1) * first.frame_count(), options);
  }
  data["frames"] = {{"count", first.frame_count()},       {"fps", options.fps},       {"numbers", base64(numbers)},
                    {"seconds", base64(seconds)},         {"times", base64(seconds)}, {"contacts", contacts.json()},
                    {"penetrations", penetrations.json()}};
  if (!options.they_meet) data["change"]["distance"] = kApart * 2 * reach;
  data["motion"] = motion.json();
  data["mesh"] = mesh(motion.rest());
  std::string html = page.fill(data);
  check_size(first, still, static_cast<double>(html.size()) - still, options);
  return html;
}

}  // namespace spherechain::baker
