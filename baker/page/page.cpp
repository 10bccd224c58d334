// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page.h"

#include <array>
#include <nlohmann/json.hpp>

#include "baker/page/base64.h"
#include "baker/page/fill_page.h"
#include "baker/page/from_runtime.h"
#include "baker/page/page_axes.h"
#include "baker/page/page_edits.h"
#include "baker/page/page_look.h"
#include "baker/page/page_mesh.h"
#include "baker/page/page_motion.h"
#include "baker/page/page_penetrations.h"
#include "baker/page/page_rig.h"
#include "baker/report/json_text.h"
#include "baker/report/report.h"
#include "baker/report/response_report.h"
#include "baker/volumes/volume_json.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

ordered_json parsed_or_null(const std::string& text) {
  return text.empty() ? ordered_json() : ordered_json::parse(text);
}

ordered_json spheres_json(const std::vector<PageSphere>& spheres) {
  ordered_json out = ordered_json::array();
  for (const PageSphere& sphere : spheres) {
    out.push_back({{"mean_abs_f", sphere.mean_abs_f}, {"max_abs_f", sphere.max_abs_f}, {"pivots", sphere.pivots}});
  }
  return out;
}

ordered_json clips_json(const AnimatedAsset& animated, const std::string& motion) {
  ordered_json out = ordered_json::array();
  for (const ClipFrames& clip : animated.clips()) {
    if (clip.count == 0) continue;
    out.push_back({{"name", clip.name.empty() ? motion : clip.name},
                   {"first", clip.first},
                   {"count", clip.count},
                   {"own_count", clip.own_count}});
  }
  return out;
}

// Each body's place at rest in source units, and which bone moves it.
ordered_json colliders_json(const Colliders& colliders) {
  ordered_json out = ordered_json::array();
  for (const ColliderBody& body : colliders.bodies) {
    ordered_json volumes = ordered_json::array();
    for (const Volume& volume : body.volumes) {
      Affine to_rest(body.rest);
      to_rest.prescale(1 / colliders.metres_per_unit);
      volumes.push_back(json_of(moved(volume, to_rest)));
    }
    out.push_back({{"part", body.name}, {"bone", body.bone_index}, {"volumes", volumes}});
  }
  return out;
}

// Pairs of bodies that overlap.
std::vector<std::array<std::uint16_t, 2>> collider_pairs_of(const Colliders& colliders,
                                                            const Deformation& deformation) {
  std::vector<std::array<std::uint16_t, 2>> out;
  for (const auto& [a, b] : overlapping(colliders, posed(colliders, deformation.bones))) {
    out.push_back({static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b)});
  }
  return out;
}

