// SPDX-License-Identifier: MIT
#include "runtime/src/asset/asset_checks.h"

#include <bitset>
#include <utility>

#include "runtime/src/base/memory.h"
#include "runtime/src/base/pair_bits.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

using SeenSpheres = std::bitset<kMaxSphereCount>;

double dot(const schema::Vec3& a, const schema::Vec3& b) {
  return double{a.x()} * b.x() + double{a.y()} * b.y() + double{a.z()} * b.z();
}

schema::Vec3 cross(const schema::Vec3& a, const schema::Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

// Returns the error of a struct in a table, or null if there is none. FlatBuffers lets such structs be missing.
template <typename Floats>
const char* fault_of(const Floats* value) {
  return value == nullptr ? "missing" : is_finite(*value) ? nullptr : "not finite";
}

class AssetChecker {
 public:
  AssetChecker(const schema::Asset& root, const AssetView& asset, Message& message)
      : root_(root), asset_(asset), message_(message) {}

  bool run(std::size_t size) {
    return check_header() && check_buffers() && check_pivots() && check_spheres() && check_chains(size) &&
           check_ignored() && check_rest_pairs(SC_RADIUS_FIT, "rest_pairs_fit") &&
           check_rest_pairs(SC_RADIUS_DETECT, "rest_pairs_detect") && check_joints() && check_bones() &&
           check_parts() && check_moments();
  }

 private:
  template <typename Floats>
  bool is_given(const Floats* value, const char* name) {
    const char* const fault = fault_of(value);
    return fault == nullptr || message_.wrong("%s: %s", name, fault);
  }
  template <typename Floats>
  bool is_given(const Floats* value, const char* table, std::uint32_t i, const char* field) {
    const char* const fault = fault_of(value);
    return fault == nullptr || message_.wrong_at(table, i, field, fault);
  }

  bool is_positive(float value, const char* name) {
    return is_above_0(value) || message_.wrong("%s: %g is not a finite number above 0", name, double{value});
  }

  bool is_in_range(std::size_t count, std::size_t limit, const char* name) {
    return (count > 0 && count <= limit) || message_.wrong("%s: %zu of them, not 1 to %zu", name, count, limit);
  }

  bool check_header() {
    const schema::Fit& fit = *root_.fit();
    return (asset_.refit_rule() <= RefitRule::kMoments ||
            message_.wrong("refit: %u is no known rule", static_cast<unsigned>(asset_.refit_rule()))) &&
           is_positive(root_.source()->metres_per_unit(), "source.metres_per_unit") && check_frame(*root_.frame()) &&
           is_given(fit.phi1(), "fit.phi1") && is_given(fit.phi1_adjusted(), "fit.phi1_adjusted") &&
           is_given(fit.phi2(), "fit.phi2");
  }

  bool check_frame(const schema::Frame& frame) {
    if (!is_given(frame.origin(), "frame.origin") || !is_given(frame.left(), "frame.left") ||
        !is_given(frame.up(), "frame.up") || !is_given(frame.forward(), "frame.forward") ||
        !is_positive(frame.height(), "frame.height")) {
      return false;
    }
    constexpr double kTolerance = 1e-3;  // of a unit length; axes made in float are within 1e-6
    const auto is_near = [](double value, double wanted) { return std::abs(value - wanted) <= kTolerance; };
    const schema::Vec3 &left = *frame.left(), &up = *frame.up(), &forward = *frame.forward();
    return (is_near(dot(left, left), 1.0) && is_near(dot(up, up), 1.0) && is_near(dot(left, up), 0.0) &&
            is_near(dot(forward, forward), 1.0) && is_near(dot(cross(left, up), forward), 1.0)) ||
           message_.wrong("frame: left, up and forward are not orthonormal and right-handed");
  }

  // FlatBuffers' verifier checks the alignment of the array's length only.
  template <typename T>
  bool is_aligned(Span<const T> values, const char* name) {
    return values.size == 0 || !any_misaligned(values.data) ||
           message_.wrong("%s: not aligned to %zu bytes", name, alignof(T));
  }

  bool check_buffers() {
    const Span<const sc_source_buffer> buffers = asset_.source_buffers();
    if (!is_aligned(buffers, "source.buffers")) {
      return false;
    }
    for (std::size_t i = 0; i < buffers.size; ++i) {
      const sc_source_buffer& buffer = buffers[i];
      if (std::uint64_t{buffer.first_vertex} + buffer.vertex_count > asset_.vertex_count()) {
        return message_.wrong("source.buffers[%zu].first_vertex: %" PRIu32 " and %" PRIu32
                              " on is past the %zu vertices of the source",
                              i, buffer.first_vertex, buffer.vertex_count, asset_.vertex_count());
      }
    }
    return true;
  }

  bool check_pivots() {
    const Span<const Pivot> pivots = asset_.pivots();
    const std::size_t count = asset_.vertex_count();
    for (std::size_t i = 0; i < pivots.size; ++i) {
      const Pivot& pivot = pivots[i];
      for (const auto& [vertex, field] : {std::pair{pivot.a, ".a"}, {pivot.b, ".b"}, {pivot.c, ".c"}}) {
        if (vertex >= count) {
          return message_.past_end("pivots", i, field, vertex, count, "vertices of the source");
        }
      }
      if (!std::isfinite(pivot.weight)) {
        return message_.wrong_at("pivots", i, ".weight", "not finite");
      }
    }
    return true;
  }

  bool check_figures(const RestSphere& sphere, std::size_t i) {
    const struct {
      bool holds;
      const char *field, *fault;
    } rules[] = {
        {is_finite(sphere.center), ".center", "not finite"},
        {is_above_0(sphere.radius), ".radius", "not a finite number above 0"},
        {is_at_least_0(sphere.detect_radius), ".detect_radius", "not a finite number of at least 0"},
        {is_above_0(sphere.pivot_spread), ".pivot_spread", "not a finite number above 0"},
        {sphere.pivot_count > 0, ".pivot_count", "0, but a sphere needs a pivot"},
        {sphere.side <= SC_SIDE_RIGHT, ".side", "no known side"},
        {sphere.level >= -1, ".level", "below -1"},
        {sphere.reserved == 0, ".reserved", "not 0"},
    };
    for (const auto& rule : rules) {
      if (!rule.holds) {
        return message_.wrong_at("spheres", i, rule.field, rule.fault);
      }
    }
    return true;
  }

  bool check_spheres() {
    const Span<const RestSphere> spheres = asset_.spheres();
    const std::size_t pivots = asset_.pivots().size, regions = asset_.region_count();
    if (!is_in_range(spheres.size, kMaxSphereCount, "spheres")) {
      return false;
    }
    std::uint64_t pivots_used = 0;
    for (std::size_t i = 0; i < spheres.size; ++i) {
      const RestSphere& sphere = spheres[i];
      if (!check_figures(sphere, i)) {
        return false;
      }
      if (std::uint64_t{sphere.first_pivot} + sphere.pivot_count > pivots) {
        return message_.wrong("spheres[%zu].first_pivot: %" PRIu32 " and %u on is past the %zu pivots", i,
                              sphere.first_pivot, unsigned{sphere.pivot_count}, pivots);
      }
      if (sphere.region >= regions) {
        return message_.past_end("spheres", i, ".region", sphere.region, regions, "regions");
      }
      pivots_used += sphere.pivot_count;
    }
    // Shared pivots would let a small file ask for a very long refit.
    return pivots_used <= pivots ||
           message_.wrong("spheres: their pivot_count add up to %" PRIu64 ", past the %zu pivots", pivots_used, pivots);
  }

  bool check_chain(std::size_t c, const ChainView& chain, SeenSpheres& seen) {
    const auto past_end = [&](const char* list, std::size_t i, std::uint32_t value, std::size_t count) {
      return message_.wrong("chains[%zu].%s[%zu]: %" PRIu32 " is past the %zu %s", c, list, i, value, count, list);
    };
    const std::size_t regions = asset_.region_count(), spheres = asset_.spheres().size;
    for (std::size_t i = 0; i < chain.regions.size; ++i) {
      if (chain.regions[i] >= regions) {
        return past_end("regions", i, chain.regions[i], regions);
      }
    }
    for (std::size_t i = 0; i < chain.spheres.size; ++i) {
      const std::uint32_t sphere = chain.spheres[i];
      if (sphere >= spheres) {
        return past_end("spheres", i, sphere, spheres);
      }
      if (seen[sphere]) {
        return message_.wrong("chains[%zu].spheres[%zu]: %" PRIu32 " is in this chain already", c, i, sphere);
      }
      seen[sphere] = true;
    }
    for (const std::uint32_t sphere : chain.spheres) {
      seen[sphere] = false;
    }
    return true;
  }

  bool check_chains(std::size_t size) {
    SeenSpheres seen;  // in one chain at a time
    std::uint64_t bytes = 0;
    for (std::size_t c = 0; c < asset_.chain_count(); ++c) {
      // Chains that share one array would let a small file ask for a very long check.
      const ChainView chain = asset_.chain(c);
      bytes += chain.regions.size + std::uint64_t{4} * chain.spheres.size;
      if (bytes > size) {
        return message_.wrong_at("chains", c, "the chains up to here list more than the file has bytes for");
      }
      if (!check_chain(c, chain, seen)) {
        return false;
      }
    }
    return true;
  }

  bool check_ignored() {
    const Span<const std::uint64_t> words = asset_.ignored();
    const std::size_t spheres = asset_.spheres().size, bits = pairs_of(spheres);
    if (words.size != words_for(bits)) {
      return message_.wrong("ignored: %zu words, not the %zu that %zu spheres need", words.size, words_for(bits),
                            spheres);
    }
    return is_aligned(words, "ignored") && (bits % 64 == 0 || (words[words.size - 1] >> (bits % 64)) == 0 ||
                                            message_.wrong("ignored: a spare bit is not 0"));
  }

  bool check_rest_pairs(Radius radius, const char* name) {
    const Span<const RestPair> pairs = asset_.rest_pairs(radius);
    const std::size_t count = asset_.spheres().size;
    Pair before{};
    for (std::size_t i = 0; i < pairs.size; ++i) {
      const Pair pair{pairs[i].a, pairs[i].b};
      if (pair.b >= count) {
        return message_.past_end(name, i, ".b", pair.b, count, "spheres");
      }
      if (pair.a >= pair.b) {
        return message_.wrong_at(name, i, "a is not below b");
      }
      if (!(pairs[i].rest_scale >= 0.0F && pairs[i].rest_scale < 1.0F)) {
        return message_.wrong_at(name, i, "scale is not in [0, 1)");
      }
      if (!(before < pair)) {  // the first is above (0, 0)
        return message_.wrong_at(name, i, "not sorted, or there twice");
      }
      before = pair;
    }
    return true;
  }

  bool check_joints() {
    for (std::uint32_t i = 0; i < asset_.joint_count(); ++i) {
      const schema::Joint& joint = *root_.joints()->Get(i);
      if (joint.parent() < -1 || joint.parent() >= std::int64_t{i}) {
        return message_.wrong("joints[%" PRIu32 "].parent: %" PRId32 " is not -1 or a joint before it", i,
                              joint.parent());
      }
      if (!is_given(joint.position(), "joints", i, ".position") || !is_given(joint.tail(), "joints", i, ".tail")) {
        return false;
      }
    }
    return true;
  }

  bool check_bones() {
    for (std::uint32_t i = 0; i < asset_.bone_count(); ++i) {
      const schema::Bone& bone = *root_.bones()->Get(i);
      if (!is_given(bone.inverse_bind(), "bones", i, ".inverse_bind")) {
        return false;
      }
      if (bone.is_rest() && i + 1 != asset_.bone_count()) {
        return message_.wrong_at("bones", i, ".is_rest", "not the last bone");
      }
    }
    return true;
  }

  bool check_parts() {
    if (!is_in_range(asset_.part_count(), kMaxPartCount, "parts")) {
      return false;
    }
    for (std::size_t i = 0; i < asset_.spheres().size; ++i) {
      if (asset_.spheres()[i].part >= asset_.part_count()) {
        return message_.wrong_at("spheres", i, ".part", "past the body parts");
      }
    }
    const std::size_t bones = asset_.bone_count();
    for (std::size_t i = 0; i < asset_.part_count(); ++i) {
      const BodyPart part = asset_.part(i);
      if (part.side > SC_SIDE_RIGHT || part.bone < -1 || part.bone >= static_cast<std::int64_t>(bones)) {
        return message_.wrong("parts[%zu]: no known side, or a bone past the %zu", i, bones);
      }
      if (part.parent < -1 || part.parent >= static_cast<std::int64_t>(asset_.part_count())) {
        return message_.wrong("parts[%zu]: hangs on a part that does not exist", i);
      }
    }
    return true;
  }

  bool check_moments() {
    const schema::Moments* const moments = root_.moments();
    const bool are_wanted = asset_.refit_rule() == RefitRule::kMoments && asset_.bone_count() > 0;
    if ((moments != nullptr) != are_wanted) {
      return message_.wrong("moments: %s",
                            are_wanted ? "missing, but refit is moments" : "refit is another, or no bones");
    }
    return !are_wanted || (is_given(moments->origin(), "moments.origin") && moment_values_are_valid(asset_, message_));
  }

  const schema::Asset& root_;
  const AssetView& asset_;
  Message& message_;
};

}  // namespace

bool values_are_valid(const schema::Asset& root, const AssetView& asset, std::size_t size, SkinSizes& sizes,
                      Message& message) {
  return AssetChecker(root, asset, message).run(size) && skin_values_are_valid(asset, sizes, message) &&
         figures_are_in_range(asset, size, message);
}

}  // namespace spherechain
