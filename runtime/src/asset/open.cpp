// SPDX-License-Identifier: MIT
// Verifies an asset's bytes.
#include <bitset>
#include <new>

#include "runtime/src/asset/asset_checks.h"
#include "runtime/src/base/status.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

constexpr std::size_t kHeaderSize = 8;  // the root's offset and the identifier
constexpr std::size_t kMinSize = kHeaderSize + sizeof(schema::Sphere) + sizeof(schema::Pivot);
constexpr std::size_t kMaxSize = FLATBUFFERS_MAX_BUFFER_SIZE - 1;
constexpr flatbuffers::uoffset_t kMaxDepth = 8;        // the schema's tables nest two deep
constexpr flatbuffers::uoffset_t kMaxTables = 100000;  // regions, chains, bones: some dozens in a human

// The version of bytes that have not passed the verifier yet; false where they have no readable one.
bool read_version(const std::uint8_t* bytes, std::size_t size, std::uint32_t& version) {
  flatbuffers::Verifier verifier(bytes, size);
  if (verifier.VerifyOffset(0) == 0) {
    return false;
  }
  const auto& root = *flatbuffers::GetRoot<flatbuffers::Table>(bytes);
  constexpr flatbuffers::voffset_t kField = schema::Asset::VT_FORMAT_VERSION;
  if (!root.VerifyTableStart(verifier) || !root.VerifyField<std::uint32_t>(verifier, kField, alignof(std::uint32_t))) {
    return false;
  }
  version = root.GetField<std::uint32_t>(kField, 0);
  return true;
}

sc_code verify(const void* data, std::size_t size, Message& message) {
  if (data == nullptr) {
    message.wrong("data: null");
    return SC_NULL;
  }
  if (reinterpret_cast<std::uintptr_t>(data) % SC_ASSET_ALIGNMENT != 0) {
    message.wrong("data: not aligned to %d bytes", SC_ASSET_ALIGNMENT);
    return SC_MISALIGNED;
  }
  if (size < kHeaderSize || !schema::AssetBufferHasIdentifier(data)) {
    message.wrong("file identifier: not \"%s\", so this is no sphere chain asset", schema::AssetIdentifier());
    return SC_NOT_AN_ASSET;
  }
  if (size < kMinSize || size > kMaxSize) {
    message.wrong("size: %zu bytes, but an asset has %zu to %zu", size, kMinSize, kMaxSize);
    return SC_CORRUPT;
  }
  // The version first: another format's tables need not pass this one's verifier.
  const auto* const bytes = static_cast<const std::uint8_t*>(data);
  std::uint32_t version = 0;
  if (read_version(bytes, size, version) && version != kFormatVersion) {
    message.wrong("format_version: %" PRIu32 ", but this runtime reads %" PRIu32 " only: %s", version, kFormatVersion,
                  version < kFormatVersion ? "bake it again" : "update spherechain, or bake it with this version");
    return SC_OTHER_VERSION;
  }
  flatbuffers::Verifier verifier(bytes, size, kMaxDepth, kMaxTables);
  if (!schema::VerifyAssetBuffer(verifier)) {
    message.wrong("structure: an offset or an array of the %zu bytes leads outside them (cut short or overwritten?)",
                  size);
    return SC_CORRUPT;
  }
  return SC_OK;
}

}  // namespace

Status check_abi(std::uint32_t abi, Message& message) {
  if (abi == SC_ABI_VERSION) {
    return done();
  }
  message.wrong("compiled with spherechain's headers of ABI version %" PRIu32 ", linked with its library of %d", abi,
                SC_ABI_VERSION);
  return refuse(SC_WRONG_ABI, SC_FIELD_NONE);
}

Status AssetView::open(const void* data, std::size_t size, Message& message) noexcept {
  const sc_code code = verify(data, size, message);
  if (code != SC_OK) {
    return refuse(code, SC_FIELD_DATA);
  }
  const schema::Asset& root = *schema::GetAsset(data);
  view(root);
  if (!values_are_valid(root, *this, size, skin_.sizes, message)) {
    *this = AssetView();
    return refuse(SC_CORRUPT, SC_FIELD_DATA);
  }
  for (const std::uint64_t word : ignored_) {
    ignored_count_ += std::bitset<64>(word).count();
  }
  return done();
}

}  // namespace spherechain

extern "C" {

sc_status sc_asset_open(sc_asset* asset, uint32_t abi, const void* data, size_t size, char* message,
                        size_t message_size) noexcept {
  using namespace spherechain;
  Message sentence(message, message_size);
  const Status same = check_abi(abi, sentence);
  if (same != SC_OK) {
    return same;
  }
  if (asset == nullptr) {
    sentence.wrong("asset: null");
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  return (new (asset) AssetView)->open(data, size, sentence);
}

}  // extern "C"
