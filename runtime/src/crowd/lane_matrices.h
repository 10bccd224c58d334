// SPDX-License-Identifier: MIT
// Matrices of as many instances as a register has lanes: from one instance after the other to one a lane.
#include "simd/highway.h"

#if defined(SPHERECHAIN_CROWD_LANE_MATRICES_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_CROWD_LANE_MATRICES_H
#undef SPHERECHAIN_CROWD_LANE_MATRICES_H
#else
#define SPHERECHAIN_CROWD_LANE_MATRICES_H
#endif

#include <hwy/cache_control.h>

#include "crowd/refit.h"
#include "pairs/sphere_registers.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// By bone, row and column. The lanes of instances that are not there take after the last one.
HWY_INLINE void transpose(const LaneRefit& batch) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::ScalableTag<float> d;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const MatrixLayout layout = batch.inputs.layout;
  const bool by_rows = layout == SC_ROWS_3X4 || layout == SC_ROWS_4X4;
  const std::size_t quads = layout == SC_COLUMNS_4X4 ? 4 : 3;
  std::size_t places[16];  // of a matrix's figures, as they come
  for (std::size_t i = 0; i < 4 * quads; ++i) {
    const std::size_t column_size = quads == 4 ? 4 : 3;
    const std::size_t row = i % column_size, column = i / column_size;
    places[i] = kLanes * (by_rows ? i : row < 3 ? 4 * row + column : kMatrixFloats);
  }
  const float* instances[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    instances[lane] = batch.inputs.matrices + (lane < batch.count ? lane : batch.count - 1) * batch.instance_stride;
  }
  for (std::size_t bone = 0; bone < batch.bone_count; ++bone) {
    float* const out = batch.matrices + bone * kMatrixFloats * kLanes;
    for (std::size_t quad = 0; quad < quads; ++quad) {
      const std::size_t at = bone * batch.inputs.stride + 4 * quad;
      hn::Vec<decltype(d)> figures[4];
      const auto four_at = [&](std::size_t lane) -> const Sphere& {  // four figures, as a sphere has
        return *reinterpret_cast<const Sphere*>(instances[lane] + at);
      };
      load_spheres(d, four_at, figures[0], figures[1], figures[2], figures[3]);
      for (std::size_t i = 0; i < 4; ++i) {
        if (places[4 * quad + i] < kLanes * kMatrixFloats) {
          hn::Store(figures[i], d, out + places[4 * quad + i]);
        }
      }
    }
  }
}

// Fetches the matrices of the next call's instances into the cache, a few lines at each of `calls` calls.
class Fetcher {
 public:
  HWY_INLINE Fetcher(const LaneRefit& batch, std::size_t calls)
      : next_(batch.inputs.matrices + batch.count * batch.instance_stride),
        stride_(batch.instance_stride),
        size_((batch.bone_count - 1) * batch.inputs.stride + kMatrixFloats),
        left_(batch.next_count),
        step_((batch.next_count * (size_ / kLine + 1) + calls - 1) / calls) {}

  HWY_INLINE void fetch() {
    for (std::size_t i = 0; i < step_ && left_ > 0; ++i) {
      hwy::Prefetch(next_ + at_);
      at_ += kLine;
      if (at_ >= size_) {
        at_ = 0;
        next_ += stride_;
        --left_;
      }
    }
  }

 private:
  static constexpr std::size_t kLine = 16;  // floats
  const float* next_;
  std::size_t stride_, size_, left_, step_, at_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif
