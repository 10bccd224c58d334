// SPDX-License-Identifier: MIT
#include "asset/asset_checks.h"

#include <bitset>
#include <cinttypes>
#include <cmath>
#include <utility>

#include "asset/asset_view.h"
#include "asset/moment_checks.h"
#include "asset/skin_checks.h"
#include "asset/sphere_set.h"
#include "pairs/pair_bits.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

bool is_finite(float value) { return std::isfinite(value); }
bool is_finite(const schema::Vec3& v) { return is_finite(v.x()) && is_finite(v.y()) && is_finite(v.z()); }
bool is_finite(const schema::FitError& e) { return is_finite(e.mean_abs_f()) && is_finite(e.max_abs_f()); }

double dot(const schema::Vec3& a, const schema::Vec3& b) {
  return double{a.x()} * b.x() + double{a.y()} * b.y() + double{a.z()} * b.z();
}

schema::Vec3 cross(const schema::Vec3& a, const schema::Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

// A struct in a table is optional to FlatBuffers; to us it is not.
template <typename Struct>
bool is_given(const Struct* value, const char* name, Message& message) {
  if (value == nullptr) {
    return message.wrong("%s: missing", name);
  }
  return is_finite(*value) || message.wrong("%s: not finite", name);
}

bool is_positive(float value, const char* name, Message& message) {
  return (is_finite(value) && value > 0.0F) ||
         message.wrong("%s: %g is not a finite number above 0", name, double{value});
}

bool check_frame(const schema::Frame& frame, Message& message) {
  if (!is_given(frame.origin(), "frame.origin", message) || !is_given(frame.left(), "frame.left", message) ||
      !is_given(frame.up(), "frame.up", message) || !is_given(frame.forward(), "frame.forward", message) ||
      !is_positive(frame.height(), "frame.height", message)) {
    return false;
  }
  constexpr double kTolerance = 1e-3;  // of a unit length; axes made in float are within 1e-6
  const auto is_near = [](double value, double wanted) { return std::abs(value - wanted) <= kTolerance; };
  const schema::Vec3& left = *frame.left();
  const schema::Vec3& up = *frame.up();
  const schema::Vec3& forward = *frame.forward();
  return (is_near(dot(left, left), 1.0) && is_near(dot(up, up), 1.0) && is_near(dot(left, up), 0.0) &&
          is_near(dot(forward, forward), 1.0) && is_near(dot(cross(left, up), forward), 1.0)) ||
         message.wrong("frame: left, up and forward are not orthonormal and right-handed");
}

bool check_header(const schema::Asset& root, Message& message) {
  const auto refit = static_cast<unsigned>(root.refit());
  if (refit > static_cast<unsigned>(RefitRule::kMoments)) {
    return message.wrong("refit: %u is no known rule", refit);
  }
  return is_positive(root.source()->metres_per_unit(), "source.metres_per_unit", message) &&
         check_frame(*root.frame(), message) && is_given(root.fit()->phi1(), "fit.phi1", message) &&
         is_given(root.fit()->phi1_adjusted(), "fit.phi1_adjusted", message) &&
         is_given(root.fit()->phi2(), "fit.phi2", message);
}

// The verifier only sees to the alignment of the array's length.
template <typename Vector>
bool is_aligned(const Vector& vector, const char* name, Message& message) {
  constexpr std::size_t kAlignment = alignof(std::uint64_t);
  return vector.size() == 0 || reinterpret_cast<std::uintptr_t>(vector.Data()) % kAlignment == 0 ||
         message.wrong("%s: not aligned to %zu bytes", name, kAlignment);
}

bool check_buffers(const schema::Source& source, Message& message) {
  if (source.buffers() == nullptr) {
    return true;
  }
  if (!is_aligned(*source.buffers(), "source.buffers", message)) {
    return false;
  }
  for (std::uint32_t i = 0; i < source.buffers()->size(); ++i) {
    const schema::SourceBuffer& buffer = *source.buffers()->Get(i);
    if (std::uint64_t{buffer.first_vertex()} + buffer.vertex_count() > source.vertex_count()) {
      return message.wrong("source.buffers[%" PRIu32 "].first_vertex: %" PRIu32 " and %" PRIu32
                           " on is past the %" PRIu32 " vertices of the source",
                           i, buffer.first_vertex(), buffer.vertex_count(), source.vertex_count());
    }
  }
  return true;
}

bool check_bones(const schema::Asset& root, Message& message) {
  for (std::uint32_t i = 0; i < root.bones()->size(); ++i) {
    const schema::Bone& bone = *root.bones()->Get(i);
    const schema::Matrix* matrix = bone.inverse_bind();
    if (matrix == nullptr) {
      return message.wrong("bones[%" PRIu32 "].inverse_bind: missing", i);
    }
    for (const float element : *matrix->elements()) {
      if (!is_finite(element)) {
        return message.wrong("bones[%" PRIu32 "].inverse_bind: not finite", i);
      }
    }
    if (bone.is_rest() && i + 1 != root.bones()->size()) {
      return message.wrong("bones[%" PRIu32 "].is_rest: not the last bone", i);
    }
  }
  return true;
}

bool check_parts(const schema::Asset& root, Message& message) {
  const std::uint32_t count = root.parts()->size(), bones = root.bones()->size();
  if (count == 0 || count > kMaxPartCount) {
    return message.wrong("parts: %" PRIu32 " of them, not 1 to %" PRIu32, count, kMaxPartCount);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const schema::Part& part = *root.parts()->Get(i);
    if (static_cast<unsigned>(part.side()) > static_cast<unsigned>(SC_SIDE_RIGHT) || part.bone() < -1 ||
        part.bone() >= std::int64_t{bones}) {
      return message.wrong("parts[%" PRIu32 "]: no known side, or a bone past the %" PRIu32, i, bones);
    }
  }
  return true;
}

bool check_pivots(const schema::Asset& root, Message& message) {
  const std::uint32_t vertex_count = root.source()->vertex_count();
  for (std::uint32_t i = 0; i < root.pivots()->size(); ++i) {
    const schema::Pivot& pivot = *root.pivots()->Get(i);
    const std::uint32_t corners[] = {pivot.a(), pivot.b(), pivot.c()};
    for (int corner = 0; corner < 3; ++corner) {
      if (corners[corner] >= vertex_count) {
        return message.wrong("pivots[%" PRIu32 "].%c: %" PRIu32 " is past the %" PRIu32 " vertices of the source", i,
                             "abc"[corner], corners[corner], vertex_count);
      }
    }
    if (!is_finite(pivot.weight())) {
      return message.wrong("pivots[%" PRIu32 "].weight: not finite", i);
    }
  }
  return true;
}

bool check_sphere_numbers(const schema::Sphere& sphere, std::uint32_t i, Message& message) {
  const auto wrong = [&](const char* field, const char* what) {
    return message.wrong("spheres[%" PRIu32 "].%s: %s", i, field, what);
  };
  if (!is_finite(sphere.center())) {
    return wrong("center", "not finite");
  }
  if (!is_finite(sphere.radius()) || sphere.radius() <= 0.0F) {
    return wrong("radius", "not a finite number above 0");
  }
  if (!is_finite(sphere.detect_radius()) || sphere.detect_radius() < 0.0F) {
    return wrong("detect_radius", "not a finite number of at least 0");
  }
  if (!is_finite(sphere.pivot_spread()) || sphere.pivot_spread() <= 0.0F) {
    return wrong("pivot_spread", "not a finite number above 0");
  }
  if (sphere.pivot_count() == 0) {
    return wrong("pivot_count", "0, but a sphere needs a pivot");
  }
  if (static_cast<unsigned>(sphere.side()) > static_cast<unsigned>(SC_SIDE_RIGHT)) {
    return wrong("side", "no known side");
  }
  if (sphere.level() < -1) {
    return wrong("level", "below -1");
  }
  return sphere.reserved() == 0 || wrong("reserved", "not 0");
}

bool check_spheres(const schema::Asset& root, Message& message) {
  const std::uint32_t count = root.spheres()->size();
  if (count == 0 || count > kMaxSphereCount) {
    return message.wrong("spheres: %" PRIu32 " of them, not 1 to %" PRIu32, count, kMaxSphereCount);
  }
  const std::uint32_t pivots = root.pivots()->size();
  const std::uint32_t regions = root.regions()->size();
  std::uint64_t pivots_used = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const schema::Sphere& sphere = *root.spheres()->Get(i);
    if (!check_sphere_numbers(sphere, i, message)) {
      return false;
    }
    if (std::uint64_t{sphere.first_pivot()} + sphere.pivot_count() > pivots) {
      return message.wrong("spheres[%" PRIu32 "].first_pivot: %" PRIu32 " and %u on is past the %" PRIu32 " pivots", i,
                           sphere.first_pivot(), unsigned{sphere.pivot_count()}, pivots);
    }
    if (sphere.region() >= regions) {
      return message.wrong("spheres[%" PRIu32 "].region: %u is past the %" PRIu32 " regions", i,
                           unsigned{sphere.region()}, regions);
    }
    pivots_used += sphere.pivot_count();
  }
  // Shared pivots would let a small file ask for a very long refit.
  return pivots_used <= pivots ||
         message.wrong("spheres: their pivot_count add up to %" PRIu64 ", past the %" PRIu32 " pivots", pivots_used,
                       pivots);
}

