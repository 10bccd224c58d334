// SPDX-License-Identifier: MIT
// The response keeps its promises, on the doll of the golden tests.
#include "spherechain/response.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

#include "../../golden/clip.h"
#include "counting_new.h"
#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

constexpr float kStep = 1.0F / 32;
constexpr double kBudget = 1.05, kFastest = 8;  // radians, and a second

using Joints = std::vector<Transform>;

Vec3 turned(const float (&q)[4], const Vec3& v) {
  const double w = double{q[3]}, x = double{q[0]}, y = double{q[1]}, z = double{q[2]},
               n = 2 / (w * w + x * x + y * y + z * z);
  const double cx = y * v.z - z * v.y, cy = z * v.x - x * v.z, cz = x * v.y - y * v.x;
  return {static_cast<float>(v.x + n * (w * cx + y * cz - z * cy)),
          static_cast<float>(v.y + n * (w * cy + z * cx - x * cz)),
          static_cast<float>(v.z + n * (w * cz + x * cy - y * cx))};
}

double distance(const Vec3& l, const Vec3& r) { return double{std::hypot(l.x - r.x, l.y - r.y, l.z - r.z)}; }

struct Played {
  Doll doll{DOLL_FOLDER, "doll.sphc"};
  Model model{doll.bytes.data(), 8 * doll.bytes.size(), nullptr, 0, SC_ROWS_3X4};
  std::vector<std::uint32_t> parents = parents_of(doll.asset);
  Body body{model}, looker{model};
  Response response;
  ResponseState state;
  ResponseFrame frame;

  Played() : response(body, def()) {
    REQUIRE_MESSAGE(doll.error.empty(), doll.error);
    REQUIRE(response);
    frame.seconds = kStep;
  }
  ResponseDef def() const {
    ResponseDef out;
    out.parents = parents.data();
    out.joint_count = parents.size();
    return out;
  }
  // The clip, with shoulders that turn half as far again.
  Joints at(std::size_t f) const {
    Joints out = joints_at(doll.asset, f);
    for (const std::size_t shoulder : {joint("left_shoulder"), joint("right_shoulder")}) {
      float* const q = out[shoulder].rotation;
      const float squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2], size = std::sqrt(squared + q[3] * q[3]),
                  more = size + 2 * q[3];
      q[3] = size * q[3] + q[3] * q[3] - squared;
      for (int k = 0; k < 3; ++k) q[k] *= more;
    }
    return out;
  }
  Status respond(Joints& joints) {
    frame.joints = joints.data();
    return response.respond(state, frame);
  }
  std::size_t joint(std::string_view name) const {
    std::size_t out = 0;
    while (name != view_of(doll.asset).joint(out).name) ++out;
    return out;
  }
  // The joints in the world, rotations not of unit length.
  std::vector<Transform> world_of(const Joints& joints) const {
    std::vector<Transform> world;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Transform& own = joints[j];
      Transform here = own;
      if (parents[j] != SC_NO_JOINT) {
        const Transform& above = world[parents[j]];
        const Vec3 moved = turned(above.rotation, own.translation);
        here.translation = {above.translation.x + moved.x, above.translation.y + moved.y,
                            above.translation.z + moved.z};
        const float *a = above.rotation, *b = own.rotation;
        here.rotation[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
        here.rotation[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
        here.rotation[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
        here.rotation[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
      }
      world.push_back(here);
    }
    return world;
  }
  // Moves a body to these joints, in another way than the response does.
  void pose(Body& of, const Joints& joints, const Transform& place = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}) const {
    std::vector<float> bones;
    const std::vector<Transform> world = world_of(joints);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Transform& here = world[j];
      const Vec3 rest = view_of(doll.asset).joint(j).position, from = turned(here.rotation, rest);
      const Vec3 axes[] = {turned(here.rotation, {1, 0, 0}), turned(here.rotation, {0, 1, 0}),
                           turned(here.rotation, {0, 0, 1})};
      const float shift[] = {here.translation.x - from.x, here.translation.y - from.y, here.translation.z - from.z};
      const float rows[3][3] = {
          {axes[0].x, axes[1].x, axes[2].x}, {axes[0].y, axes[1].y, axes[2].y}, {axes[0].z, axes[1].z, axes[2].z}};
      for (std::size_t r = 0; r < 3; ++r) {
        bones.insert(bones.end(), {rows[r][0], rows[r][1], rows[r][2], shift[r]});
      }
    }
    Pose pose;
    pose.bones = bones.data();
    pose.bone_count = bones.size() / 12;
    pose.bone_layout = SC_ROWS_3X4;
    REQUIRE(of.set_pose(pose, place) == SC_OK);
  }
  // How deep arms are at fault beyond the rule.
  double fault_depth(const Joints& joints) {
    pose(looker, joints);
    double sum = 0;
    for (const Penetration& found : looker.penetrations()) {
      const std::string_view name = model.part_name(found.part), other = model.part_name(found.other);
      const bool is_of_arm = name.find("arm") != name.npos || other.find("arm") != other.npos;
      sum += is_of_arm && found.measures.relation != SC_RELATION_JOINED ? double{found.fault_depth} : 0;
    }
    return sum;
  }
};

