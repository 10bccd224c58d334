// SPDX-License-Identifier: MIT
// What spherechain.js calls: the C interface, with a character's memory and its lists in one object, and results in
// words at fixed places. Lists grow to the largest frame so far. One thread.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>

#include "asset/asset_view.h"
#include "asset/status.h"
#include "pose/pose.h"
#include "simd/simd.h"
#include "skin/skin_inputs.h"
#include "skin/skin_table.h"
#include "spherechain/spherechain.h"
#include "spherechain/version.h"

#define EXPORT(name) extern "C" __attribute__((export_name(#name)))

using namespace spherechain;

namespace {

// Why the last call that failed did.
char message[256];

// Of a call that wrote the sentence itself.
bool fails(const Status& status) { return status != SC_OK; }

bool fails_alone(const Status& status) {
  if (status == SC_OK) {
    return false;
  }
  const char* const field = sc_field_name(status.field);
  std::snprintf(message, sizeof message, "%s%s%s", field, *field == 0 ? "" : ": ", sc_code_text(status.code));
  return true;
}

bool are_finite(const float* values, std::size_t count) {
  return std::all_of(values, values + count, [](float value) { return std::isfinite(value); });
}

bool is_out_of_memory() { return fails_alone({SC_NO_MEMORY, SC_FIELD_NONE}); }

// A list in memory of its own.
template <typename T>
class List {
 public:
  List() = default;
  List(const List&) = delete;
  List& operator=(const List&) = delete;
  ~List() { std::free(data_); }

  // Room for so many, whose values are any. False where there is no memory.
  bool reserve(std::size_t count) {
    if (count <= capacity_) {
      return true;
    }
    std::free(data_);
    capacity_ = 0;
    data_ = count > SIZE_MAX / sizeof(T) ? nullptr : static_cast<T*>(std::malloc(count * sizeof(T)));
    capacity_ = data_ == nullptr ? 0 : count;
    return data_ != nullptr;
  }
  T* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }

 private:
  T* data_ = nullptr;
  std::size_t capacity_ = 0;
};

using Words = List<std::uint64_t>;

constexpr std::size_t kTrianglesMin = 4096;  // pairs that a frame has room for at first

struct OpenedAsset {
  sc_asset asset{};
  void* bytes = nullptr;
  Words skin_table;
  Surface surface;
  List<std::uint32_t> triangles;  // three of surface's vertices for each of the source's

  ~OpenedAsset() { std::free(bytes); }
  sc_asset_info info() const { return sc_asset_get_info(&asset); }
  bool has_skin() const { return skin_table.capacity() > 0; }
};

// Words that JavaScript reads; pointers and counts.
struct Results {
  float* palette;  // in
  float* morph_weights;
  Sphere* spheres;
  Pair* pairs;
  std::uint32_t pair_count;
  PartContact* contacts;
  std::uint32_t contact_count;
  TriangleContact* triangles;
  std::uint32_t triangle_count;
  Penetration* penetrations;
  std::uint32_t penetration_count;
  float* vertices;
  std::uint32_t vertex_count;
  PartContact* contacts_with;  // another character
  std::uint32_t contact_with_count;
  Penetration* penetrations_with;
  std::uint32_t penetration_with_count;
};

struct PosedCharacter {
  Results results{};
  const OpenedAsset* asset = nullptr;
  std::uint32_t joint_count = 0;
  List<std::uint32_t> joint_of_bone;
  List<float> palette, morph_weights, bones, vertices;
  bool morphs = false;
  Words detect_tables[2], scratch;
  List<Sphere> spheres;
  List<Pair> pairs;
  List<PartContact> contacts, contacts_with;
  List<TriangleContact> triangles, triangles_with;
  List<Penetration> penetrations, previous, penetrations_with;
  std::size_t previous_count = 0, triangle_with_count = 0;

  Pose pose() const {
    Pose pose;
    pose.bones = bones.data();
    pose.bone_count = asset->info().bone_count;
    pose.bone_layout = SC_ROWS_3X4;
    pose.morph_weights = morphs ? morph_weights.data() : nullptr;
    pose.morph_weight_count = morphs ? asset->info().morph_count : 0;
    return pose;
  }
  JobBody body() const { return {&asset->asset, pose(), asset->skin_table.data(), nullptr}; }
};

