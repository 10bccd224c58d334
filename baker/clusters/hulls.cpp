// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "baker/clusters/clusters.h"
#include "baker/clusters/round_up.h"

namespace spherechain::baker {
namespace {

constexpr Eigen::Index kPointsMax = 96, kLanes = 16;  // points of a hull at most; its points come in lanes
constexpr double kNear = 0.03;              // of the spheres' mean radius: as near to the hull as this is near enough
constexpr double kNearest = 0.25;           // of that: no nearer point is looked for
constexpr Eigen::Index kCandidates = 2048;  // vertices of a sphere that may be points of its hull
constexpr double kEnough = 0.01;            // of a distance: what is found may be longer by this
constexpr int kStepsMax = 100;
constexpr double kRounding = 1e-13;  // more than double precision takes from shares and sums, of lengths of 1

// A sphere's vertices as the asset has them: their places, seen from the hull's centre, and their weights.
struct HullSkin {
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

HullSkin skin_of(const Character& character, const std::vector<SurfaceVertex>& all, std::vector<Index> vertices) {
  HullSkin out;
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
Eigen::MatrixXd lift(const HullSkin& skin) {
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

// A mean of chosen points: which, and their shares, which sum to 1.
struct Mean {
  std::vector<Eigen::Index> of;
  std::vector<double> shares;
  double distance = std::numeric_limits<double>::max();  // to the vertex that it stands for
};

// The means of chosen points that are nearest to vertices: the nearest points of their hull, by Wolfe's algorithm
// ("Finding the nearest point in a polytope", 1976). A step takes in the point that lies farthest towards the vertex,
// and goes to the nearest mean of those taken in; where shares would be negative, it drops their points on the way.
class NearestMeans {
 public:
  NearestMeans(const Eigen::MatrixXd& vertices, double near_enough)
      : vertices_(vertices),
        near_enough_(near_enough),
        points_(kPointsMax, vertices.rows()),
        means_(static_cast<std::size_t>(vertices.cols())) {}

  Eigen::Index count() const { return static_cast<Eigen::Index>(chosen_.size()); }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }
  const Mean& mean(Eigen::Index vertex) const { return means_[static_cast<std::size_t>(vertex)]; }

  void choose(Eigen::Index vertex) {
    points_.row(count()) = vertices_.col(vertex).transpose();
    chosen_.push_back(vertex);
  }

  void find(Eigen::Index vertex) {
    Mean& mean = means_[static_cast<std::size_t>(vertex)];
    const auto place = vertices_.col(vertex);
    const auto points = points_.topRows(count());
    if (mean.of.empty()) {
      Eigen::Index nearest = 0;
      (points.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
      mean.of = {nearest};
      mean.shares = {1};
    }
    double before = std::numeric_limits<double>::max();
    for (int step = 0; step < kStepsMax; ++step) {
      off_ = -place;
      for (std::size_t k = 0; k < mean.of.size(); ++k) off_ += mean.shares[k] * points_.row(mean.of[k]).transpose();
      mean.distance = off_.norm();
      if (mean.distance <= near_enough_ || mean.distance >= before) return;
      before = mean.distance;
      Eigen::Index next = 0;
      towards_.noalias() = points * off_;
      const double farthest = off_.dot(off_ + place) - towards_.minCoeff(&next);
      if (farthest <= kEnough * mean.distance * mean.distance) return;
      mean.of.push_back(next);
      mean.shares.push_back(0);
      while (drop_on_the_way(place, mean)) {
      }
    }
  }

 private:
  // Goes to the nearest mean on the plane of its points, or as far as no share is negative. Returns whether it dropped
  // points.
  bool drop_on_the_way(const Eigen::Ref<const Eigen::VectorXd>& place, Mean& mean) {
    const auto count = static_cast<Eigen::Index>(mean.of.size());
    from_.resize(place.size(), count);
    for (Eigen::Index k = 0; k < count; ++k) {
      from_.col(k) = points_.row(mean.of[static_cast<std::size_t>(k)]).transpose() - place;
    }
    // The shares of the least mean are those of this system's solution, over their sum. The constant that is added to
    // each of the products changes the size of the solution alone, and makes the system regular.
    products_.noalias() = from_.transpose() * from_;
    products_.array() += products_.trace() / static_cast<double>(count);
    const Eigen::LLT<Eigen::MatrixXd> factors(products_);
    wanted_ = factors.solve(Eigen::VectorXd::Ones(count));
    wanted_ /= wanted_.sum();
    if (factors.info() != Eigen::Success || !wanted_.allFinite()) return false;
    double way = 1;
    std::size_t first = 0;  // to be dropped
    for (std::size_t k = 0; k < mean.of.size(); ++k) {
      const double share = mean.shares[k], wanted = wanted_[static_cast<Eigen::Index>(k)];
      if (wanted >= 0 || share > way * (share - wanted)) continue;
      way = share / (share - wanted);
      first = k;
    }
    for (std::size_t k = 0; k < mean.of.size(); ++k) {
      mean.shares[k] += way * (wanted_[static_cast<Eigen::Index>(k)] - mean.shares[k]);
    }
    if (way == 1) return false;
    mean.of.erase(mean.of.begin() + static_cast<std::ptrdiff_t>(first));
    mean.shares.erase(mean.shares.begin() + static_cast<std::ptrdiff_t>(first));
    return true;
  }

  const Eigen::MatrixXd& vertices_;
  double near_enough_;
  Eigen::MatrixXd points_;  // a row each
  std::vector<Eigen::Index> chosen_;
  std::vector<Mean> means_;
  Eigen::VectorXd off_, towards_, wanted_;
  Eigen::MatrixXd from_, products_;
};

// Chooses the vertex that is farthest from the hull of those before, again and again. More points bring no vertex
// farther away: only those that may be farthest are looked at again. On fine skin it looks at an even part of the
// vertices: that the others are near is measured, not assumed.
NearestMeans choose_points(const Eigen::MatrixXd& vertices, double near) {
  NearestMeans means(vertices, kNearest * near);
  const Eigen::Index stride = (vertices.cols() + kCandidates - 1) / kCandidates;
  using Seen = std::pair<double, Eigen::Index>;  // a vertex, and its distance when it was last looked at
  std::priority_queue<Seen> candidates;
  for (Eigen::Index v = 0; v < vertices.cols(); v += stride) {
    candidates.emplace(std::numeric_limits<double>::max(), v);
  }
  std::vector<Eigen::Index> looked_at(static_cast<std::size_t>(vertices.cols()), 0);  // when there were so many points
  Eigen::Index farthest = 0;
  vertices.colwise().squaredNorm().maxCoeff(&farthest);
  do {
    means.choose(farthest);
    for (farthest = candidates.top().second; looked_at[static_cast<std::size_t>(farthest)] < means.count();
         farthest = candidates.top().second) {
      candidates.pop();
      means.find(farthest);
      looked_at[static_cast<std::size_t>(farthest)] = means.count();
      candidates.emplace(means.mean(farthest).distance, farthest);
    }
  } while (means.count() < std::min(kPointsMax, vertices.cols()) &&
           (means.count() % kLanes != 0 || candidates.top().first > near));
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) means.find(v);
  return means;
}

// Measures how far the vertices are from their means: the differences of w_b (v - center; 1), bone by bone.
void measure(const HullSkin& skin, const NearestMeans& means, Hull& out) {
  std::vector<Eigen::Vector4d> most(skin.bones.size(), Eigen::Vector4d::Zero());
  double slack = 0;
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    const Mean& mean = means.mean(static_cast<Eigen::Index>(v));
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < skin.bones.size(); ++b) {
      Eigen::Vector4d off = skin.weights[v][b] * skin.places[v].homogeneous();
      for (std::size_t k = 0; k < mean.of.size(); ++k) {
        const auto point = static_cast<std::size_t>(means.chosen()[static_cast<std::size_t>(mean.of[k])]);
        off -= mean.shares[k] * skin.weights[point][b] * skin.places[point].homogeneous();
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

Hull hull_of(const HullSkin& skin, double near) {
  Hull out;
  if (skin.vertices.empty()) return out;
  const Eigen::MatrixXd lifted = lift(skin);
  const NearestMeans means = choose_points(lifted, near);
  for (const Eigen::Index point : means.chosen()) out.points.push_back(skin.vertices[static_cast<std::size_t>(point)]);
  out.points.resize((out.points.size() + kLanes - 1) / kLanes * kLanes, out.points.back());
  out.center = skin.center;
  out.radius = round_up(skin.radius * (1 + 1e-15));
  measure(skin, means, out);
  return out;
}

}  // namespace

std::vector<Hull> make_hulls(const Character& character, const std::vector<SurfaceVertex>& vertices,
                             std::vector<std::vector<Index>> of_spheres) {
  std::vector<HullSkin> skins;
  double radii = 0;
  for (std::vector<Index>& of_sphere : of_spheres) {
    skins.push_back(skin_of(character, vertices, std::move(of_sphere)));
    radii += skins.back().radius;
  }
  const double near = kNear * radii / static_cast<double>(skins.size());
  std::vector<Hull> out;
  for (const HullSkin& skin : skins) out.push_back(hull_of(skin, near));
  return out;
}

}  // namespace spherechain::baker
