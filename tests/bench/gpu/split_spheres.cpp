// SPDX-License-Identifier: MIT
#include "split_spheres.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "runtime/src/base/pair_bits.h"
#include "tiny_asset.h"

namespace spherechain::bench {
namespace {

// The plastic number's powers: their multiples' fractions fill a square evenly.
constexpr double kAround = 0.7548776662466927, kUp = 0.5698402909980532, kTurn = 6.283185307179586;

// Spheres that open() takes; nobody refits them.
void add_spheres(const AssetView& whole, std::uint32_t parts, test::AssetParts& out) {
  out = test::random_asset(1, 1).parts;
  RestSphere part = out.spheres[0];
  part.triangle_count = 0;
  const std::vector<Pivot> pivots = out.pivots;
  out.spheres.clear();
  out.pivots.clear();
  for (std::size_t i = 0; i < whole.spheres().size * parts; ++i) {
    part.first_pivot = static_cast<std::uint32_t>(out.pivots.size());
    out.spheres.push_back(part);
    out.pivots.insert(out.pivots.end(), pivots.begin(), pivots.end());
  }
}

void add_pairs(const AssetView& whole, std::uint32_t parts, test::AssetParts& out) {
  const std::size_t n = out.spheres.size();
  out.ignored.assign(words_for(pairs_of(n)), 0);
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (a / parts == b / parts || test_bit(whole.ignored(), ignored_bit(a / parts, b / parts))) {
        set_bit({out.ignored.data(), out.ignored.size()}, ignored_bit(a, b));
      }
    }
  }
  out.rest_detect.clear();
  out.rest_fit.clear();
  const Span<const RestPair> rest = whole.rest_pairs(SC_RADIUS_FIT);
  for (std::size_t first = 0, last = 0; first < rest.size; first = last) {
    while (last < rest.size && rest[last].a == rest[first].a) {
      ++last;
    }
    for (std::uint32_t i = 0; i < parts; ++i) {
      for (std::size_t pair = first; pair < last; ++pair) {
        for (std::uint32_t j = 0; j < parts; ++j) {
          out.rest_fit.push_back({parts * rest[pair].a + i, parts * rest[pair].b + j, rest[pair].rest_scale});
        }
      }
    }
  }
}

void add_chains(const AssetView& whole, std::uint32_t parts, test::AssetParts& out) {
  out.chains.clear();
  for (std::size_t c = 0; c < whole.chain_count(); ++c) {
    const ChainView chain = whole.chain(c);
    test::ChainEntry split{chain.name, {}, {}};
    for (const std::uint32_t sphere : chain.spheres) {
      for (std::uint32_t i = 0; i < parts; ++i) {
        split.spheres.push_back(parts * sphere + i);
      }
    }
    out.chains.push_back(std::move(split));
  }
}

}  // namespace

SplitAsset::SplitAsset(const Asset& whole, std::uint32_t parts)
    : radius_(static_cast<float>(1 / std::cbrt(static_cast<double>(parts)))) {
  const AssetView& view = view_of(whole);
  if (parts == 0 || view.spheres().size > kMaxSphereCount / parts) {
    throw std::runtime_error("spheres in " + std::to_string(parts) + " parts: none, or more than an asset may have");
  }
  for (std::uint32_t i = 0; i < parts; ++i) {
    // As dense everywhere in the ball that keeps the parts inside.
    const double height = 1 - 2 * std::fmod(kUp * i, 1.0), angle = kTurn * std::fmod(kAround * i, 1.0);
    const double ring = std::sqrt(1 - height * height);
    const double far = std::cbrt((i + 0.5) / parts) * (1 - static_cast<double>(radius_));
    offsets_.push_back({static_cast<float>(far * ring * std::cos(angle)), static_cast<float>(far * height),
                        static_cast<float>(far * ring * std::sin(angle))});
  }
  test::AssetParts all;
  add_spheres(view, parts, all);
  add_pairs(view, parts, all);
  add_chains(view, parts, all);
  bytes_ = test::build(all);
  char message[160] = "";
  if (sc_asset_open(&asset_, SC_ABI_VERSION, bytes_.data(), bytes_.size(), message, sizeof message) != SC_OK) {
    throw std::runtime_error("spheres in " + std::to_string(parts) + " parts: " + message);
  }
}

std::vector<Sphere> SplitAsset::split(const std::vector<Sphere>& spheres) const {
  std::vector<Sphere> out;
  out.reserve(spheres.size() * offsets_.size());
  for (const Sphere& s : spheres) {
    for (const Offset& o : offsets_) {
      out.push_back({s.x + s.radius * o.x, s.y + s.radius * o.y, s.z + s.radius * o.z, s.radius * radius_});
    }
  }
  return out;
}

}  // namespace spherechain::bench
