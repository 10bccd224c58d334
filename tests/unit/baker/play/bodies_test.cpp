// SPDX-License-Identifier: GPL-3.0-or-later
// Props that meet each other and the ground, where the answer is known.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "glb_writer.h"
#include "jobs.h"
#include "temporary_folder.h"
#include "two_shapes.h"

namespace spherechain::test {
namespace {

using Vec = baker::Vec3;
using baker::Affine;

constexpr double kPi = std::numbers::pi;

class Prop {
 public:
  explicit Prop(const Shape& shape)
      : asset_([&] {
          Glb glb;
          std::vector<float> positions;
          std::vector<std::uint32_t> corners;
          for (const Vec& p : shape.positions) {
            for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
          }
          for (const auto& t : shape.triangles) corners.insert(corners.end(), t.begin(), t.end());
          glb.json["nodes"] = {{{"mesh", 0}}};
          glb.json["meshes"] = {{{"primitives",
                                  {{{"attributes", {{"POSITION", glb.accessor(positions, "VEC3")}}},
                                    {"indices", glb.accessor(corners, "SCALAR")}}}}}};
          const TemporaryFolder folder;
          const baker::Bake baked =
              baker::bake(folder.write("prop.glb", glb.bytes()), baker::make_settings("prop", "{}", "test"), {});
          return baker::OpenAsset({reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size()}, "prop");
        }()) {}

  const Asset& asset() const { return *asset_.handle(); }

 private:
  baker::OpenAsset asset_;
};

// A prop in a place.
struct Placed {
  JobBody body;
  std::vector<float> bone;  // SC_ROWS_3X4

  Placed(const Prop& prop, const Affine& place) {
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) bone.push_back(static_cast<float>(place(row, column)));
    }
    body.asset = &prop.asset();
    body.pose.bones = bone.data();
    body.pose.bone_count = 1;
    body.pose.bone_layout = SC_ROWS_3X4;
  }
  Placed(const Placed&) = delete;  // the body points into this
};

Affine at(double x, double y, double z) { return Affine(Eigen::Translation3d(x, y, z)); }

// The same bits on every target.
std::vector<Penetration> measure(const Placed& a, const Placed& b) {
  BodyContactJob find;
  find.a = a.body;
  find.b = b.body;
  const SkinContacts found = find_contacts(find);
  REQUIRE(found.status == SC_OK);
  BodyPenetrationJob job;
  job.a = a.body;
  job.b = b.body;
  job.contacts = found.triangles.data();
  job.contact_count = found.triangles.size();
  const std::vector<Penetration> out = spherechain::test::measure(job, SC_TARGET_BEST);
  for (const Target target : supported_targets()) {
    CHECK(same_bits(spherechain::test::measure(job, target), out));
  }
  return out;
}

struct Ground {
  Vec up{0, 1, 0};
  float height = 0;
  float (*terrain)(const void*, sc_vec3) = nullptr;
};

std::vector<Penetration> below(const Placed& prop, const Ground& ground) {
  const PreparedSkin table(*prop.body.asset);
  std::vector<std::uint64_t> scratch(floor_scratch_words(prop.body.asset));
  FloorJob job;
  job.body = prop.body;
  job.body.skin_table = table.words.data();
  job.up = {static_cast<float>(ground.up.x()), static_cast<float>(ground.up.y()), static_cast<float>(ground.up.z())};
  job.height = ground.height;
  job.terrain = ground.terrain;
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  std::vector<Penetration> first;
  for (const Target target : supported_targets()) {
    job.target = target;
    job.penetrations = nullptr;
    job.penetration_capacity = 0;
    REQUIRE(job.run() == SC_OK);
    std::vector<Penetration> found(job.penetration_count);
    job.penetrations = found.data();
    job.penetration_capacity = found.size();
    REQUIRE(job.run() == SC_OK);
    if (target == supported_targets()[0]) first = found;
    CHECK(same_bits(found, first));
  }
  return first;
}

}  // namespace

TEST_CASE("two props are as deep as their shortest overlap, and part along it") {
  const Prop large(box(1, 1, 1)), small(box(0.5, 0.5, 0.5));
  const Placed a(large, at(3, -2, 5));
  const std::vector<Penetration> found = measure(a, Placed(small, at(4.4, -1.7, 5.2)));
  REQUIRE(found.size() == 1);
  CHECK(found[0].part == 0);
  CHECK(found[0].other == 0);
  CHECK(found[0].measures.depth == doctest::Approx(0.1).epsilon(1e-4));
  CHECK(found[0].direction.x < -0.9999F);
  REQUIRE(found[0].measures.volume >= 0);
  CHECK(found[0].measures.volume == doctest::Approx(0.1).epsilon(1e-3));
  CHECK(found[0].kind == SC_CLASS_PENETRATION);
  CHECK(found[0].deepest.position.x == doctest::Approx(4).epsilon(1e-5));
  CHECK(found[0].deepest_other.position.x == doctest::Approx(3.9).epsilon(1e-5));
  // The other way round the way is the other way.
  const std::vector<Penetration> other = measure(Placed(small, at(4.4, -1.7, 5.2)), a);
  REQUIRE(other.size() == 1);
  CHECK(other[0].measures.depth == doctest::Approx(0.1).epsilon(1e-4));
  CHECK(other[0].direction.x > 0.9999F);
  CHECK(measure(a, Placed(small, at(4.6, -1.7, 5.2))).empty());
}

