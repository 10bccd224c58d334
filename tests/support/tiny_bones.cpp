// SPDX-License-Identifier: MIT
#include "tiny_bones.h"

#include <algorithm>
#include <map>

namespace spherechain::test {
namespace {

constexpr std::uint32_t kMorphCount = 3, kIdleMorph = 1;

TinySkin random_skin(std::size_t vertex_count, std::size_t bone_count, std::mt19937& random) {
  TinySkin skin;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    std::map<std::uint32_t, double> weights;
    if (random() % 8 == 0 || bone_count == 1) {
      weights[static_cast<std::uint32_t>(bone_count - 1)] = 1;  // moved by no bone
    } else {
      double sum = 0;
      for (std::size_t k = 0; k < 1 + random() % 3; ++k) {
        const double weight = uniform(random, 0.1F, 1.0F);
        weights[static_cast<std::uint32_t>(random() % (bone_count - 1))] += weight;
        sum += weight;
      }
      for (auto& [bone, weight] : weights) {
        weight /= sum;
      }
    }
    skin.weights.emplace_back(weights.begin(), weights.end());
    skin.morphs.emplace_back();
    for (std::uint32_t m = 0; m < kMorphCount; ++m) {
      const auto delta = [&] { return uniform(random, -0.1F, 0.1F); };
      if (m != kIdleMorph && random() % 3 == 0) {
        skin.morphs.back().push_back({m, {delta(), delta(), delta()}});
      }
    }
  }
  return skin;
}

struct Sums {
  std::array<std::array<double, kPivotLanes>, 4> q{};
  std::map<std::uint32_t, std::array<std::array<double, kPivotLanes>, 3>> morphs;
};

void add_corner(const TinyAsset& tiny, const TinySkin& skin, std::uint32_t v, std::size_t lane,
                std::map<std::uint32_t, Sums>& terms) {
  for (const auto& [bone, weight] : skin.weights[v]) {
    Sums& sums = terms[bone];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sums.q[axis][lane] += weight * double{tiny.rest[3 * v + axis]} / 3;
    }
    sums.q[3][lane] += weight / 3;
    for (const auto& [target, delta] : skin.morphs[v]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sums.morphs[target][axis][lane] += weight * double{delta[axis]} / 3;
      }
    }
  }
}

void store(const std::array<double, kPivotLanes>& from, float (&to)[kPivotLanes]) {
  std::transform(from.begin(), from.end(), to, [](double value) { return static_cast<float>(value); });
}

void add_group(const TinyAsset& tiny, const TinySkin& skin, std::size_t first, std::size_t count, BoneRefitParts& out) {
  std::map<std::uint32_t, Sums> terms;
  out.weights.push_back({});
  for (std::size_t lane = 0; lane < count; ++lane) {
    const Pivot& pivot = tiny.parts.pivots[first + lane];
    out.weights.back().values[lane] = pivot.weight;
    for (const std::uint32_t corner : {pivot.a, pivot.b, pivot.c}) {
      add_corner(tiny, skin, corner, lane, terms);
    }
  }
  out.term_counts.push_back(static_cast<std::uint32_t>(terms.size()));
  for (const auto& [bone, sums] : terms) {
    out.term_bones.push_back(bone);
    BoneTerm& term = out.terms.emplace_back();
    store(sums.q[0], term.x);
    store(sums.q[1], term.y);
    store(sums.q[2], term.z);
    store(sums.q[3], term.w);
    out.morph_term_counts.push_back(static_cast<std::uint32_t>(sums.morphs.size()));
    for (const auto& [target, delta] : sums.morphs) {
      out.morph_targets.push_back(target);
      MorphTerm& morph = out.morph_terms.emplace_back();
      store(delta[0], morph.x);
      store(delta[1], morph.y);
      store(delta[2], morph.z);
    }
  }
}

