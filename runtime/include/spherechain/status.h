// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/abi.h"

namespace spherechain {

// What every operation of the runtime returns. Values are never reassigned; new ones are appended.
enum class Status : int {
  kOk = 0,
  kNullArgument = 1,        // a required pointer is null
  kMisaligned = 2,          // memory that is not aligned as its type; an asset's bytes, to kAssetAlignment
  kTruncated = 3,           // fewer bytes than any asset has
  kWrongIdentifier = 4,     // not a .sphc file
  kUnsupportedVersion = 5,  // written by a newer (or never released) format
  kCorrupt = 6,             // the FlatBuffers structure is broken, or a value is out of its range
  kNotOpen = 7,             // the Asset was never opened
  kTooFewVertices = 8,      // the vertex buffer is shorter than the asset's source
  kTooFewSpheres = 9,       // a sphere buffer holds fewer spheres than the asset has
  kContextTooSmall = 10,    // the caller's scratch memory is smaller than the asset needs
  kOverflow = 11,           // an output buffer was too small; the job says how many entries were needed
  kBadStride = 12,          // a stride shorter than what it strides over (a vertex: 12 bytes), or no multiple of 4
  kWrongSource = 13,        // the positions are not the rest pose the asset was baked from
  kBadArgument = 14,        // an enum value or an index that does not exist
  kUnsupportedTarget = 15,  // this build or this machine does not have the instruction set asked for
  kBadFilter = 16,          // a Filter's buffer has not the size the asset asks for
  kSharedMemory = 17,       // a buffer that is written shares memory with another of the call's
  kNotInAsset = 18,         // the asset lacks the tables the job reads: of an older baker, or of a source without bones
  kTooFewBones = 19,        // fewer bone matrices than the asset has bones
  kTooFewMorphs = 20,       // morph weights, but fewer than the asset has morph targets
  kWrongAbi = 21,           // the program was compiled with the headers of another version of the library
  kNoDevice = 22,           // no CUDA device, or no driver for one
  kDeviceFailed = 23,       // the CUDA device or its driver reported an error
  kDeviceTooSmall = 24,     // the asset does not fit into a block's memory on the CUDA device
};

// A short English sentence without a final stop. Never null, also for values that do not exist.
SPHERECHAIN_API const char* to_string(Status status) noexcept;

}  // namespace spherechain
