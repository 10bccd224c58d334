// SPDX-License-Identifier: GPL-3.0-or-later
#include <zlib.h>

#include <algorithm>
#include <cstdint>

#include "baker/import/arrays.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kEntryMax = std::size_t{1} << 30;  // bytes

// A member of a zip archive, by its central directory.
struct ZipEntry {
  std::string name;
  std::uint64_t method = 0, flags = 0, checksum = 0, packed = 0, size = 0, header_at = 0;
};

class ZipFile {
 public:
  ZipFile(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {
    std::uint64_t at = end_record(), count = number(at + 10, 2), directory = number(at + 16, 4);
    constexpr std::uint64_t kLocator = 20;
    if (at >= kLocator && number(at - kLocator, 4) == 0x07064b50) {  // zip64
      at = number(at - kLocator + 8, 8);
      if (number(at, 4) != 0x06064b50) fail();
      count = number(at + 32, 8);
      directory = number(at + 48, 8);
    }
    for (std::uint64_t e = 0; e < count; ++e) {
      if (number(directory, 4) != 0x02014b50) fail();
      entries_.push_back(entry_at(directory));
      directory += 46 + number(directory + 28, 2) + number(directory + 30, 2) + number(directory + 32, 2);
    }
  }
  const std::vector<ZipEntry>& entries() const { return entries_; }

  // The bytes of a member, unpacked. Throws Error(kFile).
  std::string unpacked(const ZipEntry& entry) const {
    if (number(entry.header_at, 4) != 0x04034b50) fail();
    const std::uint64_t at = entry.header_at + 30 + number(entry.header_at + 26, 2) + number(entry.header_at + 28, 2);
    const std::string_view packed = part(at, entry.packed);
    if ((entry.flags & 1) != 0) fail("is encrypted (save it without a password)");
    // Deflate shrinks to a 1032th at best.
    if (entry.size > kEntryMax || entry.size / 1032 > entry.packed + 1) fail("has a table that is too large");
    std::string out;
    if (entry.method == 0)
      out = packed;
    else if (entry.method == 8)
      out = inflated(packed, entry.size);
    else
      fail("is packed by method " + std::to_string(entry.method) + " (use numpy.savez or savez_compressed)");
    if (out.size() != entry.size ||
        crc32_z(0, reinterpret_cast<const Bytef*>(out.data()), out.size()) != entry.checksum) {
      fail();
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what = "is damaged or cut off (save it again)") const {
    throw Error(ExitCode::kFile, file_ + ": " + what);
  }
  std::string_view part(std::uint64_t at, std::uint64_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) fail();
    return bytes_.substr(at, size);
  }
  std::uint64_t number(std::uint64_t at, std::size_t size) const {
    std::uint64_t out = 0;
    const std::string_view bytes = part(at, size);
    for (std::size_t k = size; k-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[k]);
    return out;
  }

  // A comment may follow it.
  std::uint64_t end_record() const {
    constexpr std::size_t kRecord = 22, kCommentMax = 65535;
    for (std::size_t comment = 0; comment <= kCommentMax && kRecord + comment <= bytes_.size(); ++comment) {
      const std::uint64_t at = bytes_.size() - kRecord - comment;
      if (number(at, 4) == 0x06054b50) return at;
    }
    fail();
  }

  ZipEntry entry_at(std::uint64_t at) const {
    ZipEntry out;
    const std::uint64_t name_size = number(at + 28, 2), extra_size = number(at + 30, 2);
    out.name = part(at + 46, name_size);
    out.flags = number(at + 8, 2);
    out.method = number(at + 10, 2);
    out.checksum = number(at + 16, 4);
    out.packed = number(at + 20, 4);
    out.size = number(at + 24, 4);
    out.header_at = number(at + 42, 4);
    // Numbers that need more than 32 bits follow in an extra field, in this order.
    const std::uint64_t end = at + 46 + name_size + extra_size;
    for (std::uint64_t field = at + 46 + name_size; field + 4 <= end; field += 4 + number(field + 2, 2)) {
      if (number(field, 2) != 1) continue;
      std::uint64_t value = field + 4;
      for (std::uint64_t* wide : {&out.size, &out.packed, &out.header_at}) {
        if (*wide != 0xFFFFFFFF) continue;
        *wide = number(value, 8);
        value += 8;
      }
    }
    return out;
  }

  std::string inflated(std::string_view packed, std::size_t size) const {
    std::string out(size, '\0');
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(std::min(packed.size(), kEntryMax));
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(size);
    const int result = inflate(&stream, Z_FINISH);
    const std::size_t written = stream.total_out;
    inflateEnd(&stream);
    if (result != Z_STREAM_END || written != size) fail();
    return out;
  }

  std::string_view bytes_;
  const std::string& file_;
  std::vector<ZipEntry> entries_;
};

}  // namespace

Arrays parse_npz(std::string_view bytes, const std::string& file) {
  const ZipFile zip(bytes, file);
  Arrays out;
  for (const ZipEntry& entry : zip.entries()) {
    constexpr std::string_view kEnding = ".npy";
    if (!entry.name.ends_with(kEnding)) continue;
    const std::string name = entry.name.substr(0, entry.name.size() - kEnding.size());
    const std::string table = zip.unpacked(entry);
    try {
      out[name] = parse_npy(table, name);
    } catch (const Error& error) {
      out[name].refused = std::string(error.what()).substr(name.size() + 2);
    }
  }
  if (out.empty()) throw Error(ExitCode::kFile, file + ": has no numpy tables");
  return out;
}

}  // namespace spherechain::baker
