// SPDX-License-Identifier: MIT
// A frame of the response: turn the joints as the last frame's rows ask, look for contacts there, and turn them
// further.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/response/response.h"
#include "runtime/src/response/rows.h"
#include "runtime/src/response/solve.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_response_frame, row_count);

namespace {

constexpr double kRelease = 0.03;       // seconds, in which a turn that nothing asks for shrinks to 1 / e
constexpr double kFastest = 8;          // radians a second
constexpr double kLongest = 1;          // seconds: a longer frame counts as that
constexpr double kNothing = 1e-4;       // a smaller turn ends
constexpr double kLacks = 0.0006;       // a share of the height: what rows may lack without another round
constexpr double kPlantedOff = 0.0011;  // a share of the height: what planted joints may be off
constexpr int kPlantSteps = 4;          // towards where they are animated
constexpr int kHalvings = 6;            // of the turns where the steps do not lead there; the last makes them zero
constexpr std::uint32_t kRounds = 3, kFirstRounds = 2;

using Turns = Double3[kTurningMost];
using StoredTurns = float[kTurningMost][3];

void store(const Turns& from, std::size_t count, StoredTurns& to) {
  for (std::size_t t = 0; t < count; ++t) {
    store(from[t], to[t]);
  }
}

// A caller may put any bits into a state's words: where a turn is not finite, nothing is remembered.
State load_state(const std::uint64_t* words) {
  State out;
  std::memcpy(&out, words, sizeof out);
  const auto are_finite = [](const StoredTurns& turns) {
    return std::all_of(std::begin(turns), std::end(turns), is_finite);
  };
  const bool is_sound = are_finite(out.turns) && std::all_of(std::begin(out.past), std::end(out.past), are_finite);
  return is_sound ? out : State{};
}

bool is_zero(const Double3& v) { return dot(v, v) == 0; }

bool are_turned(const sc_response& response, const Turns& turns) {
  return std::any_of(turns, turns + response.turning_count, [](const Double3& turn) { return !is_zero(turn); });
}

Quaternion turned(const sc_transform& joint, const Double3& turn) {
  return product(turn_of(turn), quaternion_of(joint));
}

void set_rotation(sc_transform& joint, const Quaternion& q) {
  const double entries[] = {q.x, q.y, q.z, q.w};
  std::transform(std::begin(entries), std::end(entries), joint.rotation,
                 [](double entry) { return static_cast<float>(entry); });
}

Skeleton skeleton_of(const sc_response& response) {
  return {{response.parents.data, response.parents.size}, {response.order.data, response.order.size}};
}

// Places the joints with these turns.
void place(sc_response& response, const sc_transform* joints, const Turns& turns) {
  std::copy_n(joints, response.joints.size, response.joints.data);
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    if (!is_zero(turns[t])) {
      sc_transform& joint = response.joints[response.turning[t].joint];
      set_rotation(joint, turned(joint, turns[t]));
    }
  }
  place_joints(skeleton_of(response), response.joints.data, response.place, response.world);
}

// Moves the body to these joints with these turns.
Status pose(sc_response& response, const sc_response_frame& frame, const sc_transform* joints, const Turns& turns) {
  place(response, joints, turns);
  const sc_model& model = *response.body->model;
  const std::size_t bones = response.bones.size / 12;
  for (std::size_t b = 0; b < bones; ++b) {
    const std::uint32_t joint = model.joint_of_bone == nullptr ? static_cast<std::uint32_t>(b) : model.joint_of_bone[b];
    const Affine bone = joint == SC_NO_JOINT ? response.place
                                             : product(response.world[joint],
                                                       affine_of_rows(sc_asset_bone(&model.asset, b).inverse_bind));
    for (std::size_t i = 0; i < 12; ++i) {
      response.bones[12 * b + i] = static_cast<float>(bone.m[i / 4][i % 4]);
    }
  }
  sc_pose out{};
  out.bones = response.bones.data;
  out.bone_count = bones;
  out.bone_layout = SC_ROWS_3X4;
  out.morph_weights = frame.morph_weights;
  out.morph_weight_count = frame.morph_weight_count;
  const Status status = take_pose(*response.body, out, nullptr, true);
  const AssetView& asset = asset_of(*response.body);
  response.height = double{asset.info().height} * scale_of(asset, response.body->now.pose);
  return status;
}

