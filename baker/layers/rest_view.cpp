// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/rest_view.h"

#include <cmath>
#include <cstdint>

#include "baker/layers/views.h"
#include "baker/os/parallel.h"

namespace spherechain::baker {

RestView look_at_rest(const LayeredSkin& skin, std::size_t turns, double pixel) {
  const std::size_t threads = thread_count();
  std::vector<SeenPixels> lenses(threads, SeenPixels(skin, pixel * skin.height));
  for (SeenPixels& lens : lenses) lens.clear();
  run_parallel(threads, turns, [&](std::size_t thread, std::size_t turn) {
    for (const Vec3& eye : view_directions(skin.up, turn)) lenses[thread].look(skin.rest.positions, eye);
  });
  RestView out{std::vector<double>(skin.rest.triangles.size()), std::vector<char>(skin.piece_count)};
  std::vector<std::int64_t> votes(skin.piece_count);
  for (const SeenPixels& lens : lenses) {
    for (std::size_t t = 0; t < out.seen.size(); ++t) {
      const auto [front, back] = lens.of_triangle()[t];
      out.seen[t] += front + back;
      votes[skin.piece[t]] += std::int64_t{front} - std::int64_t{back};
    }
  }
  const double views = static_cast<double>(turns * view_directions(skin.up, 0).size());
  for (std::size_t t = 0; t < out.seen.size(); ++t) {
    if (out.seen[t] > 0) out.seen[t] *= std::pow(pixel * skin.height, 2) / (views * triangle_area(skin.rest, t));
  }
  for (std::size_t p = 0; p < votes.size(); ++p) out.is_inverted[p] = votes[p] < 0;
  return out;
}

}  // namespace spherechain::baker