// As spherechain.js reads them.
static_assert(sizeof(void*) == 4 && sizeof(Results) == 17 * 4);
static_assert(sizeof(PartContact) == 9 * 4 && offsetof(PartContact, low) == 12);
static_assert(sizeof(TriangleContact) == 12 * 4 && offsetof(TriangleContact, from) == 24);
static_assert(sizeof(Penetration) == 44 * 4 && offsetof(Penetration, direction) == 16);
static_assert(offsetof(Penetration, centre) == 32 && offsetof(Penetration, deepest_other) == 96);
static_assert(offsetof(Penetration, measures) == 124 && offsetof(sc_measures, is_one_piece) == 48);
static_assert(sizeof(sc_bone) == 8 && sizeof(sc_part) == 20 && sizeof(sc_rest_sphere) == 32);

bool list_triangles(OpenedAsset& opened) {
  const std::size_t count = opened.info().triangle_count;
  if (!opened.triangles.reserve(3 * count)) {
    return false;
  }
  std::memset(opened.triangles.data(), 0, 3 * count * sizeof(std::uint32_t));
  const Surface& surface = opened.surface;
  for (std::size_t place = 0; place < surface.triangles.size; ++place) {
    std::memcpy(opened.triangles.data() + 3 * surface.triangles[place], surface.triangle_vertices.data + 3 * place,
                3 * sizeof(std::uint32_t));
  }
  return true;
}

// Runs a job that lists triangles, again with more room where they are too many. As the functions below, 0 or 1.
template <typename Job>
int find_all(Job& job, List<TriangleContact>& triangles, bool lists_triangles) {
  for (;;) {
    job.triangles = lists_triangles ? triangles.data() : nullptr;
    job.triangle_capacity = lists_triangles ? triangles.capacity() : 0;
    const Status status = job.run();
    if (status != SC_OVERFLOW) {
      return fails_alone(status);
    }
    if (!triangles.reserve(job.triangle_count + job.triangle_count / 2)) {
      return is_out_of_memory();
    }
  }
}

}  // namespace

EXPORT(failure) const char* failure() { return message; }
EXPORT(version) const char* version() { return SC_VERSION; }
EXPORT(allocate) void* allocate(std::size_t size) { return std::malloc(size); }
EXPORT(release) void release(void* memory) { std::free(memory); }

// Takes `bytes`, of allocate(). Null: failure().
EXPORT(open_asset) OpenedAsset* open_asset(void* bytes, std::size_t size) {
  void* const memory = std::malloc(sizeof(OpenedAsset));
  if (memory == nullptr) {
    std::free(bytes);
    is_out_of_memory();
    return nullptr;
  }
  auto* const opened = new (memory) OpenedAsset;
  opened->bytes = bytes;
  const auto close = [&] {
    opened->~OpenedAsset();
    std::free(memory);
    return nullptr;
  };
  if (fails(sc_asset_open(&opened->asset, SC_ABI_VERSION, bytes, size, message, sizeof message))) {
    return close();
  }
  const std::size_t words = sc_skin_table_words(&opened->asset);
  if (words == 0) {
    return opened;
  }
  if (!opened->skin_table.reserve(words)) {
    is_out_of_memory();
    return close();
  }
  if (fails_alone(sc_prepare_skin(&opened->asset, opened->skin_table.data(), words)) ||
      fails_alone(read_skin_table(view_of(opened->asset), opened->skin_table.data(), opened->surface))) {
    return close();
  }
  if (!list_triangles(*opened)) {
    is_out_of_memory();
    return close();
  }
  return opened;
}

EXPORT(close_asset) void close_asset(OpenedAsset* opened) {
  opened->~OpenedAsset();
  std::free(opened);
}

