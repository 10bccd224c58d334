// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/play/play.h"

namespace spherechain::baker {

struct CudaFrame {
  std::vector<Sphere> spheres;
  std::vector<Pair> pairs;
};

struct CudaFrames {
  std::vector<CudaFrame> frames;
  double us = 0;  // a frame, on the device: refit and detection in one
};

// All frames at once on the GPU, a character each, from bones. Throws Error(kInternal) where there is no CUDA device,
// or this build has no CUDA; Error(kFile) where the asset has no bones.
CudaFrames play_on_cuda(const AnimatedAsset& animated, Radius radius);

}  // namespace spherechain::baker