// The doll at rest, arms out to the sides.
struct Resting {
  Joints joints;
  std::vector<float> bones;
  Pose pose;

  explicit Resting(const Played& played) : joints(played.at(0)) {
    for (Transform& joint : joints) {
      std::copy_n(std::vector<float>{0, 0, 0, 1}.data(), 4, joint.rotation);
      bones.insert(bones.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    }
    pose.bones = bones.data();
    pose.bone_count = joints.size();
    pose.bone_layout = SC_ROWS_3X4;
  }
  Resting(const Resting&) = delete;
};

// The angle between two rotations.
double between(const Transform& l, const Transform& r) {
  double dot = 0, ll = 0, rr = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    dot += double{l.rotation[k]} * double{r.rotation[k]};
    ll += double{l.rotation[k]} * double{l.rotation[k]};
    rr += double{r.rotation[k]} * double{r.rotation[k]};
  }
  return 2 * std::acos(std::min(std::abs(dot) / std::sqrt(ll * rr), 1.0));
}

bool same(const Joints& l, const Joints& r) { return same_bits(l, r); }

TEST_CASE("arms leave the body, and never go deeper than they are animated") {
  Played played;
  int before = 0, after = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    const Joints animated = played.at(f);
    Joints joints = animated;
    REQUIRE(played.respond(joints) == SC_OK);
    const double was = played.fault_depth(animated), is = played.fault_depth(joints);
    before += was > 0 ? 1 : 0;
    after += is > 0 ? 1 : 0;
    CHECK(is <= was + 1e-3 * double{played.model.info().height});
    CHECK((played.frame.turned == 0) == same(animated, joints));
  }
  CHECK(before > 40);
  CHECK(after < before / 3);  // some are deeper than a budget reaches
}

TEST_CASE("where nothing is near, all stays as it is, bit for bit") {
  Played played;
  const Resting rest(played);
  Joints joints = rest.joints;
  REQUIRE(played.respond(joints) == SC_OK);
  CHECK(played.frame.turned == 0);
  CHECK(same(rest.joints, joints));
}

TEST_CASE("joints keep to their budgets and to the pace of the response") {
  Played played;
  Joints last, last_animated;
  double most = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    const Joints animated = played.at(f);
    Joints joints = animated;
    REQUIRE(played.respond(joints) == SC_OK);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      CHECK(between(animated[j], joints[j]) <= kBudget + 1e-4);
      most = std::max(most, between(animated[j], joints[j]));
      if (f == 0) continue;
      const double turn = between(last[j], joints[j]), own = between(last_animated[j], animated[j]);
      const bool comes_back = between(animated[j], joints[j]) < 0.6 * between(last_animated[j], last[j]);
      CHECK((turn <= own + kFastest * double{kStep} + 1e-3 || comes_back));
    }
    last = joints;
    last_animated = animated;
  }
  CHECK(most > 0.95 * kBudget);
}

TEST_CASE("small steps of the animation make small steps of the response") {
  Played played;
  played.frame.seconds = kStep / 32;
  double largest = 0;
  Joints last;
  for (int i = 0; i < 600; ++i) {
    Joints joints = played.at(0);
    const double t = -1.2 * i / 600;  // the tangent of half the angle: across the chest
    Transform& shoulder = joints[played.joint("left_shoulder")];
    shoulder.rotation[0] = shoulder.rotation[2] = 0;
    shoulder.rotation[1] = static_cast<float>(t);
    shoulder.rotation[3] = 1;
    REQUIRE(played.respond(joints) == SC_OK);
    for (std::size_t j = 0; j < joints.size() && !last.empty(); ++j)
      largest = std::max(largest, between(last[j], joints[j]));
    last = joints;
  }
  CHECK(largest < 0.02);
}

