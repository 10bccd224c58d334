// SPDX-License-Identifier: MIT
// Steps, of one body and of two: what they say of the ends is what a frame's job says, and hostile calls are refused.
#include <algorithm>
#include <cmath>

#include "fuzz_case.h"
#include "jobs.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kStepWords = std::size_t{1} << 17;
constexpr std::size_t kSpheresMax = 16;  // of more, steps in many pieces take too long

// May it be refused as too wild?
bool draw_transforms(Case& c, sc_transform* joints, std::size_t count) {
  const std::uint32_t modes[] = {0, 0, 0, 0, 0, 8, 1};
  const std::uint32_t hostile = c.random.pick(modes);
  const float reaches[] = {1, 1, 1, 1, 30, 1e6F};
  const float reach = c.random.pick(reaches);
  const float scales[] = {0, 0, 0.3F, 1.5F};  // the last mirrors some
  const float scale = c.random.pick(scales);
  for (std::size_t i = 0; i < count; ++i) {
    sc_transform& joint = joints[i];
    joint.translation = {reach * c.random.figure(), c.random.figure(), c.random.figure()};
    for (float& part : joint.rotation) part = c.random.figure();
    joint.rotation[3] += c.random.one_in(2) ? 2.0F : 0.0F;  // turned by little
    joint.scale = {1 + scale * c.random.figure(), 1 + scale * c.random.figure(), 1 + scale * c.random.figure()};
    if (hostile > 0 && c.random.one_in(hostile)) {
      const float figures[] = {0, -0.0F, 1e-45F, 1e-30F, 1e18F, -1e30F, 3e38F};
      float* const any[] = {&joint.translation.x, &joint.translation.y, &joint.scale.x, &joint.scale.y, &joint.scale.z};
      *c.random.pick(any) = c.random.pick(figures);
    }
  }
  return hostile > 0 || reach > 1 || scale > 0;
}

void draw_joints(Case& c, Motion& motion, bool& may_be_wild) {
  motion.blend = c.random.one_in(2) ? SC_BLEND_SLERP : SC_BLEND_NLERP;
  const std::size_t bones = c.view().bone_count();
  motion.joint_count = bones + c.random.below(3);
  sc_transform* const ends[] = {c.arena.add<sc_transform>(motion.joint_count),
                                c.arena.add<sc_transform>(motion.joint_count)};
  for (sc_transform* joints : ends) may_be_wild = draw_transforms(c, joints, motion.joint_count) || may_be_wild;
  if (c.random.one_in(4)) std::copy(ends[0], ends[0] + motion.joint_count / 2, ends[1]);  // some stay
  motion.start_joints = ends[0];
  motion.end_joints = ends[1];
  if (c.random.one_in(2)) {
    std::uint32_t* const parents = c.arena.add<std::uint32_t>(motion.joint_count);
    for (std::size_t i = 0; i < motion.joint_count; ++i) {
      parents[i] = i == 0 || c.random.one_in(4) ? SC_NO_JOINT : static_cast<std::uint32_t>(c.random.up_to(i - 1));
    }
    motion.parents = parents;
  }
  if (c.random.one_in(2)) {
    std::uint32_t* const joint_of_bone = c.arena.add<std::uint32_t>(bones);
    for (std::size_t i = 0; i < bones; ++i) {
      joint_of_bone[i] =
          c.random.one_in(8) ? SC_NO_JOINT : static_cast<std::uint32_t>(c.random.up_to(motion.joint_count - 1));
    }
    motion.joint_of_bone = joint_of_bone;
  }
  for (Pose* pose : {&motion.body.pose, &motion.end}) {
    if (c.random.one_in(2)) {
      pose->morph_weight_count = c.view().morph_count();
      float* const weights = c.arena.add<float>(pose->morph_weight_count);
      fill_figures(c, weights, pose->morph_weight_count);
      pose->morph_weights = weights;
    }
  }
}

// False where the asset has no skin, or a large one.
bool draw_motion(Case& c, Motion& motion, const std::uint64_t* skin_table, bool& may_be_wild) {
  motion.body.asset = &c.asset;
  motion.body.skin_table = skin_table;
  const bool has_bones = c.view().bone_count() > 0;
  if (has_bones && c.random.one_in(2)) {
    draw_joints(c, motion, may_be_wild);
  } else if (has_bones && c.random.one_in(2)) {
    draw_bones(c, motion.body.pose);
    draw_bones(c, motion.end);
  } else if (!draw_vertices(c, motion.body.pose) || !draw_vertices(c, motion.end)) {
    return false;
  }
  may_be_wild = may_be_wild || motion.body.pose.morph_weights != nullptr || motion.end.morph_weights != nullptr;
  if (c.random.one_in(3)) {
    std::uint64_t* const parts = c.arena.add<std::uint64_t>(sc_part_words(&c.asset));
    std::fill_n(parts, sc_part_words(&c.asset), c.random.bits());
    motion.body.ignored_parts = parts;
  }
  return true;
}

