// SPDX-License-Identifier: MIT
#include "asset/status.h"

extern "C" {

// No default below: the compiler names a value that is forgotten.
const char* sc_code_text(sc_code code) noexcept {
  switch (code) {
    case SC_OK:
      return "done";
    case SC_OVERFLOW:
      return "too small for what there is";
    case SC_NULL:
      return "null";
    case SC_MISALIGNED:
      return "not aligned as its type";
    case SC_TOO_SMALL:
      return "too small";
    case SC_BAD_STRIDE:
      return "a stride below the size of an entry, or no multiple of 4";
    case SC_BAD_VALUE:
      return "a value that does not exist";
    case SC_ALIASED:
      return "overlaps another buffer of the call";
    case SC_NOT_OPEN:
      return "not open";
    case SC_NOT_IN_ASSET:
      return "the asset has no data for this";
    case SC_UNSUPPORTED_TARGET:
      return "not in this build, or not on this machine";
    case SC_NOT_AN_ASSET:
      return "not a sphere chain asset";
    case SC_OTHER_VERSION:
      return "an asset of another format version";
    case SC_CORRUPT:
      return "cut short or damaged";
    case SC_WRONG_ABI:
      return "the program was compiled with other headers than the library";
    case SC_WRONG_SOURCE:
      return "not the vertices that the asset was baked from";
    case SC_NO_SUCH_BONE:
      return "the skeleton lacks a bone of the asset";
    case SC_OTHER_BIND:
      return "a bone rests elsewhere than in the asset";
    case SC_NO_MEMORY:
      return "out of memory";
    case SC_NO_DEVICE:
      return "no CUDA device, or no driver for one";
    case SC_DEVICE_FAILED:
      return "the CUDA device or its driver reported an error";
    case SC_DEVICE_TOO_SMALL:
      return "the asset does not fit into the memory that the CUDA device has for a block";
  }
  return "unknown code";
}

const char* sc_field_name(sc_field field) noexcept {
  switch (field) {
    case SC_FIELD_NONE:
      return "";
    case SC_FIELD_ASSET:
      return "asset";
    case SC_FIELD_DATA:
      return "data";
    case SC_FIELD_BONES:
      return "pose.bones";
    case SC_FIELD_BONE_COUNT:
      return "pose.bone_count";
    case SC_FIELD_BONE_LAYOUT:
      return "pose.bone_layout";
    case SC_FIELD_BONE_STRIDE:
      return "pose.bone_stride";
    case SC_FIELD_VERTICES:
      return "pose.vertices";
    case SC_FIELD_VERTEX_COUNT:
      return "pose.vertex_count";
    case SC_FIELD_VERTEX_STRIDE:
      return "pose.vertex_stride";
    case SC_FIELD_MORPH_WEIGHTS:
      return "pose.morph_weights";
    case SC_FIELD_RADIUS:
      return "radius";
    case SC_FIELD_TARGET:
      return "target";
    case SC_FIELD_SPHERES:
      return "spheres";
    case SC_FIELD_TABLE:
      return "table";
    case SC_FIELD_FILTER:
      return "filter";
    case SC_FIELD_PAIRS:
      return "pairs";
    case SC_FIELD_BITS:
      return "bits";
    case SC_FIELD_SCOPE:
      return "scope";
    case SC_FIELD_CANDIDATES:
      return "candidates";
    case SC_FIELD_SCRATCH:
      return "scratch";
    case SC_FIELD_PARTS:
      return "parts";
    case SC_FIELD_TRIANGLES:
      return "triangles";
    case SC_FIELD_INSTANCES:
      return "instance_count";
    case SC_FIELD_INSTANCE_STRIDE:
      return "instance_stride";
    case SC_FIELD_TASKS:
      return "task_count";
    case SC_FIELD_COUNTS:
      return "counts";
    case SC_FIELD_JOINTS:
      return "joints";
    case SC_FIELD_INDEX:
      return "index";
    case SC_FIELD_OUTPUT:
      return "output";
    case SC_FIELD_STREAM:
      return "stream";
    case SC_FIELD_SKIN_TABLE:
      return "skin_table";
  }
  return "unknown field";
}

}  // extern "C"
