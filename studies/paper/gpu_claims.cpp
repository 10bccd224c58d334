// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gpu_time.h"

namespace spherechain::paper {
namespace {

constexpr double kLead = 0.95;  // less of the other's time than that is a lead
constexpr double kMany = 10000, kAbout = 0.9;

Verdict without_gpu() { return {kNotRun, "Needs a GPU: spherechain_figure16."}; }

// The least of some methods' times at a sphere count; infinite where none of them was timed.
double fastest(const Table& medians, double spheres, const char* column, std::initializer_list<const char*> methods) {
  double out = std::numeric_limits<double>::infinity();
  for (const char* method : methods) {
    const Table t = medians.where("spheres", spheres).where("method", method);
    if (!t.empty() && !std::isnan(t.number(0, column))) out = std::min(out, t.number(0, column));
  }
  return out;
}

std::vector<double> counts_of(const Table& medians) {
  std::vector<double> out = medians.numbers("spheres");
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

Verdict evaluate_gpu_m1_faster(const Table& medians) {
  if (medians.empty()) return without_gpu();
  const auto is_stated = [&](double spheres) {
    return spheres == medians.number(nearest_count(medians, kSummedSpheres), "spheres") ||
           spheres == medians.number(nearest_count(medians, kStatedSpheres), "spheres");
  };
  std::size_t leads = 0, asked = 0;
  std::string finding;
  for (const auto& [column, name] :
       {std::pair("kernel_us", "the kernels alone"), std::pair("frame_us", "with launch and copies")}) {
    finding += fmt::format("{}M1 / M2, {}:", finding.empty() ? "" : " ", name);
    for (const double spheres : counts_of(medians)) {
      const double chain = fastest(medians, spheres, column, {kGpuM1Chain});
      const double place = fastest(medians, spheres, column, {kGpuM1Sphere});
      const double m2 = fastest(medians, spheres, column, {kGpuM2Sphere});
      finding += fmt::format(
          "{} {:.2f} at {:g} spheres ({:.1f} us with a thread a sphere of a chain, {:.1f} with a "
          "thread a chain, against {:.1f})",
          finding.back() == ':' ? "" : ",", std::min(chain, place) / m2, spheres, place, chain, m2);
      if (!is_stated(spheres)) continue;
      ++asked;
      leads += std::min(chain, place) < kLead * m2 ? 1 : 0;
    }
    finding += ".";
  }
  return {graded(leads == asked, leads > 0), finding};
}

Verdict evaluate_gpu_needs_many(const Table& medians) {
  if (medians.empty()) return without_gpu();
  bool behind_below = true, behind_first = false, ahead_last = false;
  std::string finding = "Fastest kernel with launch and copies against the faster of M1 and M2 on one core of the CPU:";
  const std::vector<double> counts = counts_of(medians);
  for (const double spheres : counts) {
    const double gpu = fastest(medians, spheres, "frame_us", {kGpuM1Chain, kGpuM1Sphere, kGpuM2Sphere});
    const double cpu = fastest(medians, spheres, "kernel_us", {kCpuM1, kCpuM2});
    const bool behind = gpu > cpu;
    if (spheres < kAbout * kMany) behind_below = behind_below && behind;
    if (spheres == counts.front()) behind_first = behind;
    if (spheres == counts.back()) ahead_last = !behind && spheres >= kAbout * kMany;
    finding += fmt::format("{} {:.1f} us against {:.1f} at {:g} spheres", spheres == counts.front() ? "" : ",", gpu,
                           cpu, spheres);
  }
  return {graded(behind_below && ahead_last, behind_first && ahead_last), finding + "."};
}

}  // namespace spherechain::paper