void add_joint_ways(Case& c, Motion& motion, Ways& ways) {
  sc_transform* const ends[] = {const_cast<sc_transform*>(motion.start_joints),
                                const_cast<sc_transform*>(motion.end_joints)};
  const float none[] = {NAN, INFINITY, -INFINITY};
  const std::size_t count = motion.joint_count;
  ways.insert(ways.end(), {[&] { motion.start_joints = nullptr, c.spoil(SC_NULL, SC_FIELD_JOINTS); },
                           [&] { motion.end_joints = nullptr, c.spoil(SC_NULL, SC_FIELD_JOINTS); },
                           [&] { put_askew(c, motion.end_joints), c.spoil(SC_MISALIGNED, SC_FIELD_JOINTS); },
                           [&, ends, none, count] {
                             float* const figures = &c.random.pick(ends)[c.random.up_to(count - 1)].translation.x;
                             figures[c.random.below(10)] = c.random.pick(none);
                             c.spoil(SC_BAD_VALUE, SC_FIELD_JOINTS);
                           },
                           [&, ends, count] {
                             std::fill_n(c.random.pick(ends)[c.random.up_to(count - 1)].rotation, 4, 0.0F);
                             c.spoil(SC_BAD_VALUE, SC_FIELD_JOINTS);
                           },
                           [&, count] {
                             std::uint32_t* const parents = c.arena.add<std::uint32_t>(count);
                             std::fill_n(parents, count, SC_NO_JOINT);
                             const std::size_t i = c.random.up_to(count - 1);
                             parents[i] = static_cast<std::uint32_t>(i + c.random.below(3));
                             motion.parents = parents;
                             c.spoil(SC_BAD_VALUE, SC_FIELD_PARENTS);
                           },
                           [&, count] {
                             std::uint32_t* const joints = c.arena.add<std::uint32_t>(c.view().bone_count());
                             std::fill_n(joints, c.view().bone_count(), static_cast<std::uint32_t>(count));
                             motion.joint_of_bone = joints;
                             c.spoil(SC_TOO_SMALL, SC_FIELD_JOINTS);
                           },
                           [&] {
                             motion.end.bones = c.arena.add<float>(12 * c.view().bone_count());
                             c.spoil(SC_BAD_VALUE, SC_FIELD_JOINTS);
                           }});
}

void add_motion_ways(Case& c, Motion& motion, bool is_first, Ways& ways) {
  ways.emplace_back([&] { motion.body.skin_table = nullptr, c.spoil(SC_NULL, SC_FIELD_SKIN_TABLE); });
  ways.emplace_back([&] { put_askew(c, motion.body.skin_table), c.spoil(SC_MISALIGNED, SC_FIELD_SKIN_TABLE); });
  ways.emplace_back([&] { motion.body.asset = &c.closed, c.spoil(SC_NOT_OPEN, SC_FIELD_ASSET); });
  ways.emplace_back([&] {
    motion.joint_count = ~std::size_t{0} >> c.random.below(8 * sizeof(std::size_t) - 24);
    c.spoil(SC_BAD_VALUE, SC_FIELD_JOINTS);
  });
  ways.emplace_back([&] { motion.blend = draw_none<Blend>(c, 3), c.spoil(SC_BAD_VALUE, SC_FIELD_BLEND); });
  if (is_first) ways.emplace_back([&] { motion.body.asset = nullptr, c.spoil(SC_NULL, SC_FIELD_ASSET); });
  if (motion.blend != SC_BLEND_LINEAR) {
    return add_joint_ways(c, motion, ways);
  }
  Pose& pose = c.random.one_in(2) ? motion.body.pose : motion.end;
  if (pose.bones != nullptr) {
    add_bone_ways(c, pose, ways);
    return;
  }
  add_vertex_ways(c, pose, ways);
  ways.emplace_back([&] {
    if (c.view().bone_count() > 0) {
      motion.end = {};
      draw_bones(c, motion.end);
      c.spoil(SC_BAD_VALUE, SC_FIELD_END);
    }
  });
}

using Parts = std::vector<Pair>;

