// SPDX-License-Identifier: MIT
// Responses: skeletons that are none, joints that are nowhere, and states whose words are any bits.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "fuzz_case.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kTrianglesMost = 120;  // of more, poses that collapse take too long
constexpr std::size_t kResponseWords = std::size_t{1} << 17;
constexpr std::size_t kTurning = 16;  // the most joints that may turn

// Parents, most of them sound: in any order, with several roots. False where they are none of a skeleton.
bool draw_parents(Case& c, std::uint32_t* parents, std::size_t count) {
  for (std::size_t j = 0; j < count; ++j) {
    parents[j] = j == 0 || c.random.one_in(5) ? SC_NO_JOINT : static_cast<std::uint32_t>(c.random.up_to(j - 1));
  }
  if (count > 1 && c.random.one_in(2)) {  // children first
    std::reverse(parents, parents + count);
    for (std::size_t j = 0; j < count; ++j) {
      parents[j] = parents[j] == SC_NO_JOINT ? SC_NO_JOINT : static_cast<std::uint32_t>(count - 1 - parents[j]);
    }
  }
  if (count == 0 || !c.random.one_in(8)) return true;
  const std::size_t at = c.random.up_to(count - 1);
  const std::uint32_t none[] = {static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(count), SC_NO_JOINT - 1};
  parents[at] = c.random.pick(none);
  return false;
}

// False where it is not sound for certain.
bool draw_transform(Case& c, Transform& out) {
  out = {{c.random.figure(), c.random.figure(), c.random.figure()}, {0, 0, 0, 1}, {1, 1, 1}};
  for (float& entry : out.rotation) entry += c.random.figure();
  const float scales[] = {1, 1, 1, -1, 0.5F, 1e-3F, 0, 1e-30F, 1e15F, -3e38F};
  if (c.random.one_in(3)) out.scale.x = c.random.pick(scales);
  if (c.random.one_in(3)) out.scale.y = out.scale.z = c.random.pick(scales);
  if (c.random.one_in(60)) fill_figures(c, &out.translation.x, 3);
  if (c.random.one_in(200)) fill_figures(c, out.rotation, 4);
  if (c.random.one_in(200)) std::fill_n(out.rotation, 4, 0.0F);
  const float* const r = out.rotation;
  const double size = double{r[0]} * double{r[0]} + double{r[1]} * double{r[1]} + double{r[2]} * double{r[2]} +
                      double{r[3]} * double{r[3]};
  return size > 1e-12 && size < 1e12 && std::isfinite(out.translation.x) && std::isfinite(out.translation.y) &&
         std::isfinite(out.translation.z);
}

// Other bits in some of a state's words: any, small numbers, or figures that are none.
void spoil_state(Case& c, ResponseState& state) {
  const std::uint32_t modes[] = {1, 3, 30, 300};
  const std::uint32_t mode = c.random.pick(modes);
  for (std::uint64_t& word : state.words) {
    if (!c.random.one_in(mode)) continue;
    float figures[2];
    fill_figures(c, figures, 2);
    const std::uint64_t small =
        c.random.below(4) | std::uint64_t{c.random.below(4)} << 16 | std::uint64_t{c.random.below(40)} << 32;
    std::uint64_t bits = 0;
    std::memcpy(&bits, figures, sizeof bits);
    const std::uint64_t draws[] = {bits, bits, small, c.random.bits()};
    word = c.random.pick(draws);
  }
}

// A frame, and what is wrong with it for certain.
struct DrawnFrame {
  ResponseFrame frame;
  const sc_body* others[3] = {};
  std::uint32_t planted[4] = {};
  Status wanted{};
};

// Buffers of a character's frames.
struct Buffers {
  std::size_t joint_count;
  Transform *joints, *ahead, *place;
  ResponseState* state;
  Ground ground{.up = {0, 1, 0}};
};

void spoil_frame(Case& c, const Body& own, DrawnFrame& out) {
  ResponseFrame& frame = out.frame;
  const float none[] = {NAN, -1e-38F, -1, 1.5F, INFINITY};
  switch (c.random.below(7)) {
    case 0:
      do frame.seconds = c.random.pick(none);
      while (frame.seconds == 1.5F);  // counts as 1
      out.wanted = {SC_BAD_VALUE, SC_FIELD_QUERY};
      return;
    case 1:
      frame.weakness = c.random.pick(none);
      out.wanted = {SC_BAD_VALUE, SC_FIELD_QUERY};
      return;
    case 2:
      frame.ahead_frames = 4 + c.random.below(3);
      out.wanted = frame.ahead == nullptr ? Status{SC_NULL, SC_FIELD_BODIES} : Status{SC_BAD_VALUE, SC_FIELD_QUERY};
      return;
    case 3:
      frame.others = out.others;
      frame.other_count = 1 + c.random.below(3);
      out.others[frame.other_count - 1] = nullptr;
      out.wanted = {SC_NULL, SC_FIELD_BODIES};
      return;
    case 5:
      frame.planted = out.planted;
      frame.planted_count = 1;
      out.planted[0] = 0x10000;
      out.wanted = {SC_BAD_VALUE, SC_FIELD_JOINTS};
      return;
    case 4:
      frame.joints = nullptr;
      out.wanted = {SC_NULL, SC_FIELD_JOINTS};
      return;
    default:  // asked of itself
      frame.others = out.others;
      frame.other_count = 1;
      out.others[0] = own.handle();
  }
}

