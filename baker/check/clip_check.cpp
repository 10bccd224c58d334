// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/clip_check.h"

#include <algorithm>
#include <utility>

#include "baker/check/event_pictures.h"
#include "baker/page/clip_page.h"
#include "baker/page/page_axes.h"
#include "baker/page/page_motion.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kSampleSize = 1500;

}  // namespace

ClipChecker::ClipChecker(const AnimatedAsset& animated, const std::filesystem::path& source, Target target)
    : animated_(animated),
      axes_(page_axes(animated)),
      finder_(animated, target, axes_),
      pokes_(animated, source),
      picture_(animated.character().source_positions, animated.character().source_triangles, axes_) {
  animated.check_clusters();
}

// A motion may bring weights that the one before had not.
void ClipChecker::take_sample() {
  const std::vector<Vec3>& rest = animated_.character().source_positions;
  if (sample_weights_.empty() != animated_.weights().empty()) sample_.clear();
  if (!sample_.empty()) return;
  const std::size_t step = std::max<std::size_t>(1, rest.size() / kSampleSize);
  for (std::size_t v = 0; v < rest.size(); v += step) {
    sample_.push_back(rest[v]);
    if (!animated_.weights().empty()) sample_weights_.push_back(animated_.weights()[v]);
  }
}

ClipCheck ClipChecker::check(std::size_t index, const Progress& progress) {
  const ClipFrames& clip = animated_.clips()[index];
  take_sample();
  PageMotion motion(animated_.character(), axes_);
  ClipEvents found = finder_.find(clip, [&](int frame, const Deformation& pose) {
    progress(frame, clip.count);
    motion.add(pose, pose.positions.empty() ? deform(sample_, sample_weights_, pose.bones) : pose.positions);
    pokes_.look(clip, frame, pose);
  });
  PokeWatch::Found pokes = pokes_.take(clip);
  ClipCheck out;
  out.heat = heat_of(found, mm_per_unit(animated_.asset()));
  out.page = clip_page(animated_, clip, found, pokes.shown, motion);
  out.pictures = draw_events(animated_, clip, found, picture_);
  out.result.frames = clip.count - clip.between;
  out.result.between = clip.between;
  out.result.fps = clip.fps;
  out.result.loops = found.loops;
  out.result.unseen = std::move(found.unseen);
  out.result.events = std::move(found.events);
  out.result.pokes = std::move(pokes.events);
  return out;
}

}  // namespace spherechain::baker
