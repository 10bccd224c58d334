// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "baker/import/arrays.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kNumbersMax = 100'000'000, kTextsMax = 1'000'000, kDimensionsMax = 32;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

// The dictionary in front of a table, which is written as Python would.
class NpyHeader {
 public:
  explicit NpyHeader(std::string_view text) : text_(text) {
    expect('{');
    while (!skip('}')) {
      const std::string key(quoted());
      expect(':');
      if (key == "descr") {
        skip_space();
        if (!text_.starts_with('\'') && !text_.starts_with('"')) fail("has several columns of different types");
        type = quoted();
      } else if (key == "fortran_order") {
        is_fortran = word() == "True";
      } else if (key == "shape") {
        read_shape();
      } else {
        fail("has a damaged header");
      }
      if (skip(',')) continue;
      expect('}');
      break;
    }
  }
  std::string type;
  bool is_fortran = false;
  std::vector<std::size_t> shape;

 private:
  void skip_space() {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\n')) text_.remove_prefix(1);
  }
  bool skip(char c) {
    skip_space();
    if (!text_.starts_with(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!skip(c)) fail("has a damaged header");
  }
  std::string_view take(std::size_t length) {
    if (length > text_.size()) fail("has a damaged header");
    const std::string_view out = text_.substr(0, length);
    text_.remove_prefix(length);
    return out;
  }
  std::string_view quoted() {
    skip_space();
    const char quote = take(1)[0];
    if (quote != '\'' && quote != '"') fail("has a damaged header");
    const std::string_view out = take(std::min(text_.find(quote), text_.size()));
    take(1);
    return out;
  }
  std::string_view word() {
    skip_space();
    return take(std::min(text_.find_first_of(" ,})"), text_.size()));
  }
  void read_shape() {
    expect('(');
    while (!skip(')')) {
      std::string_view number = word();
      if (number.ends_with('L')) number.remove_suffix(1);  // Python 2
      std::size_t size = 0;
      const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), size);
      if (error != std::errc() || end != number.data() + number.size()) fail("has a damaged header");
      shape.push_back(size);
      if (shape.size() > kDimensionsMax) fail("has a damaged header");
      skip(',');
    }
  }

  std::string_view text_;
};

std::uint64_t word_of(const char* at, std::size_t size, bool is_big_endian) {
  std::uint64_t out = 0;
  for (std::size_t k = 0; k < size; ++k) {
    out |= std::uint64_t{static_cast<unsigned char>(at[is_big_endian ? size - 1 - k : k])} << (8 * k);
  }
  return out;
}

double half(std::uint64_t bits) {
  const double sign = (bits & 0x8000) != 0 ? -1 : 1, digits = static_cast<double>(bits & 0x3FF);
  const int exponent = static_cast<int>(bits >> 10 & 31);
  if (exponent == 31) return digits == 0 ? sign * HUGE_VAL : NAN;
  return exponent == 0 ? sign * std::ldexp(digits, -24) : sign * std::ldexp(1024 + digits, exponent - 25);
}

double number_of(const ElementType& type, const char* at) {
  const std::uint64_t bits = word_of(at, type.size, type.is_big_endian);
  const auto unused = static_cast<int>(64 - 8 * type.size);
  switch (type.kind) {
    case 'f':
      if (type.size == 2) return half(bits);
      return type.size == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits)) : std::bit_cast<double>(bits);
    case 'i':
      return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
    case 'b':
      return bits != 0 ? 1 : 0;
    default:
      return static_cast<double>(bits);
  }
}

void put_utf8(std::uint64_t c, std::string& out) {
  const auto put = [&](std::uint64_t byte) { out.push_back(static_cast<char>(byte)); };
  const auto rest = [&](int shift) { put(0x80 | (c >> shift & 0x3F)); };
  if (c > 0x10FFFF || (c >= 0xD800 && c < 0xE000)) c = 0xFFFD;
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | c >> 6);
    rest(0);
  } else if (c < 0x10000) {
    put(0xE0 | c >> 12);
    rest(6);
    rest(0);
  } else {
    put(0xF0 | c >> 18);
    rest(12);
    rest(6);
    rest(0);
  }
}