// Into `words`: numbers, then as floats origin, left, up, forward, height, metres per unit, then texts.
EXPORT(describe) void describe(const OpenedAsset* opened, std::uint32_t* words) {
  const sc_asset_info info = opened->info();
  const auto number = [&](std::size_t value) { *words++ = static_cast<std::uint32_t>(value); };
  number(info.sphere_count), number(info.bone_count), number(info.part_count), number(info.morph_count);
  number(info.region_count), number(info.vertex_count), number(info.triangle_count);
  number(reinterpret_cast<std::uintptr_t>(opened->triangles.data()));
  number(reinterpret_cast<std::uintptr_t>(info.source_file));
  const float figures[] = {info.origin.x,  info.origin.y,  info.origin.z, info.left.x,         info.left.y,
                           info.left.z,    info.up.x,      info.up.y,     info.up.z,           info.forward.x,
                           info.forward.y, info.forward.z, info.height,   info.metres_per_unit};
  std::memcpy(words, figures, sizeof figures);
}

EXPORT(describe_bone) void describe_bone(const OpenedAsset* opened, std::size_t i, sc_bone* out) {
  *out = sc_asset_bone(&opened->asset, i);
}
EXPORT(describe_part) void describe_part(const OpenedAsset* opened, std::size_t i, sc_part* out) {
  *out = sc_asset_part(&opened->asset, i);
}
EXPORT(describe_sphere) void describe_sphere(const OpenedAsset* opened, std::size_t i, sc_rest_sphere* out) {
  *out = sc_asset_sphere(&opened->asset, i);
}
EXPORT(region_name) const char* region_name(const OpenedAsset* opened, std::size_t i) {
  return sc_asset_region_name(&opened->asset, i);
}
EXPORT(morph_name) const char* morph_name(const OpenedAsset* opened, std::size_t i) {
  return sc_asset_morph_name(&opened->asset, i);
}
EXPORT(class_name) const char* class_name(std::int32_t kind) {
  return sc_penetration_class_name(static_cast<PenetrationClass>(kind));
}

EXPORT(destroy_character) void destroy_character(PosedCharacter* character) {
  character->~PosedCharacter();
  std::free(character);
}

// `joints` null: palettes in the asset's order. Inverse binds by columns or rows, or null. Null: failure().
EXPORT(create_character)
PosedCharacter* create_character(const OpenedAsset* asset, const sc_bone* joints, std::size_t joint_count,
                                 std::int32_t layout) {
  void* const memory = std::malloc(sizeof(PosedCharacter));
  if (memory == nullptr) {
    is_out_of_memory();
    return nullptr;
  }
  auto* const made = new (memory) PosedCharacter;
  made->asset = asset;
  const sc_asset_info info = asset->info();
  const std::size_t bones = info.bone_count, spheres = info.sphere_count, parts = info.part_count;
  made->joint_count = static_cast<std::uint32_t>(joints == nullptr ? bones : joint_count);
  const std::size_t table = sc_detect_table_words(&asset->asset);
  if (!made->joint_of_bone.reserve(bones) || !made->palette.reserve(16 * made->joint_count) ||
      !made->bones.reserve(12 * bones) || !made->morph_weights.reserve(info.morph_count) ||
      !made->spheres.reserve(spheres) || !made->pairs.reserve(spheres * (spheres - 1) / 2) ||
      !made->detect_tables[0].reserve(table) || !made->detect_tables[1].reserve(table) ||
      !made->scratch.reserve(sc_skin_scratch_words(&asset->asset)) ||
      !made->scratch.reserve(sc_penetration_scratch_words(&asset->asset, kTrianglesMin)) ||
      !made->contacts.reserve(parts * (parts + 1) / 2) || !made->penetrations.reserve(parts * (parts + 1) / 2) ||
      !made->previous.reserve(parts * (parts + 1) / 2) ||
      !made->triangles.reserve(asset->has_skin() ? kTrianglesMin : 0) ||
      !made->vertices.reserve(3 * asset->surface.source_vertices.size)) {
    is_out_of_memory();
    destroy_character(made);
    return nullptr;
  }
  for (std::uint32_t b = 0; b < bones; ++b) {
    made->joint_of_bone.data()[b] = b;
  }
  if (joints != nullptr && fails(sc_bind_joints(&asset->asset, joints, joint_count,
                                                layout == 0 ? SC_ROWS_3X4 : static_cast<MatrixLayout>(layout),
                                                made->joint_of_bone.data(), bones, message, sizeof message))) {
    destroy_character(made);
    return nullptr;
  }
  for (const Radius radius : {SC_RADIUS_DETECT, SC_RADIUS_FIT}) {
    if (fails_alone(sc_prepare_detect(&asset->asset, radius, nullptr, made->detect_tables[radius].data(), table))) {
      destroy_character(made);
      return nullptr;
    }
  }
  Results& results = made->results;
  results.palette = made->palette.data();
  results.morph_weights = made->morph_weights.data();
  results.spheres = made->spheres.data();
  results.pairs = made->pairs.data();
  results.contacts = made->contacts.data();
  results.vertices = made->vertices.data();
  results.vertex_count = static_cast<std::uint32_t>(asset->surface.source_vertices.size);
  return made;
}

// Takes what JavaScript wrote into results.palette and results.morph_weights. The functions below return 0, or 1 and
// failure().
EXPORT(set_pose) int set_pose(PosedCharacter* c, std::int32_t layout, int morphs) {
  c->morphs = morphs != 0;
  Pose palette;
  palette.bones = c->palette.data();
  palette.bone_count = c->joint_count;
  palette.bone_layout = static_cast<MatrixLayout>(layout);
  if (fails_alone(sc_gather_bones(&c->asset->asset, c->joint_of_bone.data(), &palette, c->bones.data()))) {
    return 1;
  }
  // A pose that is not finite has no contacts: it would look clean.
  const sc_asset_info info = c->asset->info();
  for (std::size_t b = 0; b < info.bone_count; ++b) {
    if (!are_finite(c->bones.data() + 12 * b, 12)) {
      std::snprintf(message, sizeof message, "the palette's matrix of bone \"%s\" (joint %u) is not finite",
                    sc_asset_bone(&c->asset->asset, b).name, c->joint_of_bone.data()[b]);
      return 1;
    }
  }
  for (std::size_t m = 0; m < (c->morphs ? info.morph_count : 0); ++m) {
    if (!std::isfinite(c->morph_weights.data()[m])) {
      std::snprintf(message, sizeof message, "the weight of morph \"%s\" is not finite",
                    sc_asset_morph_name(&c->asset->asset, m));
      return 1;
    }
  }
  return 0;
}

EXPORT(check_rest) int check_rest(PosedCharacter* c) {
  const Pose pose = c->pose();
  return fails(sc_check_rest_pose(&c->asset->asset, &pose, message, sizeof message));
}

EXPORT(refit) int refit(PosedCharacter* c, std::int32_t radius) {
  RefitJob job;
  job.asset = &c->asset->asset;
  job.pose = c->pose();
  job.radius = static_cast<Radius>(radius);
  job.spheres = c->spheres.data();
  job.sphere_capacity = c->spheres.capacity();
  return fails_alone(job.run());
}

EXPORT(detect) int detect(PosedCharacter* c, std::int32_t radius) {
  if (refit(c, radius)) {
    return 1;
  }
  DetectJob job;
  job.asset = &c->asset->asset;
  job.spheres = c->spheres.data();
  job.sphere_count = c->spheres.capacity();
  job.radius = static_cast<Radius>(radius);
  job.table = c->detect_tables[radius].data();
  job.pairs = c->pairs.data();
  job.pair_capacity = c->pairs.capacity();
  const bool failed = fails_alone(job.run());
  c->results.pair_count = static_cast<std::uint32_t>(failed ? 0 : job.pair_count);
  return failed;
}

EXPORT(find_contacts) int find_contacts(PosedCharacter* c, std::int32_t scope, int lists_triangles) {
  Results& results = c->results;
  results.contact_count = results.triangle_count = 0;
  SkinContactJob job;
  job.asset = &c->asset->asset;
  job.pose = c->pose();
  job.scope = static_cast<Scope>(scope);
  job.skin_table = c->asset->skin_table.data();
  job.scratch = c->scratch.data();
  job.scratch_words = sc_skin_scratch_words(&c->asset->asset);
  job.parts = c->contacts.data();
  job.part_capacity = c->contacts.capacity();
  if (find_all(job, c->triangles, lists_triangles != 0)) {
    return 1;
  }
  results.contact_count = static_cast<std::uint32_t>(job.part_count);
  results.triangles = c->triangles.data();
  results.triangle_count = static_cast<std::uint32_t>(job.triangle_count);
  return 0;
}