TEST_CASE("an arm that starts inside the body comes out") {
  Played played;
  int inside = 0, out = 0;
  for (std::size_t f = 0; f < kFrames; f += 2) {
    const Joints held = played.at(f);
    if (!(played.fault_depth(held) > 0)) continue;
    played.state = {};
    Joints joints;
    for (int i = 0; i < 12; ++i) {
      joints = held;
      REQUIRE(played.respond(joints) == SC_OK);
    }
    ++inside;
    out += played.fault_depth(joints) > 0 ? 0 : 1;
  }
  CHECK(inside > 60);
  CHECK(inside - out <= inside / 10);  // these are deeper than a budget reaches
}

TEST_CASE("a bent elbow does not bend backward") {
  Played played;
  const std::size_t elbow = played.joint("left_elbow"), wrist = played.joint("left_wrist");
  double least = 1, sharpest = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    const Joints animated = played.at(f);
    Joints joints = animated;
    REQUIRE(played.respond(joints) == SC_OK);
    const auto axis = [&](const Joints& of) {
      const Vec3 u = of[elbow].translation, l = turned(of[elbow].rotation, of[wrist].translation);
      const double size = distance(u, {}) * distance(l, {});
      return Vec3{static_cast<float>((u.y * l.z - u.z * l.y) / size),
                  static_cast<float>((u.z * l.x - u.x * l.z) / size),
                  static_cast<float>((u.x * l.y - u.y * l.x) / size)};
    };
    const Vec3 was = axis(animated), is = axis(joints);
    sharpest = std::max(sharpest, distance(was, {}));
    least = std::min(least, double{was.x * is.x + was.y * is.y + was.z * is.z});
  }
  CHECK(sharpest > 0.5);
  CHECK(least > -0.01);
}

TEST_CASE("planted joints stay where they are animated, and the arms still leave the body") {
  Played played;
  const double height = double{played.model.info().height};
  const std::uint32_t planted[] = {static_cast<std::uint32_t>(played.joint("left_wrist")),
                                   static_cast<std::uint32_t>(played.joint("right_wrist"))};
  std::vector<float> mobility(played.parents.size());
  for (const char* const name : {"left_shoulder", "right_shoulder", "left_elbow", "right_elbow"}) {
    mobility[played.joint(name)] = 1;
  }
  // A hand that turns itself keeps its direction, too.
  for (const float of_hands : {0.0F, 1.0F}) {
    mobility[planted[0]] = mobility[planted[1]] = of_hands;
    ResponseDef def = played.def();
    def.mobility = mobility.data();
    played.response = Response(played.body, def);
    REQUIRE(played.response);
    double moved[2] = {}, turned[2] = {};  // without and with: the largest
    int cleared = 0;
    for (const bool are_planted : {false, true}) {
      played.state = {};
      played.frame.planted = planted;
      played.frame.planted_count = are_planted ? 2 : 0;
      for (std::size_t f = 0; f < kFrames; ++f) {
        const Joints animated = played.at(f);
        Joints joints = animated;
        REQUIRE(played.respond(joints) == SC_OK);
        const std::vector<Transform> was = played.world_of(animated), is = played.world_of(joints);
        for (const std::uint32_t joint : planted) {
          double &far = moved[are_planted ? 1 : 0], &most = turned[are_planted ? 1 : 0];
          far = std::max(far, distance(was[joint].translation, is[joint].translation) / height);
          most = std::max(most, between(was[joint], is[joint]));
        }
        cleared += are_planted && played.fault_depth(animated) > 0 && !(played.fault_depth(joints) > 0) ? 1 : 0;
      }
    }
    CHECK(moved[0] > 0.05);
    CHECK(moved[1] < 0.00115);  // 2 mm on a human
    CHECK(turned[0] > 0.3);
    CHECK((of_hands == 0 || turned[1] < 0.0087));  // half a degree
    CHECK(cleared > 5);
  }
}

