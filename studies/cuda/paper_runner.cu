// SPDX-License-Identifier: MIT
#include <cuda_runtime.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <stdexcept>

#include "paper_runner.h"

namespace spherechain::cuda_paper {
namespace {

constexpr std::uint32_t kThreads = 64;  // a block; the paper gives no number

__global__ void nothing() {}

__global__ void m2_sphere(Scene scene, PairList list) {
  test_sphere(scene, blockIdx.x * blockDim.x + threadIdx.x, list);
}

__global__ void m1_chain(Scene scene, PairList list) { test_chain(scene, blockIdx.x * blockDim.x + threadIdx.x, list); }

__global__ void m1_sphere(Scene scene, PairList list) {
  test_place(scene, blockIdx.y, blockIdx.x * blockDim.x + threadIdx.x, list);
}

void check(cudaError_t error, const char* what) {
  if (error != cudaSuccess) {
    throw std::runtime_error(std::string(what) + ": " + cudaGetErrorString(error));
  }
}

// Events, memory of the device, and memory of the host that is copied from and to at full speed.
class Resources {
 public:
  Resources() = default;
  Resources(const Resources&) = delete;
  Resources& operator=(const Resources&) = delete;
  ~Resources() {
    std::for_each(device_.begin(), device_.end(), cudaFree);
    std::for_each(host_.begin(), host_.end(), cudaFreeHost);
    std::for_each(events_.begin(), events_.end(), cudaEventDestroy);
  }

  template <typename T>
  T* on_device(std::size_t count) {
    void*& memory = device_.emplace_back();
    check(cudaMalloc(&memory, std::max<std::size_t>(count, 1) * sizeof(T)), "allocation on the device");
    return static_cast<T*>(memory);
  }
  template <typename T>
  T* copy_to_device(const T* from, std::size_t count) {
    T* const to = on_device<T>(count);
    check(cudaMemcpy(to, from, count * sizeof(T), cudaMemcpyHostToDevice), "copy of a table to the device");
    return to;
  }
  template <typename T>
  T* on_host(std::size_t count) {
    void*& memory = host_.emplace_back();
    check(cudaMallocHost(&memory, std::max<std::size_t>(count, 1) * sizeof(T)), "allocation on the host");
    return static_cast<T*>(memory);
  }
  cudaEvent_t event() {
    cudaEvent_t& event = events_.emplace_back();
    check(cudaEventCreate(&event), "cudaEventCreate");
    return event;
  }

 private:
  std::vector<void*> device_, host_;
  std::vector<cudaEvent_t> events_;
};

using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

std::string version(int number) { return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10); }

void wait() { check(cudaDeviceSynchronize(), "a kernel of the paper"); }

}  // namespace

Device device() {
  int driver = 0, runtime = 0, current = 0;
  cudaDeviceProp properties;
  check(cudaGetDevice(&current), "cudaGetDevice");
  check(cudaGetDeviceProperties(&properties, current), "cudaGetDeviceProperties");
  check(cudaDriverGetVersion(&driver), "cudaDriverGetVersion");
  check(cudaRuntimeGetVersion(&runtime), "cudaRuntimeGetVersion");
  return {properties.name, version(driver), version(runtime)};
}

struct Runner::Memory : Resources {
  Memory(const Tables& tables, std::uint32_t capacity)
      : scene(tables.scene(on_device<Sphere>(tables.asset->spheres().size))),
        longest_chain(tables.longest_chain),
        list{on_device<ChainPair>(capacity), capacity, on_device<std::uint32_t>(1)},
        host_spheres(on_host<Sphere>(scene.sphere_count)),
        host_entries(on_host<ChainPair>(capacity)),
        host_count(on_host<std::uint32_t>(1)) {
    scene.chain_begin = copy_to_device(tables.chain_begin.data(), tables.chain_begin.size());
    scene.members = copy_to_device(tables.members.data(), tables.members.size());
    scene.ignored = copy_to_device(tables.asset->ignored().data, tables.asset->ignored().size);
    scene.rest_pairs = copy_to_device(tables.rest_pairs.data, tables.rest_pairs.size);
  }

