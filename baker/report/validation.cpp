// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kWorstMisses = 20;

const char* radius_name(RadiusKind radius) { return radius == RadiusKind::kFit ? "fit" : "detect"; }
const char* method_name(Method method) { return method == Method::kM1 ? "m1" : "m2"; }

std::size_t shown_misses(const Validation& validation) { return std::min(validation.misses.size(), kWorstMisses); }

}  // namespace

std::string validation_json(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings) {
  const double height = animated.frame().height;
  const Score& score = validation.score;
  ordered_json out{
      {"frames", score.frames},
      {"raw_pairs", validation.raw_pairs},
      {"out_of_scope",
       {{"rest", validation.rest}, {"same_sphere", validation.same_sphere}, {"ignored", validation.ignored}}},
      {"truth_pairs", score.true_pairs},
      {"pair_recall", score.pair_recall()},
      {"frame_any_recall", score.frame_any_recall()},
      {"frame_all_recall", score.frame_all_recall()},
      {"precision", score.precision()},
      {"reported_per_frame", score.reported_per_frame()},
      {"missed_depth", score.missed_depth / height},
      {"radius", radius_name(settings.radius)},
      {"mode", method_name(settings.method)},
      {"truth_frames", score.true_frames},
      {"degenerate_triangles", validation.degenerate},
  };
  out["worst_misses"] = ordered_json::array();
  for (std::size_t i = 0; i < shown_misses(validation); ++i) {
    const Miss& miss = validation.misses[i];
    out["worst_misses"].push_back({{"frame", miss.frame},
                                   {"time", animated.time(miss.frame)},
                                   {"spheres", {miss.spheres.a, miss.spheres.b}},
                                   {"triangle_pairs", miss.triangle_pairs},
                                   {"depth", miss.depth / height}});
  }
  return out.dump(1) + "\n";
}

std::string validation_text(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings) {
  const double height = animated.frame().height;
  const Score& score = validation.score;
  std::string out = fmt::format("{} frames, radius {}, {}\n\n", score.frames, radius_name(settings.radius),
                                settings.method == Method::kM1 ? "M1" : "M2");
  out += fmt::format("triangle pairs that intersect   {:>8}\n", validation.raw_pairs);
  out += fmt::format("  at rest too                   {:>8}\n", validation.rest);
  out += fmt::format("  of one sphere                 {:>8}\n", validation.same_sphere);
  out += fmt::format("  of ignored spheres            {:>8}\n", validation.ignored);
  out += fmt::format("  true                          {:>8}  in {} frames\n\n", score.true_pairs, score.true_frames);
  out += fmt::format("pair recall      {:.4f}\n", score.pair_recall());
  out += fmt::format("frame recall     {:.4f} any, {:.4f} all\n", score.frame_any_recall(), score.frame_all_recall());
  out += fmt::format("precision        {:.4f}\n", score.precision());
  out += fmt::format("reported         {:.2f} pairs a frame\n", score.reported_per_frame());
  out += fmt::format("missed depth     {:.2f} % of the height\n", 100 * score.missed_depth / height);
  if (!validation.misses.empty()) out += "\nworst misses: frame, spheres, triangle pairs, depth in % of the height\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(shown_misses(validation), 5); ++i) {
    const Miss& miss = validation.misses[i];
    out += fmt::format("  {:>5}  {:>3} - {:<3} {:>5}  {:.2f}\n", miss.frame, miss.spheres.a, miss.spheres.b,
                       miss.triangle_pairs, 100 * miss.depth / height);
  }
  return out;
}

}  // namespace spherechain::baker
