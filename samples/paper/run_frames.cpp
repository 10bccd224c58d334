// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_frames.h"

#include <chrono>

#include "mesh/error.h"
#include "spherechain/detect.h"
#include "spherechain/refit.h"
#include "statistics.h"

namespace spherechain::paper {
namespace {

using Clock = std::chrono::steady_clock;

void check(Status status) {
  if (status != Status::kOk) throw baker::Error(baker::ExitCode::kInternal, to_string(status));
}

bool overlap(const Sphere& p, const Sphere& q) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, s = p.radius + q.radius;
  return (dx * dx + dy * dy) + dz * dz < s * s;
}

// The buffers of a game that runs one asset.
class Runner {
 public:
  explicit Runner(const std::vector<std::uint8_t>& bytes) {
    char message[256] = "";
    if (asset_.open(bytes.data(), bytes.size(), message, sizeof message) != Status::kOk) {
      throw baker::Error(baker::ExitCode::kInternal, message);
    }
    const std::size_t n = asset_.spheres().size;
    spheres_.resize(n);
    pairs_.resize(n * (n - 1) / 2);
    words_.resize(DetectContext::words_needed(asset_));
  }

  Cost run(std::size_t method, const std::vector<float>& positions) {
    Cost cost;
    const auto start = Clock::now();
    switch (method) {
      case 0:
        refit(positions);
        break;
      case 1:
      case 2:
        cost = detect(method == 1 ? Method::kM1 : Method::kM2);
        break;
      case 3:
        for (std::size_t c = 0; c < asset_.chain_count(); ++c) {
          const Span<const std::uint32_t> chain = asset_.chain(c).spheres;
          compare_all(
              chain.size, [&](std::size_t i) { return spheres_[chain[i]]; }, cost);
        }
        break;
      default:
        compare_all(
            spheres_.size(), [&](std::size_t i) { return spheres_[i]; }, cost);
    }
    cost.us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    return cost;
  }

 private:
  void refit(const std::vector<float>& positions) {
    RefitJob job;
    job.asset = &asset_;
    job.positions = positions.data();
    job.vertex_count = positions.size() / 3;
    job.radius = RadiusKind::kFit;
    job.spheres = {spheres_.data(), spheres_.size()};
    check(job.run());
  }

  Cost detect(Method method) {
    DetectContext context{{words_.data(), words_.size()}};
    DetectJob job;
    job.asset = &asset_;
    job.spheres = {spheres_.data(), spheres_.size()};
    job.radius = RadiusKind::kFit;
    job.method = method;
    job.target = Target::kScalar;
    job.context = &context;
    job.pairs = {pairs_.data(), pairs_.size()};
    check(job.run());
    return {job.test_count, job.chain_pair_count, 0};
  }

  template <typename At>
  static void compare_all(std::size_t n, const At& at, Cost& cost) {
    for (std::size_t i = 0; i < n; ++i) {
      const Sphere p = at(i);
      for (std::size_t j = 0; j < n; ++j) cost.overlaps += overlap(p, at(j)) ? 1 : 0;
    }
    cost.tests += n * n;
  }

  Asset asset_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> words_;
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
          out[a][f].methods[m] = runners[a].run(m, positions[f]);
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