void draw_frame(Case& c, const Buffers& buffers, const Body& own, const Body& other, DrawnFrame& out) {
  ResponseFrame& frame = out.frame;
  bool is_sound = true;
  const auto draw = [&](Transform* transforms, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) is_sound = draw_transform(c, transforms[i]) && is_sound;
    return transforms;
  };
  frame.joints = draw(buffers.joints, buffers.joint_count);
  if (c.random.one_in(3)) {
    frame.ahead = draw(buffers.ahead, buffers.joint_count);
    frame.ahead_frames = c.random.below(4);
  }
  if (c.random.one_in(2)) frame.place = draw(buffers.place, 1);
  const float shares[] = {0, 1, 1.0F / 60, 1.0F / 60, 1e-38F};
  frame.seconds = c.random.pick(shares);
  frame.weakness = c.random.one_in(3) ? c.random.pick(shares) : 0;
  frame.rounds = c.random.below(4);
  out.others[0] = out.others[1] = other.handle();
  frame.others = out.others;
  frame.other_count = c.random.one_in(2) ? c.random.below(3) : 0;
  if (c.random.one_in(3)) frame.ground = &buffers.ground;
  if (buffers.joint_count > 0 && c.random.one_in(3)) {
    frame.planted = out.planted;
    frame.planted_count = c.random.below(5);
    for (std::uint32_t& joint : out.planted) {
      joint = static_cast<std::uint32_t>(c.random.up_to(buffers.joint_count - 1));
    }
  }
  if (!is_sound) out.wanted = {SC_BAD_VALUE, SC_FIELD_TRANSFORM};
  if (c.random.one_in(6)) spoil_frame(c, own, out);
}

void check_status(Case& c, const Status& status, const DrawnFrame& drawn) {
  const sc_code codes[] = {SC_OK,           SC_NULL,     SC_BAD_VALUE, SC_TOO_SMALL,
                           SC_NOT_IN_ASSET, SC_NOT_OPEN, SC_ALIASED,   SC_MISALIGNED};
  c.expect(std::any_of(std::begin(codes), std::end(codes), [&](sc_code code) { return status == code; }) &&
               (status == SC_OK || status.field != SC_FIELD_NONE),
           "a response's status");
  c.expect(drawn.wanted == SC_OK || status == drawn.wanted, "the status of a wrong frame");
}

void check_joints(Case& c, const ResponseFrame& frame, const std::vector<Transform>& before, const Transform* after) {
  std::uint32_t changed = 0;
  for (std::size_t j = 0; j < before.size(); ++j) {
    changed += std::memcmp(&before[j], &after[j], sizeof before[j]) != 0 ? 1 : 0;
    c.expect(std::memcmp(&before[j].translation, &after[j].translation, sizeof(Vec3)) == 0 &&
                 std::memcmp(&before[j].scale, &after[j].scale, sizeof(Vec3)) == 0,
             "a response moves or scales a joint");
    c.expect(std::all_of(std::begin(after[j].rotation), std::end(after[j].rotation),
                         [](float entry) { return std::isfinite(entry); }),
             "a rotation that is not finite");
  }
  c.expect(changed <= frame.turned && frame.turned <= 16 && frame.at_budget <= 16, "the counts of turned joints");
}

void check_rows(Case& c, const ResponseFrame& frame) {
  const std::size_t parts = c.view().part_count();
  for (std::size_t i = 0; i < frame.row_count; ++i) {
    const ContactRow& row = frame.rows[i];
    c.expect(row.part < parts && (row.other < parts || row.other == SC_FLOOR), "a row of no part");
    c.expect(row.body <= frame.other_count + (frame.ground != nullptr ? 1 : 0), "a row of no body");
  }
}