  void upload(const Sphere* from) {
    const std::size_t bytes = scene.sphere_count * sizeof(Sphere);
    std::memcpy(host_spheres, from, bytes);
    check(cudaMemcpyAsync(const_cast<Sphere*>(scene.spheres), host_spheres, bytes, cudaMemcpyHostToDevice),
          "copy of the spheres");
  }
  void clear_count() { check(cudaMemsetAsync(list.count, 0, sizeof(std::uint32_t)), "cudaMemsetAsync"); }
  void launch(Kernel kernel) const;
  void launch(Kernel kernel, const Sphere* from) {
    upload(from);
    clear_count();
    launch(kernel);
  }

  // Waits for all before it.
  std::uint32_t count() {
    check(cudaMemcpyAsync(host_count, list.count, sizeof(std::uint32_t), cudaMemcpyDeviceToHost), "copy of the count");
    wait();
    return *host_count;
  }
  void fetch(std::uint32_t found) {
    const std::size_t there = std::min(found, list.capacity);
    if (there > 0) {
      check(cudaMemcpyAsync(host_entries, list.entries, there * sizeof(ChainPair), cudaMemcpyDeviceToHost),
            "copy of the pairs");
      wait();
    }
  }

  Scene scene;  // on the device
  std::uint32_t longest_chain;
  PairList list;
  Sphere* host_spheres;
  ChainPair* host_entries;
  std::uint32_t* host_count;
  cudaEvent_t begin = event(), end = event();
};

void Runner::Memory::launch(Kernel kernel) const {
  const auto blocks = [](std::uint32_t threads) { return std::max(1U, (threads + kThreads - 1) / kThreads); };
  switch (kernel) {
    case Kernel::kEmpty:
      nothing<<<1, 1>>>();
      break;
    case Kernel::kM2Sphere:
      m2_sphere<<<blocks(scene.sphere_count), kThreads>>>(scene, list);
      break;
    case Kernel::kM1Chain:
      m1_chain<<<blocks(scene.chain_count), std::max(1U, std::min(scene.chain_count, kThreads))>>>(scene, list);
      break;
    case Kernel::kM1Sphere:
      m1_sphere<<<dim3(blocks(longest_chain), std::max(1U, scene.chain_count)), kThreads>>>(scene, list);
      break;
  }
  check(cudaGetLastError(), "launch of a kernel of the paper");
}

Runner::Runner(const Tables& tables, std::uint32_t pair_capacity)
    : memory_(std::make_unique<Memory>(tables, pair_capacity)) {}

Runner::~Runner() = default;

std::vector<ChainPair> Runner::pairs(Kernel kernel, const Sphere* spheres) {
  Memory& m = *memory_;
  m.launch(kernel, spheres);
  const std::uint32_t found = m.count();
  if (found > m.list.capacity) {
    throw std::runtime_error("the paper's kernels found " + std::to_string(found) + " pairs where there is room for " +
                             std::to_string(m.list.capacity));
  }
  m.fetch(found);
  std::vector<ChainPair> out(m.host_entries, m.host_entries + found);
  std::sort(out.begin(), out.end(), [](const ChainPair& l, const ChainPair& r) {
    return l.chain != r.chain ? l.chain < r.chain : l.pair < r.pair;
  });
  return out;
}

Times Runner::time(Kernel kernel, const Sphere* spheres) {
  Memory& m = *memory_;
  Times times{};
  float milliseconds = 0;
  m.upload(spheres);
  m.clear_count();
  wait();
  check(cudaEventRecord(m.begin), "cudaEventRecord");
  m.launch(kernel);
  check(cudaEventRecord(m.end), "cudaEventRecord");
  wait();
  check(cudaEventElapsedTime(&milliseconds, m.begin, m.end), "cudaEventElapsedTime");
  times.kernel = 1000.0 * static_cast<double>(milliseconds);

  Clock::time_point start = Clock::now();
  m.clear_count();
  m.launch(kernel);
  m.count();
  times.launch = microseconds_since(start);

  start = Clock::now();
  m.launch(kernel, spheres);
  m.fetch(m.count());
  times.frame = microseconds_since(start);
  return times;
}

}  // namespace spherechain::cuda_paper
