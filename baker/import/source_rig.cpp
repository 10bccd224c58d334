// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/source_rig.h"

#include <algorithm>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

Eigen::Index width_of(ChannelPath path) {
  if (path == ChannelPath::kRotation) return 4;
  return path == ChannelPath::kMorphWeight ? 1 : 3;
}

Eigen::Quaterniond to_quaternion(const Eigen::Vector4d& v) {
  const Eigen::Quaterniond q(v[3], v[0], v[1], v[2]);
  return q.norm() > 0 ? q.normalized() : Eigen::Quaterniond::Identity();
}

}  // namespace

Eigen::Vector4d sample(const Channel& channel, double seconds) {
  const Eigen::Index width = width_of(channel.path);
  const bool cubic = channel.interpolation == Interpolation::kCubicSpline;
  // `part` of a cubic key: 0 in-tangent, 1 value, 2 out-tangent.
  const auto value = [&](std::size_t key, std::size_t part) {
    const std::size_t entry = cubic ? 3 * key + part : key;
    Eigen::Vector4d out = Eigen::Vector4d::Zero();
    for (Eigen::Index i = 0; i < width; ++i) {
      out[i] = channel.values[entry * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
    }
    return out;
  };
  const auto finished = [&](const Eigen::Vector4d& v) {
    return channel.path == ChannelPath::kRotation ? to_quaternion(v).coeffs() : v;
  };
  const std::vector<double>& times = channel.times;
  // Files round times to floats: a step that is on a frame is not after it.
  const double rounding = channel.interpolation == Interpolation::kStep ? 1e-6 * (1 + seconds) : 0;
  const auto above = std::upper_bound(times.begin(), times.end(), seconds + rounding);
  if (above == times.begin()) return finished(value(0, 1));
  const auto low = static_cast<std::size_t>(above - times.begin()) - 1;
  if (above == times.end() || channel.interpolation == Interpolation::kStep) return finished(value(low, 1));
  const double span = times[low + 1] - times[low], u = (seconds - times[low]) / span;
  const Eigen::Vector4d a = value(low, 1), b = value(low + 1, 1);
  if (cubic) {
    const double u2 = u * u, u3 = u2 * u;
    return finished((2 * u3 - 3 * u2 + 1) * a + span * (u3 - 2 * u2 + u) * value(low, 2) + (3 * u2 - 2 * u3) * b +
                    span * (u3 - u2) * value(low + 1, 0));
  }
  if (channel.path == ChannelPath::kRotation) return to_quaternion(a).slerp(u, to_quaternion(b)).coeffs();
  return (1 - u) * a + u * b;
}

void decompose(Node& node) {
  const Eigen::Matrix3d linear = node.local.linear();
  node.translation = node.local.translation();
  node.scale = linear.colwise().norm();
  if (linear.determinant() < 0) node.scale = -node.scale;
  if ((node.scale.array() != 0).all()) {
    Eigen::Matrix3d turn = linear * node.scale.cwiseInverse().asDiagonal();
    // A unit matrix stays one: the quaternion of an unsheared matrix needs no orthogonalising.
    if (!turn.isUnitary(1e-6)) turn = turn_in(turn);
    node.rotation = Eigen::Quaterniond(turn).normalized();
  }
}

std::size_t typical_map(const std::vector<Affine>& maps, const std::vector<double>& weights) {
  constexpr double kMoves = 1e-6;  // a vertex: bones that move none count where all do not
  Eigen::Matrix3d median;
  for (Eigen::Index i = 0; i < 9; ++i) {
    std::vector<std::pair<double, double>> entries;
    for (std::size_t m = 0; m < maps.size(); ++m)
      entries.emplace_back(maps[m].linear()(i % 3, i / 3), weights[m] + kMoves);
    median(i % 3, i / 3) = weighted_quantile(std::move(entries), 0.5);
  }
  constexpr double kAlike = 1e-4;
  const double tolerance = kAlike * median.norm();
  std::size_t best = 0;
  for (std::size_t m = 1; m < maps.size(); ++m) {
    if ((maps[m].linear() - median).norm() < (maps[best].linear() - median).norm() - tolerance) best = m;
  }
  return best;
}

std::vector<Affine> world_of(const std::vector<Node>& nodes) {
  std::vector<Affine> world;
  for (const Node& node : nodes) {
    world.push_back(node.parent < 0 ? node.local : world[static_cast<std::size_t>(node.parent)] * node.local);
  }
  return world;
}

}  // namespace spherechain::baker
