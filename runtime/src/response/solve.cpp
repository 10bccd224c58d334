// SPDX-License-Identifier: MIT
#include "runtime/src/response/solve.h"

#include <algorithm>
#include <cmath>

namespace spherechain {
namespace {

constexpr std::size_t kSweeps = 40;
constexpr double kRoundMost = 0.4;   // radians that a joint turns in a round
constexpr double kOffHinge = 0.25;   // of an elbow's mobility, about other axes than its own
constexpr double kDirectionOff = 7;  // so many radians that a planted joint is turned count as a height
constexpr double kStraight = 0.1;    // the sine of a bend below which an elbow's axis is taken from the rest pose
constexpr double kKeepsWrist = 100;  // how dear it is to move the wrist by a metre of a human, against a radian

// The axes that a joint's turns are in: its parent's. Turns go the other way in mirrored ones.
Affine turning_axes(const sc_response& response, const Affine* world, std::size_t turning) {
  const std::uint32_t parent = response.parents[response.turning[turning].joint];
  Affine out = axes_of(parent == SC_NO_JOINT ? response.place : world[parent]);
  const Double3 x{out.m[0][0], out.m[1][0], out.m[2][0]}, y{out.m[0][1], out.m[1][1], out.m[2][1]},
      z{out.m[0][2], out.m[1][2], out.m[2][2]};
  const double sign = dot(cross(x, y), z) < 0 ? -1 : 1;
  for (auto& row : out.m) {
    for (double& entry : row) {
      entry *= sign;
    }
  }
  return out;
}

// How an elbow bends as animated, in its parent's axes.
struct Bend {
  Double3 axis{0, 0, 0};      // about which it bends further; zero: not known
  double tangent = HUGE_VAL;  // of half of its angle; HUGE_VAL: it may bend backward
};

Bend bend_of(const sc_response& response, std::size_t turning) {
  const TurningJoint& joint = response.turning[turning];
  Bend out;
  if (joint.is_given) {
    out.axis = joint.hinge;
  }
  if (joint.above == SC_NO_JOINT || joint.below == SC_NO_JOINT) {
    return out;
  }
  const Span<Affine>& at = response.animated;
  Double3 upper = place_of(at[joint.joint]) - place_of(at[joint.above]),
          lower = place_of(at[joint.below]) - place_of(at[joint.joint]);
  if (!normalize(upper) || !normalize(lower)) {
    return out;
  }
  const Double3 across = into(turning_axes(response, at.data, turning), cross(upper, lower));
  const double sine = length(across);
  out.tangent = sine / std::max(1 + dot(upper, lower), 1e-3);
  if (joint.is_given) {
    out.tangent = dot(across, joint.hinge) > 0 ? out.tangent : HUGE_VAL;
    return out;
  }
  out.axis = across + std::max(kStraight - sine, 0.0) * joint.hinge;
  if (sine < kStraight && dot(joint.hinge, joint.hinge) == 0) {
    return Bend{};
  }
  return normalize(out.axis) ? out : Bend{};
}

// The joints in the pose of this round.
struct Joints {
  Affine axes[kTurningMost];
  Double3 hinge[kTurningMost];
  // How the place of a joint's wrist follows its turn: a turn x moves it by `lever` x x, in the joint's axes.
  Double3 lever[kTurningMost];
};

Double3 eased(const TurningJoint& joint, const Double3& hinge, const Double3& x) {
  const bool is_hinge = dot(hinge, hinge) > 0;
  return joint.mobility * (is_hinge ? kOffHinge * x + (1 - kOffHinge) * dot(hinge, x) * hinge : x);
}

bool moves(const sc_response& response, std::size_t part, std::size_t turning) {
  return (response.turning_of_part[part] >> turning & 1) != 0;
}

// The joint at the end of the arm that a row is on, if the row is not on the hand itself.
std::uint32_t wrist_of(const sc_response& response, std::size_t part) {
  for (std::size_t t = response.turning_count; t-- > 0;) {
    const TurningJoint& joint = response.turning[t];
    if (moves(response, part, t) && (joint.wrist == SC_NO_JOINT || joint.joint == joint.wrist)) {
      return SC_NO_JOINT;
    }
  }
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    if (moves(response, part, t)) {
      return response.turning[t].wrist;
    }
  }
  return SC_NO_JOINT;
}

// Solves the symmetric system M x = b.
Double3 solve(const double (&m)[3][3], const Double3& b) {
  const Double3 x{m[0][0], m[1][0], m[2][0]}, y{m[0][1], m[1][1], m[2][1]}, z{m[0][2], m[1][2], m[2][2]};
  const double determinant = dot(x, cross(y, z));
  return !(std::abs(determinant) > 0)
             ? Double3{0, 0, 0}
             : (1 / determinant) * Double3{dot(b, cross(y, z)), dot(x, cross(b, z)), dot(x, cross(y, b))};
}

// How each joint follows a pull on a row: the cheaper the turn, the further, and so that the wrist moves little.
void find_pull(const sc_response& response, const Joints& joints, Row& row) {
  const std::size_t count = response.turning_count;
  for (std::size_t t = 0; t < count; ++t) {
    row.turns[t] = eased(response.turning[t], joints.hinge[t], row.opens[t]);
  }
  const std::uint32_t wrist = wrist_of(response, row.kept.part);
  if (wrist == SC_NO_JOINT) {
    return;
  }
  const double metre = response.height / 1.75;
  double m[3][3] = {};
  Double3 moved{0, 0, 0};
  for (std::size_t t = 0; t < count; ++t) {
    const TurningJoint& joint = response.turning[t];
    if (joint.wrist != wrist || joint.joint == wrist) {
      continue;
    }
    const Double3 lever = (1 / metre) * joints.lever[t];
    moved = moved + turn(joints.axes[t], cross(row.turns[t], lever));
    for (std::size_t k = 0; k < 3; ++k) {
      const Double3 world{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
      const Double3 by = eased(joint, joints.hinge[t], cross(lever, into(joints.axes[t], world)));
      const Double3 then = turn(joints.axes[t], cross(by, lever));
      m[0][k] += then.x;
      m[1][k] += then.y;
      m[2][k] += then.z;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    m[k][k] += 1 / kKeepsWrist;
  }
  const Double3 back = solve(m, moved);
  for (std::size_t t = 0; t < count; ++t) {
    const TurningJoint& joint = response.turning[t];
    if (joint.wrist == wrist && joint.joint != wrist) {
      const Double3 lever = (1 / metre) * joints.lever[t];
      row.turns[t] = row.turns[t] - eased(joint, joints.hinge[t], cross(lever, into(joints.axes[t], back)));
    }
  }
}

// How a turn of each joint, in its axes, opens a row.
void find_opening(const sc_response& response, const Joints& joints, Row& row) {
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    const Double3 from = place_of(response.world[response.turning[t].joint]);
    Double3 opens{0, 0, 0};
    if (moves(response, row.kept.part, t)) {
      opens = opens + cross(row.at - from, row.normal);
    }
    if (row.kept.body == 0 && moves(response, row.kept.other, t)) {
      opens = opens - cross(row.at_other - from, row.normal);
    }
    row.opens[t] = into(joints.axes[t], opens);
  }
}

// A joint that stays where it is animated: the world's axes, and where it turns itself about them, too.
struct Pin {
  Double3 opens[6][kTurningMost], turns[6][kTurningMost];
  double wanted[6];
  std::size_t count;
};

// Rows that joints open less than so much, squared, cannot be pulled on.
double least_pull(const sc_response& response) { return 1e-9 * response.height * response.height; }

bool hangs_on(const sc_response& response, std::uint32_t joint, std::uint32_t above) {
  while (joint != SC_NO_JOINT && joint != above) {
    joint = response.parents[joint];
  }
  return joint == above;
}

// Half the turn between two sets of axes, for small turns the whole.
Double3 turn_between(const Affine& from, const Affine& to) {
  Double3 sum{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    sum = sum + cross({from.m[0][k], from.m[1][k], from.m[2][k]}, {to.m[0][k], to.m[1][k], to.m[2][k]});
  }
  return 0.5 * sum;
}

void set_pin(const sc_response& response, const Joints& joints, std::uint32_t planted, Pin& pin) {
  const Affine &now = response.world[planted], &animated = response.animated[planted];
  const Double3 off = place_of(animated) - place_of(now), turned = turn_between(axes_of(now), axes_of(animated));
  const double wanted[] = {off.x, off.y, off.z, turned.x, turned.y, turned.z};
  std::copy_n(wanted, 6, pin.wanted);
  pin.count = 3;
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    const TurningJoint& joint = response.turning[t];
    const bool is_above = hangs_on(response, planted, joint.joint);
    pin.count = joint.joint == planted ? 6 : pin.count;
    const Double3 lever = place_of(now) - place_of(response.world[joint.joint]);
    for (std::size_t k = 0; k < 6; ++k) {
      const Double3 axis{k % 3 == 0 ? 1.0 : 0.0, k % 3 == 1 ? 1.0 : 0.0, k % 3 == 2 ? 1.0 : 0.0};
      const Double3 moves = !is_above ? Double3{0, 0, 0} : k < 3 ? cross(lever, axis) : axis;
      pin.opens[k][t] = into(joints.axes[t], moves);
      pin.turns[k][t] = joint.joint == planted ? pin.opens[k][t] : eased(joint, joints.hinge[t], pin.opens[k][t]);
    }
  }
}

// Pulls on one row of joints until they open it as wanted. Gives how hard.
double pull_on(std::size_t count, const Double3* opens, const Double3* turns, double wanted, double least_by,
               double at_least, Double3* change) {
  double opened = 0, by_pull = 0;
  for (std::size_t t = 0; t < count; ++t) {
    opened += dot(opens[t], change[t]);
    by_pull += dot(opens[t], turns[t]);
  }
  if (!(by_pull > least_by)) {
    return 0;
  }
  const double more = std::max(at_least, (wanted - opened) / by_pull);
  for (std::size_t t = 0; t < count; ++t) {
    change[t] = change[t] + more * turns[t];
  }
  return more;
}

Double3 shortened(const Double3& of, double most) {
  const double size = length(of);
  return size > most ? (most / size) * of : of;
}

// Gathers the joints in the pose of response.world.
Joints joints_of(const sc_response& response) {
  Joints out;
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    const TurningJoint& joint = response.turning[t];
    out.axes[t] = turning_axes(response, response.world.data, t);
    out.hinge[t] = bend_of(response, t).axis;
    out.lever[t] =
        joint.wrist == SC_NO_JOINT
            ? Double3{0, 0, 0}
            : into(out.axes[t], place_of(response.world[joint.wrist]) - place_of(response.world[joint.joint]));
  }
  return out;
}