// One frame, twice: another target must give the same bits.
void ask_frame(Case& c, Response& response, const Body& own, const Body& other, const Buffers& buffers) {
  DrawnFrame drawn;
  draw_frame(c, buffers, own, other, drawn);
  if (c.random.one_in(3)) spoil_state(c, *buffers.state);
  const ResponseState state = *buffers.state;
  const std::vector<Transform> joints(buffers.joints, buffers.joints + buffers.joint_count);
  ResponseState first_state;
  std::vector<Transform> first;
  Status first_status{};
  for (const bool is_again : {false, true}) {
    *buffers.state = state;
    std::copy(joints.begin(), joints.end(), buffers.joints);
    drawn.frame.target = draw_target(c);
    const Status status = response.respond(*buffers.state, drawn.frame);
    const auto is_as = [&](const ResponseState& of, const std::vector<Transform>& transforms) {
      return std::memcmp(&of, buffers.state, sizeof of) == 0 &&
             (transforms.empty() ||
              std::memcmp(transforms.data(), buffers.joints, transforms.size() * sizeof(Transform)) == 0);
    };
    if (!is_again) {
      check_status(c, status, drawn);
      first_status = status;
      first_state = *buffers.state;
      first.assign(buffers.joints, buffers.joints + buffers.joint_count);
    }
    c.expect(status == first_status && is_as(first_state, first), "another target responds otherwise");
    if (status == SC_OK) {
      check_joints(c, drawn.frame, joints, buffers.joints);
      check_rows(c, drawn.frame);
    } else {
      c.expect(is_as(state, joints), "a refused frame changes joints or state");
    }
  }
  (first_status == SC_OK ? c.tally.ran : c.tally.refused) += 1;
}

}  // namespace

void fuzz_response(Case& c) {
  if (!draw_asset(c) || sc_asset_get_info(&c.asset).triangle_count > kTrianglesMost ||
      skin_table_words(&c.asset) > kResponseWords) {
    return;
  }
  const Model model(c.asset_bytes.data, c.asset_bytes.size, nullptr, 0, SC_ROWS_3X4);
  BodyDef body_def;
  body_def.max_triangles = c.random.one_in(3) ? 1 + c.random.below(60) : 0;
  body_def.max_penetrations = c.random.below(8);
  Body own(model, body_def), other(model, body_def);
  Pose pose;
  if (c.random.one_in(2) || !draw_vertices(c, pose)) draw_bones(c, pose);
  if (!own || !other) {
    return;
  }
  const std::size_t bones = c.view().bone_count(), count = bones + c.random.below(4);
  auto* const parents = c.arena.add<std::uint32_t>(count);
  const bool are_parents = draw_parents(c, parents, count);
  auto* const mobility = c.arena.add<float>(count);
  auto* const budget = c.arena.add<float>(count);
  for (std::size_t j = 0; j < count; ++j) {
    mobility[j] = j < kTurning ? static_cast<float>(c.random.below(5)) / 4 : 0;
    budget[j] = c.random.one_in(3) ? static_cast<float>(c.random.below(9)) / 4 : 1;
  }
  ResponseDef def;
  def.parents = parents;
  def.joint_count = count;
  def.mobility = c.random.one_in(8) ? nullptr : mobility;
  def.budget = c.random.one_in(2) ? nullptr : budget;
  Status wanted = are_parents ? Status{} : Status{SC_BAD_VALUE, SC_FIELD_PARENTS};
  auto* const hinges = c.arena.add<Vec3>(count);
  for (std::size_t j = 0; j < count; ++j) {
    const float entries[] = {0, 1, -1e-20F, 1e30F};
    hinges[j] = {c.random.pick(entries), c.random.pick(entries), c.random.pick(entries)};
  }
  def.hinges = c.random.one_in(2) ? nullptr : hinges;
  if (count > 0 && c.random.one_in(16)) {
    const float none[] = {NAN, -1, 1.5F, INFINITY};
    mobility[c.random.up_to(count - 1)] = c.random.pick(none);
    if (are_parents && def.mobility != nullptr) wanted = {SC_BAD_VALUE, SC_FIELD_JOINTS};
  }
  if (bones > 0 && c.random.one_in(16)) {
    def.joint_count = c.random.up_to(bones - 1);
    wanted = {SC_TOO_SMALL, SC_FIELD_JOINTS};
  }
  Buffers buffers{count, c.arena.add<Transform>(count), c.arena.add<Transform>(count), c.arena.add<Transform>(1),
                  c.arena.add<ResponseState>(1)};
  *buffers.state = {};
  c.arena.seal();
  Response response(own, def);
  const Status made = response.status();
  c.expect(static_cast<bool>(response) == (made == SC_OK) && made == wanted, "the status of a response that is made");
  other.set_pose(pose);
  if (!response) {
    ++c.tally.refused;
  }
  for (int i = 0; response && i < 4; ++i) ask_frame(c, response, own, other, buffers);
  c.expect(c.arena.kept_but({bytes_of(buffers.joints, count), bytes_of(buffers.ahead, count),
                             bytes_of(buffers.place, 1), bytes_of(buffers.state, 1)}),
           "a response writes what it must not");
}

}  // namespace spherechain::test
