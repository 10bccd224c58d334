// SPDX-License-Identifier: MIT
// The answers that the JavaScript package must give: reference ASSET PALETTES. A line a frame of the palettes
// (samples/csharp/write_palettes): hashes of the answers about one body. --pair: instead a line every tenth frame of
// two bodies. --time: last a line of milliseconds a frame: contacts, then penetrations. SPHERECHAIN_TARGET names an
// instruction set.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "runtime/src/simd/simd.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

std::vector<char> read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) throw std::runtime_error(std::string(path) + ": cannot be read");
  return bytes;
}

// FNV-1a over words of 32 bits.
struct Hash {
  std::uint32_t value = 2166136261U;
  template <typename T>
  void add(const T* data, std::size_t count) {
    for (std::size_t i = 0; i < count * sizeof(T); i += 4) {
      std::uint32_t word = 0;
      std::memcpy(&word, reinterpret_cast<const char*>(data) + i, 4);
      value = (value ^ word) * 16777619U;
    }
  }
};

struct Palettes {
  std::vector<char> bytes;
  std::vector<Bone> joints;
  std::vector<std::string> names;
  std::vector<std::vector<float>> inverse_binds, frames;

  explicit Palettes(const char* path) : bytes(read(path)) {
    const auto count = static_cast<std::size_t>(number()), frame_count = static_cast<std::size_t>(number());
    for (std::size_t i = 0; i < count; ++i) {
      const auto length = static_cast<std::size_t>(number());
      names.emplace_back(take(length), length);
      inverse_binds.push_back(floats(16));
    }
    for (std::size_t i = 0; i < count; ++i) joints.push_back({names[i].c_str(), inverse_binds[i].data()});
    floats(16 * count);  // at rest
    for (std::size_t i = 0; i < frame_count; ++i) frames.push_back(floats(16 * count));
  }

 private:
  std::size_t at_ = 0;
  const char* take(std::size_t size) {
    if (size > bytes.size() - at_) throw std::runtime_error("the palettes are cut short");
    at_ += size;
    return bytes.data() + at_ - size;
  }
  std::int32_t number() {
    std::int32_t out = 0;
    std::memcpy(&out, take(4), 4);
    return out;
  }
  std::vector<float> floats(std::size_t count) {
    std::vector<float> out(count);
    std::memcpy(out.data(), take(4 * count), 4 * count);
    return out;
  }
};

void require(const Status& status) {
  if (status != SC_OK)
    throw std::runtime_error(std::string(sc_field_name(status.field)) + ": " + sc_code_text(status.code));
}

// The options of questions, with the instruction set that SPHERECHAIN_TARGET names.
Query options(int full = 0, std::uint32_t classes = 0) {
  Query query;
  const char* const name = std::getenv("SPHERECHAIN_TARGET");
  if (name != nullptr && !find_target(name, query.target))
    throw std::runtime_error("SPHERECHAIN_TARGET: no such target here");
  query.full = full;
  query.classes = classes;
  return query;
}

constexpr std::uint32_t kAll = 0xFFFFFFFF;  // classes

// Answers of one body, as hashes in a line.
class Line {
 public:
  Line& word(std::size_t count) {
    const auto value = static_cast<std::uint32_t>(count);
    hash_.add(&value, 1);
    return *this;
  }
  template <typename T>
  Line& list(const T* items, std::size_t count, std::size_t total) {
    hash_.add(items, count);
    return word(total);
  }
  Line& add(const Penetrations& found) {
    constexpr std::size_t kBytes = offsetof(Penetration, measures) + offsetof(Measures, reserved);
    for (const Penetration& one : found) {
      hash_.add(reinterpret_cast<const char*>(&one), kBytes);
    }
    return word(found.total);
  }
  Line& add(const Steps& found) { return list(found.items, found.count, found.count); }
  Line& add(const Contacts& found) {
    list(found.parts, found.part_count, found.part_count);
    list(found.spheres, found.sphere_count, found.sphere_total);
    return list(found.triangles, found.triangle_count, found.triangle_total);
  }
  Line& add(const SpherePairs& found) {
    list(found.spheres, found.sphere_count, found.sphere_count);
    return list(found.pairs, found.count, found.total);
  }
  void end() {
    std::printf("%s%08x", is_first_ ? "" : " ", hash_.value);
    is_first_ = false;
    hash_ = {};
  }

 private:
  Hash hash_;
  bool is_first_ = true;
};

Pose pose_of(const std::vector<float>& palette) {
  Pose pose;
  pose.bones = palette.data();
  pose.bone_count = palette.size() / 16;
  pose.bone_layout = SC_COLUMNS_4X4;
  return pose;
}

