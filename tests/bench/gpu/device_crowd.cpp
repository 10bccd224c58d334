// SPDX-License-Identifier: MIT
#include "device_crowd.h"

#include <cstring>

#include "spherechain/cuda_device.h"

namespace spherechain::bench {
namespace {

constexpr std::size_t kMostListed = 32;  // an instance, on average
constexpr std::size_t kSets = 2;

void must_be_ok(Status status, const char* what) {
  if (status != Status::kOk) {
    std::fprintf(stderr, "spherechain_bench_gpu: %s: %s (%s)\n", what, to_string(status), cuda::last_device_error());
    std::exit(1);
  }
}

// Poses far from each other for neighbours: a clip's frames in order would make the lanes of a warp go the same ways.
std::size_t pose_of(std::size_t instance, std::size_t poses) {
  constexpr std::size_t kStep = 389;  // a prime
  return instance * kStep % poses;
}

template <typename T>
std::vector<T> repeated(const std::vector<T>& poses, std::size_t pose_size, std::size_t instances) {
  std::vector<T> out(instances * pose_size);
  const std::size_t count = pose_size == 0 ? 0 : poses.size() / pose_size;
  for (std::size_t i = 0; i < instances && count > 0; ++i) {
    std::memcpy(&out[i * pose_size], &poses[pose_of(i, count) * pose_size], pose_size * sizeof(T));
  }
  return out;
}

}  // namespace

Reference refit_and_detect(const PosedAsset& posed, RadiusKind radius) {
  const std::size_t n = posed.asset.spheres().size, poses = posed.poses.pose_count;
  Reference out;
  out.spheres.resize(n * poses);
  for (std::size_t i = 0; i < poses; ++i) {
    RefitBonesJob refit;
    refit.asset = &posed.asset;
    refit.bones.data = posed.poses.matrices_of(i);
    refit.bones.count = posed.poses.bone_count;
    if (posed.poses.morph_count > 0) {
      refit.morph_weights = {posed.poses.morphs_of(i), posed.poses.morph_count};
    }
    refit.radius = radius;
    refit.spheres = {&out.spheres[i * n], n};
    must_be_ok(refit.run(), "RefitBonesJob");
  }
  out.counts.resize(poses);
  out.bits.resize(poses * DetectJob::bit_words(posed.asset));
  std::vector<std::uint64_t> words(CrowdContext::words_needed(posed.asset, 1));
  CrowdContext context{{words.data(), words.size()}};
  spherechain::CrowdJob detect;
  detect.asset = &posed.asset;
  detect.spheres = out.spheres.data();
  detect.instance_count = poses;
  detect.radius = radius;
  detect.context = &context;
  detect.counts = {out.counts.data(), poses};
  detect.bits = {out.bits.data(), out.bits.size()};
  must_be_ok(detect.run(), "CrowdJob");
  return out;
}

DeviceCrowd::DeviceCrowd(const PosedAsset& posed, const Reference& reference, RadiusKind radius, std::size_t instances)
    : posed_(posed),
      reference_(reference),
      instances_(instances),
      words_(cuda::CrowdTables::words_needed(posed.asset)),
      refitted_(instances * posed.asset.spheres().size),
      bounds_(instances),
      counts_(instances),
      bits_(instances * DetectJob::bit_words(posed.asset)),
      starts_(instances),
      pair_count_(1),
      pairs_(instances * kMostListed) {
  must_be_ok(tables_.build(posed.asset, radius, nullptr, {words_.data(), words_.size()}), "CrowdTables");
  device_tables_ = std::make_unique<DeviceArray<std::uint64_t>>(words_);
  const PoseFile& poses = posed.poses;
  for (std::size_t set = 0; set < kSets; ++set) {  // the same instances: what comes out must be the same
    matrices_.emplace_back(repeated(poses.matrices, poses.bone_count * kMatrixFloats, instances));
    if (poses.morph_count > 0) {
      weights_.emplace_back(repeated(poses.morph_weights, poses.morph_count, instances));
    }
    spheres_.emplace_back(repeated(reference.spheres, posed.asset.spheres().size, instances));
  }
}

void DeviceCrowd::enqueue(bool from_bones, unsigned outputs, std::size_t instances) {
  const std::size_t set = launches_++ % kSets;
  cuda::CrowdGroup group;
  group.tables = &tables_;
  group.device_tables = device_tables_->data();
  group.instance_count = instances;
  if (from_bones) {
    const std::size_t bones = posed_.poses.bone_count;
    group.bones = {matrices_[set].data(), bones, MatrixLayout::kRowMajor3x4, 48};
    group.instance_stride = bones * 48;
    group.morph_weights = weights_.empty() ? nullptr : weights_[set].data();
  } else {
    group.spheres = spheres_[set].data();
  }
  const auto take = [&](Output output, auto* pointer) { return (outputs & output) != 0 ? pointer : nullptr; };
  group.refitted = from_bones ? take(kSpheres, refitted_.data()) : nullptr;
  group.bounds = take(kBounds, bounds_.data());
  group.counts = take(kCounts, counts_.data());
  group.bits = take(kBits, bits_.data());
  group.pairs = take(kList, pairs_.data());
  group.starts = take(kList, starts_.data());
  group.pair_count = take(kList, pair_count_.data());
  group.pair_capacity = pairs_.size();
  const cuda::CrowdJob job{{&group, 1}, nullptr};
  must_be_ok(job.run(), "cuda::CrowdJob");
}

bool DeviceCrowd::is_right(unsigned outputs) const {
  const std::size_t poses = posed_.poses.pose_count, n = posed_.asset.spheres().size;
  const std::size_t words = DetectJob::bit_words(posed_.asset);
  std::size_t wrong = 0;
  const auto compare = [&](const char* what, const auto& got, const auto& wanted, std::size_t size) {
    for (std::size_t i = 0; i < instances_; ++i) {
      if (std::memcmp(&got[i * size], &wanted[pose_of(i, poses) * size], size * sizeof got[0]) != 0 && wrong++ < 5) {
        std::fprintf(stderr, "  instance %zu: other %s than on the CPU\n", i, what);
      }
    }
  };
  if ((outputs & kCounts) != 0) {
    compare("counts", counts_.host(), reference_.counts, 1);
  }
  if ((outputs & kBits) != 0) {
    compare("pairs", bits_.host(), reference_.bits, words);
  }
  if ((outputs & kSpheres) != 0) {
    compare("spheres", refitted_.host(), reference_.spheres, n);
  }
  if ((outputs & kList) != 0) {  // as bits again, each pair once
    const std::vector<CrowdPair> pairs = pairs_.host();
    const std::vector<std::uint64_t> starts = starts_.host();
    const std::vector<std::uint32_t> counts = counts_.host();
    std::vector<std::uint64_t> bits(instances_ * words);
    for (std::size_t i = 0; i < instances_; ++i) {
      for (std::size_t k = 0; k < counts[i] && starts[i] + k < pairs.size(); ++k) {
        const CrowdPair& pair = pairs[starts[i] + k];
        const std::size_t bit = std::size_t{pair.pair.b} * (pair.pair.b - 1) / 2 + pair.pair.a;
        const bool is_sorted = k == 0 || pairs[starts[i] + k - 1].pair < pair.pair;
        if ((pair.instance != i || pair.pair.b >= n || !is_sorted) && wrong++ < 5) {
          std::fprintf(stderr, "  instance %zu: a wrong entry in the list\n", i);
        } else {
          bits[i * words + bit / 64] |= std::uint64_t{1} << (bit % 64);
        }
      }
    }
    compare("listed pairs", bits, reference_.bits, words);
  }
  return wrong == 0;
}

std::size_t DeviceCrowd::bytes_moved(bool from_bones, unsigned outputs) const {
  const std::size_t n = posed_.asset.spheres().size;
  std::size_t out = from_bones ? posed_.poses.bone_count * 48 + posed_.poses.morph_count * 4 : n * sizeof(Sphere);
  out += (outputs & kCounts) != 0 ? sizeof(std::uint32_t) : 0;
  out += (outputs & kBits) != 0 ? DetectJob::bit_words(posed_.asset) * 8 : 0;
  out += (outputs & kSpheres) != 0 ? n * sizeof(Sphere) : 0;
  out += (outputs & kBounds) != 0 ? sizeof(Sphere) : 0;
  return out;
}

}  // namespace spherechain::bench
