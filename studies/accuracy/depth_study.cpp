// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluates the runtime's depth, direction and volume on characters in motion, against brute force and CGAL: a table in
// Markdown, one row a character. docs/accuracy.md holds it.
//   depth_study [--list] [--judged N] CHARACTER[+MOTION]...
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "baker/mesh/error.h"
#include "baker/pipeline/pipeline.h"
#include "baker/play/play.h"
#include "baker/play/player.h"
#include "brute_force.h"
#include "corefinement.h"
#include "jobs.h"
#include "runtime/src/depth/sweep.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace {

using namespace spherechain::baker;
namespace quality = spherechain::quality;
using spherechain::Pair;
using spherechain::Penetration;

constexpr int kDirections = 40;
constexpr double kMarginMetres = 0.0005;
// Shallower ones are not evaluated. Files without a unit make giants and dwarfs: within parts of the height.
constexpr double kDeepMetres = 0.003, kDeepMin = 0.001, kDeepMax = 0.01;

struct Tally {
  std::map<spherechain::PenetrationClass, int> classes;
  int frames = 0, evaluated = 0, freed = 0, freed_early = 0, within = 0, steps = 0, flips = 0;
  int volumes = 0, volumes_within = 0;
  std::vector<double> us, quick;  // quick: that form's depth over the full one's

  void add(const Tally& other) {
    for (const auto& [kind, count] : other.classes) classes[kind] += count;
    frames += other.frames, evaluated += other.evaluated, freed += other.freed, freed_early += other.freed_early;
    within += other.within, steps += other.steps, flips += other.flips;
    volumes += other.volumes, volumes_within += other.volumes_within;
    us.insert(us.end(), other.us.begin(), other.us.end());
    quick.insert(quick.end(), other.quick.begin(), other.quick.end());
  }
};

std::string share(int part, int whole) { return whole == 0 ? "-" : fmt::format("{:.1f}", 100.0 * part / whole); }

double quantile(std::vector<double> values, double at) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(at * static_cast<double>(values.size() - 1))];
}

// Two parts of a pose, by the numbers of their triangles in Surface::triangles.
struct Posed {
  const spherechain::Surface& surface;
  const std::vector<float>& positions;
  std::vector<std::uint32_t> a, b;

  Posed(const OpenAsset& asset, const std::vector<float>& at, const Penetration& of)
      : surface(asset.surface()), positions(at) {
    for (std::uint32_t t = 0; t < surface.triangles.size; ++t) {
      if (surface.parts[t] == of.other) a.push_back(t);
      if (surface.parts[t] == of.part) b.push_back(t);
    }
  }
  spherechain::TriangleCorners corners(std::uint32_t triangle, const Vec3& move) const {
    spherechain::TriangleCorners out;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = surface.source_vertices[surface.triangle_vertices[3 * triangle + k]];
      const auto at = [&](std::size_t axis) {
        return static_cast<float>(double{positions[3 * v + axis]} + move[static_cast<Eigen::Index>(axis)]);
      };
      out.p[k] = {at(0), at(1), at(2)};
    }
    return out;
  }
  bool is_free(const spherechain::PairRule& rule, const Vec3& move) const {
    std::vector<spherechain::TriangleCorners> of_a;
    std::vector<std::array<float, 6>> boxes;
    const auto box = [](const spherechain::TriangleCorners& t) {
      std::array<float, 6> out;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = [&](int i) { return k == 0 ? t.p[i].x : k == 1 ? t.p[i].y : t.p[i].z; };
        out[k] = std::min({at(0), at(1), at(2)});
        out[k + 3] = std::max({at(0), at(1), at(2)});
      }
      return out;
    };
    for (const std::uint32_t t : a) {
      of_a.push_back(corners(t, Vec3::Zero()));
      boxes.push_back(box(of_a.back()));
    }
    for (const std::uint32_t t : b) {
      const spherechain::TriangleCorners own = corners(t, move);
      const std::array<float, 6> around = box(own);
      for (std::size_t i = 0; i < a.size(); ++i) {
        bool apart = false;
        for (std::size_t k = 0; k < 3; ++k) apart = apart || boxes[i][k] > around[k + 3] || boxes[i][k + 3] < around[k];
        if (!apart && rule.counts(a[i], t) && triangles_intersect(of_a[i], own)) return false;
      }
    }
    return true;
  }
  quality::Parts parts(const spherechain::PairRule& rule) const {
    const auto all = [&](const std::vector<std::uint32_t>& triangles) {
      std::vector<quality::Corners> out;
      for (const std::uint32_t t : triangles) {
        const spherechain::TriangleCorners c = corners(t, Vec3::Zero());
        quality::Corners own;
        for (int k = 0; k < 3; ++k) own.p[k] = {double{c.p[k].x}, double{c.p[k].y}, double{c.p[k].z}};
        out.push_back(own);
      }
      return out;
    };
    return {all(a), all(b), [this, rule](std::size_t i, std::size_t j) { return rule.counts(a[i], b[j]); }};
  }
};