TEST_CASE("in a pause nothing turns on, and a long frame counts as a second") {
  Played played;
  int compared = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    Joints joints = played.at(f), again = joints, slow = joints, slower = joints;
    const ResponseState before = played.state;
    REQUIRE(played.respond(joints) == SC_OK);
    const ResponseState after = played.state;
    const float left = played.frame.remaining;
    played.frame.seconds = 0;
    REQUIRE(played.respond(again) == SC_OK);
    if (!(left > 0)) {  // else something may be taken back
      ++compared;
      for (std::size_t j = 0; j < joints.size(); ++j) CHECK(between(joints[j], again[j]) < 0.005);
    }
    for (Joints* const late : {&slow, &slower}) {
      played.state = before;
      played.frame.seconds = late == &slow ? 1.0F : 1000.0F;
      REQUIRE(played.respond(*late) == SC_OK);
    }
    CHECK(same(slow, slower));
    played.state = after;
    played.frame.seconds = kStep;
  }
  CHECK(compared > 100);
}

TEST_CASE("a joint that has a hinge turns about it") {
  Played played;
  const std::size_t clavicle = played.joint("left_clavicle");
  double along_y[2] = {};  // shares of the turns
  for (const bool is_y : {false, true}) {
    std::vector<Vec3> hinges(played.parents.size());
    hinges[clavicle] = is_y ? Vec3{0, 2, 0} : Vec3{0, 0, 1};
    ResponseDef def = played.def();
    def.hinges = hinges.data();
    std::vector<float> mobility(hinges.size(), 0.0F);
    mobility[clavicle] = 1;  // alone
    def.mobility = mobility.data();
    Response response(played.body, def);
    REQUIRE(response);
    ResponseState state;
    double sum = 0;
    for (std::size_t f = 0; f < kFrames; ++f) {
      const Joints animated = played.at(f);
      Joints joints = animated;
      played.frame.joints = joints.data();
      REQUIRE(response.respond(state, played.frame) == SC_OK);
      // The turn is the corrected rotation times the inverse of the animated one.
      const float *a = joints[clavicle].rotation, *b = animated[clavicle].rotation;
      const double x = double{a[0] * b[3] - a[3] * b[0] + a[2] * b[1] - a[1] * b[2]},
                   y = double{a[1] * b[3] - a[3] * b[1] + a[0] * b[2] - a[2] * b[0]},
                   z = double{a[2] * b[3] - a[3] * b[2] + a[1] * b[0] - a[0] * b[1]};
      along_y[is_y ? 1 : 0] += std::abs(y);
      sum += std::abs(x) + std::abs(y) + std::abs(z);
    }
    REQUIRE(sum > 0);
    along_y[is_y ? 1 : 0] /= sum;
  }
  CHECK(along_y[1] > 1.5 * along_y[0]);
}

TEST_CASE("a copy of the state replays the same on every target, and nothing is allocated") {
  Played played;
  ResponseState kept;
  std::vector<Joints> first;
  for (const Target target : supported_targets()) {
    played.frame.target = target;
    for (std::size_t f = 40; f < 100; ++f) {
      if (f == 60 && first.empty()) kept = played.state;
      Joints joints = played.at(f);
      const std::size_t allocated = allocation_count();
      const Status status = played.respond(joints);
      CHECK(allocation_count() == allocated);
      REQUIRE(status == SC_OK);
      if (f >= 60 && first.size() < 40) {
        first.push_back(joints);
      } else if (f >= 60) {
        CHECK(same(joints, first[f - 60]));
      }
    }
    played.state = {};
  }
  played.state = kept;
  for (std::size_t f = 60; f < 100; ++f) {
    Joints joints = played.at(f);
    REQUIRE(played.respond(joints) == SC_OK);
    CHECK(same(joints, first[f - 60]));
  }
}

TEST_CASE("the response fades, and sets in earlier where it knows what comes") {
  Played played;
  int turned = 0, ahead_turned = 0;
  for (std::size_t f = 0; f < kFrames - 3; ++f) {
    const Joints animated = played.at(f);
    Joints joints = animated;
    played.frame.weakness = 1;
    REQUIRE(played.respond(joints) == SC_OK);
    CHECK(same(animated, joints));
  }
  played.frame.weakness = 0;
  for (const bool is_ahead : {false, true}) {
    played.state = {};
    for (std::size_t f = 0; f < kFrames - 3; ++f) {
      Joints joints = played.at(f), later = played.at(f + 3);
      played.frame.ahead = is_ahead ? later.data() : nullptr;
      played.frame.ahead_frames = is_ahead ? 3 : 0;
      REQUIRE(played.respond(joints) == SC_OK);
      (is_ahead ? ahead_turned : turned) += played.frame.turned > 0 ? 1 : 0;
    }
  }
  CHECK(turned > 0);
  CHECK(ahead_turned > turned);
}

