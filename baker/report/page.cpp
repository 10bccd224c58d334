// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "mesh/error.h"
#include "play/player.h"
#include "play/target.h"
#include "report/json_text.h"
#include "report/play_frames.h"
#include "report/report.h"
#include "report/vec3_json.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the page's arrays are little-endian");

// Base64 of an array's bytes.
template <typename T>
std::string base64(const std::vector<T>& values) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  const std::size_t size = values.size() * sizeof(T);
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= left ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

// The skin's weights in 16 bits; a vertex's sum stays exact.
ordered_json weights_json(const std::vector<VertexWeights>& weights) {
  std::size_t influences = 0;
  for (const VertexWeights& w : weights) {
    const auto used = std::count_if(w.weight.begin(), w.weight.end(), [](double x) { return x > 0; });
    influences = std::max(influences, static_cast<std::size_t>(used));
  }
  std::vector<std::uint16_t> joints, shares;
  for (const VertexWeights& w : weights) {
    const std::size_t first = shares.size();
    int left = w.weight[0] > 0 ? 65535 : 0;
    for (std::size_t k = 0; k < influences; ++k) {
      const int share = std::min(left, static_cast<int>(std::lround(w.weight[k] * 65535)));
      joints.push_back(static_cast<std::uint16_t>(w.joint[k]));
      shares.push_back(static_cast<std::uint16_t>(share));
      left -= share;
    }
    if (left > 0) shares[first] = static_cast<std::uint16_t>(shares[first] + left);
  }
  return {{"influences", influences}, {"joints", base64(joints)}, {"weights", base64(shares)}};
}

ordered_json mesh_json(const AnimatedAsset& animated) {
  const Character& character = animated.character();
  const OpenAsset& asset = animated.asset();
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : character.source_triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::vector<std::uint16_t> owner(character.source_triangles.size(), 0xFFFF);
  for (std::size_t i = 0; i < asset->spheres().size; ++i) {
    const RestSphere& sphere = asset->spheres()[i];
    for (std::uint32_t k = 0; k < sphere.triangle_count; ++k) {
      const std::uint32_t triangle = asset.triangles()[sphere.first_triangle + k];
      if (triangle < owner.size()) owner[triangle] = static_cast<std::uint16_t>(i);
    }
  }
  ordered_json out{{"positions", base64(pack(character.source_positions))},
                   {"triangles", base64(corners)},
                   {"owner", base64(owner)}};
  out.update(weights_json(animated.weights()));
  return out;
}

// F of the paper's section 3.2 over each sphere's surrounding region, at rest.
ordered_json sphere_f_json(const AnimatedAsset& animated) {
  const Character& character = animated.character();
  const OpenAsset& asset = animated.asset();
  ordered_json out = ordered_json::array();
  for (const RestSphere& sphere : asset->spheres()) {
    std::set<Index> vertices;
    for (std::uint32_t k = 0; k < sphere.triangle_count; ++k) {
      const std::uint32_t triangle = asset.triangles()[sphere.first_triangle + k];
      if (triangle >= character.source_triangles.size()) continue;
      vertices.insert(character.source_triangles[triangle].begin(), character.source_triangles[triangle].end());
    }
    const Vec3 center(sphere.center.x, sphere.center.y, sphere.center.z);
    double sum = 0, most = 0;
    for (const Index v : vertices) {
      const double f = std::abs(sphere.radius - (center - character.source_positions[v]).norm());
      sum += f;
      most = std::max(most, f);
    }
    const double mean = vertices.empty() ? 0 : sum / static_cast<double>(vertices.size());
    out.push_back({{"mean_abs_f", mean}, {"max_abs_f", most}});
  }
  return out;
}

// The pivots of each sphere as triangle numbers: corners tell which.
ordered_json pivot_triangles_json(const AnimatedAsset& animated) {
  const OpenAsset& asset = animated.asset();
  const std::vector<Triangle>& triangles = animated.character().source_triangles;
  ordered_json out = ordered_json::array();
  for (const RestSphere& sphere : asset->spheres()) {
    ordered_json numbers = ordered_json::array();
    for (std::uint32_t p = 0; p < sphere.pivot_count; ++p) {
      const Pivot& pivot = asset->pivots()[sphere.first_pivot + p];
      for (std::uint32_t k = 0; k < sphere.triangle_count; ++k) {
        const std::uint32_t t = asset.triangles()[sphere.first_triangle + k];
        if (t < triangles.size() && triangles[t] == Triangle{pivot.a, pivot.b, pivot.c}) {
          numbers.push_back(t);
          break;
        }
      }
    }
    out.push_back(std::move(numbers));
  }
  return out;
}

ordered_json parsed_or_null(const std::string& text) {
  return text.empty() ? ordered_json() : ordered_json::parse(text);
}

