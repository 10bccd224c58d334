// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse normal equations. Their band is two frames wide, because terms couple only neighbours in time and the joints
// of one constraint.
#include "baker/fix/solve.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace spherechain::baker {
namespace {

constexpr double kSteadyTime = 0.1;  // seconds: faster changes are expensive
constexpr int kTrials = 10;          // to find out which constraints are above their target

using Matrix = Eigen::SparseMatrix<double>;

class System {
 public:
  System(const TurnedClip& clip, const std::vector<char>& in_window) : clip_(clip), slot_(in_window.size(), -1) {
    for (std::size_t f = 0; f < in_window.size(); ++f) {
      if (in_window[f] != 0) slot_[f] = static_cast<int>(slots_++);
    }
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(slots_ * clip_.count() * 3); }
  // The first unknown of a frame's joint. Negative: the joint keeps zero.
  Eigen::Index place(int frame, Index joint) const {
    if (frame < 0 || frame >= static_cast<int>(slot_.size()) || slot_[static_cast<std::size_t>(frame)] < 0) return -1;
    return static_cast<Eigen::Index>(
        (static_cast<std::size_t>(slot_[static_cast<std::size_t>(frame)]) * clip_.count() + joint) * 3);
  }

  Matrix costs() const {
    std::vector<Eigen::Triplet<double>> entries;
    const double steady = std::pow(kSteadyTime * clip_.fps(), 4);
    const auto frames = static_cast<int>(slot_.size());
    for (Index j = 0; j < clip_.count(); ++j) {
      const Eigen::Matrix3d& cost = clip_.joints()[j].cost;
      for (int f = 0; f < frames; ++f) {
        add(entries, place(f, j), place(f, j), cost);
        // The second difference of three frames. The clip's ends have none.
        if (f == 0 || f + 1 == frames) continue;
        constexpr double kBend[3] = {1, -2, 1};
        for (int a = -1; a <= 1; ++a) {
          for (int b = -1; b <= 1; ++b) {
            add(entries, place(f + a, j), place(f + b, j), steady * kBend[a + 1] * kBend[b + 1] * cost);
          }
        }
      }
    }
    Matrix out(size(), size());
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
  }

 private:
  static void add(std::vector<Eigen::Triplet<double>>& entries, Eigen::Index row, Eigen::Index column,
                  const Eigen::Matrix3d& block) {
    if (row < 0 || column < 0) return;
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index k = 0; k < 3; ++k) entries.emplace_back(row + i, column + k, block(i, k));
    }
  }

  const TurnedClip& clip_;
  std::vector<int> slot_;
  std::size_t slots_ = 0;
};

double sum_of(const Constraint& constraint, const System& system, const Eigen::VectorXd& x) {
  double sum = 0;
  for (const Constraint::Term& term : constraint.terms) {
    if (const Eigen::Index at = system.place(term.frame, term.joint); at >= 0) sum += term.by.dot(x.segment<3>(at));
  }
  return sum;
}

}  // namespace

Turns solve_turns(const TurnedClip& clip, const std::vector<char>& in_window,
                  const std::vector<Constraint>& constraints, const Turns& start, double leave) {
  const System system(clip, in_window);
  const std::size_t count = clip.count();
  Turns out(in_window.size() * count, Vec3::Zero());
  if (system.size() == 0) return out;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.size());
  for (std::size_t f = 0; f < in_window.size(); ++f) {
    for (Index j = 0; j < count; ++j) {
      if (const Eigen::Index at = system.place(static_cast<int>(f), j); at >= 0)
        x.segment<3>(at) = start[f * count + j];
    }
  }
  Matrix costs = system.costs();
  Eigen::VectorXd dear = Eigen::VectorXd::Zero(system.size());  // turns that no separation names may return to zero
  for (const Constraint& constraint : constraints) {
    if (constraint.weight == constraint.weight_above) continue;  // an equality does not depend on `start`
    for (const Constraint::Term& term : constraint.terms) {
      if (const Eigen::Index at = system.place(term.frame, term.joint); at >= 0) dear.segment<3>(at).setConstant(leave);
    }
  }
  for (Eigen::Index i = 0; i < system.size(); ++i) costs.coeffRef(i, i) += dear[i];
  const Eigen::VectorXd begin = dear.cwiseProduct(x);
  Eigen::SimplicialLLT<Matrix> cholesky;
  std::vector<char> is_above(constraints.size());
  for (std::size_t i = 0; i < constraints.size(); ++i)
    is_above[i] = sum_of(constraints[i], system, x) > constraints[i].target ? 1 : 0;
  for (int round = 0; round < kTrials; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = begin;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const Constraint& constraint = constraints[i];
      const double weight = is_above[i] != 0 ? constraint.weight_above : constraint.weight;
      if (weight == 0) continue;
      for (const Constraint::Term& a : constraint.terms) {
        const Eigen::Index row = system.place(a.frame, a.joint);
        if (row < 0) continue;
        right.segment<3>(row) += weight * constraint.target * a.by;
        for (const Constraint::Term& b : constraint.terms) {
          const Eigen::Index column = system.place(b.frame, b.joint);
          if (column < 0) continue;
          const Eigen::Matrix3d block = weight * a.by * b.by.transpose();
          for (Eigen::Index r = 0; r < 3; ++r) {
            for (Eigen::Index c = 0; c < 3; ++c) entries.emplace_back(row + r, column + c, block(r, c));
          }
        }
      }
    }
    Matrix matrix(system.size(), system.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    matrix += costs;
    cholesky.compute(matrix);
    x = cholesky.solve(right);
    bool changed = false;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const char over = sum_of(constraints[i], system, x) > constraints[i].target ? 1 : 0;
      changed |= over != is_above[i];
      is_above[i] = over;
    }
    if (!changed) break;
  }
  // A joint whose scale is 0 moves nothing, and makes no system that can be solved.
  if (!x.allFinite()) return start;
  for (std::size_t f = 0; f < in_window.size(); ++f) {
    for (Index j = 0; j < count; ++j) {
      if (const Eigen::Index at = system.place(static_cast<int>(f), j); at >= 0) out[f * count + j] = x.segment<3>(at);
    }
  }
  return out;
}

}  // namespace spherechain::baker