struct Pins {
  Pin list[kPlantedMost];
  std::size_t count;

  Pins(const sc_response& response, const Joints& joints) : count(response.planted_count) {
    for (std::size_t p = 0; p < count; ++p) {
      set_pin(response, joints, response.planted[p], list[p]);
    }
  }
  void pull(const sc_response& response, Double3* change) const {
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t k = 0; k < list[p].count; ++k) {
        pull_on(response.turning_count, list[p].opens[k], list[p].turns[k], list[p].wanted[k],
                k < 3 ? least_pull(response) : 1e-9, -HUGE_VAL, change);
      }
    }
  }
};

void add_change(const sc_response& response, const Double3* change, Double3* turns) {
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    if (std::isfinite(dot(change[t], change[t]))) {  // in some poses squares are not
      turns[t] = vector_of(product(turn_of(shortened(change[t], kRoundMost)), turn_of(turns[t])));
    }
  }
}

}  // namespace

void solve_rows(sc_response& response, const Double3* rest, Double3* turns) {
  const std::size_t count = response.turning_count;
  const Joints joints = joints_of(response);
  const Pins pins(response, joints);
  Double3 change[kTurningMost];
  for (std::size_t t = 0; t < count; ++t) {
    change[t] = rest[t] - turns[t];
  }
  for (std::size_t i = 0; i < response.row_count; ++i) {
    Row& row = response.rows[i];
    row.pull = 0;
    find_opening(response, joints, row);
    find_pull(response, joints, row);
  }
  for (std::size_t sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < response.row_count; ++i) {
      Row& row = response.rows[i];
      row.pull += pull_on(count, row.opens, row.turns, row.wanted - row.gap, least_pull(response), -row.pull, change);
    }
    pins.pull(response, change);
  }
  add_change(response, change, turns);
}