ordered_json ignored_json(const OpenAsset& asset) {
  ordered_json out = ordered_json::array();
  std::size_t bit = 0;
  for (std::size_t b = 1; b < asset->spheres().size; ++b) {
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      if (asset->ignored()[bit / 64] >> (bit % 64) & 1) out.push_back({a, b});
    }
  }
  return out;
}

// Throws where the page is too large: `still` bytes that are the same in however many frames, and `moving` of all of
// them.
void check_size(const AnimatedAsset& animated, double still, double moving, const PageOptions& options) {
  const double most = static_cast<double>(options.most_bytes);
  if (still + moving <= most) return;
  const int frames = animated.frame_count();
  const int fewer = still < most ? static_cast<int>(0.75 * frames * (most - still) / moving) : 0;
  throw Error(ExitCode::kUsage,
              fmt::format("{}: {} frames make a page of {:.1f} MB, of which browsers open {:.1f} MB ({})",
                          animated.file(), frames, (still + moving) / 1e6, most / 1e6,
                          fewer > 0 ? fmt::format("--frames {}", fewer) : "its mesh has too many triangles"));
}

// `still` is the size of the page without them.
ordered_json frames_json(const AnimatedAsset& animated, const PageOptions& options, double still,
                         const std::function<void(int)>& progress) {
  Player player(animated.asset(), options.radius, true, true, choose_target("auto"));
  std::vector<float> bones, vertices, spheres;
  ordered_json play = ordered_json::array();
  for (int i = 0; i < animated.frame_count(); ++i) {
    progress(i);
    const Deformation deformation = animated.deformation(i);
    for (const Affine& bone : deformation.bones) {
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) bones.push_back(static_cast<float>(bone.matrix()(row, column)));
      }
    }
    const std::vector<float> positions = pack(animated.positions(deformation));
    const FrameResult result = player.run(positions);
    // What is not linear in bones alone goes into the page as it is.
    if (!deformation.positions.empty() || !deformation.morphs.empty()) {
      vertices.insert(vertices.end(), positions.begin(), positions.end());
    }
    play.push_back(frame_json(animated, i, result, player));
    const std::vector<Sphere> fit = refit_spheres(animated.asset(), positions, SC_RADIUS_FIT),
                              detect = refit_spheres(animated.asset(), positions, SC_RADIUS_DETECT);
    for (std::size_t s = 0; s < fit.size(); ++s) {
      spheres.insert(spheres.end(), {fit[s].x, fit[s].y, fit[s].z, fit[s].radius, detect[s].radius});
    }
    // Base64 has four letters for three bytes; what `play` adds is not known yet.
    const double floats = static_cast<double>(spheres.size() + (vertices.empty() ? bones : vertices).size());
    check_size(animated, still, floats * sizeof(float) * 4 / 3 / (i + 1) * animated.frame_count(), options);
  }
  ordered_json out{{"count", animated.frame_count()},
                   {"fps", options.fps},
                   {"sphere_floats", 5},
                   {"spheres", base64(spheres)},
                   {"play", std::move(play)}};
  if (vertices.empty())
    out["bones"] = base64(bones);
  else
    out["vertices"] = base64(vertices);
  return out;
}

}  // namespace

std::string view_page(const AnimatedAsset& animated, const PageOptions& options,
                      const std::function<void(int)>& progress) {
  const std::string page = read_file(options.template_file);
  const std::string open = R"(<script id="spherechain-data" type="application/json">)", hole = "null</script>";
  const std::size_t at = page.find(open + hole);
  if (at == std::string::npos) {
    throw Error(ExitCode::kFile, options.template_file + ": is not the viewer's page (build it again)");
  }
  const BodyFrame frame = animated.frame();
  ordered_json data{{"title", options.title},
                    {"frame",
                     {{"origin", to_json(frame.origin)},
                      {"left", to_json(frame.left)},
                      {"up", to_json(frame.up)},
                      {"forward", to_json(frame.forward)},
                      {"height", frame.height}}},
                    {"mesh", mesh_json(animated)},
                    {"bones", animated.bone_names()},
                    {"inspect", ordered_json::parse(inspect_json(animated.asset()))},
                    {"sphere_f", sphere_f_json(animated)},
                    {"pivot_triangles", pivot_triangles_json(animated)},
                    {"ignored", ignored_json(animated.asset())},
                    {"report", parsed_or_null(options.report)},
                    {"validation", parsed_or_null(options.validation)},
                    {"motion", options.motion},
                    {"radius", options.radius == SC_RADIUS_FIT ? "fit" : "detect"}};
  const double still = static_cast<double>(page.size() + json_text(data, -1).size());
  data["frames"] = frames_json(animated, options, still, progress);
  std::string text = json_text(data, -1);
  // Nothing in it may end the script.
  for (std::size_t i = text.find('<'); i != std::string::npos; i = text.find('<', i)) text.replace(i, 1, "\\u003c");
  check_size(animated, still, static_cast<double>(page.size() + text.size()) - still, options);
  return page.substr(0, at) + open + text + page.substr(at + open.size() + std::string("null").size());
}

}  // namespace spherechain::baker
