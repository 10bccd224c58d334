// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mask/find_hidden.h"

#include <algorithm>
#include <mutex>

#include "baker/calibrate/random_poses.h"
#include "baker/layers/poke_finder.h"
#include "baker/layers/rest_view.h"
#include "baker/layers/views.h"
#include "baker/mesh/surface_query.h"
#include "baker/motion/clip.h"
#include "baker/motion/frame_times.h"
#include "baker/os/parallel.h"

namespace spherechain::baker {
namespace {

constexpr int kFramesMax = 45;  // of a clip
constexpr std::uint64_t kSeed = 1;
constexpr double kFps = 30;
constexpr double kPixel = 1.0 / 400;      // of the height
constexpr double kRestPixel = 1.0 / 800;  // at rest no pixel may change
constexpr std::size_t kRestTurns = 8;     // of the views
constexpr double kSeenShare = 2e-4;       // of a triangle's area, on average over frames and views: less is not seen

// A moment of a clip; without one, a pose of its own.
struct Frame {
  const Clip* clip;
  double seconds;
  Deformation pose;
};

std::vector<Frame> frames_of(const std::vector<Clip>& clips) {
  std::vector<Frame> out;
  for (const Clip& clip : clips) {
    const int count = std::min(frames_in(clip.duration, kFps), kFramesMax);
    for (int f = 0; f < count; ++f) out.push_back({&clip, count > 1 ? clip.duration * f / (count - 1) : 0, {}});
  }
  return out;
}

// Draws poses within the limits of the clips: moments mixed from limb to limb, and joints turned at random.
void add_random_poses(const Character& character, int count, std::vector<Frame>& frames) {
  const RandomPoses poses(character, {});
  Random random(kSeed);
  for (int i = 0; poses.any() && i < count; ++i) {
    RandomPoses::Pose pose = poses.next(random, 1 + i % 2, 0);
    frames.push_back({nullptr, 0, {std::move(pose.bones), std::move(pose.morphs), {}}});
  }
}

// The pixels and the poke-through of each triangle, summed over all frames.
struct Shown {
  std::vector<std::uint64_t> pixels;  // in all views; none of skin that comes through its cover
  std::vector<double> poke_areas;     // of skin that shows through another primitive
};

Shown look_at_frames(const Character& character, const LayeredSkin& skin, const PokeTest& pokes,
                     const PokeFinder& finder, const std::vector<Frame>& frames,
                     const std::function<void(int, int)>& progress) {
  const std::size_t threads = thread_count();
  std::vector<SeenPixels> lenses(threads, SeenPixels(skin, kPixel * skin.height));
  const std::size_t triangles = skin.rest.triangles.size();
  std::vector<Shown> shown(threads, {std::vector<std::uint64_t>(triangles), std::vector<double>(triangles)});
  std::mutex mutex;
  int done = 0;
  run_parallel(threads, frames.size(), [&](std::size_t thread, std::size_t f) {
    const Frame& frame = frames[f];
    const Deformation pose = frame.clip == nullptr ? frame.pose : sample(character.rig, *frame.clip, frame.seconds);
    const std::vector<Vec3> positions =
        deform(morph(skin.rest.positions, character.rig.morphs, pose.morphs), character.rig.weights, pose.bones);
    SeenPixels& lens = lenses[thread];
    lens.clear();
    for (const Vec3& eye : view_directions(skin.up, f)) lens.look(positions, eye);
    const std::vector<Vec3> normals = pokes.normals(positions);
    for (Index t = 0; t < triangles; ++t) {
      const auto [front, back] = lens.of_triangle()[t];
      if (front + back > 0 && !pokes.is_through(t, positions, normals)) shown[thread].pixels[t] += front + back;
    }
    if (finder.has_work()) {
      for (const PokeSpot& spot : finder.find(positions)) {
        for (std::size_t i = 0; i < spot.triangles.size(); ++i) {
          shown[thread].poke_areas[spot.triangles[i]] += spot.areas[i];
        }
      }
    }
    const std::lock_guard lock(mutex);
    progress(++done, static_cast<int>(frames.size()));
  });
  for (std::size_t one = 1; one < threads; ++one) {
    for (std::size_t t = 0; t < triangles; ++t) {
      shown[0].pixels[t] += shown[one].pixels[t];
      shown[0].poke_areas[t] += shown[one].poke_areas[t];
    }
  }
  return shown[0];
}

// The covered triangles and those around them, as far as nobody sees them.
std::vector<char> unseen_skin(const LayeredSkin& skin, const std::vector<Cover>& covers,
                              const std::vector<char>& is_seen) {
  std::vector<char> out(covers.size()), touches(skin.welded.positions.size());
  for (std::size_t t = 0; t < out.size(); ++t) {
    if (covers[t].triangle == kNoIndex || is_seen[t] != 0) continue;
    out[t] = 1;
    for (const Index v : skin.welded.triangles[t]) touches[v] = 1;
  }
  for (std::size_t t = 0; t < out.size(); ++t) {
    const Triangle& corners = skin.welded.triangles[t];
    const bool is_near = std::any_of(corners.begin(), corners.end(), [&](Index v) { return touches[v] != 0; });
    if (is_near && is_seen[t] == 0 && skin.is_opaque[t] != 0) out[t] = 1;
  }
  return out;
}

// Takes out of `unseen` what lies within `margin` of seen skin of the same piece. Returns how many triangles.
std::size_t keep_edges(const LayeredSkin& skin, double margin, std::vector<char>& unseen) {
  struct Piece {
    std::vector<Index> hidden, shown;
  };
  std::vector<Piece> pieces(skin.piece_count);
  for (Index t = 0; t < unseen.size(); ++t) {
    Piece& piece = pieces[skin.piece[t]];
    (unseen[t] != 0 ? piece.hidden : piece.shown).push_back(t);
  }
  std::size_t kept = 0;
  for (const Piece& piece : pieces) {
    if (piece.hidden.empty() || piece.shown.empty()) continue;
    const SurfaceQuery shown(skin.rest, piece.shown);
    run_parallel(thread_count(), piece.hidden.size(), [&](std::size_t, std::size_t i) {
      const Index t = piece.hidden[i];
      if (shown.closest(triangle_centroid(skin.rest, t)).distance < margin * skin.height) unseen[t] = 0;
    });
    kept += static_cast<std::size_t>(
        std::count_if(piece.hidden.begin(), piece.hidden.end(), [&](Index t) { return unseen[t] == 0; }));
  }
  return kept;
}

}  // namespace

HiddenSkin find_hidden(const Character& character, const LayeredSkin& skin, const std::vector<Clip>& clips,
                       int random_poses, double margin, const std::function<void(int, int)>& progress) {
  const RestView rest = look_at_rest(skin, kRestTurns, kRestPixel);
  const std::vector<Cover> covers = find_covers(skin, rest.is_inverted);
  const PokeTest pokes(skin, rest.is_inverted, covers, character.rig);
  std::vector<Frame> frames = frames_of(clips);
  add_random_poses(character, random_poses, frames);
  const PokeFinder finder(skin, rest, covers, pokes, character.rig);
  const Shown shown = look_at_frames(character, skin, pokes, finder, frames, progress);
  const double views = static_cast<double>(frames.size() * view_directions(skin.up, 0).size());
  const double pixel_area = kPixel * kPixel * skin.height * skin.height;
  HiddenSkin out;
  std::vector<char> is_seen(skin.rest.triangles.size());
  const std::vector<Vec3> normals = pokes.normals(skin.rest.positions);
  for (std::size_t t = 0; t < is_seen.size(); ++t) {
    const double area = triangle_area(skin.rest, t);
    out.area += area;
    out.is_covered.push_back(covers[t].triangle != kNoIndex ? 1 : 0);
    is_seen[t] = rest.seen[t] > 0;
    if (is_seen[t] != 0 && pokes.is_through(static_cast<Index>(t), skin.rest.positions, normals)) is_seen[t] = 0;
    if (static_cast<double>(shown.pixels[t]) * pixel_area > kSeenShare * area * views) is_seen[t] = 1;
  }
  out.is_hidden = unseen_skin(skin, covers, is_seen);
  out.near_edge = keep_edges(skin, margin, out.is_hidden);
  for (std::size_t t = 0; t < is_seen.size(); ++t) {
    out.poke_area += shown.poke_areas[t];
    if (out.is_hidden[t] == 0) continue;
    out.poke_hidden_area += shown.poke_areas[t];
    ++out.hidden;
    out.hidden_area += triangle_area(skin.rest, t);
  }
  out.frames = static_cast<int>(frames.size());
  return out;
}

}  // namespace spherechain::baker
