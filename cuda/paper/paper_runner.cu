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

// Memory of the device, or of the host that is copied from and to at full speed.
template <typename T>
class Buffer {
 public:
  enum class Place { kDevice, kHost };

  explicit Buffer(std::size_t count, Place place = Place::kDevice) : place_(place) {
    const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(T);
    void* memory = nullptr;
    check(place == Place::kDevice ? cudaMalloc(&memory, bytes) : cudaMallocHost(&memory, bytes), "allocation");
    data_ = static_cast<T*>(memory);
  }
  Buffer(const T* from, std::size_t count) : Buffer(count) {
    check(cudaMemcpy(data_, from, count * sizeof(T), cudaMemcpyHostToDevice), "copy of a table to the device");
  }
  ~Buffer() {
    if (place_ == Place::kDevice) {
      cudaFree(data_);
    } else {
      cudaFreeHost(data_);
    }
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  T* get() const { return data_; }

 private:
  Place place_;
  T* data_ = nullptr;
};

class Event {
 public:
  Event() { check(cudaEventCreate(&event_), "cudaEventCreate"); }
  ~Event() { cudaEventDestroy(event_); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  void record() { check(cudaEventRecord(event_), "cudaEventRecord"); }
  double microseconds_since(const Event& start) const {
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, start.event_, event_), "cudaEventElapsedTime");
    return 1000.0 * static_cast<double>(milliseconds);
  }

 private:
  cudaEvent_t event_ = nullptr;
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

struct Runner::Memory {
  Memory(const Tables& tables, std::uint32_t capacity)
      : spheres(tables.sphere_count()),
        chain_begin(tables.chain_begin.data(), tables.chain_begin.size()),
        members(tables.members.data(), tables.members.size()),
        ignored(tables.asset->ignored().data, tables.asset->ignored().size),
        rest_pairs(tables.asset->rest_pairs(tables.radius).data, tables.asset->rest_pairs(tables.radius).size),
        entries(capacity),
        count(1),
        host_spheres(tables.sphere_count(), Buffer<Sphere>::Place::kHost),
        host_entries(capacity, Buffer<ChainPair>::Place::kHost),
        host_count(1, Buffer<std::uint32_t>::Place::kHost),
        scene(tables.scene(spheres.get())),
        list{entries.get(), capacity, count.get()} {
    scene.chain_begin = chain_begin.get();
    scene.members = members.get();
    scene.ignored = ignored.get();
    scene.rest_pairs = rest_pairs.get();
  }

  Buffer<Sphere> spheres;
  Buffer<std::uint32_t> chain_begin, members;
  Buffer<std::uint64_t> ignored;
  Buffer<RestPair> rest_pairs;
  Buffer<ChainPair> entries;
  Buffer<std::uint32_t> count;
  Buffer<Sphere> host_spheres;
  Buffer<ChainPair> host_entries;
  Buffer<std::uint32_t> host_count;
  Event start, stop;
  Scene scene;  // on the device
  PairList list;

  void upload(const Sphere* from) {
    const std::size_t bytes = scene.sphere_count * sizeof(Sphere);
    std::memcpy(host_spheres.get(), from, bytes);
    check(cudaMemcpyAsync(spheres.get(), host_spheres.get(), bytes, cudaMemcpyHostToDevice), "copy of the spheres");
  }
  void clear_count() { check(cudaMemsetAsync(count.get(), 0, sizeof(std::uint32_t)), "cudaMemsetAsync"); }
};

Runner::Runner(const Tables& tables, std::uint32_t pair_capacity)
    : tables_(tables), memory_(std::make_unique<Memory>(tables, pair_capacity)) {}

Runner::~Runner() = default;

void Runner::launch(Kernel kernel) {
  const Scene& scene = memory_->scene;
  const PairList& list = memory_->list;
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
      m1_sphere<<<dim3(blocks(tables_.longest_chain), std::max(1U, scene.chain_count)), kThreads>>>(scene, list);
      break;
  }
  check(cudaGetLastError(), "launch of a kernel of the paper");
}

// Waits for all before it.
std::uint32_t Runner::count() {
  check(cudaMemcpyAsync(memory_->host_count.get(), memory_->count.get(), sizeof(std::uint32_t), cudaMemcpyDeviceToHost),
        "copy of the count");
  wait();
  return *memory_->host_count.get();
}

void Runner::fetch(std::uint32_t found) {
  const std::size_t there = std::min(found, memory_->list.capacity);
  if (there > 0) {
    check(cudaMemcpyAsync(memory_->host_entries.get(), memory_->entries.get(), there * sizeof(ChainPair),
                          cudaMemcpyDeviceToHost),
          "copy of the pairs");
    wait();
  }
}

std::vector<ChainPair> Runner::pairs(Kernel kernel, const Sphere* spheres) {
  memory_->upload(spheres);
  memory_->clear_count();
  launch(kernel);
  const std::uint32_t found = count();
  if (found > memory_->list.capacity) {
    throw std::runtime_error("the paper's kernels found " + std::to_string(found) + " pairs where there is room for " +
                             std::to_string(memory_->list.capacity));
  }
  fetch(found);
  std::vector<ChainPair> out(memory_->host_entries.get(), memory_->host_entries.get() + found);
  std::sort(out.begin(), out.end(), [](const ChainPair& l, const ChainPair& r) {
    return l.chain != r.chain ? l.chain < r.chain : l.pair < r.pair;
  });
  return out;
}

Times Runner::time(Kernel kernel, const Sphere* spheres) {
  Times times{};
  memory_->upload(spheres);
  memory_->clear_count();
  wait();
  memory_->start.record();
  launch(kernel);
  memory_->stop.record();
  wait();
  times.kernel = memory_->stop.microseconds_since(memory_->start);

  Clock::time_point start = Clock::now();
  memory_->clear_count();
  launch(kernel);
  count();
  times.launch = microseconds_since(start);

  start = Clock::now();
  memory_->upload(spheres);
  memory_->clear_count();
  launch(kernel);
  fetch(count());
  times.frame = microseconds_since(start);
  return times;
}

Times Runner::time_at_once(Kernel kernel, const Sphere* spheres) {
  Times times{};
  const Clock::time_point start = Clock::now();
  memory_->upload(spheres);
  const Clock::time_point uploaded = Clock::now();
  memory_->clear_count();
  memory_->start.record();
  launch(kernel);
  memory_->stop.record();
  const std::uint32_t found = count();
  times.launch = microseconds_since(uploaded);
  fetch(found);
  times.frame = microseconds_since(start);
  times.kernel = memory_->stop.microseconds_since(memory_->start);
  return times;
}

}  // namespace spherechain::cuda_paper
