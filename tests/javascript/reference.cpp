// SPDX-License-Identifier: MIT
// What the JavaScript package must give: reference ASSET PALETTES. A line a frame of the palettes
// (samples/csharp/write_palettes): hashes of the spheres and pairs at both radii, of contacts, triangles and
// penetrations. --pair: instead a line every tenth frame of two characters, b in a's pose, moved 0.3 along x and z:
// hashes of contacts, quick and thorough penetrations. --time: last a line of milliseconds a frame: contacts, then
// contacts and penetrations. SPHERECHAIN_TARGET names an instruction set.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "simd/simd.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

using Words = std::vector<std::uint64_t>;

void require(const Status& status) {
  if (status != SC_OK)
    throw std::runtime_error(std::string(sc_field_name(status.field)) + ": " + sc_code_text(status.code));
}

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

class PosedCharacter {
 public:
  PosedCharacter(const std::vector<char>& bytes, const Palettes& palettes) : data_((bytes.size() + 7) / 8) {
    std::memcpy(data_.data(), bytes.data(), bytes.size());
    char message[256];
    if (sc_asset_open(&asset_, SC_ABI_VERSION, data_.data(), bytes.size(), message, sizeof message) != SC_OK) {
      throw std::runtime_error(message);
    }
    const AssetInfo info = sc_asset_get_info(&asset_);
    joint_of_bone_.resize(info.bone_count);
    bones_.resize(12 * info.bone_count);
    if (sc_bind_joints(&asset_, palettes.joints.data(), palettes.joints.size(), SC_COLUMNS_4X4, joint_of_bone_.data(),
                       info.bone_count, message, sizeof message) != SC_OK) {
      throw std::runtime_error(message);
    }
    spheres_.resize(info.sphere_count);
    pairs_.resize(info.sphere_count * info.sphere_count);
    parts_.resize(info.part_count * info.part_count);
    triangles_.resize(info.triangle_count);
    penetrations_.resize(parts_.size());
    table_.resize(sc_skin_table_words(&asset_));
    require(sc_prepare_skin(&asset_, table_.data(), table_.size()));
    scratch_.resize(sc_skin_scratch_words(&asset_));
    measure_scratch_.resize(sc_penetration_scratch_words(&asset_, triangles_.size()));
    const char* const name = std::getenv("SPHERECHAIN_TARGET");
    if (name != nullptr && !find_target(name, target_))
      throw std::runtime_error("SPHERECHAIN_TARGET: no such target here");
  }

  Target target() const { return target_; }
  void pose(const std::vector<float>& palette) {
    Pose from;
    from.bones = palette.data();
    from.bone_count = palette.size() / 16;
    from.bone_layout = SC_COLUMNS_4X4;
    require(sc_gather_bones(&asset_, joint_of_bone_.data(), &from, bones_.data()));
    pose_.bones = bones_.data();
    pose_.bone_count = joint_of_bone_.size();
    pose_.bone_layout = SC_ROWS_3X4;
  }
  void hash_spheres(Hash& spheres, Hash& pairs, Radius radius) {
    RefitJob refit;
    refit.asset = &asset_;
    refit.pose = pose_;
    refit.radius = radius;
    refit.target = target_;
    refit.spheres = spheres_.data();
    refit.sphere_capacity = spheres_.size();
    require(refit.run());
    spheres.add(spheres_.data(), spheres_.size());
    DetectJob detect;
    detect.asset = &asset_;
    detect.spheres = spheres_.data();
    detect.sphere_count = spheres_.size();
    detect.radius = radius;
    detect.target = target_;
    detect.pairs = pairs_.data();
    detect.pair_capacity = pairs_.size();
    require(detect.run());
    pairs.add(pairs_.data(), detect.pair_count);
  }
  void find_contacts(bool lists_triangles) {
    contacts_ = SkinContactJob();
    contacts_.asset = &asset_;
    contacts_.pose = pose_;
    contacts_.target = target_;
    contacts_.skin_table = table_.data();
    contacts_.scratch = scratch_.data();
    contacts_.scratch_words = scratch_.size();
    contacts_.parts = parts_.data();
    contacts_.part_capacity = parts_.size();
    contacts_.triangles = lists_triangles ? triangles_.data() : nullptr;
    contacts_.triangle_capacity = lists_triangles ? triangles_.size() : 0;
    require(contacts_.run());
  }
  void measure(bool quick) {
    PenetrationJob job;
    job.asset = &asset_;
    job.pose = pose_;
    job.target = target_;
    job.skin_table = table_.data();
    job.contacts = triangles_.data();
    job.contact_count = contacts_.triangle_count;
    job.quick = quick ? 1 : 0;
    job.scratch = measure_scratch_.data();
    job.scratch_words = measure_scratch_.size();
    job.penetrations = penetrations_.data();
    job.penetration_capacity = penetrations_.size();
    require(job.run());
    penetration_count_ = job.penetration_count;
  }
  void print_frame() {
    Hash spheres, pairs, parts, triangles, quick, thorough;
    for (const Radius radius : {SC_RADIUS_DETECT, SC_RADIUS_FIT}) hash_spheres(spheres, pairs, radius);
    find_contacts(true);
    parts.add(parts_.data(), contacts_.part_count);
    triangles.add(triangles_.data(), contacts_.triangle_count);
    measure(true);
    quick.add(penetrations_.data(), penetration_count_);
    measure(false);
    thorough.add(penetrations_.data(), penetration_count_);
    std::printf("%08x %08x %08x %08x %08x %08x\n", spheres.value, pairs.value, parts.value, triangles.value,
                quick.value, thorough.value);
  }