TEST_CASE("a row's gap follows its joints as its normal says") {
  Played played;
  std::size_t looked_at = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    Joints joints = played.at(f);
    REQUIRE(played.respond(joints) == SC_OK);
    for (std::size_t i = 0; i < played.frame.row_count; ++i) {
      const ContactRow& row = played.frame.rows[i];
      CHECK(distance(row.normal, {}) == doctest::Approx(1));
      const double gap = double{row.at.x - row.at_other.x} * row.normal.x +
                         double{row.at.y - row.at_other.y} * row.normal.y +
                         double{row.at.z - row.at_other.z} * row.normal.z;
      CHECK(gap <= double{row.gap} + 1e-3 * double{played.model.info().height});
      CHECK(row.part < played.model.part_count());
      ++looked_at;
    }
  }
  CHECK(looked_at > 100);
}

TEST_CASE("a gap is a row: closed by so much, the two touch, and by less they do not") {
  Played played, other;
  const float height = played.model.info().height;
  const Resting rest(played);
  const sc_body* const others[] = {other.body.handle()};
  played.frame.others = others;
  played.frame.other_count = 1;
  played.frame.weakness = 1;
  std::size_t looked_at = 0;
  for (int step = 0; step < 60; ++step) {  // the other comes from behind
    Transform place{{0.45F * height, 0, (0.3F - 0.005F * static_cast<float>(step)) * height}, {0, 0, 0, 1}, {1, 1, 1}};
    REQUIRE(other.body.set_pose(rest.pose, place) == SC_OK);
    Joints joints = rest.joints;
    REQUIRE(played.respond(joints) == SC_OK);
    const std::vector<ContactRow> rows(played.frame.rows, played.frame.rows + played.frame.row_count);
    for (const ContactRow& row : rows) {
      const bool is_narrowest = std::none_of(rows.begin(), rows.end(), [&](const ContactRow& l) {
        return l.part == row.part && l.other == row.other && l.gap < row.gap;
      });
      CHECK(distance(row.normal, {}) == doctest::Approx(1));
      if (row.body != 1 || row.gap <= 0 || row.allowed > 0 || !is_narrowest) continue;
      for (const float share : {0.99F, 1.01F}) {
        const Transform closer{
            {place.translation.x + share * row.gap * row.normal.x, place.translation.y + share * row.gap * row.normal.y,
             place.translation.z + share * row.gap * row.normal.z},
            {0, 0, 0, 1},
            {1, 1, 1}};
        REQUIRE(played.looker.set_pose(rest.pose) == SC_OK);
        REQUIRE(other.looker.set_pose(rest.pose, closer) == SC_OK);
        const Contacts found = played.looker.contacts(other.looker);
        const bool meet = std::any_of(found.parts, found.parts + found.part_count, [&](const PartContact& parts) {
          return parts.part_a == row.part && parts.part_b == row.other;
        });
        CHECK(meet == (share > 1));
      }
      ++looked_at;
    }
  }
  CHECK(looked_at > 3);
}

TEST_CASE("a hand stays out of another character and of the ground") {
  Played played, other;
  const Resting rest(played);
  const float height = played.model.info().height;
  const sc_body* const others[] = {other.body.handle()};
  Ground ground;
  ground.up = {0, 1, 0};
  ground.height = 0.7F * height;                                     // below the shoulders
  for (const float behind : {0.0F, 0.05F, 0.06F, 0.075F, 0.085F}) {  // the other is behind the left forearm
    const bool is_ground = behind <= 0;
    const Transform place{{0.45F * height, 0, behind * height}, {0, 0, 0, 1}, {1, 1, 1}};
    REQUIRE(other.body.set_pose(rest.pose, place) == SC_OK);
    played.state = {};
    played.frame.others = others;
    played.frame.other_count = is_ground ? 0 : 1;
    played.frame.ground = is_ground ? &ground : nullptr;
    float last = 0;
    for (int i = 0; i < 30; ++i) {
      Joints joints = rest.joints;
      if (is_ground)
        std::copy_n(std::vector<float>{0, 0, -0.2F, 1}.data(), 4, joints[played.joint("left_shoulder")].rotation);
      REQUIRE(played.respond(joints) == SC_OK);
      last = 0;
      for (std::size_t r = 0; r < played.frame.row_count; ++r) {
        const ContactRow& row = played.frame.rows[r];
        CHECK((row.body == 1 && (row.other == SC_FLOOR) == is_ground));
        last = std::max(last, -row.gap - row.allowed);
      }
    }
    CHECK(played.frame.turned > 0);
    CHECK(last < 0.02F * height);
  }
}

