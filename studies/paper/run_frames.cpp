// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_frames.h"

#include <chrono>

#include "baker/play/asset_file.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/refit/refit_job.h"
#include "statistics.h"
#include "studies/plain_detection.h"

namespace spherechain::paper {
namespace {

using Clock = std::chrono::steady_clock;

bool overlap(const Sphere& p, const Sphere& q) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, s = p.radius + q.radius;
  return (dx * dx + dy * dy) + dz * dz < s * s;
}

// The buffers of a game that runs one asset.
class Runner {
 public:
  explicit Runner(const std::vector<std::uint8_t>& bytes)
      : asset_({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "a bake"),
        spheres_(asset_->spheres().size),
        pairs_(spheres_.size() * (spheres_.size() - 1) / 2) {}

  Cost run(RunMethod method, const std::vector<float>& positions) {
    Cost cost;
    const auto start = Clock::now();
    switch (method) {
      case kRefit:
        refit(positions);
        break;
      case kM1:
        cost = plain_chains();
        break;
      case kM2:
        cost = plain_all_pairs();
        break;
      case kFullM1:
        for (std::size_t c = 0; c < asset_->chain_count(); ++c) {
          const Span<const std::uint32_t> chain = asset_->chain(c).spheres;
          compare_all(
              chain.size, [&](std::size_t i) { return spheres_[chain[i]]; }, cost);
        }
        break;
      case kFullM2:
        compare_all(
            spheres_.size(), [&](std::size_t i) { return spheres_[i]; }, cost);
        break;
      case kProduct:
        cost = detect();
        break;
    }
    cost.us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    return cost;
  }

 private:
  void refit(const std::vector<float>& positions) {
    RefitJob job;
    job.asset = asset_.handle();
    job.pose.vertices = positions.data();
    job.pose.vertex_count = positions.size() / 3;
    job.radius = SC_RADIUS_FIT;
    job.target = SC_TARGET_SCALAR;
    job.spheres = spheres_.data();
    job.sphere_capacity = spheres_.size();
    baker::check_runtime(job.run());
  }

  Cost plain_chains() const {
    const PlainResult found = PlainDetection(asset_.view(), SC_RADIUS_FIT).chains(spheres_.data());
    return {found.test_count, found.chain_pairs.size(), 0};
  }

  Cost plain_all_pairs() const {
    const PlainResult found = PlainDetection(asset_.view(), SC_RADIUS_FIT).all_pairs(spheres_.data());
    return {found.test_count, found.pairs.size(), 0};
  }

  Cost detect() {
    DetectJob job;
    job.asset = asset_.handle();
    job.spheres = spheres_.data();
    job.sphere_count = spheres_.size();
    job.radius = SC_RADIUS_FIT;
    job.target = SC_TARGET_SCALAR;
    job.pairs = pairs_.data();
    job.pair_capacity = pairs_.size();
    baker::check_runtime(job.run());
    return {pairs_.size() - asset_->ignored_count(), job.pair_count, 0};
  }

  template <typename At>
  static void compare_all(std::size_t n, const At& at, Cost& cost) {
    for (std::size_t i = 0; i < n; ++i) {
      const Sphere p = at(i);
      for (std::size_t j = 0; j < n; ++j) cost.overlaps += overlap(p, at(j)) ? 1 : 0;
    }
    cost.tests += n * n;
  }

  baker::OpenAsset asset_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
};

}  // namespace

std::vector<std::vector<FrameCost>> run_frames(const std::vector<std::vector<std::uint8_t>>& assets,
                                               const std::vector<Animation>& animations, int repetitions) {
  std::vector<FrameCost> frames;
  std::vector<std::vector<float>> positions;
  for (std::size_t a = 0; a < animations.size(); ++a) {
    for (std::size_t f = 0; f < animations[a].frames.size(); ++f) {
      frames.push_back({a, f, {}});
      positions.push_back(baker::pack(animations[a].frames[f]));
    }
  }
  using Times = std::array<std::vector<double>, kMethods.size()>;
  std::vector<Runner> runners(assets.begin(), assets.end());
  std::vector<std::vector<FrameCost>> out(assets.size(), frames);
  std::vector<std::vector<Times>> times(assets.size(), std::vector<Times>(frames.size()));
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (std::size_t a = 0; a < assets.size(); ++a) {
      for (std::size_t f = 0; f < frames.size(); ++f) {
        for (std::size_t m = 0; m < kMethods.size(); ++m) {
          out[a][f].methods[m] = runners[a].run(static_cast<RunMethod>(m), positions[f]);
          times[a][f][m].push_back(out[a][f].methods[m].us);
        }
      }
    }
  }
  for (std::size_t a = 0; a < assets.size(); ++a) {
    for (std::size_t f = 0; f < frames.size(); ++f) {
      for (std::size_t m = 0; m < kMethods.size(); ++m) out[a][f].methods[m].us = median(times[a][f][m]);
    }
  }
  return out;
}

}  // namespace spherechain::paper