  // This one is a.
  void print_pair(const ::PosedCharacter& b) {
    Hash hashes[3];
    BodyContactJob found;
    found.a = {&asset_, pose_, table_.data(), nullptr};
    found.b = {&b.asset_, b.pose_, b.table_.data(), nullptr};
    Words scratch(sc_body_scratch_words(&asset_, &b.asset_));
    found.scratch = scratch.data();
    found.scratch_words = scratch.size();
    found.parts = parts_.data();
    found.part_capacity = parts_.size();
    found.triangles = triangles_.data();
    found.triangle_capacity = triangles_.size();
    require(found.run());
    hashes[0].add(parts_.data(), found.part_count);
    for (const int quick : {1, 0}) {
      BodyPenetrationJob job;
      job.a = found.a;
      job.b = found.b;
      job.contacts = triangles_.data();
      job.contact_count = found.triangle_count;
      job.quick = quick;
      scratch.resize(sc_body_penetration_scratch_words(&asset_, &b.asset_, job.contact_count));
      job.scratch = scratch.data();
      job.scratch_words = scratch.size();
      job.penetrations = penetrations_.data();
      job.penetration_capacity = penetrations_.size();
      require(job.run());
      hashes[2 - quick].add(penetrations_.data(), job.penetration_count);
    }
    std::printf("%zu %08x %08x %08x\n", found.part_count, hashes[0].value, hashes[1].value, hashes[2].value);
  }

 private:
  Words data_, table_, scratch_, measure_scratch_;
  Asset asset_;
  Pose pose_;
  Target target_ = SC_TARGET_BEST;
  std::vector<std::uint32_t> joint_of_bone_;
  std::vector<float> bones_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::vector<PartContact> parts_;
  std::vector<TriangleContact> triangles_;
  std::vector<Penetration> penetrations_;
  std::size_t penetration_count_ = 0;
  SkinContactJob contacts_;
};

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
    ::PosedCharacter character(read(argv[1]), palettes);
    if (is_pair) {
      ::PosedCharacter other(read(argv[1]), palettes);
      for (std::size_t frame = 0; frame < palettes.frames.size(); frame += 10) {
        std::vector<float> moved = palettes.frames[frame];
        for (std::size_t i = 12; i < moved.size(); i += 16) {
          moved[i] += 0.3F;
          moved[i + 2] += 0.3F;
        }
        character.pose(palettes.frames[frame]);
        other.pose(moved);
        character.print_pair(other);
      }
      return 0;
    }
    for (const std::vector<float>& palette : palettes.frames) {
      character.pose(palette);
      character.print_frame();
    }
    if (!is_timed) return 0;
    const double contacts = time_of(palettes, [&](const std::vector<float>& palette) {
      character.pose(palette);
      character.find_contacts(false);
    });
    const double penetrations = time_of(palettes, [&](const std::vector<float>& palette) {
      character.pose(palette);
      character.find_contacts(true);
      character.measure(true);
    });
    Target target{};
    resolve_target(character.target(), target);
    std::printf("%s %.4f %.4f\n", sc_target_name(target), contacts, penetrations);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reference: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
