// SPDX-License-Identifier: MIT
#include "contacts.h"

#include <memory>
#include <stdexcept>

#include "parallel.h"

namespace spherechain::python {
namespace {

// Asks one thread's bodies about one pose after another.
class Asker {
 public:
  Asker(const LoadedAsset& asset, const SkinPoses& poses, const Asked& asked)
      : asset_(asset), poses_(poses), asked_(asked), body_(take(asset, asked.other, 0)) {
    if (asked.other != nullptr) {
      other_ = take(*asked.other, &asset, 0);
    }
  }
  Asker(Asker&&) = default;
  ~Asker() {
    const bool is_kept = asked_.question != Question::kSteps && (asked_.other == nullptr || asked_.other == &asset_);
    if (body_ && is_kept && !is_wide_) {
      asset_.give_back(std::move(body_));
    }
    if (other_ && is_kept) {
      asset_.give_back(std::move(other_));
    }
  }

  // Appends the answers about a pose.
  void ask(std::size_t i, std::vector<std::uint8_t> (&lists)[3], std::size_t& total) {
    set_poses(i);
    switch (asked_.question) {
      case Question::kContacts: {
        const Contacts found = find_contacts(i, asked_.query);
        append(found.parts, found.part_count, lists[0]);
        append(found.spheres, found.sphere_count, lists[1]);
        append(found.triangles, found.triangle_count, lists[2]);
        total = found.part_count;
        break;
      }
      case Question::kSteps: {
        const Steps found = other_ ? body_->steps(*other_, asked_.query) : body_->steps(asked_.query);
        append(found.items, found.count, lists[0]);
        total = found.count;
        break;
      }
      case Question::kBounds: {
        Vec3 corners[2];
        body_->bounds(corners[0], corners[1]);
        append(corners, 2, lists[0]);
        break;
      }
      default: {
        if (asked_.question == Question::kPenetrations) {
          Query wide = asked_.query;
          wide.detail = SC_DETAIL_FULL;
          find_contacts(i, wide);  // two parts that have more triangles than a body has room for are measured whole
        }
        const Penetrations found = asked_.question == Question::kGround ? body_->below(asked_.ground, asked_.query)
                                   : other_                             ? body_->penetrations(*other_, asked_.query)
                                                                        : body_->penetrations(asked_.query);
        append(found.items, found.count, lists[0]);
        total = found.total;
      }
    }
    require(body_->status());
  }

 private:
  std::unique_ptr<Body> take(const LoadedAsset& asset, const LoadedAsset* other, std::size_t max_triangles) const {
    return asset.take_body(other, asked_.question == Question::kSteps, max_triangles);
  }

  static void set_pose(Body& body, const LoadedAsset& asset, const SkinPoses& poses, std::size_t i) {
    const AssetInfo& info = asset.info();
    Pose pose;
    if (poses.bones.data != nullptr) {
      pose = python::pose_of(asset, poses.bones, i);
      if (poses.morph_weights != nullptr) {
        pose.morph_weights = poses.morph_weights + i * info.morph_count;
        pose.morph_weight_count = info.morph_count;
      }
    } else {
      pose.vertices = poses.vertices + 3 * i * info.vertex_count;
      pose.vertex_count = info.vertex_count;
    }
    require(body.set_pose(pose));
  }

  void set_poses(std::size_t i) {
    if (asked_.question == Question::kSteps) {
      set_pose(*body_, asset_, asked_.before, i);
    }
    set_pose(*body_, asset_, poses_, i);
    if (other_ && asked_.question == Question::kSteps) {
      set_pose(*other_, *asked_.other, asked_.others_before, i);
    }
    if (other_) {
      set_pose(*other_, *asked_.other, asked_.others, i);
    }
  }

  // Takes a larger body where this one has no room for all triangles.
  Contacts find_contacts(std::size_t i, const Query& query) {
    const auto find = [&] { return other_ ? body_->contacts(*other_, query) : body_->contacts(query); };
    Contacts found = find();
    if (found.triangle_count < found.triangle_total) {
      body_ = take(asset_, asked_.other, 2 * found.triangle_total);
      is_wide_ = true;
      set_pose(*body_, asset_, poses_, i);
      found = find();
    }
    return found;
  }

  template <typename T>
  static void append(const T* entries, std::size_t count, std::vector<std::uint8_t>& out) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(entries);
    out.insert(out.end(), bytes, bytes + count * sizeof(T));
  }

  const LoadedAsset& asset_;
  const SkinPoses& poses_;
  const Asked& asked_;
  std::unique_ptr<Body> body_, other_;
  bool is_wide_ = false;
};

// A point on the skin is the sum over bones of matrix times (x, y, z, w).
struct PointTerm {
  std::size_t bone;
  double x, y, z, w;
};

class PointTerms {
 public:
  explicit PointTerms(const LoadedAsset& asset) : asset_(asset), surface_(asset.surface()) {}

