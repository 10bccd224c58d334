// SPDX-License-Identifier: MIT
// HostCrowd and enqueue_crowds() with a device that is fake but for its kernels.
#include <doctest/doctest.h>

#include <string>

#include "crowd_cases.h"
#include "fake_device.h"
#include "jobs.h"

namespace spherechain::test {

bool can_run(const char*& where) {
  where = "on a fake device";
  return true;
}

namespace {

struct Poses {
  Poses(const Asset& asset, std::size_t instances, unsigned seed) : asset(asset), instances(instances) {
    std::mt19937 random(seed);
    input.instance_count = instances;
    give_matrices(input, asset, SC_ROWS_4X4, PoseKind::kGentle, 4, random);
    for (std::size_t i = 0; i < instances; ++i) {
      const Refitted refitted = refit(asset, pose_of(input, i), SC_RADIUS_DETECT);
      spheres.insert(spheres.end(), refitted.spheres.begin(), refitted.spheres.end());
      const Detected found = detect(asset, refitted.spheres, SC_RADIUS_DETECT);
      counts.push_back(static_cast<std::uint32_t>(found.pairs.size()));
      for (const Pair& pair : found.pairs) pairs.push_back({static_cast<std::uint32_t>(i), pair});
    }
  }
  const Asset& asset;
  std::size_t instances;
  GroupInput input;
  std::vector<Sphere> spheres;
  std::vector<std::uint32_t> counts;
  std::vector<CrowdPair> pairs;
};

struct Results {
  std::vector<Sphere> spheres;
  std::vector<std::uint32_t> counts;
  std::vector<CrowdPair> pairs;
};

constexpr CrowdPair kUnwritten{77, {7, 7}};

Results give(cuda::HostCrowd& crowd, const Poses& poses, std::size_t capacity) {
  Results out{std::vector<Sphere>(poses.spheres.size()), std::vector<std::uint32_t>(poses.instances),
              std::vector<CrowdPair>(capacity, kUnwritten)};
  crowd.pose = pose_of(poses.input, 0);
  crowd.instance_stride = poses.input.instance_stride;
  crowd.instance_count = poses.instances;
  crowd.spheres = out.spheres.data();
  crowd.counts = out.counts.data();
  crowd.pairs = out.pairs.data();
  return out;
}

void check(const Results& got, const Poses& poses, std::size_t pair_count) {
  CHECK(same_bits(got.spheres, poses.spheres));
  CHECK(got.counts == poses.counts);
  REQUIRE(pair_count == poses.pairs.size());
  bool same = true;
  for (std::size_t i = 0; i < got.pairs.size(); ++i) {
    const CrowdPair& wanted = i < pair_count ? poses.pairs[i] : kUnwritten;
    same &= got.pairs[i].instance == wanted.instance && got.pairs[i].pair == wanted.pair;
  }
  CHECK(same);
}

// A device of its own for each test, and nothing left on it.
struct Device {
  Device() { fake_device = {}; }
  ~Device() {
    CHECK(fake_device.objects == 0);
    CHECK(fake_device.bytes == 0);
  }
};

std::size_t launches(cuda::Kernel kernel) { return fake_device.launches[static_cast<std::size_t>(kernel)]; }

constexpr std::size_t kCapacity = 100000;

}  // namespace

TEST_CASE("a host crowd gives the CPU's spheres, counts and sorted pairs, run after run, of more and fewer instances") {
  const Device device;
  const OpenedAsset opened(moment_asset(50, 6, 3).parts);
  cuda::HostCrowd crowd;
  REQUIRE(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 100, kCapacity) == SC_OK);
  CHECK(crowd.is_open());
  for (const std::size_t instances : {10U, 100U, 33U, 1U}) {
    const Poses poses(opened.asset, instances, static_cast<unsigned>(instances));
    const Results got = give(crowd, poses, kCapacity);
    REQUIRE(crowd.run() == SC_OK);
    check(got, poses, crowd.pair_count);
    CHECK(crowd.device_milliseconds == 0.25F);
  }
  CHECK(launches(cuda::Kernel::kBones) == 4);
  CHECK(launches(cuda::Kernel::kScratch) == 0);
  crowd.instance_count = 0;
  CHECK(crowd.run() == SC_OK);
  CHECK(crowd.pair_count == 0);

  const OpenedAsset other(moment_asset(20, 3, 4).parts);
  REQUIRE(crowd.open(other.asset, SC_RADIUS_DETECT, nullptr, 5, 1000) == SC_OK);
  const Poses poses(other.asset, 5, 9);
  const Results got = give(crowd, poses, 1000);
  REQUIRE(crowd.run() == SC_OK);
  check(got, poses, crowd.pair_count);
}

TEST_CASE("a host crowd of fewer outputs gives those") {
  const Device device;
  const OpenedAsset opened(moment_asset(30, 4, 3).parts);
  const Poses poses(opened.asset, 40, 2);
  cuda::HostCrowd crowd;
  REQUIRE(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 40, 1) == SC_OK);
  const Results got = give(crowd, poses, 1);
  crowd.spheres = nullptr;
  crowd.pairs = nullptr;
  REQUIRE(crowd.run() == SC_OK);
  CHECK(got.counts == poses.counts);
  CHECK(crowd.pair_count == poses.pairs.size());
  crowd.counts = nullptr;
  CHECK(crowd.run() == SC_OK);
}

