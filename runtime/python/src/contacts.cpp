// SPDX-License-Identifier: MIT
#include "contacts.h"

#include <stdexcept>

#include "parallel.h"

namespace spherechain::python {
namespace {

constexpr std::size_t kFirstTriangles = 1024, kFirstPenetrations = 32;

// Of one thread.
class ContactFinder {
 public:
  ContactFinder(const LoadedAsset& asset, const SkinPoses& poses, const ContactOptions& options)
      : asset_(asset), poses_(poses), options_(options), memory_(asset.take_memory()) {
    if (memory_->skin.size() == 0) {
      memory_->skin = Words(sc_skin_scratch_words(&asset.asset()));
      memory_->triangles.resize(kFirstTriangles);
      memory_->penetrations.resize(kFirstPenetrations);
    }
  }
  ContactFinder(ContactFinder&&) = default;
  ~ContactFinder() {
    if (memory_) {
      asset_.give_back(std::move(memory_));
    }
  }

  void find(std::size_t i, std::vector<Penetration>& penetrations, std::vector<TriangleContact>* triangles) {
    const sc_pose pose = pose_of(i);
    const std::size_t count = find_triangles(pose);
    const auto first = memory_->triangles.begin();
    if (triangles != nullptr) {
      triangles->assign(first, first + static_cast<std::ptrdiff_t>(count));
    }
    if (count > 0) {
      measure(pose, count, penetrations);
    }
  }

 private:
  sc_pose pose_of(std::size_t i) const {
    sc_pose pose;
    const AssetInfo& info = asset_.info();
    if (poses_.bones.data != nullptr) {
      pose = python::pose_of(asset_, poses_.bones, i);
      if (poses_.morph_weights != nullptr) {
        pose.morph_weights = poses_.morph_weights + i * info.morph_count;
        pose.morph_weight_count = info.morph_count;
      }
    } else {
      pose.vertices = poses_.vertices + 3 * i * info.vertex_count;
      pose.vertex_count = info.vertex_count;
    }
    return pose;
  }

  // Into the memory; returns how many there are.
  std::size_t find_triangles(const sc_pose& pose) {
    SkinContactJob job;
    job.asset = &asset_.asset();
    job.pose = pose;
    job.scope = options_.scope;
    job.skin_table = asset_.skin_table();
    job.scratch = memory_->skin.data();
    job.scratch_words = memory_->skin.size();
    const auto run = [&] {
      job.triangles = memory_->triangles.data();
      job.triangle_capacity = memory_->triangles.size();
      return job.run();
    };
    Status status = run();
    if (status == SC_OVERFLOW) {
      memory_->triangles.resize(job.triangle_count);
      status = run();
    }
    require(status);
    return job.triangle_count;
  }

  void measure(const sc_pose& pose, std::size_t contact_count, std::vector<Penetration>& out) {
    PenetrationJob job;
    job.asset = &asset_.asset();
    job.pose = pose;
    job.scope = options_.scope;
    job.skin_table = asset_.skin_table();
    job.contacts = memory_->triangles.data();
    job.contact_count = contact_count;
    job.quick = options_.quick ? 1 : 0;
    const std::size_t words = sc_penetration_scratch_words(&asset_.asset(), contact_count);
    if (memory_->depth.size() < words) {
      memory_->depth = Words(words);
    }
    job.scratch = memory_->depth.data();
    job.scratch_words = memory_->depth.size();
    const auto run = [&] {
      job.penetrations = memory_->penetrations.data();
      job.penetration_capacity = memory_->penetrations.size();
      return job.run();
    };
    Status status = run();
    if (status == SC_OVERFLOW) {
      memory_->penetrations.resize(job.penetration_count);
      status = run();
    }
    require(status);
    const auto first = memory_->penetrations.begin();
    out.assign(first, first + static_cast<std::ptrdiff_t>(job.penetration_count));
  }

  const LoadedAsset& asset_;
  const SkinPoses& poses_;
  const ContactOptions& options_;
  std::unique_ptr<ContactMemory> memory_;
};

template <typename T>
Runs<T> join(const std::vector<std::vector<T>>& lists) {
  Runs<T> out;
  out.first.push_back(0);
  for (const std::vector<T>& list : lists) {
    out.first.push_back(out.first.back() + list.size());
  }
  out.entries.reserve(out.first.back());
  for (const std::vector<T>& list : lists) {
    out.entries.insert(out.entries.end(), list.begin(), list.end());
  }
  return out;
}

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

FoundContacts find_contacts(const LoadedAsset& asset, const SkinPoses& poses, const ContactOptions& options) {
  std::vector<std::vector<Penetration>> penetrations(poses.count);
  std::vector<std::vector<TriangleContact>> triangles(options.lists_triangles ? poses.count : 0);
  for_each_pose(poses.count, options.threads, [&] {
    return [&, finder = ContactFinder(asset, poses, options)](std::size_t i) mutable {
      finder.find(i, penetrations[i], options.lists_triangles ? &triangles[i] : nullptr);
    };
  });
  return {join(penetrations), join(triangles)};
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
