// SPDX-License-Identifier: MIT
// A model and its bodies give the answers of the jobs that they run, from memory that is allocated when they are made.
#include "spherechain/body.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include "counting_new.h"
#include "jobs.h"
#include "palette.h"
#include "random_poses.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kBones = 9, kSpheres = 30;
constexpr Matrix kUnmoved{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
constexpr std::uint32_t kAllClasses = (1U << (SC_CLASS_INSIDE + 1)) - 1;

// A band that winds through a box, whose bones go astray. The joints of its engine are in the reverse order.
struct Winding {
  TinyAsset tiny = random_band(kSpheres, 1);
  TinySkin skin;
  std::optional<OpenedAsset> opened;
  std::vector<std::string> names;
  std::vector<Bone> joints;

  Winding() {
    for (std::size_t i = 0; i < kSpheres; ++i) give_pivots(tiny, i, 2, static_cast<unsigned>(i));
    skin = add_bones(tiny, kBones, 2);
    add_skin(tiny, &skin, 4);
    opened.emplace(tiny.parts);
    REQUIRE_MESSAGE(opened->status == SC_OK, opened->message);
    for (std::size_t b = kBones; b-- > 0;) joints.push_back(sc_asset_bone(&opened->asset, b));
  }
  Model model(const sc_allocator* allocator = nullptr) const {
    return Model(ModelDef{.inverse_bind_layout = SC_ROWS_3X4,
                          .data = opened->bytes.data(),
                          .size = opened->bytes.size(),
                          .joints = joints.data(),
                          .joint_count = joints.size(),
                          .allocator = allocator});
  }
  // The last bone stands for what none moves.
  static std::vector<Matrix> bones(unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Matrix> out = random_pose(kBones, PoseKind::kGentle, 1, random);
    out.back() = kUnmoved;
    return out;
  }
  static std::vector<Matrix> reversed(std::vector<Matrix> bones) {
    std::reverse(bones.begin(), bones.end());
    return bones;
  }
};

struct Counts {
  std::size_t made = 0, released = 0, bytes = 0;
  std::size_t fails_at = ~std::size_t{0};

  sc_allocator allocator() {
    return {[](void* user, std::size_t size, std::size_t alignment) -> void* {
              Counts& counts = *static_cast<Counts*>(user);
              if (counts.made == counts.fails_at) return nullptr;
              ++counts.made;
              counts.bytes += size;
              return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
            },
            [](void* user, void* memory, std::size_t size, std::size_t) {
              Counts& counts = *static_cast<Counts*>(user);
              ++counts.released;
              counts.bytes -= size;
              std::free(memory);
            },
            this};
  }
};

std::vector<Penetration> by_parts(const Penetrations& found) {
  std::vector<Penetration> out(found.begin(), found.end());
  std::sort(out.begin(), out.end(), [](const Penetration& l, const Penetration& r) {
    return std::pair(std::minmax(l.part, l.other), l.part) < std::pair(std::minmax(r.part, r.other), r.part);
  });
  return out;
}

// A body's answers against those of the jobs, with the engine's joints.
std::vector<Penetration> expected_of(const Winding& of, const Pose& pose, int quick) {
  SkinContactJob find;
  find.asset = &of.opened->asset;
  find.pose = pose;
  find.scope = SC_SCOPE_ALL;
  const SkinContacts contacts = find_contacts(find);
  PenetrationJob job;
  job.asset = find.asset;
  job.pose = pose;
  job.scope = find.scope;
  job.contacts = contacts.triangles.data();
  job.contact_count = contacts.triangles.size();
  job.quick = quick;
  const std::vector<std::uint16_t> inside = find_inside(*find.asset, pose, SC_TARGET_BEST);
  job.inside_a = inside.data();
  job.adds_enclosed = 1;
  job.met = contacts.parts.data();
  job.met_count = contacts.parts.size();
  std::vector<Penetration> out = measure(job, SC_TARGET_BEST);
  for (Penetration& one : out) one.joint = one.joint >= kBones - 1 ? SC_NO_JOINT : kBones - 1 - one.joint;
  return out;
}

}  // namespace