void add_packed(AssetParts& parts) {
  for (const Pivot& pivot : parts.pivots) {
    parts.pivot_vertices.insert(parts.pivot_vertices.end(), {pivot.a, pivot.b, pivot.c});
  }
  std::vector<std::uint32_t>& vertices = parts.pivot_vertices;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const auto number = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  for (const Pivot& pivot : parts.pivots) {
    parts.packed_pivots.push_back({number(pivot.a), number(pivot.b), number(pivot.c), pivot.weight});
  }
}

}  // namespace

void give_pivots(TinyAsset& tiny, std::size_t i, std::uint16_t count, unsigned seed) {
  std::mt19937 random(seed);
  RestSphere& sphere = tiny.parts.spheres[i];
  sphere.first_pivot = static_cast<std::uint32_t>(tiny.parts.pivots.size());
  sphere.pivot_count = count;
  float left = 1;
  for (std::uint16_t k = 0; k < count; ++k) {
    const auto first = static_cast<std::uint32_t>(3 * (random() % tiny.parts.triangle_count));
    const float weight = k + 1 < count ? uniform(random, -0.1F, 0.3F) : left;
    left -= weight;
    tiny.parts.pivots.push_back({first, first + 1, first + 2, weight});
  }
}

TinySkin add_bones(TinyAsset& tiny, std::size_t bone_count, unsigned seed) {
  std::mt19937 random(seed);
  TinySkin skin = random_skin(tiny.parts.vertex_count, bone_count, random);
  BoneRefitParts& refit = tiny.parts.bone_refit;
  for (std::size_t b = 0; b < bone_count; ++b) {
    const bool is_rest = b + 1 == bone_count;
    BoneParts bone{is_rest ? "rest" : "bone" + std::to_string(b), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, is_rest};
    bone.inverse_bind[3] = is_rest ? 0.0F : -static_cast<float>(b);
    refit.bones.push_back(bone);
  }
  for (std::uint32_t m = 0; m < kMorphCount; ++m) {
    refit.morphs.push_back("morph" + std::to_string(m));
  }
  for (const RestSphere& sphere : tiny.parts.spheres) {
    for (std::size_t k = 0; k < sphere.pivot_count; k += kPivotLanes) {
      add_group(tiny, skin, sphere.first_pivot + k, std::min(kPivotLanes, sphere.pivot_count - k), refit);
    }
  }
  add_packed(tiny.parts);
  return skin;
}

std::vector<Matrix> random_matrices(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Matrix> matrices(count);
  for (Matrix& matrix : matrices) {
    for (std::size_t i = 0; i < 12; ++i) {
      matrix[i] = uniform(random, -1, 1);
    }
  }
  return matrices;
}

std::array<double, 3> moved(const TinyAsset& tiny, const TinySkin& skin, std::size_t vertex,
                            const std::vector<Matrix>& matrices, const std::vector<float>& morph_weights) {
  std::array<double, 3> rest{}, out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rest[axis] = double{tiny.rest[3 * vertex + axis]};
    for (const auto& [target, delta] : skin.morphs[vertex]) {
      rest[axis] += morph_weights.empty() ? 0 : double{morph_weights[target]} * double{delta[axis]};
    }
  }
  for (const auto& [bone, weight] : skin.weights[vertex]) {
    for (std::size_t row = 0; row < 3; ++row) {
      const float* m = &matrices[bone][4 * row];
      out[row] += weight * (double{m[0]} * rest[0] + double{m[1]} * rest[1] + double{m[2]} * rest[2] + double{m[3]});
    }
  }
  return out;
}

std::vector<float> skinned(const TinyAsset& tiny, const TinySkin& skin, const std::vector<Matrix>& matrices,
                           const std::vector<float>& morph_weights) {
  std::vector<float> out;
  for (std::size_t v = 0; v < skin.weights.size(); ++v) {
    for (const double figure : moved(tiny, skin, v, matrices, morph_weights)) {
      out.push_back(static_cast<float>(figure));
    }
  }
  return out;
}

}  // namespace spherechain::test