class Study {
 public:
  Study(const std::string& character, int evaluated, bool list) : list_(list) {
    const std::size_t plus = character.find('+');
    mesh_ = character.substr(0, plus);
    MotionChoice motion;
    if (plus != std::string::npos) motion.motion = character.substr(plus + 1);
    const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("study{}.sphc", getpid());
    const Bake baked = bake(mesh_, make_settings("balanced", "{}", "study"), {});
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(baked.asset.data()), static_cast<std::streamsize>(baked.asset.size()));
    animated_.emplace(file.string(), mesh_, motion, FrameChoice{});
    std::filesystem::remove(file);
    run(evaluated);
  }
  const Tally& tally() const { return tally_; }

 private:
  void run(int evaluated) {
    const OpenAsset& asset = animated_->asset();
    const double unit = 1 / double{asset->info().metres_per_unit};
    // Files without a unit: giants are evaluated as if they were people.
    const double metre = std::min(unit, double{asset->info().height});
    Player player(asset, SC_RADIUS_DETECT, SC_TARGET_BEST);
    struct Found {
      int frame;
      Penetration what;
    };
    std::vector<Found> all;
    std::vector<Penetration> last;
    const double height = double{animated_->asset()->info().height};
    const double deep = std::clamp(kDeepMetres * metre, kDeepMin * height, kDeepMax * height);
    const auto is_fault = [&](const Penetration& p) {
      return p.kind >= SC_CLASS_DEEP_FOLD && p.part != p.other && double{p.measures.depth} >= deep;
    };
    for (int i = 0; i < animated_->frame_count(); ++i) {
      const bool is_next = i > 0 && animated_->frame_at(i).clip == animated_->frame_at(i - 1).clip;
      const std::vector<float> vertices = pack(animated_->positions(animated_->deformation(i)));
      const auto found = player.detect_triangles(pose_of(vertices), is_next);
      ++tally_.frames;
      for (const Penetration& p : found.penetrations) {
        ++tally_.classes[p.kind];
        tally_.us.push_back(found.measure_us / static_cast<double>(found.penetrations.size()));
        if (!is_fault(p)) continue;
        all.push_back({i, p});
        for (const Penetration& before : last) {
          if (!is_next || before.part != p.part || before.other != p.other || !is_fault(before)) continue;
          ++tally_.steps;
          const double turn = double{p.direction.x} * double{before.direction.x} +
                              double{p.direction.y} * double{before.direction.y} +
                              double{p.direction.z} * double{before.direction.z};
          if (turn < 0) {
            ++tally_.flips;
            if (list_) {
              fmt::print(stderr, "{} clip '{}' frame {}: {} - {}: {:.2f} mm, turned around from {:.2f} mm\n", mesh_,
                         animated_->clip_at(i), animated_->frame_at(i).number, animated_->asset()->part(p.part).name,
                         animated_->asset()->part(p.other).name, 1000 * double{p.measures.depth} / metre,
                         1000 * double{before.measures.depth} / metre);
            }
          }
        }
      }
      last = found.penetrations;
    }
    const std::size_t count = std::min(all.size(), static_cast<std::size_t>(evaluated));
    for (std::size_t k = 0; k < count; ++k) {
      const Found& found = all[k * all.size() / count];
      evaluate(found.frame, found.what, metre);
    }
  }

  void evaluate(int frame, const Penetration& what, double metre) {
    const OpenAsset& asset = animated_->asset();
    const std::vector<float> positions = pack(animated_->positions(animated_->deformation(frame)));
    const Posed posed(asset, positions, what);
    const spherechain::PairRule rule{&asset.surface(), asset->ignored(), {}, true, false};
    const Vec3 direction(double{what.direction.x}, double{what.direction.y}, double{what.direction.z});
    const double depth = double{what.distance}, margin = kMarginMetres * metre;
    const bool frees = posed.is_free(rule, (depth + margin) * direction);
    const bool frees_early = posed.is_free(rule, 0.9 * depth * direction);
    const quality::Parts parts = posed.parts(rule);
    const quality::Exit way = quality::shortest_way(parts, kDirections, margin);
    const double ratio = depth / way.depth;
    ++tally_.evaluated;
    tally_.freed += frees;
    tally_.freed_early += frees_early;
    tally_.within += ratio <= 1.25;
    tally_.quick.push_back(quick_depth(asset, positions, what) / depth);
    double volume_ratio = 0;
    const double millilitre = std::pow(0.01 * metre, 3);
    if (double{what.measures.volume} > 0.1 * millilitre) {
      const std::optional<double> volume = quality::common_volume(parts.a, parts.b);
      if (volume) {
        volume_ratio = double{what.measures.volume} / *volume;
        ++tally_.volumes;
        tally_.volumes_within += std::abs(volume_ratio - 1) <= 0.25;
      }
    }
    if (list_ && (!frees || frees_early || ratio > 1.25 || ratio < 0.8 ||
                  (volume_ratio > 0 && std::abs(volume_ratio - 1) > 0.25))) {
      fmt::print(stderr,
                 "{} clip '{}' frame {}: {} - {}: class {}, {:.2f} mm along ({:.2f} {:.2f} {:.2f}), {} {}need {:.2f} "
                 "mm along ({:.2f} {:.2f} {:.2f}); volume ratio {:.2f}\n",
                 mesh_, animated_->clip_at(frame), animated_->frame_at(frame).number, asset->part(what.part).name,
                 asset->part(what.other).name, sc_penetration_class_name(what.kind), 1000 * depth / metre,
                 direction.x(), direction.y(), direction.z(), frees ? "" : "does not free, ",
                 frees_early ? "frees early, " : "", 1000 * way.depth / metre, way.direction.x(), way.direction.y(),
                 way.direction.z(), volume_ratio);
    }
  }

  // The depth of the same parts, by the form for games.
  double quick_depth(const OpenAsset& asset, const std::vector<float>& positions, const Penetration& what) const {
    spherechain::SkinContactJob find;
    find.asset = asset.handle();
    find.pose.vertices = positions.data();
    find.pose.vertex_count = positions.size() / 3;
    const std::vector<spherechain::TriangleContact> contacts = spherechain::test::find_contacts(find).triangles;
    spherechain::PenetrationJob measure;
    measure.asset = find.asset;
    measure.pose = find.pose;
    measure.contacts = contacts.data();
    measure.contact_count = contacts.size();
    measure.quick = 1;
    for (const Penetration& found : spherechain::test::measure(measure, SC_TARGET_BEST)) {
      if (found.part == what.part && found.other == what.other) return double{found.measures.depth};
    }
    return 0;
  }

  std::string mesh_;
  bool list_;
  std::optional<AnimatedAsset> animated_;
  Tally tally_;
};

