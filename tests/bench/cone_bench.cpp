// SPDX-License-Identifier: GPL-3.0-or-later
// Goal P14: what a test of two cones costs, beside one of two spheres (docs/performance.md). First that the cones found
// are those of a plain loop, then how long both jobs take, in turns.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <stdexcept>

#include "character.h"
#include "pairs/cone.h"
#include "pairs/pair_bits.h"
#include "simd/simd.h"
#include "spherechain/detect.h"
#include "table.h"
#include "timing.h"

using namespace spherechain;
using namespace spherechain::bench;

namespace {

void check(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

// All links of the asset; or of every second sphere of a limb, and every second level of the torso.
std::vector<Pair> links_of(const Asset& asset) {
  std::vector<Pair> links(kMaxCones);
  links.resize(sc_chain_links(&asset, links.data(), links.size()));
  return links;
}

std::vector<Pair> half_of(const std::vector<Pair>& links) {
  std::vector<Pair> out;
  std::vector<bool> left_out(kMaxCones);
  for (const Pair& link : links) {
    if (left_out[link.a]) continue;
    // The link past the next one, if the run goes on.
    const auto next = std::find_if(links.begin(), links.end(), [&](const Pair& l) { return l.a == link.b; });
    out.push_back(next == links.end() ? link : Pair{link.a, next->b});
    if (next != links.end()) left_out[link.b] = true;
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

class ConeFinder {
 public:
  ConeFinder(const PosedCharacter& character, std::vector<Pair> links)
      : character_(character), links_(std::move(links)), table_(sc_cone_table_words(links_.size())) {
    std::vector<Sphere> rest;
    for (const RestSphere& s : character.view().spheres()) {
      rest.push_back({s.center.x, s.center.y, s.center.z, s.detect_radius});
    }
    check(sc_prepare_cones(&character.asset, nullptr, links_.data(), links_.size(), rest.data(), table_.data(),
                           table_.size()) == SC_OK,
          "a table of cones");
    pairs_.resize(pairs_of(links_.size()));
    job_.asset = &character.asset;
    job_.sphere_count = character.sphere_count();
    job_.table = table_.data();
    job_.pairs = pairs_.data();
    job_.pair_capacity = pairs_.size();
  }

  void find(std::size_t pose) {
    job_.spheres = character_.spheres[pose].data();
    check(job_.run() == SC_OK, "a timed job");
  }
  std::size_t tests() const { return pairs_of(links_.size()); }
  std::size_t links() const { return links_.size(); }

  // Of all poses: how many pairs there are, as the plain loop finds them.
  std::size_t checked() {
    std::size_t all = 0;
    const std::size_t stride = (links_.size() + 15) / 16 * 16;
    const float* const scales = reinterpret_cast<const float*>(table_.data() + table_.size()) - stride * links_.size();
    for (std::size_t pose = 0; pose < character_.spheres.size(); ++pose) {
      std::vector<Cone> cones;
      for (const Pair& l : links_)
        cones.push_back(cone_of(character_.spheres[pose][l.a], character_.spheres[pose][l.b]));
      find(pose);
      std::size_t found = 0;
      for (std::uint32_t a = 0; a < cones.size(); ++a) {
        for (std::uint32_t b = a + 1; b < cones.size(); ++b) {
          const float scale = scales[a * stride + b];
          if (!(scale >= 0) || !cones_touch(cones[a], cones[b], scale)) continue;
          check(found < job_.pair_count && pairs_[found] == Pair{a, b}, "a pair of cones that touch is not found");
          ++found;
        }
      }
      check(found == job_.pair_count, "a pair of cones is found that do not touch");
      all += found;
    }
    return all;
  }

 private:
  const PosedCharacter& character_;
  std::vector<Pair> links_, pairs_;
  std::vector<std::uint64_t> table_;
  ConeJob job_;
};

void run(std::size_t poses, int repetitions) {
  PosedCharacter human;
  load(human, "human", "{}", poses);
  const std::vector<Pair> all = links_of(human.asset);
  ConeFinder chains(human, all), half(human, half_of(all));

  std::vector<std::uint64_t> table(sc_detect_table_words(&human.asset));
  check(sc_prepare_detect(&human.asset, SC_RADIUS_DETECT, nullptr, table.data(), table.size()) == SC_OK, "a table");
  std::vector<Pair> pairs(pairs_of(human.sphere_count()));
  DetectJob spheres;
  spheres.asset = &human.asset;
  spheres.sphere_count = human.sphere_count();
  spheres.table = table.data();
  spheres.pairs = pairs.data();
  spheres.pair_capacity = pairs.size();

  fmt::print("{}\ntarget {}, {} repetitions, {} poses of assimp-testmodels' human.zae\n", machine(),
             sc_target_name(supported_targets()[0]), repetitions, poses);
  fmt::print("pairs of cones over all poses, equal to a plain loop's: {} of {} links, {} of {} links\n",
             chains.checked(), chains.links(), half.checked(), half.links());

  Timing timing(repetitions);
  timing.add("spheres", poses, [&](std::size_t i) {
    spheres.spheres = human.spheres[i].data();
    check(spheres.run() == SC_OK, "a timed job");
  });
  timing.add("cones", poses, [&](std::size_t i) { chains.find(i); });
  timing.add("half", poses, [&](std::size_t i) { half.find(i); });
  timing.run_all();
  const double a_sphere_test = timing.of("spheres").median / static_cast<double>(pairs.size());
  const auto print = [&](const char* name, const char* what, std::size_t count, std::size_t tests) {
    const double median = timing.of(name).median, one = median / static_cast<double>(tests);
    fmt::print("{:<28} {:>3} {:>8.0f} ns   {:6.3f} ns a test of {:>5}   {:5.2f} times a sphere test\n", what, count,
               median, one, tests, one / a_sphere_test);
  };
  print("spheres", "spheres", human.sphere_count(), pairs.size());
  print("cones", "cones along the chains", chains.links(), chains.tests());
  print("half", "cones past every second", half.links(), half.tests());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times tests of cones against tests of spheres: goal P14"};
  std::size_t poses = 1024;
  int repetitions = 31;
  app.add_option("--poses", poses, "Real poses, over eleven motions")->capture_default_str();
  app.add_option("--repetitions", repetitions, "Passes over the poses; medians are over these")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(poses, repetitions);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "spherechain_bench_cones: {}\n", error.what());
    return 1;
  }
}
