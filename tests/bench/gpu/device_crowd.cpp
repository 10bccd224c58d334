// SPDX-License-Identifier: MIT
#include "device_crowd.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/refit/refit_job.h"

namespace spherechain::bench {
namespace {

constexpr std::size_t kSets = 2;

void must_be_ok(Status status, const char* what) {
  if (status != SC_OK) {
    std::fprintf(stderr, "spherechain_bench_gpu: %s: %s: %s (%s)\n", what, sc_field_name(status.field),
                 sc_code_text(status.code), cuda::last_device_error());
    std::exit(1);
  }
}

// Poses far from each other for neighbours: a clip's frames in order would make the lanes of a warp go the same ways.
std::size_t pose_of(std::size_t instance, std::size_t poses) {
  constexpr std::size_t kStep = 389;  // a prime
  return instance * kStep % poses;
}

// At least one.
std::size_t pair_count(const Reference& reference, std::size_t instances) {
  std::size_t sum = 1;
  for (std::size_t i = 0; i < instances; ++i) {
    sum += reference.counts[pose_of(i, reference.counts.size())];
  }
  return sum;
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

Pose pose_with(const float* bones, std::size_t count) {
  Pose pose;
  pose.bones = bones;
  pose.bone_count = count;
  pose.bone_layout = SC_ROWS_3X4;
  return pose;
}

// For assets too large for shared memory: two blocks a multiprocessor.
std::size_t scratch_bytes(const std::uint64_t* table, const PoseFile& poses, std::size_t instances) {
  cudaDeviceProp properties{};
  must(cudaGetDeviceProperties(&properties, 0));
  const std::size_t block = cuda::crowd_block_bytes(table, poses.bone_count > 0, true, true);
  const std::size_t blocks =
      std::min((instances + 31) / 32, 2 * static_cast<std::size_t>(properties.multiProcessorCount));
  return block <= properties.sharedMemPerBlockOptin ? 1 : blocks * block;
}

}  // namespace

void detect(const PosedAsset& posed, Radius radius, Reference& reference) {
  const std::size_t poses = posed.poses.pose_count;
  reference.counts.resize(poses);
  reference.bits.resize(poses * sc_pair_words(&posed.asset));
  std::vector<std::uint64_t> scratch(sc_crowd_scratch_words(&posed.asset, 1));
  CrowdJob detect;
  detect.asset = &posed.asset;
  detect.spheres = reference.spheres.data();
  detect.instance_count = poses;
  detect.radius = radius;
  detect.scratch = scratch.data();
  detect.scratch_words = scratch.size();
  detect.counts = reference.counts.data();
  detect.count_capacity = poses;
  detect.bits = reference.bits.data();
  detect.bit_words = reference.bits.size();
  must_be_ok(detect.run(), "sc_detect_crowd");
}

Reference reference_of(const PosedAsset& posed, Radius radius) {
  const std::size_t n = posed.view().spheres().size, poses = posed.poses.pose_count;
  Reference out;
  out.spheres.resize(n * poses);
  for (std::size_t i = 0; i < poses; ++i) {
    RefitJob refit;
    refit.asset = &posed.asset;
    refit.pose = pose_with(posed.poses.matrices_of(i), posed.poses.bone_count);
    refit.radius = radius;
    refit.spheres = &out.spheres[i * n];
    refit.sphere_capacity = n;
    must_be_ok(refit.run(), "sc_refit");
  }
  detect(posed, radius, out);
  return out;
}

void DeviceCrowd::Wrong::add(std::size_t instance, const char* what) {
  if (count++ < 5) {
    std::fprintf(stderr, "  instance %zu: other %s than on the CPU\n", instance, what);
  }
}

DeviceCrowd::DeviceCrowd(const PosedAsset& posed, const Reference& reference, Radius radius, std::size_t instances)
    : posed_(posed),
      reference_(reference),
      instances_(instances),
      table_(cuda::crowd_table_words(posed.asset)),
      refitted_(instances * posed.view().spheres().size),
      counts_(instances),
      bits_(instances * sc_pair_words(&posed.asset)),
      starts_(instances),
      pair_count_(1),
      pairs_(pair_count(reference, instances)),
      scratch_([&] {
        must_be_ok(cuda::prepare_crowd(posed.asset, radius, nullptr, table_.data(), table_.size()), "prepare_crowd");
        return scratch_bytes(table_.data(), posed.poses, instances);
      }()) {
  device_table_ = std::make_unique<DeviceArray<std::uint64_t>>(table_);
  const PoseFile& poses = posed.poses;
  for (std::size_t set = 0; set < kSets; ++set) {  // the same instances: what comes out must be the same
    if (poses.bone_count > 0) {
      matrices_.emplace_back(repeated(poses.matrices, poses.bone_count * kMatrixFloats, instances));
    }
    spheres_.emplace_back(repeated(reference.spheres, posed.view().spheres().size, instances));
  }
}

void DeviceCrowd::enqueue(bool from_bones, unsigned outputs, std::size_t instances) {
  const std::size_t set = launches_++ % kSets;
  cuda::CrowdGroup group;
  group.table = table_.data();
  group.device_table = device_table_->data();
  group.instance_count = instances;
  if (from_bones) {
    group.pose = pose_with(matrices_[set].data(), posed_.poses.bone_count);
  } else {
    group.spheres = spheres_[set].data();
  }
  const auto take = [&](Output output, auto* pointer) { return (outputs & output) != 0 ? pointer : nullptr; };
  group.refitted = from_bones ? take(kSpheres, refitted_.data()) : nullptr;
  group.counts = take(kCounts, counts_.data());
  group.bits = take(kBits, bits_.data());
  group.pairs = take(kList, pairs_.data());
  group.starts = take(kList, starts_.data());
  group.pair_count = take(kList, pair_count_.data());
  group.pair_capacity = pairs_.size();
  group.scratch = scratch_.data();
  group.scratch_bytes = scratch_.size();
  must_be_ok(cuda::enqueue_crowds(&group, 1, nullptr), "enqueue_crowds");
}

bool DeviceCrowd::runs_right(bool from_bones, unsigned outputs) {
  const auto spoil = [](auto&... arrays) { (arrays.spoil(), ...); };
  // Results of an earlier launch could pass for those of this one, so they are overwritten.
  spoil(refitted_, counts_, bits_, starts_, pair_count_, pairs_);
  enqueue(from_bones, outputs, instances_);

  const std::size_t poses = posed_.poses.pose_count, n = posed_.view().spheres().size;
  const std::size_t words = sc_pair_words(&posed_.asset);
  Wrong wrong;
  const auto compare = [&](const char* what, const auto& got, const auto& wanted, std::size_t size) {
    for (std::size_t i = 0; i < instances_; ++i) {
      if (std::memcmp(&got[i * size], &wanted[pose_of(i, poses) * size], size * sizeof got[0]) != 0) {
        wrong.add(i, what);
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
  if ((outputs & kList) != 0) {
    compare("listed pairs", listed_bits(wrong), reference_.bits, words);
  }
  return wrong.count == 0;
}

std::vector<std::uint64_t> DeviceCrowd::listed_bits(Wrong& wrong) const {
  const std::size_t n = posed_.view().spheres().size, words = sc_pair_words(&posed_.asset);
  const std::vector<CrowdPair> pairs = pairs_.host();
  const std::vector<std::uint64_t> starts = starts_.host();
  const std::vector<std::uint32_t> counts = counts_.host();
  std::vector<std::uint64_t> bits(instances_ * words);
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < instances_; ++i) {
    total += counts[i];
    for (std::size_t k = 0; k < counts[i] && starts[i] + k < pairs.size(); ++k) {
      const auto& [instance, pair] = pairs[starts[i] + k];
      const bool is_sorted = k == 0 || pairs[starts[i] + k - 1].pair < pair;
      if (instance != i || pair.a >= pair.b || pair.b >= n || !is_sorted) {
        wrong.add(i, "entries in the list");
        break;
      }
      const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
      bits[i * words + bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
  if (pair_count_.host()[0] != total) {
    wrong.add(0, "number of pairs in all");
  }
  return bits;
}

std::size_t DeviceCrowd::bytes_moved(bool from_bones, unsigned outputs) const {
  const std::size_t n = posed_.view().spheres().size;
  std::size_t out = from_bones ? posed_.poses.bone_count * 48 : n * sizeof(Sphere);
  out += (outputs & kCounts) != 0 ? sizeof(std::uint32_t) : 0;
  out += (outputs & kBits) != 0 ? sc_pair_words(&posed_.asset) * 8 : 0;
  out += (outputs & kSpheres) != 0 ? n * sizeof(Sphere) : 0;
  return out;
}

}  // namespace spherechain::bench
