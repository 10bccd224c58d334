// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/mask_page.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/motion/clip.h"
#include "baker/motion/frame_times.h"
#include "baker/page/base64.h"
#include "baker/page/fill_page.h"
#include "baker/page/page_axes.h"
#include "baker/page/page_look.h"
#include "baker/page/page_mesh.h"
#include "baker/page/page_motion.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr double kFps = 30;
constexpr double kPageFramesMax = 3000;  // of all clips: more would make the page slow to open

enum class Layer : std::uint8_t { kOpen, kKept, kHidden };  // nothing covers it; covered, and stays; hidden

// The file's axes: without a bake nothing says where the character looks.
BodyFrame axes_of(const LayeredSkin& skin) {
  BodyFrame axes;
  axes.up = skin.up;
  const Vec3 side = std::abs(skin.up.x()) < 0.5 ? Vec3::UnitX() : Vec3::UnitY();
  axes.forward = side.cross(skin.up).normalized();
  axes.left = skin.up.cross(axes.forward);
  axes.height = skin.height;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : skin.rest.positions) box.extend(p);
  axes.origin = box.center() - skin.height / 2 * skin.up;
  return axes;
}

std::vector<std::uint8_t> layers_of(const HiddenSkin& hidden) {
  std::vector<std::uint8_t> out;
  for (std::size_t t = 0; t < hidden.is_hidden.size(); ++t) {
    const Layer layer = hidden.is_hidden[t] != 0    ? Layer::kHidden
                        : hidden.is_covered[t] != 0 ? Layer::kKept
                                                    : Layer::kOpen;
    out.push_back(static_cast<std::uint8_t>(layer));
  }
  return out;
}

ordered_json mask_json(const HiddenSkin& hidden) {
  const auto all = static_cast<double>(hidden.is_hidden.size());
  return {{"hidden", hidden.hidden},
          {"hidden_percent", 100 * static_cast<double>(hidden.hidden) / all},
          {"area_percent", hidden.area > 0 ? 100 * hidden.hidden_area / hidden.area : 0},
          {"layers", base64(layers_of(hidden))}};
}

// As many frames a second as the page can hold.
double page_fps(const std::vector<Clip>& clips) {
  double seconds = 0;
  for (const Clip& clip : clips) seconds += clip.duration;
  return std::min(kFps, kPageFramesMax / std::max(seconds, 1.0));
}

// Adds `clips`, `frames` and `motion`.
void add_frames(const Character& character, const std::vector<Clip>& clips, PageMotion& motion, ordered_json& data,
                const std::function<void(int, int)>& progress) {
  const double fps = page_fps(clips);
  int all = 0, first = 0;
  for (const Clip& clip : clips) all += frames_in(clip.duration, fps);
  std::vector<float> numbers, seconds, times;
  ordered_json& out = data["clips"] = ordered_json::array();
  for (const Clip& clip : clips) {
    const int count = frames_in(clip.duration, fps);
    for (int f = 0; f < count; ++f) {
      progress(first + f, all);
      const Deformation pose = sample(character.rig, clip, f / fps);
      motion.add(pose, deform(morph(character.source_positions, character.rig.morphs, pose.morphs),
                              character.rig.weights, pose.bones));
      numbers.push_back(static_cast<float>(f));
      seconds.push_back(static_cast<float>(f / fps));
      times.push_back(static_cast<float>((first + f) / fps));
    }
    out.push_back({{"name", clip.name}, {"first", first}, {"count", count}, {"own_count", count}});
    first += count;
  }
  data["frames"] = {{"count", all},
                    {"fps", fps},
                    {"numbers", base64(numbers)},
                    {"seconds", base64(seconds)},
                    {"times", base64(times)}};
  data["motion"] = motion.json();
}

}  // namespace

std::string mask_page(const Character& character, const LayeredSkin& skin, const std::vector<Clip>& clips,
                      const HiddenSkin& hidden, const MaskPage& page, const std::function<void(int, int)>& progress) {
  const PageTemplate html(page.template_file);
  const BodyFrame axes = axes_of(skin);
  PageParts parts{page.mesh_names, {}};
  for (const Index run : skin.run)
    parts.of_triangle.push_back(static_cast<std::uint8_t>(std::min<Index>(run, kNoPart)));
  ordered_json data{{"title", page.title},
                    {"axes", axes_json(axes)},
                    {"parts", parts.names},
                    {"inspect",
                     {{"source", {{"metres_per_unit", character.metres_per_unit}}},
                      {"regions", ordered_json::array()},
                      {"spheres", ordered_json::array()},
                      {"chains", ordered_json::array()}}},
                    {"radius", "detect"},
                    {"mask", mask_json(hidden)}};
  const bool has_look = page.look.uvs.size() == character.source_positions.size() &&
                        page.look.material_of.size() == character.source_triangles.size();
  if (has_look) data["look"] = page_look(page.look);
  PageMotion motion(character, axes);
  add_frames(character, clips, motion, data, progress);
  data["mesh"] = page_mesh(motion.rest(), character.source_triangles, character.rig.weights, parts, {});
  return html.fill(data);
}

}  // namespace spherechain::baker
