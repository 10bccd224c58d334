// SPDX-License-Identifier: MIT
#include "spherechain/status.h"

namespace spherechain {

const char* to_string(Status status) noexcept {
  // No default: the compiler names a status that is forgotten here.
  switch (status) {
    case Status::kOk:
      return "done";
    case Status::kNullArgument:
      return "a required pointer is null";
    case Status::kMisaligned:
      return "memory is not aligned as it has to be, an asset to 8 bytes";
    case Status::kTruncated:
      return "fewer bytes than any asset has";
    case Status::kWrongIdentifier:
      return "not a sphere chain asset";
    case Status::kUnsupportedVersion:
      return "the asset's format version is not one this runtime reads";
    case Status::kCorrupt:
      return "the asset is corrupt";
    case Status::kNotOpen:
      return "the asset was never opened";
    case Status::kTooFewVertices:
      return "the vertex buffer is shorter than the asset's source";
    case Status::kTooFewSpheres:
      return "the sphere buffer holds fewer spheres than the asset";
    case Status::kContextTooSmall:
      return "the context's scratch memory is smaller than the asset needs";
    case Status::kOverflow:
      return "an output buffer was too small for what there is";
    case Status::kBadStride:
      return "a stride is too short or no multiple of 4";
    case Status::kWrongSource:
      return "the positions are not the rest pose the asset was baked from";
    case Status::kBadArgument:
      return "an argument has a value that does not exist";
    case Status::kUnsupportedTarget:
      return "this build or this machine does not have the instruction set asked for";
    case Status::kBadFilter:
      return "a filter's buffer has not the size the asset asks for";
    case Status::kSharedMemory:
      return "a buffer that is written shares memory with another";
    case Status::kNotInAsset:
      return "the asset lacks the tables for this (baked by an older version, or from a source without bones)";
    case Status::kTooFewBones:
      return "there are fewer bone matrices than the asset has bones";
    case Status::kTooFewMorphs:
      return "there are fewer morph weights than the asset has morph targets";
    case Status::kWrongAbi:
      return "the program was compiled with the headers of another version of the library";
    case Status::kNoDevice:
      return "there is no CUDA device, or no driver for one";
    case Status::kDeviceFailed:
      return "the CUDA device or its driver reported an error";
    case Status::kDeviceTooSmall:
      return "the asset does not fit into the memory that the CUDA device has for a block";
  }
  return "unknown status";
}

}  // namespace spherechain
