// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

// Bytes of numpy's files, written by hand.

inline std::string little_endian(std::uint64_t value, int size) {
  std::string out;
  for (int k = 0; k < size; ++k) out.push_back(static_cast<char>(value >> (8 * k)));
  return out;
}

// An .npy file: `descr` and `shape` as Python writes them, such as '<f8' and (2, 3).
inline std::string npy(const std::string& descr, const std::string& shape, const std::string& data,
                       bool is_fortran = false, int version = 1) {
  std::string header =
      "{'descr': " + descr + ", 'fortran_order': " + (is_fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
  header.resize((header.size() + 10) / 64 * 64 + 64 - (version == 1 ? 10 : 12) - 1, ' ');
  header += '\n';
  return "\x93NUMPY" + little_endian(static_cast<std::uint64_t>(version), 2) +
         little_endian(header.size(), version == 1 ? 2 : 4) + header + data;
}

template <typename T>
std::string raw(const std::vector<T>& values) {
  std::string out(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(out.data(), values.data(), out.size());
  return out;
}

inline std::string npy(const std::vector<double>& values, const std::string& shape) {
  return npy("'<f8'", shape, raw(values));
}

// Texts of at most eight letters.
inline std::string npy(const std::vector<std::string>& texts) {
  std::string data;
  for (std::string text : texts) {
    text.resize(8, '\0');
    data += text;
  }
  return npy("'|S8'", "(" + std::to_string(texts.size()) + ",)", data);
}

// A zip archive without compression.
inline std::string npz(const std::vector<std::pair<std::string, std::string>>& tables) {
  std::string out, directory;
  for (const auto& [name, bytes] : tables) {
    const std::string file = name + ".npy";
    const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    const std::string common = little_endian(20, 2) + little_endian(0, 8) + little_endian(checksum, 4) +
                               little_endian(bytes.size(), 4) + little_endian(bytes.size(), 4) +
                               little_endian(file.size(), 2) + little_endian(0, 2);
    directory += "PK\1\2" + little_endian(20, 2) + common + little_endian(0, 10) + little_endian(out.size(), 4) + file;
    out += "PK\3\4" + common + file + bytes;
  }
  return out + directory + "PK\5\6" + little_endian(0, 4) + little_endian(tables.size(), 2) +
         little_endian(tables.size(), 2) + little_endian(directory.size(), 4) + little_endian(out.size(), 4) +
         little_endian(0, 2);
}