TEST_CASE("a body finds what the jobs find, with the engine's joints, the worst first") {
  const Winding winding;
  const Model model = winding.model();
  REQUIRE_MESSAGE(model, model.message());
  Body body(model);
  REQUIRE(body);
  std::size_t total = 0;
  for (unsigned frame = 0; frame < 10; ++frame) {
    const std::vector<Matrix> bones = Winding::bones(frame), palette = Winding::reversed(bones);
    REQUIRE(body.set_pose(pose_of(palette)) == SC_OK);
    for (const int full : {0, 1}) {
      Query query;
      query.scope = SC_SCOPE_ALL;
      query.full = full;
      query.classes = kAllClasses;
      const Penetrations found = body.penetrations(query);
      REQUIRE(body.status() == SC_OK);
      CHECK(same_bits(by_parts(found), expected_of(winding, pose_of(bones), 1 - full)));
      CHECK(found.total == found.count);
      CHECK(std::is_sorted(found.begin(), found.end(), [](const Penetration& l, const Penetration& r) {
        return l.kind != r.kind ? l.kind > r.kind : l.measures.depth > r.measures.depth;
      }));
      total += found.count;
      // Without classes the faults alone; with a limit the worst.
      query.classes = 0;
      const std::vector<Penetration> all(found.begin(), found.end());
      const auto faults = static_cast<std::size_t>(
          std::count_if(all.begin(), all.end(), [](const Penetration& one) { return is_fault(one.kind); }));
      CHECK(body.penetrations(query).count == faults);
      query.limit = 2;
      const Penetrations worst = body.penetrations(query);
      CHECK(worst.total == faults);
      REQUIRE(worst.count == std::min<std::size_t>(2, faults));
      for (std::size_t i = 0; i < worst.count; ++i) CHECK(same_bits<Penetration>({worst.items[i]}, {all[i]}));
    }
    std::set<std::tuple<std::uint32_t, std::uint32_t, PenetrationClass, float>> faults[2];
    for (const int full : {0, 1}) {
      for (const Penetration& one : body.penetrations({.scope = SC_SCOPE_ALL, .full = full})) {
        faults[full].emplace(one.part, one.other, one.kind, one.measures.depth);
      }
    }
    CHECK(faults[0] == faults[1]);
    SkinContactJob job;
    job.asset = &winding.opened->asset;
    job.pose = pose_of(bones);
    const SkinContacts expected = find_contacts(job);
    Query all;
    all.full = 1;
    const Contacts contacts = body.contacts(all);
    CHECK(same_bits({contacts.parts, contacts.parts + contacts.part_count}, expected.parts));
    CHECK(same_bits({contacts.spheres, contacts.spheres + contacts.sphere_count}, expected.spheres));
    CHECK(same_bits({contacts.triangles, contacts.triangles + contacts.triangle_count}, expected.triangles));
    CHECK(body.contacts().part_count == expected.parts.size());
    CHECK(body.contacts().triangle_total == 0);
    for (const Radius radius : {SC_RADIUS_DETECT, SC_RADIUS_FIT}) {
      Query query;
      query.radius = radius;
      const SpherePairs spheres = body.sphere_pairs(query);
      const std::vector<Sphere> refitted = refit(winding.opened->asset, pose_of(bones), radius).spheres;
      CHECK(same_bits({spheres.spheres, spheres.spheres + spheres.sphere_count}, refitted));
      CHECK(same_bits({spheres.pairs, spheres.pairs + spheres.count},
                      detect(winding.opened->asset, refitted, radius).pairs));
    }
  }
  CHECK(total > 50);
}

