// SPDX-License-Identifier: MIT
#include "runtime/src/base/status.h"

#include <utility>

namespace {

constexpr std::pair<sc_code, const char*> kCodeTexts[] = {
    {SC_OK, "done"},
    {SC_OVERFLOW, "too small for what there is"},
    {SC_NULL, "null"},
    {SC_MISALIGNED, "not aligned as its type"},
    {SC_TOO_SMALL, "too small"},
    {SC_BAD_STRIDE, "a stride below the size of an entry, or no multiple of 4"},
    {SC_BAD_VALUE, "a value that does not exist"},
    {SC_ALIASED, "overlaps another buffer of the call"},
    {SC_NOT_OPEN, "not open"},
    {SC_NOT_IN_ASSET, "the asset has no data for this"},
    {SC_UNSUPPORTED_TARGET, "not in this build, or not on this machine"},
    {SC_NOT_AN_ASSET, "not a sphere chain asset"},
    {SC_OTHER_VERSION, "an asset of another format version"},
    {SC_CORRUPT, "cut short or damaged"},
    {SC_WRONG_ABI, "the program was compiled with other headers than the library"},
    {SC_WRONG_SOURCE, "not the vertices that the asset was baked from"},
    {SC_NO_SUCH_BONE, "the skeleton lacks a bone of the asset"},
    {SC_OTHER_BIND, "a bone rests elsewhere than in the asset"},
    {SC_NO_MEMORY, "out of memory"},
    {SC_NO_DEVICE, "no CUDA device, or no driver for one"},
    {SC_DEVICE_FAILED, "the CUDA device or its driver reported an error"},
    {SC_DEVICE_TOO_SMALL, "the asset does not fit into the memory that the CUDA device has for a block"},
};

constexpr std::pair<sc_field, const char*> kFieldNames[] = {
    {SC_FIELD_NONE, ""},
    {SC_FIELD_ASSET, "asset"},
    {SC_FIELD_DATA, "data"},
    {SC_FIELD_BONES, "pose.bones"},
    {SC_FIELD_BONE_COUNT, "pose.bone_count"},
    {SC_FIELD_BONE_LAYOUT, "pose.bone_layout"},
    {SC_FIELD_BONE_STRIDE, "pose.bone_stride"},
    {SC_FIELD_VERTICES, "pose.vertices"},
    {SC_FIELD_VERTEX_COUNT, "pose.vertex_count"},
    {SC_FIELD_VERTEX_STRIDE, "pose.vertex_stride"},
    {SC_FIELD_MORPH_WEIGHTS, "pose.morph_weights"},
    {SC_FIELD_RADIUS, "radius"},
    {SC_FIELD_TARGET, "target"},
    {SC_FIELD_SPHERES, "spheres"},
    {SC_FIELD_TABLE, "table"},
    {SC_FIELD_IGNORED_PAIRS, "ignored_pairs"},
    {SC_FIELD_PAIRS, "pairs"},
    {SC_FIELD_BITS, "bits"},
    {SC_FIELD_SCOPE, "scope"},
    {SC_FIELD_CANDIDATES, "candidates"},
    {SC_FIELD_SCRATCH, "scratch"},
    {SC_FIELD_PARTS, "parts"},
    {SC_FIELD_TRIANGLES, "triangles"},
    {SC_FIELD_INSTANCES, "instance_count"},
    {SC_FIELD_INSTANCE_STRIDE, "instance_stride"},
    {SC_FIELD_TASKS, "task_count"},
    {SC_FIELD_COUNTS, "counts"},
    {SC_FIELD_JOINTS, "joints"},
    {SC_FIELD_INDEX, "index"},
    {SC_FIELD_OUTPUT, "output"},
    {SC_FIELD_STREAM, "stream"},
    {SC_FIELD_SKIN_TABLE, "skin_table"},
    {SC_FIELD_CONTACTS, "contacts"},
    {SC_FIELD_PREVIOUS, "previous"},
    {SC_FIELD_PENETRATIONS, "penetrations"},
    {SC_FIELD_RULE, "rule"},
    {SC_FIELD_IGNORED_PARTS, "ignored_parts"},
    {SC_FIELD_BODIES, "bodies"},
    {SC_FIELD_LAYERS, "layers"},
    {SC_FIELD_IGNORED, "ignored"},
    {SC_FIELD_FLOOR, "floor"},
    {SC_FIELD_END, "end"},
    {SC_FIELD_BLEND, "blend"},
    {SC_FIELD_PARENTS, "parents"},
    {SC_FIELD_TOLERANCE, "tolerance"},
    {SC_FIELD_TRANSFORM, "transform"},
    {SC_FIELD_ALLOCATOR, "allocator"},
    {SC_FIELD_QUERY, "query"},
    {SC_FIELD_PART_PAIRS, "part_pairs"},
    {SC_FIELD_STRUCT_SIZE, "struct_size"},
};

template <typename Texts, typename Value>
const char* text_of(const Texts& texts, Value value, const char* unknown) {
  for (const auto& [known, text] : texts) {
    if (known == value) {
      return text;
    }
  }
  return unknown;
}

}  // namespace

extern "C" {

const char* sc_code_text(sc_code code) noexcept { return text_of(kCodeTexts, code, "unknown code"); }

const char* sc_field_name(sc_field field) noexcept { return text_of(kFieldNames, field, "unknown field"); }

}  // extern "C"