TEST_CASE("one asset twice: two balls, one of them mirrored") {
  const Prop shape(ball(1, 24));
  Affine mirrored = at(0.9, 1.2, 0);
  mirrored.linear() = Eigen::DiagonalMatrix<double, 3>(-1, 1, 1);
  const double lens = kPi * (4 + 1.5) * (2 - 1.5) * (2 - 1.5) / 12;
  for (const Affine& place : {at(0.9, 1.2, 0), mirrored}) {
    const std::vector<Penetration> found = measure(Placed(shape, at(0, 0, 0)), Placed(shape, place));
    REQUIRE(found.size() == 1);
    CHECK(found[0].measures.depth == doctest::Approx(0.5).epsilon(0.02));
    CHECK(Vec(double{found[0].direction.x}, double{found[0].direction.y}, double{found[0].direction.z})
              .dot(Vec(0.6, 0.8, 0)) < -0.99);
    REQUIRE(found[0].measures.volume >= 0);
    CHECK(found[0].measures.volume == doctest::Approx(lens).epsilon(0.02));
  }
}

TEST_CASE("what is below a plane: depth, volume and contour of a box and of a ball") {
  const Prop cube(box(1, 1, 1)), sphere(ball(1, 24));
  const std::vector<Penetration> sunk = below(Placed(cube, at(5, 0.7, 0)), {});
  REQUIRE(sunk.size() == 1);
  CHECK(sunk[0].part == 0);
  CHECK(sunk[0].other == SC_FLOOR);
  CHECK(sunk[0].measures.depth == doctest::Approx(0.3));
  CHECK(sunk[0].direction.y == 1);
  CHECK(sunk[0].measures.volume >= 0);
  CHECK(sunk[0].measures.volume == doctest::Approx(1.2));
  CHECK(sunk[0].measures.contour_length == doctest::Approx(8));
  CHECK(sunk[0].kind == SC_CLASS_PENETRATION);
  CHECK(sunk[0].deepest_other.position.y == doctest::Approx(0));
  CHECK(sunk[0].high.y == doctest::Approx(0));
  CHECK(sunk[0].low.y == doctest::Approx(-0.3));
  CHECK(below(Placed(cube, at(5, 1.01, 0)), {}).empty());
  CHECK(below(Placed(cube, at(5, 0.9975, 0)), {})[0].kind == SC_CLASS_TOUCH);
  // All of it: the volume is the box's, and there is no contour.
  const std::vector<Penetration> under = below(Placed(cube, at(5, -3, 0)), {});
  REQUIRE(under.size() == 1);
  CHECK(under[0].measures.depth == doctest::Approx(4));
  CHECK(under[0].measures.contour_length == 0);
  CHECK(under[0].measures.volume >= 0);
  CHECK(under[0].measures.volume == doctest::Approx(8));
  // A cap of a ball, along a plane that leans; mirrored, too.
  const Vec up = Vec(1, 2, -2) / 3;
  Affine mirrored = Affine(Eigen::Translation3d(2.6 * up));
  mirrored.linear() = Eigen::DiagonalMatrix<double, 3>(1, -1, 1);
  for (const Affine& place : {Affine(Eigen::Translation3d(2.6 * up)), mirrored}) {
    const std::vector<Penetration> cap = below(Placed(sphere, place), {up, 2});
    REQUIRE(cap.size() == 1);
    CHECK(cap[0].measures.depth == doctest::Approx(0.4).epsilon(0.02));
    REQUIRE(cap[0].measures.volume >= 0);
    CHECK(cap[0].measures.volume == doctest::Approx(kPi * 0.16 * (3 - 0.4) / 3).epsilon(0.02));
    CHECK(cap[0].measures.contour_length == doctest::Approx(2 * kPi * 0.8).epsilon(0.01));
  }
}

TEST_CASE("ground over the plane: a slope") {
  const Prop cube(box(1, 1, 1));
  const std::vector<Penetration> found =
      below(Placed(cube, at(0, 1, 0)), {{0, 1, 0}, -0.5F, [](const void*, sc_vec3 p) { return 0.5F + 0.2F * p.x; }});
  REQUIRE(found.size() == 1);
  CHECK(found[0].measures.depth == doctest::Approx(0.2));
  REQUIRE(found[0].measures.volume >= 0);
  CHECK(found[0].measures.volume == doctest::Approx(0.5 * 0.2 * 1 * 2).epsilon(1e-4));  // a wedge
}

TEST_CASE("of skin that ends below the ground the volume is not known") {
  Shape open = cylinder(1, 1, 8);
  const auto flat = [&](const std::array<std::uint32_t, 3>& t) {
    return open.positions[t[0]].y() < -0.99 && open.positions[t[1]].y() < -0.99 && open.positions[t[2]].y() < -0.99;
  };
  std::erase_if(open.triangles, flat);
  Affine lying = at(0, 0.2, 0);
  lying.linear() = Eigen::AngleAxisd(1, Vec(1, 0, 0)).toRotationMatrix();
  const std::vector<Penetration> found = below(Placed(Prop(open), lying), {});
  REQUIRE(found.size() == 1);
  CHECK(found[0].measures.volume < 0);
  CHECK(found[0].measures.depth > 0.5F);
}

}  // namespace spherechain::test
