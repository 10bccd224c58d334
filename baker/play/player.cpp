// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/player.h"

#include <algorithm>
#include <chrono>

#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/refit/refit_job.h"

namespace spherechain::baker {
namespace {

using Clock = std::chrono::steady_clock;

// Median microseconds of a few runs, where a frame's work is shorter than the machine's hiccups; else of one.
template <typename Run>
double median_us(const Run& run) {
  constexpr double kLong = 5000;
  std::array<double, 5> times{};
  for (double& time : times) {
    const auto start = Clock::now();
    run();
    time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    if (times[0] > kLong) return times[0];
  }
  std::nth_element(times.begin(), times.begin() + 2, times.end());
  return times[2];
}

RefitJob refit_job(const OpenAsset& asset, const std::vector<float>& positions, Radius radius,
                   std::vector<Sphere>& spheres) {
  RefitJob job;
  job.asset = asset.handle();
  job.pose.vertices = positions.data();
  job.pose.vertex_count = positions.size() / 3;
  job.radius = radius;
  job.spheres = spheres.data();
  job.sphere_capacity = spheres.size();
  return job;
}

}  // namespace

std::vector<Sphere> refit_spheres(const OpenAsset& asset, const std::vector<float>& positions, Radius radius) {
  std::vector<Sphere> spheres(asset->spheres().size);
  check_runtime(refit_job(asset, positions, radius, spheres).run());
  return spheres;
}

Player::Player(const OpenAsset& asset, Radius radius, Target target)
    : asset_(asset),
      radius_(radius),
      target_(target),
      skin_(asset, target),
      spheres_(asset->spheres().size),
      pairs_(spheres_.size() * (spheres_.size() - 1) / 2) {
  for (std::uint32_t s = 0; s < asset->spheres().size; ++s) {
    for (const std::uint32_t triangle : asset.triangles_of(s)) sphere_of_[triangle] = s;
  }
}

FrameResult Player::run(const std::vector<float>& positions) {
  const RefitJob refit = refit_job(asset_, positions, radius_, spheres_);
  FrameResult result;
  result.refit_us = median_us([&] { check_runtime(refit.run()); });
  result.all_pairs = detect();
  return result;
}

Detection Player::take(std::vector<Sphere> spheres, const std::vector<Pair>& pairs, double us) {
  spheres_ = std::move(spheres);
  pair_count_ = pairs.size();
  std::copy(pairs.begin(), pairs.end(), pairs_.begin());
  return {pairs_.size() - asset_->ignored_count(), pair_count_, us};
}

Player::TriangleDetection Player::detect_triangles(const sc_pose& pose, bool is_next) {
  TriangleDetection out{};
  out.us = median_us([&] {
    skin_.set_pose(pose);
    skin_.count_contacts();
  });
  for (const TriangleContact& contact : skin_.triangles())
    out.pairs.push_back({contact.triangle_a, contact.triangle_b});
  const auto start = Clock::now();
  out.penetrations = skin_.measure(is_next);
  out.measure_us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  std::stable_sort(out.penetrations.begin(), out.penetrations.end(),
                   [](const Penetration& l, const Penetration& r) { return l.measures.depth > r.measures.depth; });
  return out;
}

std::vector<Pair> Player::spheres_of(const std::vector<Pair>& triangles) const {
  std::vector<Pair> out;
  for (const Pair& pair : triangles) {
    const auto [a, b] = std::minmax({sphere_of_.at(pair.a), sphere_of_.at(pair.b)});
    out.push_back({a, b});
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Detection Player::detect() {
  DetectJob job;
  job.asset = asset_.handle();
  job.spheres = spheres_.data();
  job.sphere_count = spheres_.size();
  job.radius = radius_;
  job.target = target_;
  job.pairs = pairs_.data();
  job.pair_capacity = pairs_.size();
  const double us = median_us([&] { check_runtime(job.run()); });
  pair_count_ = job.pair_count;
  return {pairs_.size() - asset_->ignored_count(), job.pair_count, us};
}

}  // namespace spherechain::baker
