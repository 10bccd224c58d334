// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_tree.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace spherechain::baker {
namespace {

constexpr std::string_view kBinaryFbx = "Kaydara FBX Binary  ";
constexpr std::size_t kHeader = 27;
constexpr int kRecordDepthMax = 32;

const FbxRecord* find_in(const std::vector<FbxRecord>& records, std::string_view name) {
  const auto found = std::find_if(records.begin(), records.end(), [&](const FbxRecord& r) { return r.name == name; });
  return found == records.end() ? nullptr : &*found;
}

template <typename T>
bool take(std::string_view& bytes, T& value) {
  if (bytes.size() < sizeof value) return false;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return true;
}

class BinaryParser {
 public:
  explicit BinaryParser(FbxTree& tree) : tree_(tree), bytes_(tree.bytes) {
    std::string_view version = bytes_.substr(std::min(bytes_.size(), kHeader - 4));
    tree_.is_whole = take(version, tree_.version);
    tree_.is_wide = tree_.version >= 7500;
    const std::size_t stop = records(std::min(bytes_.size(), kHeader), bytes_.size(), 0, tree_.records);
    tree_.end = std::min(stop + head(), bytes_.size());
  }

 private:
  std::size_t head() const { return tree_.is_wide ? 25 : 13; }
  std::size_t offset(std::size_t at) const {
    std::string_view rest = bytes_.substr(at);
    std::uint64_t wide = 0;
    std::uint32_t narrow = 0;
    if (tree_.is_wide) return take(rest, wide) ? static_cast<std::size_t>(wide) : 0;
    return take(rest, narrow) ? narrow : 0;
  }

  // Returns where the list ends: at a record that is all zero.
  std::size_t records(std::size_t at, std::size_t end, int depth, std::vector<FbxRecord>& out) {
    const std::size_t word = tree_.is_wide ? 8 : 4;
    while (head() <= end - at) {
      const std::size_t next = offset(at), count = offset(at + word), length = offset(at + 2 * word);
      const std::size_t name_length = static_cast<unsigned char>(bytes_[at + head() - 1]);
      if (next == 0 && count == 0 && length == 0 && name_length == 0) return at;
      const bool is_good = next >= at + head() && next <= end && name_length <= next - at - head() &&
                           length <= next - at - head() - name_length && depth < kRecordDepthMax;
      if (!is_good) break;
      FbxRecord record;
      record.name = bytes_.substr(at + head(), name_length);
      record.begin = at;
      record.end = next;
      record.values = bytes_.substr(at + head() + name_length, length);
      record.value_count = count;
      const std::size_t inside = at + head() + name_length + length;
      if (inside < next) {
        record.inside_end = records(inside, next, depth + 1, record.inside);
        if (record.inside_end + head() != next) tree_.is_whole = false;
      }
      out.push_back(std::move(record));
      at = next;
    }
    tree_.is_whole = false;
    return at;
  }