// Marks the triangles, by the source's numbers, whose corners lie well apart in the pose. A step leaves out the others:
// on the way to a point all would meet.
std::vector<char> sound_triangles(const Case& c, const JobBody& body, const Pose& pose) {
  Surface surface;
  std::vector<char> sound(sc_asset_get_info(&c.asset).triangle_count, 0);
  if (read_skin_table(c.view(), body.skin_table, surface) != SC_OK) return sound;
  const std::vector<float> skinned = pose.vertices == nullptr ? skin(c.asset, pose) : std::vector<float>();
  const float* const places = pose.vertices == nullptr ? skinned.data() : pose.vertices;
  const std::size_t stride = pose.vertices == nullptr ? 3 * sizeof(float) : vertex_stride(pose);
  float most = 0;
  for (const std::uint32_t v : surface.source_vertices) {
    for (int axis = 0; axis < 3; ++axis) most = std::fmax(most, std::fabs(vertex_at(places, v, stride)[axis]));
  }
  for (std::size_t t = 0; t < surface.triangles.size; ++t) {
    const float* corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = vertex_at(places, surface.source_vertices[surface.triangle_vertices[3 * t + k]], stride);
    }
    bool is_sound = std::isfinite(most);
    for (std::size_t k = 0; k < 3; ++k) {
      float apart = 0;
      for (int axis = 0; axis < 3; ++axis) {
        apart = std::max(apart, std::fabs(corners[k][axis] - corners[(k + 1) % 3][axis]));
      }
      is_sound = is_sound && apart > most / 1024;
    }
    sound[surface.triangles[t]] = is_sound ? 1 : 0;
  }
  return sound;
}

// The pairs of parts that a frame's job finds at one end of a step of linear poses, and those that the step must find.
struct PartsAtEnd {
  Parts all, sound;
};

PartsAtEnd parts_at(const Case& c, const StepJob& job, bool at_end, const std::vector<std::uint64_t>& two_scratch) {
  std::vector<std::uint64_t> scratch = two_scratch;
  std::vector<PartContact> parts(400);
  std::vector<TriangleContact> triangles(10000);
  const auto find = [&](auto frame) {
    frame.scratch = scratch.data();
    frame.scratch_words = scratch.size();
    frame.parts = parts.data();
    frame.part_capacity = parts.size();
    frame.triangles = triangles.data();
    frame.triangle_capacity = triangles.size();
    const Status status = frame.run();
    parts.resize(status == SC_OK || status == SC_OVERFLOW ? frame.part_count : 0);
    triangles.resize(std::min(triangles.size(), status == SC_OK || status == SC_OVERFLOW ? frame.triangle_count : 0));
  };
  const bool has_two = job.b.body.asset != nullptr;
  if (!has_two) {
    SkinContactJob frame;
    frame.asset = job.a.body.asset;
    frame.skin_table = job.a.body.skin_table;
    frame.pose = at_end ? job.a.end : job.a.body.pose;
    frame.filter = job.filter;
    find(frame);
  } else {
    BodyContactJob frame;
    frame.a = job.a.body;
    frame.b = job.b.body;
    if (at_end) {
      frame.a.pose = job.a.end;
      frame.b.pose = job.b.end;
    }
    find(frame);
  }
  PartsAtEnd out;
  for (const PartContact& part : parts) out.all.push_back({part.part_a, part.part_b});
  const Motion& other = has_two ? job.b : job.a;
  const std::vector<char> starts[] = {sound_triangles(c, job.a.body, job.a.body.pose),
                                      sound_triangles(c, other.body, other.body.pose)};
  const std::vector<char> ends[] = {sound_triangles(c, job.a.body, job.a.end),
                                    sound_triangles(c, other.body, other.end)};
  for (const TriangleContact& of : triangles) {
    if (starts[0][of.triangle_a] != 0 && ends[0][of.triangle_a] != 0 && starts[1][of.triangle_b] != 0 &&
        ends[1][of.triangle_b] != 0) {
      const bool is_turned = !has_two && of.part_a > of.part_b;
      out.sound.push_back(is_turned ? Pair{of.part_b, of.part_a} : Pair{of.part_a, of.part_b});
    }
  }
  std::sort(out.sound.begin(), out.sound.end());
  out.sound.erase(std::unique(out.sound.begin(), out.sound.end()), out.sound.end());
  return out;
}