// Zeros fill a text up.
std::string text_of(const ElementType& type, const char* at) {
  std::string out;
  const std::size_t width = type.kind == 'U' ? 4 : 1;
  for (std::size_t k = 0; k < type.size; k += width) {
    const std::uint64_t c = word_of(at + k, width, type.is_big_endian);
    if (type.kind == 'U')
      put_utf8(c, out);
    else
      out.push_back(static_cast<char>(c));
  }
  out.resize(out.find_last_not_of('\0') + 1);
  return out;
}

}  // namespace

ElementType element_type(std::string_view name) {
  ElementType out;
  std::string_view rest = name;
  constexpr std::string_view kOrders = "<>|=";
  if (!rest.empty() && kOrders.find(rest[0]) != kOrders.npos) {
    out.is_big_endian = rest[0] == '>';
    rest.remove_prefix(1);
  }
  const auto refuse = [&] {
    fail(fmt::format("is of the type '{}', which is not read (save numbers or texts)", name));
  };
  if (rest.empty()) refuse();
  if (rest[0] == 'O') fail("holds Python objects, which are not read (save numbers or texts)");
  out.kind = rest[0];
  rest.remove_prefix(1);
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), out.size);
  if (error != std::errc() || end != rest.data() + rest.size()) refuse();
  const auto is_one_of = [&](std::initializer_list<std::size_t> sizes) {
    return std::find(sizes.begin(), sizes.end(), out.size) != sizes.end();
  };
  constexpr std::size_t kTextMax = 1'000'000;
  bool is_read = false;
  if (out.kind == 'f') is_read = is_one_of({2, 4, 8});
  if (out.kind == 'i' || out.kind == 'u') is_read = is_one_of({1, 2, 4, 8});
  if (out.kind == 'b') is_read = out.size == 1;
  if (out.kind == 'U' || out.kind == 'S') is_read = out.size <= kTextMax;
  if (!is_read) refuse();
  if (out.kind == 'U') out.size *= 4;
  return out;
}

Array table_of(const ElementType& type, std::vector<std::size_t> shape, bool is_fortran, std::string_view bytes) {
  const bool is_text = type.kind == 'U' || type.kind == 'S';
  const std::size_t count_max = is_text ? kTextsMax : kNumbersMax;
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (size > count_max) fail(fmt::format("has more than {} values", count_max));
    count *= size;
    if (count > count_max) fail(fmt::format("has more than {} values", count_max));
  }
  if (count * type.size > bytes.size()) {
    fail(fmt::format("is cut off: it has {} of {} bytes (save it again)", bytes.size(), count * type.size));
  }
  Array out;
  // From an element in C's order to where it lies.
  std::vector<std::size_t> index(shape.size(), 0), step(shape.size(), type.size);
  for (std::size_t d = 1; d < shape.size(); ++d) {
    const std::size_t at = is_fortran ? d : shape.size() - 1 - d;
    step[at] = is_fortran ? step[at - 1] * shape[at - 1] : step[at + 1] * shape[at + 1];
  }
  for (std::size_t i = 0, place = 0; i < count; ++i) {
    if (is_text)
      out.texts.push_back(text_of(type, bytes.data() + place));
    else
      out.numbers.push_back(number_of(type, bytes.data() + place));
    for (std::size_t d = shape.size(); d-- > 0;) {
      place += step[d];
      if (++index[d] < shape[d]) break;
      place -= step[d] * shape[d];
      index[d] = 0;
    }
  }
  out.shape = std::move(shape);
  return out;
}

Array parse_npy(std::string_view bytes, const std::string& file) {
  try {
    constexpr std::size_t kStart = 8;
    if (!bytes.starts_with("\x93NUMPY")) fail("is no numpy table: it does not begin with NUMPY");
    if (bytes.size() < kStart + 4) fail("is cut off (save it again)");
    const int version = bytes[6];
    if (version < 1 || version > 3) fail(fmt::format("has version {} of numpy's format; 1 to 3 are read", version));
    const std::size_t width = version == 1 ? 2 : 4, length = word_of(bytes.data() + kStart, width, false);
    if (length > bytes.size() - kStart - width) fail("is cut off (save it again)");
    NpyHeader header(bytes.substr(kStart + width, length));
    return table_of(element_type(header.type), std::move(header.shape), header.is_fortran,
                    bytes.substr(kStart + width + length));
  } catch (const std::runtime_error& error) {
    throw Error(ExitCode::kFile, file + ": " + error.what());
  }
}

}  // namespace spherechain::baker
