// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/calibrate/samples.h"

#include <algorithm>
#include <cmath>

#include "baker/mesh/error.h"
#include "runtime/src/contacts/contact_jobs.h"
#include "runtime/src/refit/refit_job.h"

namespace spherechain::baker {
namespace {

constexpr std::uint64_t kSeed = 1;

void check(const Status& status) {
  if (status == SC_OK) return;
  throw Error(ExitCode::kInternal,
              std::string("rest pairs: ") + sc_field_name(status.field) + ": " + sc_code_text(status.code));
}

// The runtime on an asset in one pose after another.
class PosedAsset {
 public:
  PosedAsset(const std::vector<std::uint8_t>& bytes, const std::vector<Pair>& pairs)
      : words_(bytes.size() / sizeof(std::uint64_t) + 1), pairs_(pairs), touching_(pairs.size()) {
    std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::uint8_t*>(words_.data()));
    check(sc_asset_open(&asset_, SC_ABI_VERSION, words_.data(), bytes.size(), nullptr, 0));
    info_ = sc_asset_get_info(&asset_);
    spheres_.resize(info_.sphere_count);
    table_.resize(skin_table_words(&asset_));
    scratch_.resize(skin_scratch_words(&asset_));
    check(prepare_skin(&asset_, table_.data(), table_.size()));
  }

  void take(const RandomPoses::Pose& pose) {
    matrices_.clear();
    for (std::size_t b = 0; b < info_.bone_count; ++b) {
      // The asset's last bone may stand for none.
      const Affine bone = b < pose.bones.size() ? pose.bones[b] : Affine::Identity();
      for (Eigen::Index row = 0; row < 3; ++row) {
        for (Eigen::Index column = 0; column < 4; ++column) {
          matrices_.push_back(static_cast<float>(bone(row, column)));
        }
      }
    }
    morphs_.assign(pose.morphs.begin(), pose.morphs.end());
    morphs_.resize(info_.morph_count);
    find_touching();
    refit();
  }

  // `pair` is one of `pairs`, which is sorted.
  bool touch(const Pair& pair) const { return std::binary_search(touching_.begin(), touching_end(), pair); }
  const std::vector<Sphere>& spheres() const { return spheres_; }

 private:
  std::vector<Pair>::const_iterator touching_end() const {
    return touching_.begin() + static_cast<std::ptrdiff_t>(touching_count_);
  }

  sc_pose pose() const {
    sc_pose out;
    out.bones = matrices_.data();
    out.bone_count = info_.bone_count;
    out.bone_layout = SC_ROWS_3X4;
    out.morph_weights = morphs_.empty() ? nullptr : morphs_.data();
    out.morph_weight_count = morphs_.size();
    return out;
  }

  void find_touching() {
    SkinContactJob job;
    job.asset = &asset_;
    job.pose = pose();
    job.spheres_only = 1;
    job.skin_table = table_.data();
    job.candidates = pairs_.data();
    job.candidate_count = pairs_.size();
    job.scratch = scratch_.data();
    job.scratch_words = scratch_.size();
    job.spheres = touching_.data();
    job.sphere_capacity = touching_.size();
    check(job.run());
    touching_count_ = job.sphere_count;
  }

  void refit() {
    RefitJob job;
    job.asset = &asset_;
    job.pose = pose();
    job.radius = SC_RADIUS_DETECT;
    job.spheres = spheres_.data();
    job.sphere_capacity = spheres_.size();
    check(job.run());
  }

  std::vector<std::uint64_t> words_, table_, scratch_;
  sc_asset asset_;
  sc_asset_info info_;
  const std::vector<Pair>& pairs_;
  std::vector<Pair> touching_;
  std::size_t touching_count_ = 0;
  std::vector<Sphere> spheres_;
  std::vector<float> matrices_, morphs_;
};

}  // namespace

std::vector<SampledPair> sample_pairs(const std::vector<std::uint8_t>& asset, const std::vector<Pair>& pairs,
                                      const RandomPoses& poses, int count) {
  std::vector<SampledPair> out;
  for (const Pair& pair : pairs) out.push_back({pair, {}});
  PosedAsset posed(asset, pairs);
  Random random(kSeed);
  for (int i = 0; i < count; ++i) {
    const int kind = i % 3;
    const bool expected = kind == 0 && poses.have_clips();
    posed.take(poses.next(random, kind, static_cast<double>(i) / count));
    for (SampledPair& pair : out) {
      const Sphere &a = posed.spheres()[pair.spheres.a], &b = posed.spheres()[pair.spheres.b];
      const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
      const float squared = (dx * dx + dy * dy) + dz * dz,
                  far = static_cast<float>(kSampledReach) * (a.radius + b.radius);
      if (squared < far * far) {
        pair.samples.push_back({std::sqrt(squared), a.radius, b.radius, posed.touch(pair.spheres), expected});
      }
    }
  }
  return out;
}

}  // namespace spherechain::baker