TEST_CASE("characters that respond one after the other keep out of each other") {
  Played first, second;
  const float tall = first.model.info().height;
  const Transform place{{0.4F * tall, 0, 0.15F * tall}, {0, 1, 0, 0}, {1, 1, 1}};  // at the left, looks the other way
  const sc_body *const others_of_first[] = {second.body.handle()}, *const others_of_second[] = {first.body.handle()};
  first.frame.others = others_of_first;
  second.frame.others = others_of_second;
  first.frame.other_count = second.frame.other_count = 1;
  second.frame.place = &place;
  const auto depth = [](Body& of, const Body& other) {
    double sum = 0;
    for (const Penetration& found : of.penetrations(other)) sum += double{found.fault_depth};
    return sum;
  };
  int before = 0, after = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    Joints joints = first.at(f), joints_of_second = second.at((f + 60) % kFrames);
    first.pose(first.looker, joints);
    second.pose(second.looker, joints_of_second, place);
    before += depth(first.looker, second.looker) > 0 ? 1 : 0;
    second.pose(second.body, joints_of_second, place);
    REQUIRE(first.respond(joints) == SC_OK);
    REQUIRE(second.respond(joints_of_second) == SC_OK);
    first.pose(first.looker, joints);
    second.pose(second.looker, joints_of_second, place);
    const double left = depth(first.looker, second.looker);
    after += left > 0 ? 1 : 0;
    CHECK(std::abs(depth(first.body, second.body) - left) < 1e-3 * double{tall});  // the bodies are as corrected, too
  }
  CHECK(before > 20);
  CHECK(after < before / 3);
}

TEST_CASE("what cannot be is refused, and changes nothing") {
  Played played;
  Response none;
  std::vector<std::uint32_t> circle = played.parents;
  circle[0] = 1;
  ResponseDef def = played.def();
  def.parents = circle.data();
  CHECK(Response(played.body, def).status() == Status{SC_BAD_VALUE, SC_FIELD_PARENTS});
  def = played.def();
  def.joint_count = 3;
  CHECK(Response(played.body, def).status() == Status{SC_TOO_SMALL, SC_FIELD_JOINTS});
  std::vector<float> mobility(played.parents.size(), 1);
  def = played.def();
  def.mobility = mobility.data();
  CHECK(Response(played.body, def).status() == Status{SC_BAD_VALUE, SC_FIELD_JOINTS});  // too many
  std::fill(mobility.begin(), mobility.end(), 0.0F);
  mobility[1] = kNan;
  CHECK(Response(played.body, def).status() == Status{SC_BAD_VALUE, SC_FIELD_JOINTS});

  Joints joints = played.at(0);
  joints[4].rotation[2] = kNan;
  const Joints before = joints;
  const ResponseState state = played.state;
  CHECK(played.respond(joints) == Status{SC_BAD_VALUE, SC_FIELD_TRANSFORM});
  CHECK(std::memcmp(joints.data(), before.data(), joints.size() * sizeof joints[0]) == 0);
  CHECK(std::memcmp(&state, &played.state, sizeof state) == 0);
  played.frame.seconds = -1;
  joints = played.at(0);
  CHECK(played.respond(joints).code == SC_BAD_VALUE);
}

TEST_CASE("mirrored, scaled and moved characters get the same turns") {
  Played plain;
  for (const Transform& place :
       {Transform{{5, 6, 7}, {0, 0.6F, 0, 0.8F}, {2, 2, 2}}, Transform{{0, 0, 0}, {0, 0, 0, 1}, {-1, 1, 1}}}) {
    Played moved;
    plain.state = {};
    moved.frame.place = &place;
    for (std::size_t f = 0; f < 64; ++f) {
      Joints joints = plain.at(f), there = joints;
      REQUIRE(plain.respond(joints) == SC_OK);
      REQUIRE(moved.respond(there) == SC_OK);
      for (std::size_t j = 0; j < joints.size(); ++j) CHECK(between(joints[j], there[j]) < 0.05);
    }
  }
}

}  // namespace
}  // namespace spherechain::test
