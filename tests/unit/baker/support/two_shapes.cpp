// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_shapes.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "glb_writer.h"
#include "jobs.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using Vec = spherechain::baker::Vec3;

namespace {

// A profile of radii and heights from the lower pole to the upper, turned around y.
Shape turned(const std::vector<std::pair<double, double>>& profile, int around) {
  Shape out;
  const auto n = static_cast<std::uint32_t>(around);
  for (const auto& [radius, y] : profile) {
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      out.positions.push_back({radius * std::cos(angle), y, radius * std::sin(angle)});
    }
  }
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = ring * n + k, b = ring * n + (k + 1) % n;
      out.triangles.push_back({a, a + n, b + n});
      out.triangles.push_back({a, b + n, b});
    }
  }
  const auto pole = static_cast<std::uint32_t>(out.positions.size());
  out.positions.push_back({0, profile.front().second, 0});
  out.positions.push_back({0, profile.back().second, 0});
  for (std::uint32_t k = 0; k < n; ++k) {
    out.triangles.push_back({pole, k, (k + 1) % n});
    out.triangles.push_back({pole + 1, (rings - 1) * n + (k + 1) % n, (rings - 1) * n + k});
  }
  return out;
}

// As the body of the part with the lesser number has it: then that part is named first.
spherechain::Penetration lesser_first(spherechain::Penetration of) {
  if (of.part > of.other) {
    std::swap(of.part, of.other);
    std::swap(of.deepest, of.deepest_other);
    of.direction = {-of.direction.x, -of.direction.y, -of.direction.z};
  }
  return of;
}

// Two bodies that are the same asset, with only one colliding part each, must give the same measurements in the pose as
// one body.
void check_as_bodies(const spherechain::PenetrationJob& one, const spherechain::Penetration& found_in_one) {
  spherechain::Penetration expected = lesser_first(found_in_one);
  std::vector<std::uint64_t> ignored[2];
  spherechain::BodyContactJob find;
  for (spherechain::JobBody* body : {&find.a, &find.b}) {
    body->asset = one.asset;
    body->pose = one.pose;
    std::vector<std::uint64_t>& words = ignored[body == &find.a ? 0 : 1];
    const std::uint32_t part = body == &find.a ? expected.part : expected.other;
    words.assign(sc_part_words(one.asset), ~std::uint64_t{0});
    words[part / 64] ^= std::uint64_t{1} << part % 64;
    body->ignored_parts = words.data();
  }
  const spherechain::test::SkinContacts found = spherechain::test::find_contacts(find);
  REQUIRE(found.status == SC_OK);
  spherechain::BodyPenetrationJob job;
  job.a = find.a;
  job.b = find.b;
  job.contacts = found.triangles.data();
  job.contact_count = found.triangles.size();
  job.rule = one.rule;
  for (const spherechain::Target target : spherechain::supported_targets()) {
    std::vector<spherechain::Penetration> measured = spherechain::test::measure(job, target);
    REQUIRE(measured.size() == 1);
    const spherechain::PenetrationClass kind = measured[0].kind;
    CHECK((kind == SC_CLASS_SHELL || kind == SC_CLASS_TOUCH || kind == SC_CLASS_PENETRATION));
    const spherechain::Measures& in_pose = measured[0].measures;
    expected.kind = kind;
    expected.fault_depth = measured[0].fault_depth;
    expected.joint = measured[0].joint;
    expected.measures.relation = in_pose.relation;
    expected.measures.is_one_piece = in_pose.is_one_piece;
    expected.measures.rest_distance = in_pose.rest_distance;
    expected.measures.touching = in_pose.touching;
    expected.measures.thickness = in_pose.thickness;
    expected.measures.extent = in_pose.extent;
    CHECK(spherechain::test::same_bits(measured, {expected}));
  }
}

}  // namespace

Shape capsule(double radius, double half, int rings) {
  std::vector<std::pair<double, double>> profile;
  for (int k = 0; k < rings; ++k) {
    const double angle = std::numbers::pi / 2 * (k + 0.5) / rings;
    profile.emplace_back(radius * std::sin(angle), -half - radius * std::cos(angle));
  }
  profile.emplace_back(radius, -half);
  if (half > 0) profile.emplace_back(radius, half);
  for (int k = rings; k-- > 0;) {
    const auto [r, y] = profile[static_cast<std::size_t>(k)];
    profile.emplace_back(r, -y);
  }
  Shape out = turned(profile, 4 * rings);
  // The poles are on the ball.
  out.positions[out.positions.size() - 2].y() = -half - radius;
  out.positions.back().y() = half + radius;
  return out;
}

Shape ball(double radius, int rings) { return capsule(radius, 0, rings); }

Shape cylinder(double radius, double half, int rings) {
  std::vector<std::pair<double, double>> profile;
  for (int k = 0; k <= rings; ++k) profile.emplace_back(radius, half * (2.0 * k / rings - 1));
  return turned(profile, 4 * rings);
}