// `still` is the size of the page without them.
ordered_json frames_json(const AnimatedAsset& animated, const PageOptions& options, double still, PageMotion& motion,
                         const std::function<void(int)>& progress) {
  const int frames = animated.frame_count();
  PageFrames runtime(animated);
  std::vector<float> numbers, times, seconds, spheres;
  FrameLists<std::array<std::uint32_t, 2>> contacts;
  FrameLists<PenetrationEntry> penetrations;
  FrameLists<std::array<std::uint16_t, 2>> fit_pairs, detect_pairs, collider_pairs;
  for (int i = 0; i < frames; ++i) {
    progress(i);
    const Deformation as_animated = animated.deformation(i),
                      deformation = options.responder == nullptr ? as_animated : options.responder->respond(i);
    const std::vector<Vec3> positions = animated.positions(deformation);
    motion.add(deformation, positions);
    if (options.responder != nullptr) motion.add_animated(as_animated);
    const bool is_next = i > 0 && animated.frame_at(i).clip == animated.frame_at(i - 1).clip;
    const PageFrame frame = runtime.run(pack(positions), SkinPose(animated, deformation).pose(), is_next);
    numbers.push_back(static_cast<float>(animated.number(i)));
    seconds.push_back(static_cast<float>(animated.frame_at(i).seconds));
    times.push_back(static_cast<float>(animated.time(i)));
    spheres.insert(spheres.end(), frame.spheres.begin(), frame.spheres.end());
    contacts.add(frame.contacts);
    penetrations.add(entries_of(frame.penetrations, mm_per_unit(animated.asset())));
    fit_pairs.add(frame.fit_pairs);
    detect_pairs.add(frame.detect_pairs);
    if (options.colliders != nullptr) collider_pairs.add(collider_pairs_of(*options.colliders, deformation));
    // Base64 has four letters for three bytes.
    constexpr std::size_t kFigures = 10 * sizeof(float);  // times, counts and tests of a frame
    const std::size_t bytes = times.size() * kFigures + motion.bytes() + spheres.size() * sizeof(float) +
                              contacts.bytes() + penetrations.bytes() + fit_pairs.bytes() + detect_pairs.bytes();
    check_size(animated, still, static_cast<double>(bytes) * 4 / 3 / (i + 1) * frames, options);
  }
  return {{"count", frames},
          {"fps", options.fps},
          {"numbers", base64(numbers)},
          {"seconds", base64(seconds)},
          {"times", base64(times)},
          {"spheres", base64(spheres)},
          {"contacts", contacts.json()},
          {"penetrations", penetrations.json()},
          {"fit", fit_pairs.json()},
          {"detect", detect_pairs.json()},
          {"colliders", collider_pairs.json()}};
}

}  // namespace

std::string view_page(const AnimatedAsset& animated, const PageOptions& options,
                      const std::function<void(int)>& progress) {
  const PageTemplate page(options.template_file);
  const BodyFrame axes = page_axes(animated);
  const PageParts parts = page_parts(animated.asset());
  const std::vector<PageSphere> spheres = page_spheres(animated.asset(), animated.character());
  ordered_json data{{"title", options.title},
                    {"axes", axes_json(axes)},
                    {"parts", parts.names},
                    {"spheres", spheres_json(spheres)},
                    {"inspect", ordered_json::parse(inspect_json(animated.asset()))},
                    {"report", parsed_or_null(options.report)},
                    {"validation", parsed_or_null(options.validation)},
                    {"radius", options.radius == SC_RADIUS_FIT ? "fit" : "detect"},
                    {"clips", clips_json(animated, options.motion)},
                    {"rig", page_rig(animated)},
                    {"edits", page_edits(animated, spheres)},
                    {"colliders", options.colliders == nullptr ? ordered_json() : colliders_json(*options.colliders)},
                    {"mesh", page_mesh(animated, animated.character().source_positions, parts, spheres)}};
  if (!data["rig"].is_null() && page.has_runtime()) data["asset"] = base64(options.asset);
  const double still = static_cast<double>(page.size() + json_text(data, -1).size());
  PageMotion motion(animated.character(), axes);
  data["frames"] = frames_json(animated, options, still, motion, progress);
  if (options.responder != nullptr) data["response"] = response_json(options.responder->measures());
  data["motion"] = motion.json();
  data["mesh"] = page_mesh(animated, motion.rest(), parts, spheres);
  std::string html = page.fill(data);
  check_size(animated, still, static_cast<double>(html.size()) - still, options);
  return html;
}

std::string character_page(const AnimatedAsset& animated) {
  const PageParts parts = page_parts(animated.asset());
  const ordered_json all = ordered_json::parse(inspect_json(animated.asset()));
  const ordered_json data{{"axes", axes_json(page_axes(animated))},
                          {"parts", parts.names},
                          {"inspect",
                           {{"source", {{"metres_per_unit", animated.asset()->info().metres_per_unit}}},
                            {"regions", all["regions"]},
                            {"spheres", all["spheres"]},
                            {"chains", ordered_json::array()}}},
                          {"mesh", page_mesh(animated, animated.character().source_positions, parts, {})},
                          {"look", page_look(animated.look())}};
  return json_text(data, -1);
}

}  // namespace spherechain::baker