bool check_chain(const schema::Asset& root, std::uint32_t c, SphereSet& seen, Message& message) {
  const schema::Chain& chain = *root.chains()->Get(c);
  for (std::uint32_t i = 0; i < chain.regions()->size(); ++i) {
    const unsigned region = chain.regions()->Get(i);
    if (region >= root.regions()->size()) {
      return message.wrong("chains[%" PRIu32 "].regions[%" PRIu32 "]: %u is past the %" PRIu32 " regions", c, i, region,
                           root.regions()->size());
    }
  }
  const auto& spheres = *chain.spheres();
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    if (spheres.Get(i) >= root.spheres()->size()) {
      return message.wrong("chains[%" PRIu32 "].spheres[%" PRIu32 "]: %" PRIu32 " is past the %" PRIu32 " spheres", c,
                           i, spheres.Get(i), root.spheres()->size());
    }
    if (!seen.insert(spheres.Get(i))) {
      return message.wrong("chains[%" PRIu32 "].spheres[%" PRIu32 "]: %" PRIu32 " is in this chain already", c, i,
                           spheres.Get(i));
    }
  }
  for (const std::uint32_t sphere : spheres) {
    seen.erase(sphere);
  }
  return true;
}

bool check_chains(const schema::Asset& root, std::size_t size, Message& message) {
  SphereSet seen;  // in one chain at a time
  std::uint64_t bytes = 0;
  for (std::uint32_t c = 0; c < root.chains()->size(); ++c) {
    // Chains that share one array would let a small file ask for a very long check.
    const schema::Chain& chain = *root.chains()->Get(c);
    bytes += chain.regions()->size() + std::uint64_t{4} * chain.spheres()->size();
    if (bytes > size) {
      return message.wrong("chains[%" PRIu32 "]: the chains up to here list more than the file has bytes for", c);
    }
    if (!check_chain(root, c, seen, message)) {
      return false;
    }
  }
  return true;
}

