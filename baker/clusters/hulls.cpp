// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <map>
#include <memory>

#include "clusters/clusters.h"
#include "clusters/round_up.h"

namespace spherechain::baker {
namespace {

constexpr Eigen::Index kPointsMax = 96, kLanes = 16;  // points of a hull at most; its points come in lanes
constexpr double kNear = 0.03;              // of the spheres' mean radius: as near to the hull as this is near enough
constexpr Eigen::Index kCandidates = 2048;  // vertices of a sphere that may be points of its hull
constexpr double kEnough = 1e-9;  // of the squared radius: a step that shortens a squared distance by less is the last
constexpr int kStepsAPoint = 12, kLastSteps = 200, kOnlySteps = 120;
constexpr double kRounding = 1e-13;  // more than double precision takes from shares and sums, of lengths of 1

// A sphere's vertices as the asset has them: their places, seen from the hull's centre, and their weights.
struct Skin {
  std::vector<Index> vertices;
  std::vector<Index> bones;  // the one that moves most of them first
  Vec3 center;
  double radius = 0;
  std::vector<Vec3> places;
  std::vector<std::vector<double>> weights;
};

std::vector<Index> moving_bones(const std::vector<SurfaceVertex>& all, const std::vector<Index>& vertices) {
  std::map<Index, double> shares;
  for (const Index v : vertices) {
    for (const Influence& influence : all[v].influences) shares[influence.bone] += influence.weight;
  }
  std::vector<Index> out;
  for (const auto& [bone, share] : shares) out.push_back(bone);
  const auto most = std::ranges::max_element(out, {}, [&](Index bone) { return shares[bone]; });
  std::rotate(out.begin(), most, most + 1);
  return out;
}

Skin skin_of(const Character& character, const std::vector<SurfaceVertex>& all, std::vector<Index> vertices) {
  Skin out;
  if (vertices.empty()) return out;
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  out.bones = moving_bones(all, vertices);
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Index v : vertices) {
    const Vec3 place = character.source_positions[all[v].source].cast<float>().cast<double>();
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
    out.places.push_back(place);
    std::vector<double>& weights = out.weights.emplace_back(out.bones.size());
    for (const Influence& influence : all[v].influences) {
      const auto bone = std::ranges::find(out.bones, influence.bone) - out.bones.begin();
      weights[static_cast<std::size_t>(bone)] = influence.weight;
    }
  }
  out.center = ((low + high) / 2).cast<float>().cast<double>();
  for (Vec3& place : out.places) {
    place -= out.center;
    out.radius = std::max(out.radius, place.norm());
  }
  out.vertices = std::move(vertices);
  return out;
}

// Vertices as points of many dimensions: the place of a vertex, and its weighted place for each bone but the first one,
// which the others are relative to. A weight counts as much as the hull's radius: that is how far bones come apart.
Eigen::MatrixXd lift(const Skin& skin) {
  const auto bones = static_cast<Eigen::Index>(skin.bones.size());
  Eigen::MatrixXd out(4 * bones - 1, static_cast<Eigen::Index>(skin.vertices.size()));
  for (Eigen::Index v = 0; v < out.cols(); ++v) {
    const Vec3& place = skin.places[static_cast<std::size_t>(v)];
    out.col(v).head<3>() = place;
    for (Eigen::Index b = 1; b < bones; ++b) {
      const double weight = skin.weights[static_cast<std::size_t>(v)][static_cast<std::size_t>(b)];
      out.col(v).segment<3>(4 * b - 1) = weight * place;
      out(4 * b + 2, v) = weight * skin.radius;
    }
  }
  return out;
}

// For each point the shares of the chosen points whose mean is nearest to it. Steps that move a part of one share to
// another approach them.
class NearestMeans {
 public:
  explicit NearestMeans(const Eigen::MatrixXd& points)
      : points_(points),
        enough_(kEnough * points.colwise().squaredNorm().maxCoeff()),
        shares_(Eigen::MatrixXd::Zero(kPointsMax, points.cols())),
        slopes_(shares_) {}

  Eigen::Index count() const { return static_cast<Eigen::Index>(chosen_.size()); }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }
  double share(std::size_t point, std::size_t of) const {
    return shares_(static_cast<Eigen::Index>(of), static_cast<Eigen::Index>(point));
  }

  void choose(Eigen::Index point) {
    const auto last = static_cast<Eigen::Index>(chosen_.size());
    chosen_.push_back(point);
    const Eigen::VectorXd with_all = points_.transpose() * points_.col(point);
    for (Eigen::Index k = 0; k <= last; ++k) {
      products_(k, last) = products_(last, k) = with_all[chosen_[static_cast<std::size_t>(k)]];
    }
    if (last == 0) shares_.row(0).setOnes();
    slopes_.row(last) = products_.row(last).head(last + 1) * shares_.topRows(last + 1) - with_all.transpose();
  }

  double distance(Eigen::Index point) const {
    const auto m = static_cast<Eigen::Index>(chosen_.size());
    Eigen::VectorXd off = points_.col(point);
    for (Eigen::Index k = 0; k < m; ++k) {
      if (shares_(k, point) > 0) off -= shares_(k, point) * points_.col(chosen_[static_cast<std::size_t>(k)]);
    }
    return off.norm();
  }