  // Valid until the next call.
  const std::vector<PointTerm>& of(std::uint32_t triangle, const float* weights, const float* morph_weights) {
    const Span<std::uint32_t>& places = surface_.place_of_source;
    if (triangle >= places.size || places[triangle] == kNoPlace) {
      throw std::invalid_argument("triangle " + std::to_string(triangle) + " is not in the asset's skin");
    }
    const std::uint32_t place = places[triangle];
    const Cluster& cluster =
        *(std::upper_bound(surface_.clusters.begin(), surface_.clusters.end(), place,
                           [](std::uint32_t p, const Cluster& c) { return p < c.first_triangle; }) -
          1);
    const std::size_t slots = slot_count(cluster);
    terms_.clear();
    for (std::size_t k = 0; k < cluster.bone_count; ++k) {
      PointTerm term{surface_.cluster_bones[cluster.first_bone + k], 0, 0, 0, 0};
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t slot = surface_.corners[3 * std::size_t{place} + corner];
        const double share =
            double{weights[corner]} * double{surface_.slot_weights[cluster.first_weight + k * slots + slot]};
        double position[3];
        morphed(cluster, slot, slots, morph_weights, position);
        term.x += share * position[0];
        term.y += share * position[1];
        term.z += share * position[2];
        term.w += share;
      }
      terms_.push_back(term);
    }
    return terms_;
  }

 private:
  void morphed(const Cluster& cluster, std::size_t slot, std::size_t slots, const float* weights,
               double (&out)[3]) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[axis] = double{surface_.slot_positions[3 * std::size_t{cluster.first_slot} + axis * slots + slot]};
    }
    for (std::size_t i = 0; weights != nullptr && i < cluster.morph_count; ++i) {
      const SlotMorph& morph = surface_.slot_morphs[cluster.first_morph + i];
      if (morph.slot == slot) {
        const double weight{weights[morph.target]};
        out[0] += weight * double{morph.delta.x};
        out[1] += weight * double{morph.delta.y};
        out[2] += weight * double{morph.delta.z};
      }
    }
  }

  const LoadedAsset& asset_;
  Surface surface_;
  std::vector<PointTerm> terms_;
};

const float* morphs_of(const LoadedAsset& asset, const float* morph_weights, std::size_t i) {
  return morph_weights == nullptr ? nullptr : morph_weights + i * asset.info().morph_count;
}

}  // namespace

Answers ask(const LoadedAsset& asset, const SkinPoses& poses, const Asked& asked, std::size_t threads) {
  struct OfPose {
    std::vector<std::uint8_t> lists[3];
  };
  std::vector<OfPose> found(poses.count);
  Answers out;
  out.totals.resize(poses.count);
  for_each_pose(poses.count, threads, [&] {
    return
        [&, asker = Asker(asset, poses, asked)](std::size_t i) mutable { asker.ask(i, found[i].lists, out.totals[i]); };
  });
  for (std::size_t k = 0; k < 3; ++k) {
    Runs& all = out.lists[k];
    for (const OfPose& one : found) {
      all.bytes.insert(all.bytes.end(), one.lists[k].begin(), one.lists[k].end());
      all.first.push_back(all.bytes.size());
    }
  }
  return out;
}

template <typename T>
void place_points(const LoadedAsset& asset, const Poses<T>& poses, const float* morph_weights, const SkinPoints& points,
                  std::size_t threads, T* out) {
  for_each_pose(poses.count, threads, [&] {
    return [&, terms = PointTerms(asset)](std::size_t i) mutable {
      for (std::size_t p = 0; p < points.count; ++p) {
        double sum[3] = {};
        for (const PointTerm& term :
             terms.of(points.triangles[p], points.weights + 3 * p, morphs_of(asset, morph_weights, i))) {
          const T* row = poses.pose(i) + term.bone * poses.bone_stride;
          for (std::size_t m = 0; m < 3; ++m, row += 4) {
            sum[m] +=
                double{row[0]} * term.x + double{row[1]} * term.y + double{row[2]} * term.z + double{row[3]} * term.w;
          }
        }
        for (std::size_t m = 0; m < 3; ++m) {
          out[3 * (i * points.count + p) + m] = static_cast<T>(sum[m]);
        }
      }
    };
  });
}

template void place_points<float>(const LoadedAsset&, const Poses<float>&, const float*, const SkinPoints&, std::size_t,
                                  float*);
template void place_points<double>(const LoadedAsset&, const Poses<double>&, const float*, const SkinPoints&,
                                   std::size_t, double*);

void add_depth_gradients(const LoadedAsset& asset, const Penetration* penetrations, const float* slopes,
                         const std::size_t* first, std::size_t pose_count, const float* morph_weights,
                         float* gradient) {
  const std::size_t size = 12 * asset.info().bone_count;
  for_each_pose(pose_count, 1, [&] {
    return [&, terms = PointTerms(asset)](std::size_t i) mutable {
      for (std::size_t p = first[i]; p < first[i + 1]; ++p) {
        const Penetration& of = penetrations[p];
        const float direction[3] = {of.direction.x, of.direction.y, of.direction.z};
        for (const SkinPoint* point : {&of.deepest_other, &of.deepest}) {
          const float slope = point == &of.deepest_other ? slopes[p] : -slopes[p];
          for (const PointTerm& term : terms.of(point->triangle, point->weights, morphs_of(asset, morph_weights, i))) {
            float* row = gradient + i * size + 12 * term.bone;
            for (std::size_t m = 0; m < 3; ++m, row += 4) {
              const float along = slope * direction[m];
              row[0] += along * static_cast<float>(term.x);
              row[1] += along * static_cast<float>(term.y);
              row[2] += along * static_cast<float>(term.z);
              row[3] += along * static_cast<float>(term.w);
            }
          }
        }
      }
    };
  });
}

}  // namespace spherechain::python
