// SPDX-License-Identifier: MIT
#include "tiny_bones.h"

#include <algorithm>
#include <map>

namespace spherechain::test {
namespace {

constexpr std::uint32_t kMorphCount = 3, kIdleMorph = 1;

// The first vertex at the same position.
std::size_t twin_of(const TinyAsset& tiny, std::size_t vertex) {
  std::size_t twin = 0;
  while (!std::equal(&tiny.rest[3 * twin], &tiny.rest[3 * twin] + 3, &tiny.rest[3 * vertex])) {
    ++twin;
  }
  return twin;
}

TinySkin random_skin(const TinyAsset& tiny, std::size_t bone_count, std::mt19937& random) {
  TinySkin skin;
  for (std::size_t v = 0; v < tiny.parts.vertex_count; ++v) {
    if (const std::size_t twin = twin_of(tiny, v); twin != v && random() % 2 == 0) {
      skin.weights.push_back(std::vector(skin.weights[twin]));
      skin.morphs.push_back(std::vector(skin.morphs[twin]));
      continue;
    }
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

}  // namespace

void give_pivots(TinyAsset& tiny, std::size_t i, std::uint16_t count, unsigned seed) {
  std::mt19937 random(seed);
  RestSphere& sphere = tiny.parts.spheres[i];
  sphere.first_pivot = static_cast<std::uint32_t>(tiny.parts.pivots.size());
  sphere.pivot_count = count;
  float left = 1;
  std::size_t last = tiny.corners.size();
  for (std::uint16_t k = 0; k < count; ++k) {
    std::size_t next = random() % tiny.corners.size();
    next = next == last ? (next + 1) % tiny.corners.size() : next;  // two of one place have no spread
    last = next;
    const auto& [a, b, c] = tiny.corners[next];
    const float weight = k + 1 < count ? uniform(random, -0.1F, 0.3F) : left;
    left -= weight;
    tiny.parts.pivots.push_back({a, b, c, weight});
  }
}

TinySkin add_bones(TinyAsset& tiny, std::size_t bone_count, unsigned seed) {
  std::mt19937 random(seed);
  TinySkin skin = random_skin(tiny, bone_count, random);
  for (std::size_t b = 0; b < bone_count; ++b) {
    const bool is_rest = b + 1 == bone_count;
    BoneEntry bone{is_rest ? "" : "bone" + std::to_string(b), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, is_rest};
    bone.inverse_bind[3] = is_rest ? 0.0F : -static_cast<float>(b);
    tiny.parts.bones.push_back(bone);
  }
  for (std::size_t i = 0; i < tiny.parts.parts.size(); ++i) {
    tiny.parts.parts[i].bone = static_cast<std::int32_t>(i % bone_count);
  }
  for (std::uint32_t m = 0; m < kMorphCount; ++m) {
    tiny.parts.morphs.push_back("morph" + std::to_string(m));
  }
  tiny.parts.skin.hulls.resize(tiny.parts.spheres.size());  // of spheres without triangles
  if (tiny.parts.refit == static_cast<std::uint8_t>(RefitRule::kMoments)) {
    add_moments(tiny, skin);
  }
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