TEST_CASE("more pairs than a host crowd has room for are counted, and none is written") {
  const Device device;
  const OpenedAsset opened(moment_asset(30, 4, 3).parts);
  const Poses poses(opened.asset, 40, 2);
  REQUIRE(poses.pairs.size() > 100);
  cuda::HostCrowd crowd;
  REQUIRE(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 40, poses.pairs.size() - 1) == SC_OK);
  const Results got = give(crowd, poses, poses.pairs.size());
  CHECK(crowd.run() == SC_OVERFLOW);
  CHECK(crowd.pair_count == poses.pairs.size());
  CHECK(got.counts == poses.counts);
  for (const CrowdPair& pair : got.pairs) REQUIRE(pair.instance == kUnwritten.instance);
  REQUIRE(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 40, poses.pairs.size()) == SC_OK);
  const Results again = give(crowd, poses, poses.pairs.size());
  CHECK(crowd.run() == SC_OK);
  check(again, poses, crowd.pair_count);
}

TEST_CASE("a host crowd of a large asset has scratch, as much as there is room for") {
  const OpenedAsset opened(moment_asset(60, 5, 6).parts);
  const Poses poses(opened.asset, 150, 3);  // five blocks
  for (const int multiprocessors : {1, 2, 100}) {
    const Device device;
    fake_device.most_shared_bytes = 30 * 1024;
    fake_device.multiprocessors = multiprocessors;
    cuda::HostCrowd crowd;
    REQUIRE(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 150, kCapacity) == SC_OK);
    const Results got = give(crowd, poses, kCapacity);
    REQUIRE(crowd.run() == SC_OK);
    check(got, poses, crowd.pair_count);
    CHECK(launches(cuda::Kernel::kBones) == 0);
    CHECK(launches(cuda::Kernel::kScratch) == 1);
  }
}

TEST_CASE("a host crowd refuses what it cannot run, before it asks the device, and writes nothing") {
  const Device device;
  const OpenedAsset opened(moment_asset(20, 4, 3).parts), boneless(random_asset(20, 3).parts);
  const Asset closed;
  std::uint64_t word = 0;
  const auto* const bad = reinterpret_cast<const std::uint64_t*>(reinterpret_cast<const char*>(&word) + 4);
  cuda::HostCrowd crowd;
  const auto open = [&](const Asset& asset, const std::uint64_t* ignored, std::size_t instances, std::size_t capacity) {
    const Status status = crowd.open(asset, SC_RADIUS_DETECT, ignored, instances, capacity);
    CHECK(crowd.is_open() == (status == SC_OK));
    return status;
  };
  CHECK(crowd.run() == SC_NOT_OPEN);
  CHECK(open(closed, nullptr, 1, 1) == SC_NOT_OPEN);
  CHECK(open(boneless.asset, nullptr, 1, 1) == SC_NOT_IN_ASSET);
  CHECK(open(opened.asset, nullptr, 0, 1) == Status{SC_BAD_VALUE, SC_FIELD_INSTANCES});
  CHECK(open(opened.asset, nullptr, 1, 0) == Status{SC_BAD_VALUE, SC_FIELD_PAIRS});
  CHECK(open(opened.asset, nullptr, ~std::size_t{0}, 1) == Status{SC_BAD_VALUE, SC_FIELD_INSTANCES});
  CHECK(open(opened.asset, bad, 1, 1) == Status{SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS});
  CHECK(open(opened.asset, nullptr, 1, ~std::size_t{0} / 2) == SC_NO_MEMORY);
  CHECK(fake_device.calls == 0);

  REQUIRE(open(opened.asset, nullptr, 10, 1000) == SC_OK);
  const Poses poses(opened.asset, 10, 1);
  const std::size_t calls = fake_device.calls;
  const auto refused = [&](sc_code code, sc_field field, auto change) {
    const Results got = give(crowd, poses, 1000);
    change();
    CHECK(crowd.run() == Status{code, field});
    CHECK(crowd.pair_count == 0);
    for (const std::uint32_t count : got.counts) CHECK(count == 0);
    CHECK(got.pairs[0].instance == kUnwritten.instance);
  };
  refused(SC_BAD_VALUE, SC_FIELD_INSTANCES, [&] { crowd.instance_count = 11; });
  refused(SC_NULL, SC_FIELD_BONES, [&] { crowd.pose.bones = nullptr; });
  refused(SC_TOO_SMALL, SC_FIELD_BONE_COUNT, [&] { --crowd.pose.bone_count; });
  refused(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE, [&] { crowd.pose.bone_stride = 60; });
  refused(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [&] { crowd.instance_stride = 16; });
  refused(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [&] { crowd.instance_stride = ~std::size_t{3}; });
  refused(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT, [&] { crowd.pose.bone_layout = static_cast<MatrixLayout>(9); });
  CHECK(fake_device.calls == calls);
  const Results got = give(crowd, poses, 1000);
  CHECK(crowd.run() == SC_OK);
  check(got, poses, crowd.pair_count);
  crowd.close();
  CHECK(crowd.run() == SC_NOT_OPEN);
}