void solve_planted(const sc_response& response, Double3* turns) {
  const Joints joints = joints_of(response);
  const Pins pins(response, joints);
  Double3 change[kTurningMost] = {};
  for (std::size_t sweep = 0; sweep < kSweeps; ++sweep) {
    pins.pull(response, change);
  }
  add_change(response, change, turns);
}

double off_planted(const sc_response& response) {
  double most = 0;
  for (std::size_t p = 0; p < response.planted_count; ++p) {
    const std::uint32_t joint = response.planted[p];
    const Affine &now = response.world[joint], &animated = response.animated[joint];
    most = std::max(most, length(place_of(animated) - place_of(now)) / response.height);
    const bool turns = std::any_of(response.turning, response.turning + response.turning_count,
                                   [&](const TurningJoint& t) { return t.joint == joint; });
    most = turns ? std::max(most, length(turn_between(axes_of(now), axes_of(animated))) / kDirectionOff) : most;
  }
  return most;
}

std::uint32_t limit_turns(const sc_response& response, Double3* turns) {
  std::uint32_t limited = 0;
  for (std::size_t t = 0; t < response.turning_count; ++t) {
    const double budget = response.turning[t].budget;
    limited += length(turns[t]) > budget ? 1 : 0;
    turns[t] = shortened(turns[t], budget);
    const Bend bend = bend_of(response, t);
    const double back = -dot(turns[t], bend.axis) - 2 * bend.tangent;
    if (back > 0) {
      turns[t] = turns[t] + back * bend.axis;
    }
  }
  return limited;
}

}  // namespace spherechain