TEST_CASE("where there is no room for all triangles, or for all penetrations, the answers are the same, or the worst") {
  const Winding winding;
  const Model model = winding.model();
  Body roomy(model), narrow(model, BodyDef{.max_triangles = 400, .max_penetrations = 3});
  Query query;
  query.scope = SC_SCOPE_ALL;
  query.classes = kAllClasses;
  bool overflowed = false;
  for (unsigned frame = 0; frame < 10; ++frame) {
    const std::vector<Matrix> bones = Winding::bones(frame);
    REQUIRE(roomy.set_pose(pose_of(bones)) == SC_OK);
    REQUIRE(narrow.set_pose(pose_of(bones)) == SC_OK);
    const Penetrations all = roomy.penetrations(query);
    const std::vector<Penetration> expected(all.begin(), all.end());
    const Penetrations worst = narrow.penetrations(query);
    CHECK(worst.total == expected.size());
    REQUIRE(worst.count == std::min<std::size_t>(3, expected.size()));
    CHECK(same_bits<Penetration>({worst.begin(), worst.end()},
                                 {expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(worst.count)}));
    Query lists = query;
    lists.full = 1;
    const Contacts contacts = narrow.contacts(lists);
    CHECK(contacts.triangle_total == roomy.contacts(lists).triangle_total);
    overflowed = overflowed || contacts.triangle_count < contacts.triangle_total;
  }
  CHECK(overflowed);
}

TEST_CASE("two bodies, the ground and the way between two poses give what the jobs give") {
  const Winding winding;
  const Model model = winding.model();
  BodyDef def;
  def.finds_steps = 1;
  Body one(model, def), other(model, def);
  const Transform place{{0.2F, 0.1F, 0}, {0, 0, 0.6F, 0.8F}, {1, 1, 1}};
  const auto placed = [&](std::vector<Matrix> bones) {
    REQUIRE(sc_place_bones(&place, bones[0].data(), bones.size()) == SC_OK);
    return bones;
  };
  CHECK(one.penetrations(other).count == 0);
  CHECK(one.status() == sc_status{SC_NOT_OPEN, SC_FIELD_BODIES});
  std::vector<std::vector<Matrix>> of_one, of_other;
  for (const unsigned seed : {3U, 4U}) {
    of_one.push_back(Winding::bones(seed));
    of_other.push_back(placed(Winding::bones(seed + 10)));
    REQUIRE(one.set_pose(pose_of(Winding::reversed(of_one.back()))) == SC_OK);
    REQUIRE(other.set_pose(pose_of(Winding::reversed(Winding::bones(seed + 10))), place) == SC_OK);
  }
  BodyContactJob find;
  find.a.asset = find.b.asset = &winding.opened->asset;
  find.a.pose = pose_of(of_one[1]);
  find.b.pose = pose_of(of_other[1]);
  const SkinContacts contacts = find_contacts(find);
  const Contacts found = one.contacts(other, {.full = 1});
  CHECK(same_bits({found.triangles, found.triangles + found.triangle_count}, contacts.triangles));
  CHECK(found.triangle_count > 0);
  BodyPenetrationJob measure_job;
  measure_job.a = find.a;
  measure_job.b = find.b;
  measure_job.contacts = contacts.triangles.data();
  measure_job.contact_count = contacts.triangles.size();
  measure_job.quick = 1;
  std::vector<Penetration> expected = measure(measure_job, SC_TARGET_BEST);
  for (Penetration& penetration : expected) penetration.joint = model.part_joint(penetration.part);
  Query query;
  query.classes = kAllClasses;
  const Penetrations penetrations = one.penetrations(other, query);
  std::vector<Penetration> sorted(penetrations.begin(), penetrations.end());
  std::sort(sorted.begin(), sorted.end(), [](const Penetration& l, const Penetration& r) {
    return std::pair(l.part, l.other) < std::pair(r.part, r.other);
  });
  CHECK(same_bits(sorted, expected));
  CHECK(!expected.empty());

  StepJob step;
  step.a.body = find.a;
  step.b.body = find.b;
  step.a.body.pose = pose_of(of_one[0]);
  step.b.body.pose = pose_of(of_other[0]);
  step.a.end = find.a.pose;
  step.b.end = find.b.pose;
  const Steps steps = one.steps(other);
  REQUIRE(one.status() == SC_OK);
  CHECK(same_bits({steps.items, steps.items + steps.count}, find_contacts(step).contacts));
  CHECK(steps.count > 0);

  const Ground ground{.up = {0, 1, 0}, .height = 0.3F};
  query.classes = kAllClasses;
  const Penetrations below = other.below(ground, query);
  REQUIRE(other.status() == SC_OK);
  CHECK(below.count > 0);
  for (const Penetration& part : below) {
    CHECK(part.other == SC_FLOOR);
    CHECK(part.joint == model.part_joint(part.part));
  }
  sc_vec3 low, high;
  CHECK(other.bounds(low, high) == SC_OK);
  for (const Penetration& part : below) CHECK(part.deepest.position.y >= low.y);
}