bool check_ignored(const schema::Asset& root, Message& message) {
  const auto& words = *root.ignored();
  const std::size_t bits = pairs_of(root.spheres()->size());
  if (words.size() != words_for(bits)) {
    return message.wrong("ignored: %" PRIu32 " words, not the %zu that %" PRIu32 " spheres need", words.size(),
                         words_for(bits), root.spheres()->size());
  }
  if (!is_aligned(words, "ignored", message)) {
    return false;
  }
  if (bits % 64 != 0 && (words.Get(words.size() - 1) >> (bits % 64)) != 0) {
    return message.wrong("ignored: a spare bit is not 0");
  }
  return true;
}

using RestPairs = flatbuffers::Vector<const schema::RestPair*>;

bool check_rest_pairs(const RestPairs& pairs, const char* name, std::uint32_t sphere_count, Message& message) {
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const schema::RestPair& pair = *pairs.Get(i);
    const auto wrong = [&](const char* what) { return message.wrong("%s[%" PRIu32 "]: %s", name, i, what); };
    if (pair.b() >= sphere_count) {
      return message.wrong("%s[%" PRIu32 "].b: %" PRIu32 " is past the %" PRIu32 " spheres", name, i, pair.b(),
                           sphere_count);
    }
    if (pair.a() >= pair.b()) {
      return wrong("a is not below b");
    }
    if (!(pair.scale() >= 0.0F && pair.scale() < 1.0F)) {
      return wrong("scale is not in [0, 1)");
    }
    if (i > 0 && !(Pair{pairs.Get(i - 1)->a(), pairs.Get(i - 1)->b()} < Pair{pair.a(), pair.b()})) {
      return wrong("not sorted, or there twice");
    }
  }
  return true;
}

bool check_joints(const schema::Asset& root, Message& message) {
  if (root.joints() == nullptr) {
    return true;
  }
  for (std::uint32_t i = 0; i < root.joints()->size(); ++i) {
    const schema::Joint& joint = *root.joints()->Get(i);
    if (joint.parent() < -1 || joint.parent() >= std::int64_t{i}) {
      return message.wrong("joints[%" PRIu32 "].parent: %" PRId32 " is not -1 or a joint before it", i, joint.parent());
    }
    for (const auto& [point, name] : {std::pair{joint.position(), "position"}, std::pair{joint.tail(), "tail"}}) {
      if (point == nullptr || !is_finite(*point)) {
        return message.wrong("joints[%" PRIu32 "].%s: %s", i, name, point == nullptr ? "missing" : "not finite");
      }
    }
  }
  return true;
}

}  // namespace

bool values_are_valid(const schema::Asset& root, std::size_t size, SkinSizes& sizes, Message& message) {
  const std::uint32_t spheres = root.spheres()->size();
  return check_header(root, message) && check_buffers(*root.source(), message) && check_pivots(root, message) &&
         check_spheres(root, message) && check_chains(root, size, message) && check_ignored(root, message) &&
         check_rest_pairs(*root.rest_pairs_fit(), "rest_pairs_fit", spheres, message) &&
         check_rest_pairs(*root.rest_pairs_detect(), "rest_pairs_detect", spheres, message) &&
         check_joints(root, message) && check_bones(root, message) && check_parts(root, message) &&
         moment_values_are_valid(root, message) && skin_values_are_valid(root, sizes, message);
}

std::size_t count_ignored(const schema::Asset& root) {
  std::size_t count = 0;
  for (const std::uint64_t word : *root.ignored()) {
    count += std::bitset<64>(word).count();
  }
  return count;
}

}  // namespace spherechain