// Brings planted joints back to where they are animated; where their joints cannot, all turn less.
std::uint32_t hold_planted(sc_response& response, const sc_transform* joints, Turns& turns) {
  std::uint32_t at_budget = limit_turns(response, turns);
  for (int halving = 0; response.planted_count > 0; ++halving) {
    for (int step = 0; step < kPlantSteps; ++step) {
      place(response, joints, turns);
      solve_planted(response, turns);
      at_budget = limit_turns(response, turns);
    }
    place(response, joints, turns);
    if (off_planted(response) <= kPlantedOff || halving == kHalvings) {
      break;
    }
    std::for_each(turns, turns + response.turning_count,
                  [&](Double3& turn) { turn = (halving + 1 < kHalvings ? 0.5 : 0.0) * turn; });
  }
  return at_budget;
}

// The turns that keep what can be known apart at these joints, from the rows of the frames before on.
Status find_turns(sc_response& response, const sc_response_frame& frame, const sc_transform* joints, const State& state,
                  Turns& turns, std::uint32_t& at_budget) {
  const std::size_t count = response.turning_count;
  place_joints(skeleton_of(response), joints, response.place, response.animated);
  const double seconds = std::min(double{frame.seconds}, kLongest), passed = seconds / kRelease,
               kept = 1 / (1 + passed + passed * passed / 2);
  Turns rest, last;
  for (std::size_t t = 0; t < count; ++t) {
    last[t] = turns[t] = load(state.turns[t]);
    rest[t] = kept * last[t];
  }
  const auto next = [&] {
    set_wanted(response, frame);
    solve_rows(response, rest, turns);
    for (std::size_t t = 0; t < count; ++t) {
      const Double3 step = turns[t] - last[t];
      const double size = length(step), most = state.has_begun != 0 ? kFastest * seconds : kFastest;
      turns[t] = size > most ? last[t] + (most / size) * step : turns[t];
      turns[t] = (1 - double{frame.weakness}) * turns[t];
    }
    at_budget = hold_planted(response, joints, turns);
  };
  Status status = pose(response, frame, joints, turns);
  if (status != SC_OK) {
    return status;
  }
  carry_rows(response, state, frame, seconds);
  next();
  const std::uint32_t rounds = (frame.rounds == 0 ? kRounds : frame.rounds) * (state.has_begun != 0 ? 1 : kFirstRounds);
  forget_gaps(response);
  for (std::uint32_t round = 0; round < rounds; ++round) {
    status = pose(response, frame, joints, turns);
    status = status == SC_OK ? find_rows(response, frame, round == 0 ? seconds : 0) : status;
    if (status != SC_OK) {
      return status;
    }
    set_wanted(response, frame);
    // Gaps matter where a correction could close them, or where rows are all that is asked for.
    if (round == 0 && (are_turned(response, turns) || most_lacking(response) > 0 || frame.weakness == 1)) {
      status = find_gaps(response, frame);
      if (status != SC_OK) {
        return status;
      }
      set_wanted(response, frame);
    }
    if (round + 1 == rounds || !(most_lacking(response) > kLacks * response.height)) {
      break;
    }
    next();
  }
  return done();
}