// Of the triangles that find_contacts() listed, with its scope.
EXPORT(measure) int measure(PosedCharacter* c, std::int32_t scope, int quick) {
  Results& results = c->results;
  results.penetration_count = 0;
  if (!c->scratch.reserve(sc_penetration_scratch_words(&c->asset->asset, results.triangle_count))) {
    return is_out_of_memory();
  }
  // The frame before is kept of the thorough measure alone.
  List<Penetration>& out = c->penetrations;
  PenetrationJob job;
  job.asset = &c->asset->asset;
  job.pose = c->pose();
  job.scope = static_cast<Scope>(scope);
  job.skin_table = c->asset->skin_table.data();
  job.contacts = results.triangles;
  job.contact_count = results.triangle_count;
  job.previous = quick != 0 ? nullptr : c->previous.data();
  job.previous_count = quick != 0 ? 0 : c->previous_count;
  job.quick = quick;
  job.scratch = c->scratch.data();
  job.scratch_words = c->scratch.capacity();
  job.penetrations = out.data();
  job.penetration_capacity = out.capacity();
  if (fails_alone(job.run())) {
    return 1;
  }
  results.penetrations = out.data();
  results.penetration_count = static_cast<std::uint32_t>(job.penetration_count);
  if (quick == 0) {
    c->previous_count = job.penetration_count;
    std::memcpy(c->previous.data(), out.data(), job.penetration_count * sizeof(Penetration));
  }
  return 0;
}

// Contacts of two characters; `c` keeps what is found.
EXPORT(meet) int meet(PosedCharacter* c, const PosedCharacter* other, int lists_triangles) {
  Results& results = c->results;
  results.contact_with_count = 0;
  BodyContactJob job;
  job.a = c->body();
  job.b = other->body();
  if (!c->asset->has_skin() || !other->asset->has_skin()) {
    return fails_alone({SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  }
  if (!c->scratch.reserve(sc_body_scratch_words(job.a.asset, job.b.asset)) ||
      !c->contacts_with.reserve(c->asset->info().part_count * other->asset->info().part_count) ||
      !c->triangles_with.reserve(lists_triangles != 0 ? kTrianglesMin : 0)) {
    return is_out_of_memory();
  }
  job.scratch = c->scratch.data();
  job.scratch_words = c->scratch.capacity();
  job.parts = c->contacts_with.data();
  job.part_capacity = c->contacts_with.capacity();
  if (find_all(job, c->triangles_with, lists_triangles != 0)) {
    return 1;
  }
  results.contacts_with = c->contacts_with.data();
  results.contact_with_count = static_cast<std::uint32_t>(job.part_count);
  c->triangle_with_count = job.triangle_count;
  return 0;
}

// Of the triangles that meet() listed.
EXPORT(measure_meeting) int measure_meeting(PosedCharacter* c, const PosedCharacter* other, int quick) {
  Results& results = c->results;
  results.penetration_with_count = 0;
  BodyPenetrationJob job;
  job.a = c->body();
  job.b = other->body();
  job.contacts = c->triangles_with.data();
  job.contact_count = c->triangle_with_count;
  job.quick = quick;
  if (!c->scratch.reserve(sc_body_penetration_scratch_words(job.a.asset, job.b.asset, job.contact_count)) ||
      !c->penetrations_with.reserve(c->contacts_with.capacity())) {
    return is_out_of_memory();
  }
  job.scratch = c->scratch.data();
  job.scratch_words = c->scratch.capacity();
  job.penetrations = c->penetrations_with.data();
  job.penetration_capacity = c->penetrations_with.capacity();
  if (fails_alone(job.run())) {
    return 1;
  }
  results.penetrations_with = c->penetrations_with.data();
  results.penetration_with_count = static_cast<std::uint32_t>(job.penetration_count);
  return 0;
}

EXPORT(skin) int skin(PosedCharacter* c) {
  const OpenedAsset& asset = *c->asset;
  const Pose pose = c->pose();
  if (!asset.has_skin()) {
    return fails_alone({SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  }
  if (fails_alone(check_bones(view_of(asset.asset), pose))) {
    return 1;
  }
  Target target{};
  resolve_target(SC_TARGET_BEST, target);
  skin_vertices(asset.surface, pose, target, {}, c->vertices.data());
  return 0;
}
