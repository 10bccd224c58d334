// SPDX-License-Identifier: MIT
#include "paper_case.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "runtime/src/pairs/detect_job.h"

namespace spherechain::bench {
namespace {

constexpr std::size_t kRoom = 1 << 14;  // pairs, to begin with

void check(Status status, const std::string& what) {
  if (status != SC_OK) {
    throw std::runtime_error(what + ": " + sc_field_name(status.field) + ": " + sc_code_text(status.code));
  }
}

std::vector<std::vector<Sphere>> frames_of(const PosedAsset& character) {
  const PoseFile& poses = character.poses;
  if (poses.sphere_count == 0) {
    throw std::runtime_error("the poses hold no spheres (write them again with spherechain_gpu_data)");
  }
  std::vector<std::vector<Sphere>> out;
  for (std::size_t pose = 0; pose < poses.pose_count; ++pose) {
    out.emplace_back(poses.spheres_of(pose), poses.spheres_of(pose) + poses.sphere_count);
  }
  return out;
}

bool by_chain(const ChainPair& l, const ChainPair& r) {
  return l.chain != r.chain ? l.chain < r.chain : l.pair < r.pair;
}

}  // namespace

PaperCase::PaperCase(const std::string& folder, const std::string& name_, std::uint32_t parts_)
    : name(name_), parts(parts_) {
  for (const std::string animation : {"arms", "legs"}) {
    std::string error;
    if (!read_posed_asset(folder, name + "_" + animation, whole, error)) {
      throw std::runtime_error(error);
    }
    animations.push_back({animation, frames_of(whole)});
  }
  if (parts > 1) {
    split = std::make_unique<SplitAsset>(whole.asset, parts);
    for (PaperAnimation& animation : animations) {
      for (std::vector<Sphere>& frame : animation.frames) {
        frame = split->split(frame);
      }
    }
  }
  tables = std::make_unique<cuda_paper::Tables>(view(), SC_RADIUS_FIT);
}

std::vector<ChainPair> chain_pairs_of(const AssetView& asset, const std::vector<ChainPair>& m2) {
  std::vector<ChainPair> out;
  for (std::uint32_t c = 0; c < asset.chain_count(); ++c) {
    std::vector<bool> is_member(asset.spheres().size);
    for (const std::uint32_t sphere : asset.chain(c).spheres) {
      is_member[sphere] = true;
    }
    for (const ChainPair& one : m2) {
      if (is_member[one.pair.a] && is_member[one.pair.b]) {
        out.push_back({c, one.pair});
      }
    }
  }
  return out;
}

CpuRunner::CpuRunner(const PaperCase& paper_case) : case_(paper_case), pairs_(kRoom), chain_pairs_(kRoom) {}

std::vector<ChainPair> CpuRunner::pairs(CpuMethod method, const std::vector<Sphere>& spheres) {
  run(method, spheres);
  if (found_ > chain_pairs_.size()) {
    pairs_.resize(found_);
    chain_pairs_.resize(found_);
    run(method, spheres);
  }
  std::vector<ChainPair> out(chain_pairs_.begin(), chain_pairs_.begin() + found_);
  if (method == CpuMethod::kM2) {
    std::transform(pairs_.begin(), pairs_.begin() + found_, out.begin(), [](const Pair& p) { return ChainPair{0, p}; });
  }
  std::sort(out.begin(), out.end(), by_chain);
  return out;
}

double CpuRunner::time(CpuMethod method, const std::vector<Sphere>& spheres) {
  const auto start = std::chrono::steady_clock::now();
  run(method, spheres);
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

void CpuRunner::run(CpuMethod method, const std::vector<Sphere>& spheres) {
  if (method == CpuMethod::kM1) {
    const cuda_paper::Scene scene = case_.tables->scene(spheres.data());
    found_ = 0;
    for (std::uint32_t chain = 0; chain < scene.chain_count; ++chain) {
      test_chain(scene, chain, {chain_pairs_.data(), static_cast<std::uint32_t>(chain_pairs_.size()), &found_});
    }
    return;
  }
  DetectJob job;
  job.asset = &case_.asset();
  job.spheres = spheres.data();
  job.sphere_count = spheres.size();
  job.radius = SC_RADIUS_FIT;
  job.target = SC_TARGET_SCALAR;
  job.pairs = pairs_.data();
  job.pair_capacity = pairs_.size();
  const Status status = job.run();
  if (status != SC_OVERFLOW) {
    check(status, "overlaps on the CPU");
  }
  found_ = static_cast<std::uint32_t>(job.pair_count);
}

}  // namespace spherechain::bench