void print_row(const std::string& name, const Tally& t) {
  const auto of = [&](spherechain::PenetrationClass kind) {
    const auto found = t.classes.find(kind);
    return found == t.classes.end() ? 0 : found->second;
  };
  const auto volumes = t.volumes == 0 ? std::string("-") : fmt::format("{} of {}", t.volumes_within, t.volumes);
  fmt::print("| {} | {} | {} {} {} {} {} {} | {} | {} | {} | {} | {} | {} | {:.2f}, {:.2f} | {:.2f}, {:.2f} |\n", name,
             t.frames, of(SC_CLASS_REST), of(SC_CLASS_SHELL), of(SC_CLASS_TOUCH), of(SC_CLASS_FOLD),
             of(SC_CLASS_DEEP_FOLD), of(SC_CLASS_PENETRATION), t.evaluated, share(t.freed, t.evaluated),
             share(t.freed_early, t.evaluated), share(t.within, t.evaluated), share(t.flips, t.steps), volumes,
             quantile(t.quick, 0.5), quantile(t.quick, 0.9), quantile(t.us, 0.5) / 1000, quantile(t.us, 0.95) / 1000);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> characters;
  int evaluated = 40;
  bool list = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--list") == 0) {
      list = true;
    } else if (std::strcmp(argv[i], "--judged") == 0 && i + 1 < argc) {
      evaluated = std::atoi(argv[++i]);
    } else {
      characters.emplace_back(argv[i]);
    }
  }
  if (characters.empty()) {
    fmt::print(stderr, "usage: depth_study [--list] [--judged N] CHARACTER[+MOTION]...\n");
    return 2;
  }
  fmt::print(
      "| character | frames | rest, shell, touch, fold, deep fold, penetration | judged | frees | 0.9 frees | ≤ 1.25 | "
      "turns | volume | quick | ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  Tally total;
  for (const std::string& character : characters) {
    try {
      const Study study(character, evaluated, list);
      print_row(std::filesystem::path(character).filename().string(), study.tally());
      total.add(study.tally());
    } catch (const std::exception& error) {
      fmt::print(stderr, "depth_study: {}\n", error.what());
      return 3;
    }
  }
  print_row("all", total);
  return 0;
}