// In frame_hashes.mjs: frameHashes().
void print_frame(const Model& model, Body& body, const Palettes& palettes, std::size_t frame) {
  Line line;
  require(body.set_pose(pose_of(palettes.frames[frame == 0 ? 0 : frame - 1])));
  const Penetrations last = body.penetrations(options());
  require(body.set_pose(pose_of(palettes.frames[frame])));
  Query steady = options();
  steady.previous = last.items;
  steady.previous_count = last.count;
  line.add(body.penetrations(steady)).end();
  Query spheres = options();
  for (const Radius radius : {SC_RADIUS_DETECT, SC_RADIUS_FIT}) {
    spheres.radius = radius;
    line.add(body.sphere_pairs(spheres));
  }
  line.end();
  line.add(body.contacts(options(1))).add(body.contacts(options())).end();
  line.add(body.penetrations(options())).end();
  line.add(body.penetrations(options(0, kAll))).end();
  line.add(body.penetrations(options(1, kAll))).end();

  Query worst = options(0, 1U << SC_CLASS_TOUCH | 1U << SC_CLASS_PENETRATION);
  Rule rule = sc_default_rule();
  rule.touch_depth = 0.0625F;
  worst.rule = &rule;
  worst.limit = 1;
  line.add(body.penetrations(worst)).end();

  const std::uint64_t* const own = model.info().ignored_pairs;
  std::vector<std::uint64_t> ignored(own, own + sc_pair_words(&model.asset()));
  require(sc_ignore_parts(&model.asset(), ignored.data(), 0, 1, 1));
  ignored[0] &= ~std::uint64_t{1};  // of spheres 0 and 1
  Query filtered = options(0, kAll);
  filtered.ignored_pairs = ignored.data();
  line.add(body.penetrations(filtered)).add(body.sphere_pairs(filtered)).end();

  Vec3 low, high;
  require(body.bounds(low, high));
  Ground ground;
  ground.up = {0, 1, 0};
  ground.height = low.y + 0.0625F * model.info().height;
  line.list(&low, 1, 0).list(&high, 1, 0).add(body.below(ground, options(0, kAll))).end();
  line.add(body.steps(options())).end();
  std::puts("");
}

// Two characters, the second one 0.3 away along x and z. In frame_hashes.mjs: pairHashes().
void print_pair(Body& a, Body& b, const Palettes& palettes, std::size_t frame) {
  const Transform away{{0.3F, 0, 0.3F}, {0, 0, 0, 1}, {1, 1, 1}};
  for (const std::size_t of : {frame, frame + 1}) {
    require(a.set_pose(pose_of(palettes.frames[of])));
    require(b.set_pose(pose_of(palettes.frames[of]), away));
  }
  Line line;
  const Contacts contacts = a.contacts(b, options(1));
  std::printf("%zu ", contacts.part_count);
  line.add(contacts).end();
  line.add(a.penetrations(b, options())).end();
  line.add(a.penetrations(b, options(1, kAll))).end();
  const std::uint64_t ignored = 0x55555555, ignored_of_other = 6;  // parts 0, 2, 4 ...; 1 and 2
  Query query = options(0, kAll);
  query.ignored_parts = &ignored;
  query.ignored_parts_of_other = &ignored_of_other;
  line.add(a.penetrations(b, query)).end();
  line.add(a.steps(b, options())).end();
  std::puts("");
}

// Milliseconds a frame. Each frame's fastest pass: other programs of the machine do not count.
template <typename Frame>
double time_of(const Palettes& palettes, const Frame& frame) {
  std::vector<double> best(palettes.frames.size(), 1e9);
  for (int pass = 0; pass < 8; ++pass) {
    for (std::size_t i = 0; i < best.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      frame(palettes.frames[i]);
      const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - start;
      best[i] = std::min(best[i], passed.count());
    }
  }
  double sum = 0;
  for (const double time : best) sum += time;
  return sum / static_cast<double>(best.size());
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_timed = argc == 4 && std::strcmp(argv[3], "--time") == 0;
  const bool is_pair = argc == 4 && std::strcmp(argv[3], "--pair") == 0;
  if (argc != 3 && !is_timed && !is_pair) {
    std::fputs("usage: reference ASSET PALETTES [--time|--pair]\n", stderr);
    return 2;
  }
  try {
    const Palettes palettes(argv[2]);
    const std::vector<char> file = read(argv[1]);
    const Model model(file.data(), file.size(), palettes.joints.data(), palettes.joints.size(), SC_COLUMNS_4X4);
    if (!model) throw std::runtime_error(model.message());
    BodyDef def;
    def.finds_steps = 1;
    Body body(model, def), other(model, def);
    require(body.status());
    require(other.status());
    for (std::size_t frame = 0; is_pair && frame + 1 < palettes.frames.size(); frame += 10) {
      print_pair(body, other, palettes, frame);
    }
    for (std::size_t frame = 0; !is_pair && frame < palettes.frames.size(); ++frame) {
      print_frame(model, body, palettes, frame);
    }
    if (!is_timed) return 0;
    const Query query = options();
    const double contacts = time_of(palettes, [&](const std::vector<float>& palette) {
      require(body.set_pose(pose_of(palette)));
      body.contacts(query);
    });
    const double penetrations = time_of(palettes, [&](const std::vector<float>& palette) {
      require(body.set_pose(pose_of(palette)));
      body.penetrations(query);
    });
    Target target{};
    resolve_target(query.target, target);
    std::printf("%s %.4f %.4f\n", sc_target_name(target), contacts, penetrations);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reference: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