void check_contacts(Case& c, const StepJob& job) {
  Parts at_start, at_end;
  for (std::size_t i = 0; i < job.contact_count; ++i) {
    const StepContact& of = job.contacts[i];
    const Pair parts{of.part_a, of.part_b};
    c.expect(of.begin >= 0 && of.begin <= of.end && of.end <= 1, "times of a step");
    c.expect(i == 0 || Pair{job.contacts[i - 1].part_a, job.contacts[i - 1].part_b} < parts, "the order of contacts");
    c.expect(of.at_start == 0 || (of.begin == 0 && of.triangle_a == SC_NO_TRIANGLE), "a contact at the start");
    c.expect(of.at_end == 0 || of.end == 1, "a contact at the end");
    if (of.at_start != 0) at_start.push_back(parts);
    if (of.at_end != 0) at_end.push_back(parts);
  }
  if (job.a.blend == SC_BLEND_LINEAR && job.b.blend == SC_BLEND_LINEAR) {
    const std::vector<std::uint64_t> scratch(body_scratch_words(&c.asset, &c.asset) + skin_scratch_words(&c.asset));
    const auto are_as_in = [](const Parts& found, const PartsAtEnd& frame) {
      return std::includes(frame.all.begin(), frame.all.end(), found.begin(), found.end()) &&
             std::includes(found.begin(), found.end(), frame.sound.begin(), frame.sound.end());
    };
    c.expect(are_as_in(at_start, parts_at(c, job, false, scratch)), "the contacts at the start");
    c.expect(are_as_in(at_end, parts_at(c, job, true, scratch)), "the contacts at the end");
  }
}

}  // namespace

void fuzz_steps(Case& c) {
  const std::size_t table_words = draw_asset(c) ? skin_table_words(&c.asset) : 0;
  if (table_words == 0 || table_words > kStepWords || c.n > kSpheresMax || c.view().part_count() > 20) {
    return;
  }
  std::uint64_t* const table = c.arena.add<std::uint64_t>(table_words);
  c.expect(prepare_skin(&c.asset, table, table_words) == SC_OK, "a skin table is refused");
  StepJob job;
  const bool has_two = c.random.one_in(2);
  bool may_be_wild = false;
  if (!draw_motion(c, job.a, table, may_be_wild) || (has_two && !draw_motion(c, job.b, table, may_be_wild))) {
    return;
  }
  Filter filter;
  if (!has_two && c.random.one_in(2)) {
    filter = draw_filter(c);
    job.filter = &filter;
  }
  const float tolerances[] = {0, 0, 1e-3F, 1, 1e-30F};
  job.tolerance = c.random.pick(tolerances);
  job.scratch_words = step_scratch_words(&job.a, has_two ? &job.b : nullptr);
  if (job.scratch_words > kStepWords) {
    return;
  }
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.contact_capacity = c.random.one_in(2) ? 400 : c.random.below(20);
  job.contacts = c.arena.add<StepContact>(job.contact_capacity);
  Target other = SC_TARGET_BEST;
  Ways ways = {
      [&] { job.scratch = nullptr, c.spoil(SC_NULL, SC_FIELD_SCRATCH); },
      [&] { job.scratch_words = c.random.up_to(job.scratch_words - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SCRATCH); },
      [&] { job.contacts = nullptr, job.contact_capacity = 1, c.spoil(SC_NULL, SC_FIELD_CONTACTS); },
      [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
      [&] {
        const float none[] = {NAN, -1e-45F, -1, 1.1F, INFINITY};
        job.tolerance = c.random.pick(none);
        c.spoil(SC_BAD_VALUE, SC_FIELD_TOLERANCE);
      },
      [&] {
        if (job.filter == nullptr) filter = draw_filter(c);
        job.filter = &filter;
        if (has_two) return c.spoil(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS);
        spoil_filter(c, filter);
      },
      [&] {
        if (job.contact_capacity > 0 && put_over(c, job.contacts, bytes_of(job.scratch, job.scratch_words))) {
          c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
        }
      }};
  const bool is_first = !has_two || c.random.one_in(2);
  add_motion_ways(c, is_first ? job.a : job.b, is_first, ways);
  spoil_some(c, ways);

  if (may_be_wild && c.spoiled == 0) {
    const Status status = job.run();
    if (status == Status{SC_BAD_VALUE, SC_FIELD_JOINTS} || status == Status{SC_BAD_VALUE, SC_FIELD_MORPH_WEIGHTS}) {
      ++c.tally.refused;  // and only scratch memory is written
      return;
    }
  }
  Call call;
  call.run = [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.contacts, std::min(job.contact_capacity, job.contact_count)),
                              bytes_of(job.scratch, job.scratch_words)};
  };
  call.tidy = [&] { std::fill_n(job.scratch, job.scratch_words, std::uint64_t{0}); };
  if (run_twice(c, call) == SC_OK) {
    check_contacts(c, job);
  }
}

}  // namespace spherechain::test
