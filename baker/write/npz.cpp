// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/write/npz.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "baker/mesh/error.h"
#include "baker/mesh/utf8.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

std::string little_endian(std::uint64_t value, int size) {
  std::string out;
  for (int k = 0; k < size; ++k) out.push_back(static_cast<char>(value >> (8 * k)));
  return out;
}

// A text in numpy's type U: its code points, 32 bits each.
std::string code_points(const std::string& text) {
  const std::string whole = as_utf8(text);
  std::string out;
  for (std::size_t at = 0; at < whole.size();) {
    const CodePoint point = *first_code_point(std::string_view(whole).substr(at));
    out += little_endian(point.code, 4);
    at += point.length;
  }
  return out;
}

std::string shape_text(const std::vector<std::size_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

// The place of a member's bytes in a zip archive is a number of 32 bits.
constexpr std::uint64_t kArchiveMax = 0xFFFFFFFF;

constexpr const char* kMark = "writer";

}  // namespace

NpzFile::NpzFile(const std::filesystem::path& path) : path_(path), file_(path) { add(kMark, std::string(kWriter)); }

void NpzFile::add_bytes(const std::string& name, const std::string& type, const std::string& shape, const void* data,
                        std::size_t size) {
  constexpr std::size_t kMagic = 10, kAlign = 64;
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  header.resize((header.size() + kMagic) / kAlign * kAlign + kAlign - kMagic - 1, ' ');
  header = "\x93NUMPY" + little_endian(1, 2) + little_endian(header.size() + 1, 2) + header + "\n";
  const std::string member = name + ".npy";
  if (size > kTableMax || at_ + size > kArchiveMax) {
    throw Error(ExitCode::kFile,
                path_.string() + ": would have more than 1 GB (fewer frames: --clip, --frames, --fps)");
  }
  uLong checksum = crc32_z(0, reinterpret_cast<const Bytef*>(header.data()), header.size());
  if (size > 0) checksum = crc32_z(checksum, static_cast<const Bytef*>(data), size);
  constexpr std::uint64_t kDate = 0x21;  // the first that a zip archive has, 1 January 1980
  const std::string common = little_endian(20, 2) + little_endian(0, 6) + little_endian(kDate, 2) +
                             little_endian(checksum, 4) + little_endian(header.size() + size, 4) +
                             little_endian(header.size() + size, 4) + little_endian(member.size(), 2) +
                             little_endian(0, 2);
  directory_ += "PK\1\2" + little_endian(20, 2) + common + little_endian(0, 10) + little_endian(at_, 4) + member;
  const std::string start = "PK\3\4" + common + member + header;
  file_.write(start);
  file_.write({static_cast<const char*>(data), size});
  at_ += start.size() + size;
  ++count_;
}

void NpzFile::add(const std::string& name, const std::vector<float>& values, const std::vector<std::size_t>& shape) {
  add_bytes(name, "<f4", shape_text(shape), values.data(), 4 * values.size());
}

void NpzFile::add(const std::string& name, const std::vector<double>& values) {
  add_bytes(name, "<f8", shape_text({values.size()}), values.data(), 8 * values.size());
}

void NpzFile::add(const std::string& name, const std::vector<std::int32_t>& values) {
  add_bytes(name, "<i4", shape_text({values.size()}), values.data(), 4 * values.size());
}

void NpzFile::add(const std::string& name, const std::vector<std::string>& texts) {
  std::vector<std::string> points;
  std::size_t width = 4;
  for (const std::string& text : texts) {
    points.push_back(code_points(text));
    width = std::max(width, points.back().size());
  }
  std::string bytes;
  for (std::string& text : points) {
    text.resize(width, '\0');
    bytes += text;
  }
  add_bytes(name, fmt::format("<U{}", width / 4), shape_text({texts.size()}), bytes.data(), bytes.size());
}

void NpzFile::add(const std::string& name, const std::string& text) {
  const std::string points = code_points(text);
  add_bytes(name, fmt::format("<U{}", std::max<std::size_t>(points.size() / 4, 1)), "()", points.data(), points.size());
}

void NpzFile::finish() {
  file_.write(directory_ + "PK\5\6" + little_endian(0, 4) + little_endian(count_, 2) + little_endian(count_, 2) +
              little_endian(directory_.size(), 4) + little_endian(at_, 4) + little_endian(0, 2));
  file_.finish();
}

bool is_own_npz(const std::string& start) {
  return start.starts_with("PK\3\4") && start.find(std::string(kMark) + ".npy") == 30 &&
         start.find(code_points("spherechain")) != std::string::npos;
}

}  // namespace spherechain::baker
