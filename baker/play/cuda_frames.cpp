// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/cuda_frames.h"

#include "baker/mesh/error.h"

#if defined(SPHERECHAIN_CUDA)
#include "spherechain/cuda.h"
#endif

namespace spherechain::baker {

#if defined(SPHERECHAIN_CUDA)

namespace {

void check_cuda(Status status) {
  if (status != SC_OK) {
    throw Error(ExitCode::kInternal, std::string("--backend cuda: ") + to_string(status) + " (" +
                                         cuda::last_device_error() + "; --backend auto needs no GPU)");
  }
}

}  // namespace

CudaFrames play_on_cuda(const AnimatedAsset& animated, Radius radius) {
  const OpenAsset& asset = animated.asset();
  if (asset->bone_count() == 0 || asset->refit_rule() != RefitRule::kMoments) {
    throw Error(
        ExitCode::kFile,
        animated.file() + ": has no bones that its spheres can be refitted from (bake it with profile balanced)");
  }
  check_cuda(cuda::check_device());
  const auto count = static_cast<std::size_t>(animated.frame_count());
  std::vector<float> matrices;
  for (int i = 0; i < animated.frame_count(); ++i) {
    const std::vector<float> palette = bone_palette(asset, animated.deformation(i));
    matrices.insert(matrices.end(), palette.begin(), palette.end());
  }
  const std::size_t n = asset->spheres().size, most = n * (n - 1) / 2;
  std::vector<Sphere> spheres(n * count);
  std::vector<std::uint32_t> counts(count);
  std::vector<CrowdPair> pairs(most * count + 1);
  cuda::HostCrowd crowd;
  check_cuda(crowd.open(*asset.handle(), radius, nullptr, count, pairs.size()));
  crowd.pose.bones = matrices.data();
  crowd.pose.bone_count = asset->bone_count();
  crowd.pose.bone_layout = SC_ROWS_3X4;
  crowd.instance_count = count;
  crowd.spheres = spheres.data();
  crowd.counts = counts.data();
  crowd.pairs = pairs.data();
  check_cuda(crowd.run());  // the first launch loads the kernel
  check_cuda(crowd.run());
  CudaFrames out{std::vector<CudaFrame>(count), 1000.0 * crowd.device_milliseconds / static_cast<double>(count)};
  const CrowdPair* pair = pairs.data();
  for (std::size_t i = 0; i < count; ++i) {
    out.frames[i].spheres.assign(&spheres[i * n], &spheres[i * n] + n);
    for (std::uint32_t k = 0; k < counts[i]; ++k) out.frames[i].pairs.push_back((pair++)->pair);
  }
  return out;
}

#else

CudaFrames play_on_cuda(const AnimatedAsset&, Radius) {
  throw Error(
      ExitCode::kInternal,
      "--backend cuda: this build has no CUDA (configure with SPHERECHAIN_CUDA=ON; --backend auto needs no GPU)");
}

#endif

}  // namespace spherechain::baker
