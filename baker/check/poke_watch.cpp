// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/poke_watch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "baker/import/glb_file.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/os/child_process.h"

namespace spherechain::baker {
namespace {

constexpr double kFps = 5;
constexpr double kGap = 0.4;  // seconds
constexpr std::size_t kRestTurns = 2;
constexpr double kRestPixel = 1.0 / 400;
constexpr Index kNoPart = 255;

int step_of(const ClipFrames& clip) { return std::max(1, static_cast<int>(std::lround(clip.fps / kFps))); }

Index part_of(const PokeSpot& spot, const BodyParts& parts) {
  std::map<Index, double> areas;
  for (std::size_t i = 0; i < spot.triangles.size(); ++i) {
    if (parts.of_triangle[spot.triangles[i]] != kNoPart) areas[parts.of_triangle[spot.triangles[i]]] += spot.areas[i];
  }
  const auto most =
      std::max_element(areas.begin(), areas.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
  return most == areas.end() ? kNoPart : most->first;
}

}  // namespace

struct PokeWatch::Layers {
  std::vector<PrimitiveRun> runs;
  std::vector<std::string> names;  // of the runs
  LayeredSkin skin;
  RestView rest;
  std::vector<Cover> covers;
  PokeTest pokes;
  PokeFinder finder;

  Layers(const Character& character, const nlohmann::ordered_json& gltf)
      : runs(primitive_runs(character, gltf)),
        skin(make_layered_skin(character, runs, gltf)),
        rest(look_at_rest(skin, kRestTurns, kRestPixel)),
        covers(find_covers(skin, rest.is_inverted)),
        pokes(skin, rest.is_inverted, covers, character.rig),
        finder(skin, rest, covers, pokes, character.rig) {
    for (const PrimitiveRun& run : runs) names.push_back(run_name(run, gltf));
  }
};

PokeWatch::PokeWatch(const AnimatedAsset& animated, const std::filesystem::path& source) : animated_(animated) {
  const Character& character = animated.character();
  if (character.buffers.size() < 2 || character.rig.weights.empty()) return;
  try {
    layers_ = std::make_unique<Layers>(character, glb_of_bytes(read_as_glb(source), source.string()).json);
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    // Nobody knows its materials: what covers and what is glass.
    add_note(source.string() + ": is not looked at for skin that shows through clothes (" + error.what() + ")");
    return;
  }
  if (!layers_->finder.has_work()) layers_.reset();
  parts_ = body_parts_of(animated.asset());
}

PokeWatch::~PokeWatch() = default;

void PokeWatch::look(const ClipFrames& clip, int frame, const Deformation& pose) {
  const MotionFrame& at = animated_.frame_at(clip.first + frame);
  if (!layers_ || at.between > 0 || static_cast<int>(at.number) % step_of(clip) != 0) return;
  for (PokeSpot& spot : layers_->finder.find(animated_.positions(pose))) {
    const Index part = part_of(spot, parts_);
    spots_.push_back({frame, part, std::move(spot)});
  }
}

PokeWatch::Found PokeWatch::take(const ClipFrames& clip) {
  Found out;
  const double mm = mm_per_unit(animated_.asset());
  const auto frame_of = [&](std::size_t s) { return animated_.number(clip.first + spots_[s].frame); };
  struct One {
    PokeEvent event;
    PagePoke shown;
  };
  std::vector<One> all;
  for (const std::vector<std::size_t>& joined : join_spots(spots_, static_cast<int>(kGap * clip.fps))) {
    std::map<int, double> areas;  // by frame
    for (const std::size_t s : joined) areas[spots_[s].frame] += spots_[s].spot.area;
    const auto worst =
        std::max_element(areas.begin(), areas.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
    const FrameSpot& first = spots_[joined.front()];
    One& one = all.emplace_back();
    PokeEvent& event = one.event;
    event.pieces = {layers_->names[first.spot.inner], layers_->names[first.spot.outer]};
    if (first.part != kNoPart) event.part = parts_.parts[first.part].name;
    event.from = frame_of(joined.front());
    event.to = frame_of(joined.back());
    event.place = worst->first;
    event.area_cm2 = mm * mm / 100 * worst->second;
    double largest = 0;
    for (const std::size_t s : joined) {
      const auto& [frame, part, spot] = spots_[s];
      if (frame != worst->first) continue;
      event.worst = frame_of(s);
      event.height_mm = std::max(event.height_mm, mm * spot.height);
      one.shown.triangles.insert(one.shown.triangles.end(), spot.triangles.begin(), spot.triangles.end());
      if (spot.area <= largest) continue;
      largest = spot.area;
      event.point = spot.point;
      event.eye = spot.eye;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      const PrimitiveRun& run = layers_->runs[side == 0 ? first.spot.inner : first.spot.outer];
      one.shown.pieces[side] = {run.first, run.count};
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const One& l, const One& r) { return l.event.area_cm2 > r.event.area_cm2; });
  for (One& one : all) {
    out.events.push_back(std::move(one.event));
    out.shown.push_back(std::move(one.shown));
  }
  spots_.clear();
  return out;
}

}  // namespace spherechain::baker