// Gives up what makes it worse, at first by half: faults are not to be deeper in sum than they are animated.
Status take_back(sc_response& response, const sc_response_frame& frame, Turns& turns) {
  const std::size_t count = response.turning_count;
  const double after = response.fault_depth;
  if (!are_turned(response, turns) || !(after > 0)) {
    return done();
  }
  State rows;
  keep_rows(response, rows);
  const auto look_at = [&](const Turns& of) {
    const Status status = pose(response, frame, frame.joints, of);
    return status == SC_OK ? find_rows(response, frame, 0) : status;
  };
  Turns tried{};
  bool is_better = true;
  response.row_count = 0;  // faults are then measured along their shortest ways
  Status status = look_at(tried);
  const double before = response.fault_depth;
  if (status == SC_OK && before < after) {  // along the ways that rows keep, faults are deeper than by the shortest
    response.row_count = 0;
    status = look_at(turns);
    is_better = response.fault_depth <= before;
  }
  if (status != SC_OK || is_better) {
    status = status == SC_OK ? pose(response, frame, frame.joints, turns) : status;
    carry_rows(response, rows, frame, 0);
    response.fault_depth = after;
    return status;
  }
  for (std::size_t t = 0; t < count; ++t) {
    tried[t] = 0.5 * turns[t];
  }
  hold_planted(response, frame.joints, tried);
  status = look_at(tried);
  if (status == SC_OK && response.fault_depth > before) {
    std::fill_n(tried, count, Double3{0, 0, 0});
    status = look_at(tried);
  }
  std::copy_n(tried, count, turns);
  return status;
}

// The mean of the turns around this frame, those of the frames that are ahead among them.
void smooth(const sc_response& response, State& state, std::uint32_t ahead, const Turns& found, Turns& out) {
  const std::size_t count = response.turning_count;
  double weights = 0;
  std::fill_n(out, count, Double3{0, 0, 0});
  const std::uint32_t known = std::min(state.past_count, 2 * ahead);
  for (std::uint32_t back = 0; back <= known; ++back) {
    const double window = ahead, u = (window - back) / (window + 1), weight = (1 - u * u) * (1 - u * u);
    weights += weight;
    for (std::size_t t = 0; t < count; ++t) {
      out[t] = out[t] + weight * (back == 0 ? found[t] : load(state.past[back - 1][t]));
    }
  }
  for (std::size_t t = 0; t < count; ++t) {
    out[t] = (1 / weights) * out[t];
  }
  std::memmove(state.past[1], state.past[0], sizeof state.past - sizeof state.past[0]);
  store(found, count, state.past[0]);
  state.past_count = std::min(state.past_count + 1, static_cast<std::uint32_t>(2 * kAheadMost));
}

void list_rows(sc_response& response, sc_response_frame& frame) {
  for (std::size_t i = 0; i < response.row_count; ++i) {
    const Row& row = response.rows[i];
    response.listed[i] = {row.kept.part,
                          row.kept.body > frame.other_count ? SC_FLOOR : std::uint32_t{row.kept.other},
                          row.kept.body,
                          to_float(row.at),
                          to_float(row.at_other),
                          to_float(row.normal),
                          static_cast<float>(row.gap),
                          row.kept.allowed};
  }
  frame.rows = response.listed;
  frame.row_count = response.row_count;
}