Shape box(double x, double y, double z) {
  Shape out;
  for (int k = 0; k < 8; ++k) out.positions.push_back({k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z});
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

spherechain::Penetration only(const std::vector<spherechain::Penetration>& found) {
  REQUIRE(found.size() == 1);
  return found[0];
}

TwoShapes::TwoShapes(const Shape& a, const Shape& b, double apart, bool is_child, bool one_piece)
    : first_of_b_(a.positions.size()), apart_(apart), are_joined_(is_child || one_piece), asset_([&] {
        Glb glb;
        std::vector<float> weights, inverse_binds;
        std::vector<std::uint16_t> joints;
        std::vector<std::uint32_t> corners;
        for (const Shape* shape : {&a, &b}) {
          const bool second = shape == &b;
          for (const Vec& p : shape->positions) {
            rest_.insert(rest_.end(), {static_cast<float>(p.x() + (second ? apart : 0)), static_cast<float>(p.y()),
                                       static_cast<float>(p.z())});
            joints.insert(joints.end(), {static_cast<std::uint16_t>(second ? 1 : 0), 0, 0, 0});
            weights.insert(weights.end(), {1, 0, 0, 0});
          }
          const auto first = static_cast<std::uint32_t>(second ? a.positions.size() : 0);
          for (const auto& t : shape->triangles)
            corners.insert(corners.end(), {first + t[0], first + t[1], first + t[2]});
          for (int i = 0; i < 16; ++i) inverse_binds.push_back(i % 5 == 0 ? 1.0F : 0.0F);
        }
        if (one_piece) {
          const auto first_of_b = static_cast<std::uint32_t>(a.positions.size());
          const auto last = static_cast<std::uint32_t>(a.positions.size() + b.positions.size() - 1);
          corners.insert(corners.end(), {first_of_b - 2, first_of_b - 1, last});
        }
        glb.json["nodes"] = {{{"name", "root"}, {"children", nlohmann::json::array({1})}},
                             {{"name", "a"}},
                             {{"name", "b"}},
                             {{"mesh", 0}, {"skin", 0}}};
        glb.json["nodes"][is_child ? 1 : 0]["children"].push_back(2);
        glb.json["scenes"] = {{{"nodes", {0, 3}}}};
        glb.json["meshes"] = {{{"primitives",
                                {{{"attributes",
                                   {{"POSITION", glb.accessor(rest_, "VEC3")},
                                    {"JOINTS_0", glb.accessor(joints, "VEC4")},
                                    {"WEIGHTS_0", glb.accessor(weights, "VEC4")}}},
                                  {"indices", glb.accessor(corners, "SCALAR")}}}}}};
        glb.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", glb.accessor(inverse_binds, "MAT4")}}};
        const TemporaryFolder folder;
        const Bake baked = bake(folder.write("shapes.glb", glb.bytes()), make_settings("balanced", "{}", "test"), {});
        return OpenAsset({reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size()}, "shapes");
      }()) {}

std::vector<float> TwoShapes::posed(const Place& place, const Place& both) const {
  std::vector<float> vertices = rest_;
  for (std::size_t v = 0; 3 * v < vertices.size(); ++v) {
    float* const p = vertices.data() + 3 * v;
    Vec at(double{p[0]}, double{p[1]}, double{p[2]});
    if (v >= first_of_b_) at = place(at - Vec(apart_, 0, 0));
    if (both) at = both(at);
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(at[k]);
  }
  return vertices;
}

std::vector<spherechain::Penetration> TwoShapes::ask(const Place& place, const Place& both,
                                                     spherechain::Scope scope) const {
  const std::vector<float> vertices = posed(place, both);
  spherechain::Body body(asset_.model());
  spherechain::Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  REQUIRE(body.set_pose(pose) == SC_OK);
  std::vector<spherechain::Penetration> out;
  for (const spherechain::Target target : spherechain::supported_targets()) {
    spherechain::Query query;
    query.scope = scope;
    query.full = 1;
    query.classes = ~0U;
    query.target = target;
    REQUIRE(body.set_pose(pose) == SC_OK);
    const spherechain::Penetrations found = body.penetrations(query);
    REQUIRE(body.status() == SC_OK);
    const std::vector<spherechain::Penetration> all(found.begin(), found.end());
    if (target == spherechain::supported_targets()[0]) out = all;
    CHECK(spherechain::test::same_bits(all, out));
  }
  return out;
}

std::size_t TwoShapes::count_inside(const Place& place, std::uint64_t ignored, std::uint64_t ignored_of_other) const {
  const std::vector<float> vertices = posed(place, {});
  spherechain::Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  spherechain::Body body(asset_.model()), other(asset_.model());
  REQUIRE(body.set_pose(pose) == SC_OK);
  REQUIRE(other.set_pose(pose) == SC_OK);
  spherechain::Query query;
  query.classes = 1U << SC_CLASS_INSIDE;
  query.ignored_parts = &ignored;
  query.ignored_parts_of_other = &ignored_of_other;
  const std::size_t count = body.penetrations(other, query).count;
  REQUIRE(body.status() == SC_OK);
  return count;
}

std::vector<spherechain::Penetration> TwoShapes::measure(
    const Place& place, const std::function<void(spherechain::PenetrationJob&)>& change, const Place& both) const {
  const std::vector<float> vertices = posed(place, both);
  spherechain::SkinContactJob find;
  find.asset = asset_.handle();
  find.pose.vertices = vertices.data();
  find.pose.vertex_count = vertices.size() / 3;
  find.scope = SC_SCOPE_ALL;
  const spherechain::test::SkinContacts found = spherechain::test::find_contacts(find);
  REQUIRE(found.status == SC_OK);
  spherechain::PenetrationJob job;
  job.asset = find.asset;
  job.pose = find.pose;
  job.scope = find.scope;
  job.contacts = found.triangles.data();
  job.contact_count = found.triangles.size();
  if (change) change(job);
  const std::vector<spherechain::Penetration> out = spherechain::test::measure(job, SC_TARGET_BEST);
  for (const spherechain::Target target : spherechain::supported_targets()) {
    CHECK(spherechain::test::same_bits(spherechain::test::measure(job, target), out));
  }
  for (const spherechain::Penetration& two : out) {
    // For two bodies, no part continues in a part of the other.
    const bool has_history = job.previous_count > 0 || job.quick != 0;
    if (two.part != two.other && job.filter == nullptr && !are_joined_ && !has_history) check_as_bodies(job, two);
  }
  return out;
}
