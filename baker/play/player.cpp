// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/player.h"

#include <algorithm>
#include <chrono>

#include "mesh/error.h"
#include "spherechain/detect_skin.h"

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

Player::Player(const Asset& asset, RadiusKind radius, bool m1, bool m2, Target target)
    : asset_(asset),
      radius_(radius),
      m1_(m1),
      m2_(m2),
      target_(target),
      spheres_(asset.spheres().size),
      pairs_(spheres_.size() * (spheres_.size() - 1) / 2),
      words_(DetectContext::words_needed(asset)),
      contact_words_(TriangleContactContext::words_needed(asset)) {}

FrameResult Player::run(const std::vector<float>& positions) {
  const RefitJob refit = refit_job(asset_, positions, radius_, spheres_);
  FrameResult result;
  result.refit_us = median_us([&] { check(refit.run()); });
  if (m1_) result.m1 = detect(Method::kM1);
  if (m2_) result.m2 = detect(Method::kM2);
  return result;
}

Detection Player::take(std::vector<Sphere> spheres, const std::vector<Pair>& pairs, double us) {
  spheres_ = std::move(spheres);
  pair_count_ = pairs.size();
  std::copy(pairs.begin(), pairs.end(), pairs_.begin());
  return {pairs_.size() - asset_.ignored_count(), pair_count_, pair_count_, us};
}

template <typename Job>
Job Player::skin_job(const std::vector<float>& positions, TriangleContactContext& context) {
  context.words = {contact_words_.data(), contact_words_.size()};
  Job job;
  job.asset = &asset_;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.target = target_;
  job.context = &context;
  return job;
}

Player::SkinDetection Player::detect_skin(const std::vector<float>& positions) {
  SkinDetection out{std::vector<Pair>(pairs_.size()), 0};
  TriangleContactContext context;
  auto job = skin_job<DetectSkinJob>(positions, context);
  job.pairs = {out.pairs.data(), out.pairs.size()};
  out.us = median_us([&] { check(job.run()); });
  out.pairs.resize(job.pair_count);
  return out;
}

Player::TriangleDetection Player::detect_triangles(const std::vector<float>& positions) {
  TriangleContactContext context;
  auto job = skin_job<TriangleContactJob>(positions, context);
  check(job.run());  // to count
  TriangleDetection out{std::vector<TrianglePair>(job.pair_count), 0};
  job.pairs = {out.pairs.data(), out.pairs.size()};
  out.us = median_us([&] { check(job.run()); });
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
