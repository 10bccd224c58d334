// SPDX-License-Identifier: MIT
// Behaviour that only a device shows: streams, and graphs.
#include <cuda_runtime_api.h>
#include <doctest/doctest.h>

#include <vector>

#include "crowd_cases.h"
#include "jobs.h"
#include "spherechain/cuda.h"

namespace spherechain::test {

long long count_wrong_roots();  // count_wrong_roots.cu

namespace {

template <typename T>
T* on_device(const std::vector<T>& from) {
  void* to = nullptr;
  REQUIRE(cudaMalloc(&to, from.size() * sizeof(T)) == cudaSuccess);
  REQUIRE(cudaMemcpy(to, from.data(), from.size() * sizeof(T), cudaMemcpyHostToDevice) == cudaSuccess);
  return static_cast<T*>(to);
}

}  // namespace

TEST_CASE("the kernel's square root is the rounded one for every float it is used for") {
  CHECK(count_wrong_roots() == 0);
}

TEST_CASE("a crowd is captured into a graph, and each replay finds the pairs of the spheres as they are then") {
  constexpr std::size_t kSpheres = 40, kInstances = 100;
  std::mt19937 random(2);
  const OpenedAsset opened(random_asset(kSpheres, 2).parts);
  const std::vector<std::uint64_t> table = table_of(opened.asset, SC_RADIUS_DETECT);

  cuda::CrowdGroup group;
  group.table = table.data();
  group.device_table = on_device(table);
  group.instance_count = kInstances;
  auto* spheres = on_device(std::vector<Sphere>(kSpheres * kInstances));
  group.spheres = spheres;
  group.counts = on_device(std::vector<std::uint32_t>(kInstances));
  group.starts = on_device(std::vector<std::uint64_t>(kInstances));
  group.pairs = on_device(std::vector<CrowdPair>(kInstances * 1000));
  group.pair_capacity = kInstances * 1000;
  group.pair_count = on_device(std::vector<std::uint64_t>(1));

  cudaStream_t stream = nullptr;
  REQUIRE(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking) == cudaSuccess);
  cudaGraph_t graph = nullptr;
  REQUIRE(cudaStreamBeginCapture(stream, cudaStreamCaptureModeGlobal) == cudaSuccess);
  REQUIRE(cuda::enqueue_crowds(&group, 1, stream) == SC_OK);
  REQUIRE(cudaStreamEndCapture(stream, &graph) == cudaSuccess);
  cudaGraphExec_t replayed = nullptr;
  REQUIRE(cudaGraphInstantiate(&replayed, graph, 0) == cudaSuccess);

  for (int replay = 0; replay < 3; ++replay) {
    std::vector<Sphere> all;
    std::vector<std::uint32_t> wanted;
    std::size_t total = 0;
    for (std::size_t i = 0; i < kInstances; ++i) {
      const std::vector<Sphere> one = random_spheres(kSpheres, random);
      all.insert(all.end(), one.begin(), one.end());
      const Detected found = detect(opened.asset, one, SC_RADIUS_DETECT, SC_TARGET_SCALAR);
      wanted.push_back(static_cast<std::uint32_t>(found.pairs.size()));
      total += found.pairs.size();
    }
    REQUIRE(cudaMemcpyAsync(spheres, all.data(), all.size() * sizeof(Sphere), cudaMemcpyHostToDevice, stream) ==
            cudaSuccess);
    REQUIRE(cudaGraphLaunch(replayed, stream) == cudaSuccess);
    REQUIRE(cudaStreamSynchronize(stream) == cudaSuccess);
    std::vector<std::uint32_t> counts(kInstances);
    std::uint64_t count = 0;
    cudaMemcpy(counts.data(), group.counts, kInstances * sizeof counts[0], cudaMemcpyDeviceToHost);
    cudaMemcpy(&count, group.pair_count, sizeof count, cudaMemcpyDeviceToHost);
    CHECK(counts == wanted);
    CHECK(count == total);
  }
  cudaGraphExecDestroy(replayed);
  cudaGraphDestroy(graph);
  cudaStreamDestroy(stream);
  for (const void* memory : {static_cast<const void*>(group.device_table), static_cast<const void*>(spheres),
                             static_cast<const void*>(group.counts), static_cast<const void*>(group.starts),
                             static_cast<const void*>(group.pairs), static_cast<const void*>(group.pair_count)}) {
    cudaFree(const_cast<void*>(memory));
  }
}

TEST_CASE("a host crowd on the device gives the CPU's spheres and sorted pairs, from shared memory and from scratch") {
  for (const unsigned spheres : {40U, 300U}) {
    constexpr std::size_t kInstances = 70;
    const OpenedAsset opened(moment_asset(spheres, 6, 2).parts);
    std::mt19937 random(3);
    GroupInput in;
    in.instance_count = kInstances;
    give_matrices(in, opened.asset, SC_COLUMNS_4X4, PoseKind::kGentle, 0, random);
    std::vector<Sphere> wanted, refitted(spheres * kInstances);
    std::vector<CrowdPair> wanted_pairs;
    for (std::uint32_t i = 0; i < kInstances; ++i) {
      const Refitted one = refit(opened.asset, pose_of(in, i), SC_RADIUS_DETECT);
      wanted.insert(wanted.end(), one.spheres.begin(), one.spheres.end());
      for (const Pair& pair : detect(opened.asset, one.spheres, SC_RADIUS_DETECT).pairs) {
        wanted_pairs.push_back({i, pair});
      }
    }
    std::vector<CrowdPair> pairs(wanted_pairs.size());
    cuda::HostCrowd crowd;
    REQUIRE(crowd.open(opened.asset, SC_RADIUS_DETECT, nullptr, kInstances, pairs.size()) == SC_OK);
    crowd.pose = pose_of(in, 0);
    crowd.instance_stride = in.instance_stride;
    crowd.instance_count = kInstances;
    crowd.spheres = refitted.data();
    crowd.pairs = pairs.data();
    REQUIRE(crowd.run() == SC_OK);
    CHECK(same_bits(refitted, wanted));
    CHECK(crowd.pair_count == wanted_pairs.size());
    CHECK(same_bits(pairs, wanted_pairs));
    CHECK(crowd.device_milliseconds > 0);
  }
}

}  // namespace spherechain::test
