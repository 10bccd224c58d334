// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 16.
#include <fmt/format.h>

#include <algorithm>

#include "figures.h"
#include "statistics.h"

namespace spherechain::paper {
namespace {

// Much longer than the rest of a panel, and the rest would be a line at its bottom.
constexpr double kTooLong = 10;

struct Drawn {
  const char* method;
  Colour colour;
};

Series over_counts(const Table& medians, const char* method, const char* column, Colour colour, Style style,
                   const std::string& label) {
  const Table t = medians.where("method", method);
  return {label, colour, style, t.numbers("spheres"), t.numbers(column)};
}

}  // namespace

std::string gpu_label(const std::string& method) {
  return method == kGpuM1Chain    ? "M1, a thread a chain"
         : method == kGpuM1Sphere ? "M1, a thread a sphere"
         : method == kGpuM2Sphere ? "M2, a thread a sphere"
         : method == kGpuEmpty    ? "an empty kernel"
         : method == kCpuM1       ? "M1 on the CPU"
         : method == kCpuM2       ? "M2 on the CPU"
                                  : method;
}

Figure gpu_time_figure(const Results& results) {
  Figure figure{"figure16",
                "The paper's kernels frame by frame, the kernel alone. Top: arms; bottom: legs. A kernel more than ten "
                "times as long as the others of its panel is left out: the next figure has it.",
                0,
                236,
                {}};
  const Table& all = results.gpu.frames;
  const Table medians = gpu_medians(results.gpu);
  const std::vector<double> counts = medians.where("method", kGpuM2Sphere).numbers("spheres");
  figure.columns = counts.size();
  for (const std::string& animation : all.words("animation")) {
    for (const double spheres : counts) {
      const Table one = all.where("animation", animation).where("spheres", spheres);
      Panel panel{fmt::format("{}, {:g} spheres", animation, spheres), "frame", "time (µs)", {}};
      panel.x_tick = 10;
      double least_median = 0;
      for (const Drawn& drawn : {Drawn{kGpuM2Sphere, Colour::kVermilion}, Drawn{kGpuM1Sphere, Colour::kBlue},
                                 Drawn{kGpuM1Chain, Colour::kGreen}}) {
        const Table t = one.where("method", drawn.method);
        const double time = median(t.numbers("kernel_us"));
        if (!panel.series.empty() && time > kTooLong * least_median) continue;
        least_median = panel.series.empty() ? time : std::min(least_median, time);
        panel.series.push_back({gpu_label(drawn.method), drawn.colour,
                                t.rows.size() > 1 ? Style::kLineAndMarks : Style::kMarks, t.numbers("frame"),
                                t.numbers("kernel_us")});
      }
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

Figure gpu_count_figure(const Results& results) {
  Figure figure{"figure16_counts",
                "Figure 16 over the number of spheres, medians over both animations. Left: the kernels alone; middle: "
                "with launch and copies; right: a thread a sphere with launch and copies beside one core of a "
                "CPU.",
                3,
                300,
                {}};
  const Table medians = gpu_medians(results.gpu);
  for (const auto& [column, title] :
       {std::pair("kernel_us", "the kernels alone (µs)"), std::pair("frame_us", "with launch and copies (µs)")}) {
    Panel panel{title, "spheres", "", {}};
    panel.log_axes = true;
    for (const Drawn& drawn : {Drawn{kGpuM2Sphere, Colour::kVermilion}, Drawn{kGpuM1Sphere, Colour::kBlue},
                               Drawn{kGpuM1Chain, Colour::kGreen}}) {
      panel.series.push_back(
          over_counts(medians, drawn.method, column, drawn.colour, Style::kLineAndMarks, gpu_label(drawn.method)));
    }
    panel.series.push_back(
        over_counts(medians, kGpuEmpty, column, Colour::kGrey, Style::kDashed, gpu_label(kGpuEmpty)));
    figure.panels.push_back(std::move(panel));
  }
  Panel cpu{"GPU and CPU (µs)", "spheres", "", {}};
  cpu.log_axes = true;
  cpu.series = {over_counts(medians, kGpuM2Sphere, "frame_us", Colour::kVermilion, Style::kLineAndMarks, ""),
                over_counts(medians, kGpuM1Sphere, "frame_us", Colour::kBlue, Style::kLineAndMarks, ""),
                over_counts(medians, kCpuM2, "kernel_us", Colour::kOrange, Style::kLineAndMarks, gpu_label(kCpuM2)),
                over_counts(medians, kCpuM1, "kernel_us", Colour::kPurple, Style::kLineAndMarks, gpu_label(kCpuM1))};
  figure.panels.push_back(std::move(cpu));
  return figure;
}

}  // namespace spherechain::paper
