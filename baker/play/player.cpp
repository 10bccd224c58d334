// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/player.h"

#include <algorithm>
#include <chrono>

#include "mesh/error.h"

namespace spherechain::baker {
namespace {

using Clock = std::chrono::steady_clock;

// Median microseconds of a few runs: a frame's work is shorter than the machine's hiccups.
template <typename Run>
double median_us(const Run& run) {
  std::array<double, 5> times{};
  for (double& time : times) {
    const auto start = Clock::now();
    run();
    time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }
  std::nth_element(times.begin(), times.begin() + 2, times.end());
  return times[2];
}

RefitJob refit_job(const Asset& asset, const std::vector<float>& positions, RadiusKind radius,
                   std::vector<Sphere>& spheres) {
  RefitJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.radius = radius;
  job.spheres = {spheres.data(), spheres.size()};
  return job;
}

void check(Status status) {
  if (status != Status::kOk) throw Error(ExitCode::kInternal, to_string(status));
}

}  // namespace

std::vector<Sphere> refit_spheres(const Asset& asset, const std::vector<float>& positions, RadiusKind radius) {
  std::vector<Sphere> spheres(asset.spheres().size);
  RefitJob job = refit_job(asset, positions, radius, spheres);
  check(job.run());
  return spheres;
}

Player::Player(const Asset& asset, RadiusKind radius, bool chains, bool all_pairs, Target target)
    : asset_(asset),
      radius_(radius),
      chains_(chains),
      all_pairs_(all_pairs),
      target_(target),
      spheres_(asset.spheres().size),
      pairs_(spheres_.size() * (spheres_.size() - 1) / 2),
      words_(DetectContext::words_needed(asset)),
      contact_words_(TriangleContactContext::words_needed(asset)) {
  for (std::uint32_t s = 0; s < asset.spheres().size; ++s) {
    const RestSphere& sphere = asset.spheres()[s];
    for (std::uint32_t k = 0; k < sphere.triangle_count; ++k) {
      sphere_of_[asset.triangles()[sphere.first_triangle + k]] = s;
    }
  }
}

FrameResult Player::run(const std::vector<float>& positions) {
  const RefitJob refit = refit_job(asset_, positions, radius_, spheres_);
  FrameResult result;
  result.refit_us = median_us([&] { check(refit.run()); });
  if (chains_) result.chains = detect(Method::kM1);
  if (all_pairs_) result.all_pairs = detect(Method::kM2);
  return result;
}

Detection Player::take(std::vector<Sphere> spheres, const std::vector<Pair>& pairs, double us) {
  spheres_ = std::move(spheres);
  pair_count_ = pairs.size();
  std::copy(pairs.begin(), pairs.end(), pairs_.begin());
  return {pairs_.size() - asset_.ignored_count(), pair_count_, pair_count_, us};
}

Player::TriangleDetection Player::detect_triangles(const std::vector<float>& positions) {
  TriangleContactContext context;
  context.words = {contact_words_.data(), contact_words_.size()};
  TriangleContactJob job;
  job.asset = &asset_;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.target = target_;
  job.context = &context;
  check(job.run());  // to count
  TriangleDetection out{std::vector<TrianglePair>(job.pair_count), 0};
  job.pairs = {out.pairs.data(), out.pairs.size()};
  out.us = median_us([&] { check(job.run()); });
  return out;
}

std::vector<Pair> Player::spheres_of(const std::vector<TrianglePair>& triangles) const {
  std::vector<Pair> out;
  for (const TrianglePair& pair : triangles) {
    const auto [a, b] = std::minmax({sphere_of_.at(pair.a), sphere_of_.at(pair.b)});
    out.push_back({a, b});
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Detection Player::detect(Method method) {
  DetectContext context{{words_.data(), words_.size()}};
  DetectJob job;
  job.asset = &asset_;
  job.spheres = {spheres_.data(), spheres_.size()};
  job.radius = radius_;
  job.method = method;
  job.target = target_;
  job.context = &context;
  job.pairs = {pairs_.data(), pairs_.size()};
  const double us = median_us([&] { check(job.run()); });
  pair_count_ = job.pair_count;
  return {job.test_count, job.pair_count, job.chain_pair_count, us};
}

}  // namespace spherechain::baker