TEST_CASE("with a limit the deepest parts below the ground are listed, whatever their numbers") {
  const Winding winding;
  const Model model = winding.model();
  Body body(model);
  int not_the_first = 0;
  for (unsigned frame = 0; frame < 10; ++frame) {
    REQUIRE(body.set_pose(pose_of(Winding::bones(frame))) == SC_OK);
    const Ground ground{.up = {0, 1, 0}, .height = 0.5F};
    Query query;
    query.classes = kAllClasses;
    const Penetrations found = body.below(ground, query);
    const std::vector<Penetration> all(found.begin(), found.end());
    query.limit = 1;
    const Penetrations deepest = body.below(ground, query);
    CHECK(deepest.total == all.size());
    if (all.empty()) continue;
    CHECK(same_bits<Penetration>({deepest.begin(), deepest.end()}, {all[0]}));
    not_the_first +=
        std::any_of(all.begin(), all.end(), [&](const auto& one) { return one.part < all[0].part; }) ? 1 : 0;
  }
  CHECK(not_the_first > 2);
}

TEST_CASE("another body of more parts than there is room for is refused, however few its triangles are") {
  const Winding winding;
  TinyAsset tiny = random_band(5, 1);
  for (int k = 0; k < 60; ++k) tiny.parts.parts.push_back({"part " + std::to_string(k)});
  const TinySkin skin = add_bones(tiny, kBones, 2);
  add_skin(tiny, &skin, 4);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const Model model = winding.model(), many(opened.bytes.data(), opened.bytes.size(), nullptr, 0, SC_LAYOUT_UNSET);
  REQUIRE_MESSAGE(many, many.message());
  BodyDef def;
  def.largest_other = many.handle();
  Body narrow(model), roomy(model, def), other(many);
  for (Body* body : {&narrow, &roomy, &other}) REQUIRE(body->set_pose(pose_of(Winding::bones(1))) == SC_OK);
  narrow.contacts(other);
  CHECK(narrow.status() == sc_status{SC_TOO_SMALL, SC_FIELD_BODIES});
  CHECK(narrow.penetrations(other).count == 0);
  CHECK(narrow.status() == sc_status{SC_TOO_SMALL, SC_FIELD_BODIES});
  roomy.contacts(other);
  CHECK(roomy.status() == SC_OK);
}

