// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 16, measured on another machine: what spherechain_figure16 wrote there.
#pragma once

#include <filesystem>
#include <string>

#include "table.h"

namespace spherechain::paper {

// figure16.csv: a row a number of spheres, animation, method and frame. Times in us: the kernel alone, with its launch,
// with the copies too; of a method on the CPU only the first. Empty where it was not run.
struct GpuTime {
  Table frames{"figure16",
               {"spheres", "parts", "animation", "method", "frame", "overlaps", "kernel_us", "launch_us", "frame_us"},
               {}};
  std::string machine;  // chip, CUDA, processor, date
  std::string command;
};

// Methods as the file names them.
inline constexpr const char *kGpuM1Chain = "gpu_m1_chain", *kGpuM1Sphere = "gpu_m1_sphere",
                            *kGpuM2Sphere = "gpu_m2_sphere", *kGpuEmpty = "gpu_empty", *kCpuM1 = "cpu_m1",
                            *kCpuM2 = "cpu_m2";

// Empty where there is no such file. Throws Error(kFile) that names it where it is another one.
GpuTime read_gpu_time(const std::filesystem::path& file);

// figure16_medians.csv: over the frames of both animations, a row a number of spheres and method.
Table gpu_medians(const GpuTime& time);

}  // namespace spherechain::paper