TEST_CASE("where there is no device, or no driver for it, a host crowd says so and holds nothing") {
  const OpenedAsset opened(moment_asset(20, 4, 3).parts);
  for (const cudaError_t error :
       {cudaSuccess, cudaErrorNoDevice, cudaErrorInsufficientDriver, cudaErrorSystemDriverMismatch,
        cudaErrorNoKernelImageForDevice, cudaErrorSystemNotReady, cudaErrorCompatNotSupportedOnDevice}) {
    const Device device;
    fake_device.count = 0;
    fake_device.error = error;
    cuda::HostCrowd crowd;
    CHECK(cuda::check_device() == SC_NO_DEVICE);
    CHECK(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 5, 10) == SC_NO_DEVICE);
    CHECK(!crowd.is_open());
    CHECK(std::string(cuda::last_device_error()) == "the fake device failed");
  }
}

TEST_CASE("each failure of the device is reported, leaves nothing behind, and can be got over") {
  const OpenedAsset opened(moment_asset(20, 4, 3).parts);
  const Poses poses(opened.asset, 40, 5);
  for (const int most_shared_bytes : {227 * 1024, 4 * 1024}) {
    const Device device;
    fake_device.most_shared_bytes = most_shared_bytes;
    std::size_t failures = 0, failed_runs = 0;
    for (std::size_t calls = 0; failures == calls; ++calls) {
      CAPTURE(calls);
      fake_device.error = cudaErrorIllegalAddress;
      fake_device.calls_before_error = calls;
      cuda::HostCrowd crowd;
      Status status = crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, 40, kCapacity);
      CHECK(crowd.is_open() == (status == SC_OK));
      if (status == SC_OK) {
        const Results unread = give(crowd, poses, kCapacity);
        status = crowd.run();
        failed_runs += status == SC_DEVICE_FAILED ? 1U : 0U;
      }
      failures += status == SC_DEVICE_FAILED ? 1U : 0U;
      CHECK((status == SC_DEVICE_FAILED || status == SC_OK));
      fake_device.error = cudaSuccess;
      if (!crowd.is_open()) continue;
      const Results got = give(crowd, poses, kCapacity);
      CHECK(crowd.run() == SC_OK);
      check(got, poses, crowd.pair_count);
    }
    CHECK(failures > 20);
    CHECK(failed_runs > 8);
  }
}

TEST_CASE(
    "a call clears the counts of all groups with a list, of those without instances too, and launches each kind once") {
  const Device device;
  const OpenedAsset opened(random_asset(30, 2).parts);
  std::mt19937 random(1);
  const std::vector<Sphere> spheres = spheres_of(30, 64, 30, random);
  alignas(16) std::uint64_t words[20000];
  const std::vector<std::uint64_t> table = table_of(opened.asset, SC_RADIUS_DETECT);
  REQUIRE(table.size() <= std::size(words));
  std::copy(table.begin(), table.end(), words);
  std::vector<std::uint32_t> counts(64);
  std::vector<std::uint64_t> starts(64), pair_counts(3, 99);
  std::vector<CrowdPair> pairs(10000);
  alignas(16) static unsigned char scratch[200000];
  std::vector<cuda::CrowdGroup> groups(3);
  for (std::size_t g = 0; g < 3; ++g) {
    groups[g].table = table.data();
    groups[g].device_table = words;
    groups[g].instance_count = g == 1 ? 0 : 64;
    groups[g].spheres = spheres.data();
    groups[g].counts = counts.data();
    groups[g].pairs = pairs.data();
    groups[g].pair_capacity = pairs.size();
    groups[g].starts = starts.data();
    groups[g].pair_count = &pair_counts[g];
    groups[g].scratch = scratch;
    groups[g].scratch_bytes = sizeof scratch;
  }
  const auto enqueue = [&] { return cuda::enqueue_crowds(groups.data(), groups.size(), nullptr); };
  REQUIRE(enqueue() == SC_OK);
  CHECK(launches(cuda::Kernel::kSpheres) == 1);
  CHECK(pair_counts[0] > 100);
  CHECK(pair_counts[1] == 0);
  CHECK(pair_counts[2] == pair_counts[0]);
  fake_device.most_shared_bytes = 1024;
  REQUIRE(enqueue() == SC_OK);
  CHECK(launches(cuda::Kernel::kSpheres) == 1);
  CHECK(launches(cuda::Kernel::kScratch) == 1);
  CHECK(pair_counts[2] == pair_counts[0]);
  groups[0].scratch = nullptr;
  pair_counts[0] = 5;
  CHECK(enqueue() == SC_DEVICE_TOO_SMALL);
  CHECK(pair_counts[0] == 5);

  const std::size_t calls = fake_device.calls;
  CHECK(cuda::enqueue_crowds(nullptr, 0, nullptr) == SC_OK);
  CHECK(fake_device.calls == calls);
}

}  // namespace spherechain::test