TEST_CASE("contacts with another body are of the pose that it has now") {
  const Winding winding;
  const Model model = winding.model();
  Body body(model), other(model);
  REQUIRE(body.set_pose(pose_of(Winding::bones(1))) == SC_OK);
  REQUIRE(other.set_pose(pose_of(Winding::bones(2))) == SC_OK);
  const std::size_t near = body.contacts(other, {.full = 1}).triangle_total;
  CHECK(near > 0);
  other = Body(model);  // perhaps where the old one was
  const Transform away{{1000, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
  REQUIRE(other.set_pose(pose_of(Winding::bones(2)), away) == SC_OK);
  CHECK(body.contacts(other, {.full = 1}).triangle_total == 0);
}

TEST_CASE("directions of faults stay steady with the last list as history") {
  const Winding winding;
  const Model model = winding.model();
  Body body(model);
  Query query;
  query.scope = SC_SCOPE_ALL;
  Penetrations last{};
  for (unsigned frame = 0; frame < 6; ++frame) {
    const std::vector<Matrix> bones = Winding::bones(frame / 2);
    REQUIRE(body.set_pose(pose_of(bones)) == SC_OK);
    query.previous = last.items;
    query.previous_count = last.count;
    const std::vector<Penetration> before(last.begin(), last.end());
    last = body.penetrations(query);
    REQUIRE(body.status() == SC_OK);
    CHECK(last.count > 0);
    if (frame % 2 == 1) CHECK(same_bits(before, {last.begin(), last.end()}));
  }
}

TEST_CASE("no question allocates; what cannot be made is null, and leaves nothing behind") {
  const Winding winding;
  Counts counts;
  const sc_allocator allocator = counts.allocator();
  {
    const Model model = winding.model(&allocator);
    REQUIRE(model);
    Body body(model), other(model);
    const std::size_t made = counts.made;
    CHECK(made == 5);
    const std::vector<Matrix> bones = Winding::bones(1);
    const Pose pose = pose_of(bones);
    const std::size_t by_new = allocation_count();
    std::size_t found = 0;
    for (int frame = 0; frame < 3; ++frame) {
      body.set_pose(pose);
      other.set_pose(pose);
      found += body.penetrations().total;
      found += body.penetrations(other).total;
      found += body.contacts(other).part_count;
      found += body.sphere_pairs().total;
    }
    const std::size_t by_new_after = allocation_count();
    CHECK(by_new_after == by_new);
    CHECK(counts.made == made);
    CHECK(body.status() == SC_OK);
    CHECK(found > 0);
    const Body moved(std::move(body));
    CHECK(moved);
    CHECK_FALSE(body);
  }
  CHECK(counts.made == counts.released);
  CHECK(counts.bytes == 0);
  for (std::size_t k = 0; k < 4; ++k) {
    Counts failing;
    failing.fails_at = k;
    const sc_allocator scarce = failing.allocator();
    const Model model = winding.model(&scarce);
    const Body body = model ? Body(model) : Body();
    CHECK_FALSE(body);
    CHECK((model ? body.status() : model.status()) == SC_NO_MEMORY);
    if (!model) CHECK(std::string(model.message()) == "out of memory");
  }
}

TEST_CASE("a model knows what a triangle belongs to, which joint moves a part, and whether a palette is at rest") {
  const Winding winding;
  Model model = winding.model();
  const PreparedSkin skin(winding.opened->asset);
  std::size_t known = 0;
  for (std::uint32_t t = 0; t < winding.tiny.corners.size(); ++t) {
    const TriangleOwner owner = model.triangle(t);
    const std::uint32_t place = skin.surface.place_of_source[t];
    if (place == kNoPlace) {
      CHECK(owner.part == SC_NO_PART);
      continue;
    }
    ++known;
    CHECK(owner.part == skin.surface.parts[place]);
    CHECK(owner.sphere == skin.surface.triangle_spheres[place]);
    CHECK(owner.region == sc_asset_sphere(&model.asset(), owner.sphere).region);
  }
  CHECK(known > 100);
  CHECK(model.triangle(1000000).part == SC_NO_PART);
  std::set<std::uint32_t> joints;
  for (std::uint32_t part = 0; part < sc_asset_get_info(&model.asset()).part_count; ++part) {
    const auto bone = static_cast<std::uint32_t>(sc_asset_part(&model.asset(), part).bone);
    CHECK(model.part_joint(part) == (bone >= kBones - 1 ? SC_NO_JOINT : kBones - 1 - bone));
    joints.insert(model.part_joint(part));
  }
  CHECK(joints.size() > 1);
  CHECK(model.part_joint(1000) == SC_NO_JOINT);
  const std::vector<Matrix> rest(kBones, kUnmoved), moved = Winding::bones(2);
  CHECK(model.check_rest(pose_of(rest)) == SC_OK);
  CHECK(model.check_rest(pose_of(moved)) == SC_OTHER_BIND);
  CHECK(std::string(model.message()).find("bind pose") != std::string::npos);
  const Model wrong(winding.opened->bytes.data(), winding.opened->bytes.size() - 100, nullptr, 0, SC_LAYOUT_UNSET);
  CHECK_FALSE(wrong);
  CHECK(wrong.status() == SC_CORRUPT);
}

TEST_CASE("a model keeps a copy of bytes that lay anywhere, and bodies take palettes of any layout and stride") {
  const Winding winding;
  const std::vector<std::uint8_t>& bytes = winding.opened->bytes;
  std::vector<std::uint8_t> askew(bytes.size() + 1);
  std::copy(bytes.begin(), bytes.end(), askew.begin() + 1);
  Model bound(askew.data() + 1, bytes.size(), winding.joints.data(), winding.joints.size(), SC_ROWS_3X4);
  const Model plain(bytes.data(), bytes.size(), nullptr, 0, SC_LAYOUT_UNSET);
  askew.assign(askew.size(), 0);
  REQUIRE_MESSAGE(bound, bound.message());
  const Model model(std::move(bound));
  CHECK_FALSE(bound);
  CHECK(std::string(model.part_name(1)) == "right hand");
  CHECK(model.part_count() == model.info().part_count);
  CHECK(model.part(1).side == SC_SIDE_RIGHT);
  Body with_joints(model), in_order(plain);
  std::size_t total = 0;
  for (unsigned frame = 0; frame < 6; ++frame) {
    const std::vector<Matrix> bones = Winding::bones(frame);
    SkinContactJob job;
    job.asset = &winding.opened->asset;
    job.pose = pose_of(bones);
    const std::vector<PartContact> expected = find_contacts(job).parts;
    for (const MatrixLayout layout : kLayouts) {
      for (const std::size_t padding : {0U, 3U}) {
        const Palette palette(bones, layout, padding), reversed(Winding::reversed(bones), layout, padding);
        REQUIRE(with_joints.set_pose(reversed.pose()) == SC_OK);
        REQUIRE(in_order.set_pose(palette.pose()) == SC_OK);
        for (Body* body : {&with_joints, &in_order}) {
          const Contacts found = body->contacts();
          CHECK(same_bits<PartContact>({found.begin(), found.end()}, expected));
          total += found.part_count;
        }
      }
    }
  }
  CHECK(total > 50);
}

TEST_CASE("questions about some pairs of body parts find of all answers those of these pairs") {
  const Winding winding;
  const Model model = winding.model();
  const std::uint32_t n = model.part_count();
  std::vector<std::uint64_t> pairs(n * n / 64 + 1, 0);
  std::mt19937 random(7);
  const auto is_asked = [&](std::uint32_t a, std::uint32_t b) {
    return (pairs[(a * n + b) / 64] >> (a * n + b) % 64 & 1) != 0;
  };
  BodyDef wide, narrow;
  wide.max_triangles = 100000;
  narrow.max_triangles = 1000;
  Body body(model, wide), small(model, narrow), other(model);
  std::size_t some = 0, all = 0;
  for (unsigned frame = 0; frame < 10; ++frame) {
    for (std::uint64_t& word : pairs) word = random() & random();
    const std::vector<Matrix> bones = Winding::reversed(Winding::bones(frame));
    for (Body* one : {&body, &small, &other}) REQUIRE(one->set_pose(pose_of(bones)) == SC_OK);
    for (const bool of_two : {false, true}) {
      const auto is_wanted = [&](std::uint32_t a, std::uint32_t b) {
        return is_asked(a, b) || (!of_two && is_asked(b, a));
      };
      Query query;
      query.scope = of_two ? SC_SCOPE_APART : SC_SCOPE_ALL;
      query.full = 1;
      query.classes = kAllClasses;
      const Contacts contacts = of_two ? body.contacts(other, query) : body.contacts(query);
      std::vector<PartContact> parts;
      for (const PartContact& one : contacts) {
        if (is_wanted(one.part_a, one.part_b)) parts.push_back(one);
      }
      std::vector<TriangleContact> triangles;
      for (std::size_t i = 0; i < contacts.triangle_count; ++i) {
        const TriangleContact& one = contacts.triangles[i];
        if (is_wanted(one.part_a, one.part_b)) triangles.push_back(one);
      }
      REQUIRE(contacts.triangle_count == contacts.triangle_total);
      all += contacts.triangle_count;
      some += triangles.size();
      std::vector<Penetration> expected;
      for (const Penetration& one : by_parts(of_two ? body.penetrations(other, query) : body.penetrations(query))) {
        if (is_wanted(one.part, one.other)) expected.push_back(one);
      }
      query.part_pairs = pairs.data();
      const Contacts found = of_two ? body.contacts(other, query) : body.contacts(query);
      CHECK(same_bits({found.begin(), found.end()}, parts));
      CHECK(same_bits({found.triangles, found.triangles + found.triangle_count}, triangles));
      CHECK(same_bits(by_parts(of_two ? body.penetrations(other, query) : body.penetrations(query)), expected));
      if (!of_two) CHECK(same_bits(by_parts(small.penetrations(query)), expected));
    }
  }
  CHECK(some > 1000);
  CHECK(all > 2 * some);
}

TEST_CASE("a model without triangles has spheres, and no answer about its skin") {
  const std::vector<std::uint8_t> bytes = build(random_asset(5, 1).parts);
  const Model model(bytes.data(), bytes.size(), nullptr, 0, SC_LAYOUT_UNSET);
  REQUIRE_MESSAGE(model, model.message());
  CHECK(model.triangle(0).part == SC_NO_PART);
  Body body(model);
  REQUIRE(body);
  const std::vector<float> vertices(3 * model.info().vertex_count, 0);
  Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = model.info().vertex_count;
  REQUIRE(body.set_pose(pose) == SC_OK);
  CHECK(body.sphere_pairs().sphere_count == 5);
  CHECK(body.contacts().part_count == 0);
  CHECK(body.status() == sc_status{SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  CHECK(body.penetrations().count == 0);
  CHECK(body.status() == sc_status{SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  Vec3 low, high;
  CHECK(body.bounds(low, high) == sc_status{SC_NOT_IN_ASSET, SC_FIELD_ASSET});
}

TEST_CASE("bounds from vertices are those of the finite ones") {
  const Winding winding;
  const Model model = winding.model();
  Body body(model);
  std::vector<float> vertices = winding.tiny.rest;
  Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  for (std::size_t v = 3; v < vertices.size(); v += 3) {
    low = {std::min(low.x, vertices[v]), std::min(low.y, vertices[v + 1]), std::min(low.z, vertices[v + 2])};
    high = {std::max(high.x, vertices[v]), std::max(high.y, vertices[v + 1]), std::max(high.z, vertices[v + 2])};
  }
  Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::fill_n(vertices.begin(), 3, 9.0F);
    vertices[axis] = kInfinity;
    REQUIRE(body.set_pose(pose) == SC_OK);
    Vec3 found[2];
    CHECK(body.bounds(found[0], found[1]) == SC_OK);
    CHECK(same_bits<Vec3>({found[0], found[1]}, {low, high}));
  }
}

TEST_CASE("a model that cannot be made is null, and the message says why") {
  const Winding winding;
  const std::vector<std::uint8_t>& bytes = winding.opened->bytes;
  std::string message;
  const auto create = [&](std::uint32_t abi, const std::vector<std::uint8_t>& data, const std::vector<Bone>& joints) {
    sc_model_def def{};
    def.data = data.data();
    def.size = data.size();
    def.joints = joints.empty() ? nullptr : joints.data();
    def.joint_count = joints.size();
    def.inverse_bind_layout = SC_ROWS_3X4;
    message.assign(256, '\0');
    sc_model* model = reinterpret_cast<sc_model*>(&def);
    const sc_status status = sc_create_model(abi, &def, &model, message.data(), message.size());
    CHECK(model == nullptr);
    message.resize(message.find('\0'));
    return status;
  };
  CHECK(create(SC_ABI_VERSION - 1, bytes, {}) == SC_WRONG_ABI);
  CHECK(!message.empty());
  CHECK(create(SC_ABI_VERSION, {bytes.begin(), bytes.end() - 100}, {}) == SC_CORRUPT);
  CHECK(!message.empty());
  std::vector<Bone> joints = winding.joints;
  joints[3].name = "other";
  CHECK(create(SC_ABI_VERSION, bytes, joints) == SC_NO_SUCH_BONE);
  CHECK_MESSAGE(message.find(winding.joints[3].name) != std::string::npos, message);
  sc_model_def def{};
  sc_model* model = nullptr;
  CHECK(sc_create_model(SC_ABI_VERSION, &def, &model, nullptr, 0) == sc_status{SC_NULL, SC_FIELD_DATA});
  def.data = bytes.data();
  def.size = bytes.size();
  CHECK(sc_create_model(SC_ABI_VERSION, &def, nullptr, nullptr, 0) == sc_status{SC_NULL, SC_FIELD_OUTPUT});
  const sc_allocator incomplete{};
  def.allocator = &incomplete;
  CHECK(sc_create_model(SC_ABI_VERSION, &def, &model, nullptr, 0) == sc_status{SC_NULL, SC_FIELD_ALLOCATOR});
  CHECK(sc_create_model(SC_ABI_VERSION, nullptr, &model, nullptr, 0) == sc_status{SC_NULL, SC_FIELD_DATA});
  sc_destroy_model(nullptr);
  sc_destroy_body(nullptr);
}

TEST_CASE("a question with a wrong argument finds nothing and names the field") {
  const Winding winding;
  const Model model = winding.model();
  Body body(model);
  const std::vector<Matrix> bones = Winding::bones(1);
  Pose pose = pose_of(bones);
  pose.bone_layout = SC_LAYOUT_UNSET;
  CHECK(body.set_pose(pose) == sc_status{SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT});
  CHECK(body.contacts().part_count == 0);
  CHECK(body.status() == sc_status{SC_NOT_OPEN, SC_FIELD_BODIES});
  REQUIRE(body.set_pose(pose_of(bones)) == SC_OK);
  Query query;
  Rule rule = sc_default_rule();
  rule.version = 1;
  query.rule = &rule;
  CHECK(body.penetrations(query).count == 0);
  CHECK(body.status() == sc_status{SC_BAD_VALUE, SC_FIELD_RULE});
  body.steps();
  CHECK(body.status() == sc_status{SC_NOT_OPEN, SC_FIELD_BODIES});
  REQUIRE(body.set_pose(pose_of(bones)) == SC_OK);
  body.steps();
  CHECK(body.status() == sc_status{SC_TOO_SMALL, SC_FIELD_BODIES});
  body.contacts(body);
  CHECK(body.status() == sc_status{SC_ALIASED, SC_FIELD_BODIES});
  const std::vector<std::uint64_t> no_parts(4, 0);
  const auto refuses = [&](sc_field field, const auto& spoil) {
    query = {};
    spoil(query);
    CHECK(body.contacts(query).part_count == 0);
    CHECK(body.status() == sc_status{SC_BAD_VALUE, field});
    CHECK(body.penetrations(query).count == 0);
    CHECK(body.status() == sc_status{SC_BAD_VALUE, field});
  };
  refuses(SC_FIELD_SCOPE, [](Query& q) { q.scope = static_cast<Scope>(7); });
  refuses(SC_FIELD_IGNORED_PARTS, [&](Query& q) { q.ignored_parts = no_parts.data(); });
  refuses(SC_FIELD_QUERY, [](Query& q) { q.full = 7; });
  refuses(SC_FIELD_QUERY, [](Query& q) { q.classes = 1U << 31; });
  query = {};
  query.part_pairs = no_parts.data();
  body.steps(query);
  CHECK(body.status() == sc_status{SC_BAD_VALUE, SC_FIELD_PART_PAIRS});
  body.below({.up = {0, 1, 0}}, query);
  CHECK(body.status() == sc_status{SC_BAD_VALUE, SC_FIELD_PART_PAIRS});
  Vec3 low, high;
  CHECK(sc_get_bounds(body.handle(), nullptr, &high) == sc_status{SC_NULL, SC_FIELD_OUTPUT});
  CHECK(sc_get_bounds(body.handle(), &low, nullptr) == sc_status{SC_NULL, SC_FIELD_OUTPUT});
  const Body none;
  CHECK(body.penetrations(none).count == 0);
  CHECK(body.status() == sc_status{SC_NULL, SC_FIELD_BODIES});
  CHECK(sc_create_body(nullptr, nullptr, nullptr) == sc_status{SC_NULL, SC_FIELD_ASSET});
  sc_penetrations found{nullptr, 5, 5};
  CHECK(sc_find_penetrations(nullptr, nullptr, nullptr, &found) == sc_status{SC_NULL, SC_FIELD_BODIES});
  CHECK(found.count == 0);
}

}  // namespace spherechain::test