Status check(const sc_response& response, const sc_response_frame& frame) {
  if (frame.joints == nullptr || (frame.ahead_frames > 0 && frame.ahead == nullptr) ||
      (frame.other_count > 0 && frame.others == nullptr)) {
    return refuse(SC_NULL, frame.joints == nullptr ? SC_FIELD_JOINTS : SC_FIELD_BODIES);
  }
  if (frame.planted_count > 0 && frame.planted == nullptr) {
    return refuse(SC_NULL, SC_FIELD_JOINTS);
  }
  if (frame.planted_count > kPlantedMost ||
      std::any_of(frame.planted, frame.planted + frame.planted_count,
                  [&](std::uint32_t joint) { return joint >= response.joints.size; })) {
    return refuse(SC_BAD_VALUE, SC_FIELD_JOINTS);
  }
  const auto is_share = [](float value) { return value >= 0 && value <= 1; };
  if (!(frame.seconds >= 0) || !std::isfinite(frame.seconds) || !is_share(frame.weakness) || frame.rounds > 16 ||
      frame.other_count > kOthersMost || frame.ahead_frames > kAheadMost) {
    return refuse(SC_BAD_VALUE, SC_FIELD_QUERY);
  }
  if (std::any_of(frame.others, frame.others + frame.other_count,
                  [](const sc_body* body) { return body == nullptr; })) {
    return refuse(SC_NULL, SC_FIELD_BODIES);
  }
  const auto are_sound = [&](const sc_transform* joints) {
    return joints == nullptr || std::all_of(joints, joints + response.joints.size, is_sound);
  };
  return !are_sound(frame.joints) || !are_sound(frame.ahead) || (frame.place != nullptr && !is_sound(*frame.place))
             ? refuse(SC_BAD_VALUE, SC_FIELD_TRANSFORM)
             : done();
}

// A checked frame.
Status respond(sc_response& own, std::uint64_t* state, sc_response_frame& frame) {
  frame.turned = frame.at_budget = 0;
  frame.remaining = 0;
  frame.rows = own.listed;
  frame.row_count = 0;
  State memory = load_state(state);
  own.place = frame.place == nullptr ? kUnmoved : affine_of(*frame.place);
  own.planted_count = static_cast<std::uint32_t>(frame.planted_count);
  std::copy_n(frame.planted, frame.planted_count, own.planted);
  const std::size_t count = own.turning_count;
  if (count == 0) {
    return done();
  }
  const bool is_ahead = frame.ahead_frames > 0;
  Turns turns, output;
  Status status = find_turns(own, frame, is_ahead ? frame.ahead : frame.joints, memory, turns, frame.at_budget);
  if (status == SC_OK && !is_ahead) {
    status = take_back(own, frame, turns);
  }
  if (status != SC_OK) {
    return status;
  }
  const bool is_clear =
      std::all_of(own.rows, own.rows + own.row_count, [](const Row& row) { return row.kept.is_clear != 0; });
  for (std::size_t t = 0; t < count; ++t) {
    turns[t] = is_clear && length(turns[t]) < kNothing ? Double3{0, 0, 0} : turns[t];
  }
  keep_rows(own, memory);
  frame.remaining = static_cast<float>(own.fault_depth);
  std::copy_n(turns, count, output);
  if (is_ahead) {
    smooth(own, memory, frame.ahead_frames, turns, output);
    place_joints(skeleton_of(own), frame.joints, own.place, own.animated);
    hold_planted(own, frame.joints, output);
    status = pose(own, frame, frame.joints, output);
    if (status != SC_OK) {
      return status;
    }
  }
  list_rows(own, frame);
  for (std::size_t t = 0; t < count; ++t) {
    if (!is_zero(output[t])) {
      sc_transform& joint = frame.joints[own.turning[t].joint];
      set_rotation(joint, turned(joint, output[t]));
      ++frame.turned;
    }
  }
  memory.has_begun = 1;
  store(turns, count, memory.turns);
  std::memcpy(state, &memory, sizeof memory);
  return done();
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" sc_status sc_respond(sc_response* response, uint64_t* state, sc_response_frame* given) noexcept {
  if (response == nullptr || state == nullptr || given == nullptr) {
    return refuse(SC_NULL, response == nullptr ? SC_FIELD_BODIES : SC_FIELD_OUTPUT);
  }
  sc_response_frame frame{};
  Status status = read_struct(given, frame);
  status = status == SC_OK ? check(*response, frame) : status;
  if (status != SC_OK) {
    return status;
  }
  status = respond(*response, state, frame);
  given->turned = frame.turned;
  given->at_budget = frame.at_budget;
  given->remaining = frame.remaining;
  given->rows = frame.rows;
  given->row_count = frame.row_count;
  return status;
}