  FbxTree& tree_;
  std::string_view bytes_;
};

class TextParser {
 public:
  explicit TextParser(FbxTree& tree) : tree_(tree), bytes_(tree.bytes) {
    records(0, tree_.records);
    if (at_ < bytes_.size()) tree_.is_whole = false;  // a bracket too many
    tree_.end = bytes_.size();
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  bool is_at(char c) const { return at_ < bytes_.size() && bytes_[at_] == c; }
  void skip_to_line_end() { at_ = std::min(bytes_.find('\n', at_), bytes_.size()); }
  void skip_space() {
    while (at_ < bytes_.size() && (is_space(bytes_[at_]) || bytes_[at_] == ';'))
      bytes_[at_] == ';' ? skip_to_line_end() : void(++at_);
  }

  // Leaves at_ at the bracket that ends the list, or at the end of the file.
  void records(int depth, std::vector<FbxRecord>& out) {
    for (skip_space(); at_ < bytes_.size() && bytes_[at_] != '}'; skip_space()) {
      FbxRecord record;
      record.begin = at_;
      const std::size_t colon = std::min(bytes_.find_first_of(":{}\"\n", at_), bytes_.size());
      if (colon == bytes_.size() || bytes_[colon] != ':' || depth >= kRecordDepthMax) return damaged();
      record.name = bytes_.substr(at_, colon - at_);
      at_ = colon + 1;
      record.values = values();
      if (is_at('{')) {
        ++at_;
        records(depth + 1, record.inside);
        record.inside_end = at_;
        if (!is_at('}')) return damaged();
        ++at_;
      }
      record.end = at_;
      out.push_back(std::move(record));
    }
  }
  void damaged() {
    tree_.is_whole = false;
    at_ = bytes_.size();
  }

  // Up to the bracket or the line's end. A list goes on where a line ends with a comma, or the next begins with one.
  std::string_view values() {
    const std::size_t begin = at_;
    std::size_t end = at_;  // of the last value
    bool is_open = false;   // after a comma
    while (at_ < bytes_.size() && bytes_[at_] != '{' && bytes_[at_] != '}') {
      const char c = bytes_[at_];
      if (c == '\n') {
        const std::size_t next = std::min(bytes_.find_first_not_of(" \t\r\n", at_), bytes_.size());
        const char first = next < bytes_.size() ? bytes_[next] : '}';
        const bool is_value = first == '"' || first == '-' || first == '.' || (first >= '0' && first <= '9');
        if (first != ',' && first != '{' && !(is_open && is_value)) break;
        at_ = next;
        continue;
      }
      if (c == '"') at_ = std::min(bytes_.find('"', at_ + 1), bytes_.size() - 1);
      ++at_;
      if (is_space(c)) continue;
      is_open = c == ',';
      end = at_;
    }
    return bytes_.substr(begin, end - begin);
  }

  FbxTree& tree_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

std::vector<FbxValue> binary_values(std::string_view bytes, std::size_t count) {
  std::vector<FbxValue> out;
  const auto take_whole = [&](auto value) {
    if (!take(bytes, value)) return false;
    out.push_back({static_cast<double>(value), static_cast<std::int64_t>(value), {}});
    return true;
  };
  const auto take_real = [&](auto value) {
    if (!take(bytes, value)) return false;
    out.push_back({static_cast<double>(value), {}, {}});
    return true;
  };
  while (out.size() < count && !bytes.empty()) {
    const char type = bytes[0];
    bytes.remove_prefix(1);
    std::uint32_t length = 0;
    bool good = false;
    if (type == 'Y') good = take_whole(std::int16_t{});
    if (type == 'C') good = take_whole(std::int8_t{});
    if (type == 'I') good = take_whole(std::int32_t{});
    if (type == 'L') good = take_whole(std::int64_t{});
    if (type == 'F') good = take_real(float{});
    if (type == 'D') good = take_real(double{});
    if (type == 'S' && take(bytes, length) && length <= bytes.size()) {
      const std::string_view text = bytes.substr(0, length);
      out.push_back({{}, {}, text.substr(0, text.find(std::string_view("\0\1", 2)))});
      bytes.remove_prefix(length);
      good = true;
    }
    if (!good) break;
  }
  return out;
}

// Up to the first word that is no number.
std::vector<FbxValue> text_values(std::string_view rest) {
  std::vector<FbxValue> out;
  while (!(rest = rest.substr(std::min(rest.find_first_not_of(" \t\r\n,"), rest.size()))).empty()) {
    if (rest[0] == '"') {
      const std::size_t end = rest.find('"', 1);
      if (end == std::string_view::npos) break;
      std::string_view text = rest.substr(1, end - 1);
      if (const std::size_t kind = text.find("::"); out.size() == 1 && kind != std::string_view::npos)
        text.remove_prefix(kind + 2);
      out.push_back({{}, {}, text});
      rest.remove_prefix(end + 1);
      continue;
    }
    const std::string word(rest.substr(0, std::min(rest.find_first_of(" \t\r\n,"), rest.size())));
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (end == word.c_str()) break;
    const bool is_whole = word.find_first_of(".eE") == std::string::npos;
    out.push_back(
        {number, is_whole ? std::optional<std::int64_t>(std::strtoll(word.c_str(), nullptr, 10)) : std::nullopt, {}});
    rest.remove_prefix(word.size());
  }
  return out;
}

std::size_t width_of(char type) {
  return type == 'd' || type == 'l' ? 8 : type == 'f' || type == 'i' ? 4 : type == 'b' ? 1 : 0;
}

std::optional<FbxArray> binary_array(std::string_view bytes) {
  FbxArray out;
  std::uint32_t count = 0, encoding = 0, length = 0;
  if (!take(bytes, out.type) || !take(bytes, count) || !take(bytes, encoding) || !take(bytes, length)) return {};
  const std::size_t width = width_of(out.type), size = count * width;
  if (width == 0 || length > bytes.size() || encoding > 1) return {};
  bytes = bytes.substr(0, length);
  out.is_packed = encoding == 1;
  if (out.is_packed) {
    constexpr std::size_t kRatioMax = 1100;  // zlib packs no better
    if (size > kRatioMax * (length + 1)) return {};
    out.unpacked.resize(size + 1);  // no null pointer
    uLongf got = size;
    if (uncompress(reinterpret_cast<Bytef*>(out.unpacked.data()), &got, reinterpret_cast<const Bytef*>(bytes.data()),
                   length) != Z_OK)
      return {};
    bytes = {out.unpacked.data(), got};
  }
  if (bytes.size() != size) return {};
  for (std::size_t k = 0; k < count; ++k) out.items.push_back(bytes.substr(k * width, width));
  return out;
}

std::optional<FbxArray> text_array(const FbxRecord& record) {
  const FbxRecord* const list = record.find("a");
  FbxArray out;
  out.type = 't';
  std::string_view rest = list != nullptr ? list->values : record.values;
  while (!(rest = rest.substr(std::min(rest.find_first_not_of(" \t\r\n,"), rest.size()))).empty()) {
    const std::size_t end = std::min(rest.find_first_of(" \t\r\n,"), rest.size());
    if (std::string_view("+-.0123456789nNiI").find(rest[0]) == std::string_view::npos) return {};
    out.items.push_back(rest.substr(0, end));
    rest.remove_prefix(end);
  }
  return out;
}

template <typename T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <typename To>
To item_as(char type, std::string_view item) {
  const auto read = [&](auto value) {
    take(item, value);
    if constexpr (std::is_floating_point_v<decltype(value)> && std::is_integral_v<To>) {
      constexpr decltype(value) kMax = 1e18F;
      return std::abs(value) < kMax ? static_cast<To>(value) : To{0};
    }
    return static_cast<To>(value);
  };
  switch (type) {
    case 'f':
      return read(float{});
    case 'd':
      return read(double{});
    case 'i':
      return read(std::int32_t{});
    case 'l':
      return read(std::int64_t{});
    case 'b':
      return read(std::int8_t{});
    default:
      break;
  }
  const std::string word(item);
  if constexpr (std::is_floating_point_v<To>) return std::strtod(word.c_str(), nullptr);
  return static_cast<To>(std::strtoll(word.c_str(), nullptr, 10));
}

template <typename From>
std::string item_of(char type, From value) {
  switch (type) {
    case 'f':
      return bytes_of(static_cast<float>(value));
    case 'd':
      return bytes_of(static_cast<double>(value));
    case 'i':
      return bytes_of(static_cast<std::int32_t>(value));
    case 'l':
      return bytes_of(static_cast<std::int64_t>(value));
    case 'b':
      return bytes_of(static_cast<std::int8_t>(value));
    default:
      break;
  }
  if constexpr (std::is_floating_point_v<From>) return fmt::format("{}", static_cast<float>(value));
  return fmt::format("{}", value);
}

}  // namespace

const FbxRecord* FbxRecord::find(std::string_view wanted) const { return find_in(inside, wanted); }
const FbxRecord* FbxTree::find(std::string_view name) const { return find_in(records, name); }

double FbxArray::number(std::size_t item) const { return item_as<double>(type, items[item]); }
std::int64_t FbxArray::whole(char type, std::string_view item) { return item_as<std::int64_t>(type, item); }
std::string fbx_item(char type, double number) { return item_of(type, number); }
std::string fbx_item(char type, std::int64_t whole) { return item_of(type, whole); }

std::vector<FbxValue> FbxTree::values(const FbxRecord& record) const {
  return is_binary ? binary_values(record.values, record.value_count) : text_values(record.values);
}

std::optional<FbxArray> FbxTree::array(const FbxRecord& record) const {
  return is_binary ? binary_array(record.values) : text_array(record);
}

bool is_fbx(std::string_view bytes) {
  constexpr std::size_t kFirst = 4096;
  return bytes.starts_with(kBinaryFbx) || bytes.substr(0, kFirst).find("FBXHeaderExtension") != std::string_view::npos;
}

FbxTree parse_fbx(std::string_view bytes) {
  FbxTree out;
  out.bytes = bytes;
  out.is_binary = bytes.starts_with(kBinaryFbx);
  if (out.is_binary) {
    BinaryParser{out};
    return out;
  }
  TextParser{out};
  const FbxRecord* const header = out.find("FBXHeaderExtension");
  if (const FbxRecord* const version = header == nullptr ? nullptr : header->find("FBXVersion")) {
    const std::vector<FbxValue> values = out.values(*version);
    if (!values.empty() && values[0].whole) out.version = static_cast<std::uint32_t>(*values[0].whole);
  }
  return out;
}

}  // namespace spherechain::baker