  void improve(Eigen::Index point, int steps) {
    const auto m = static_cast<Eigen::Index>(chosen_.size());
    auto shares = shares_.col(point).head(m);
    auto slopes = slopes_.col(point).head(m);
    for (int step = 0; step < steps; ++step) {
      Eigen::Index to = 0, from = -1;
      for (Eigen::Index k = 0; k < m; ++k) {
        if (slopes[k] < slopes[to]) to = k;
        if (shares[k] > 0 && (from < 0 || slopes[k] > slopes[from])) from = k;
      }
      const double squared = products_(to, to) + products_(from, from) - 2 * products_(to, from);
      const double down = slopes[from] - slopes[to];
      if (!(down > 0) || !(squared > 0)) break;
      const double moved = std::min(down / squared, shares[from]);
      if (moved * down < enough_) break;
      shares[to] += moved;
      shares[from] -= moved;
      slopes += moved * (products_.col(to) - products_.col(from)).head(m);
    }
  }

 private:
  const Eigen::MatrixXd& points_;
  double enough_;
  std::vector<Eigen::Index> chosen_;
  Eigen::Matrix<double, kPointsMax, kPointsMax> products_;
  Eigen::MatrixXd shares_, slopes_;  // a point's column: of the chosen ones
};

// Chooses the point that is farthest from the hull of the points before, again and again. Of fine skin it looks at an
// even part: that the others are near is measured, not assumed.
void choose_points(const Eigen::MatrixXd& points, double near, NearestMeans& means) {
  Eigen::VectorXd distances(points.cols());
  Eigen::Index farthest = 0;
  points.colwise().squaredNorm().maxCoeff(&farthest);
  distances.setConstant(std::numeric_limits<double>::max());
  const Eigen::Index stride = (points.cols() + kCandidates - 1) / kCandidates;
  do {
    means.choose(farthest);
    farthest = 0;
    for (Eigen::Index v = 0; v < points.cols(); v += stride) {
      if (distances[v] > near) {
        means.improve(v, kStepsAPoint);
        distances[v] = means.distance(v);
      }
      if (distances[v] > distances[farthest]) farthest = v;
    }
  } while (means.count() < std::min(kPointsMax, points.cols()) &&
           (means.count() % kLanes != 0 || distances[farthest] > near));
  for (Eigen::Index v = 0; v < points.cols(); ++v) means.improve(v, v % stride == 0 ? kLastSteps : kOnlySteps);
}

// Measures how far the vertices are from their means: the differences of w_b (v - center; 1), bone by bone.
void measure(const Skin& skin, const NearestMeans& means, Hull& out) {
  std::vector<Eigen::Vector4d> most(skin.bones.size(), Eigen::Vector4d::Zero());
  double slack = 0;
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < skin.bones.size(); ++b) {
      Eigen::Vector4d off = skin.weights[v][b] * skin.places[v].homogeneous();
      for (std::size_t k = 0; k < means.chosen().size(); ++k) {
        const auto point = static_cast<std::size_t>(means.chosen()[k]);
        off -= means.share(v, k) * skin.weights[point][b] * skin.places[point].homogeneous();
      }
      most[b] = most[b].cwiseMax(off.cwiseAbs());
      sum += off.head<3>();
    }
    slack = std::max(slack, sum.norm());
  }
  const Eigen::Vector4d rounding = kRounding * Eigen::Vector4d(skin.radius, skin.radius, skin.radius, 1);
  for (std::size_t b = 0; b < skin.bones.size(); ++b) {
    const Eigen::Vector4d off = most[b] + rounding;
    out.bones.push_back({skin.bones[b], {round_up(off[0]), round_up(off[1]), round_up(off[2]), round_up(off[3])}});
  }
  out.slack = round_up(slack + kRounding * skin.radius);
}

Hull hull_of(const Skin& skin, double near) {
  Hull out;
  if (skin.vertices.empty()) return out;
  const Eigen::MatrixXd lifted = lift(skin);
  const auto means = std::make_unique<NearestMeans>(lifted);
  choose_points(lifted, near, *means);
  for (const Eigen::Index point : means->chosen()) out.points.push_back(skin.vertices[static_cast<std::size_t>(point)]);
  out.points.resize((out.points.size() + kLanes - 1) / kLanes * kLanes, out.points.back());
  out.center = skin.center;
  out.radius = round_up(skin.radius * (1 + 1e-15));
  measure(skin, *means, out);
  return out;
}

}  // namespace

std::vector<Hull> make_hulls(const Character& character, const std::vector<SurfaceVertex>& vertices,
                             std::vector<std::vector<Index>> of_spheres) {
  std::vector<Skin> skins;
  double radii = 0;
  for (std::vector<Index>& of_sphere : of_spheres) {
    skins.push_back(skin_of(character, vertices, std::move(of_sphere)));
    radii += skins.back().radius;
  }
  const double near = kNear * radii / static_cast<double>(skins.size());
  std::vector<Hull> out;
  for (const Skin& skin : skins) out.push_back(hull_of(skin, near));
  return out;
}

}  // namespace spherechain::baker
