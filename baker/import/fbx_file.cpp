// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace spherechain::baker {
namespace {

constexpr std::string_view kBinaryFbx = "Kaydara FBX Binary  ";
constexpr std::size_t kFbxHeader = 27;

bool is_kept(std::string_view property) {
  return property.starts_with("Lcl ") || property.starts_with("d|") || property == "RotationOrder";
}

// A record's values as both forms of the file have them.
struct FbxValue {
  std::optional<double> number;
  std::optional<std::int64_t> whole;
  std::string_view text;
};

// Takes over what a record says, if it is one of those that matter.
class FbxCollector {
 public:
  explicit FbxCollector(FbxFile& out) : out_(out) {}

  void take(std::string_view record, const std::vector<FbxValue>& values) {
    const auto kind = record == "Model"                ? std::optional(FbxKind::kModel)
                      : record == "AnimationCurveNode" ? std::optional(FbxKind::kCurves)
                      : record == "AnimationStack"     ? std::optional(FbxKind::kStack)
                                                       : std::nullopt;
    if (kind && values.size() >= 3 && values[0].whole) {
      const bool is_joint = values[2].text == "LimbNode" || values[2].text == "Root";
      out_.objects.push_back({*values[0].whole, values[1].text, *kind, is_joint, {}});
    } else if (record == "P" && values.size() >= 5 && !out_.objects.empty() && is_kept(values[0].text)) {
      std::array<double, 3> numbers{};
      for (std::size_t k = 0; k < 3 && 4 + k < values.size(); ++k) numbers[k] = values[4 + k].number.value_or(0);
      out_.objects.back().values.emplace(values[0].text, numbers);
    } else if (record == "C" && values.size() >= 3 && values[1].whole && values[2].whole) {
      out_.links.push_back(
          {*values[1].whole, *values[2].whole, std::string(values.size() > 3 ? values[3].text : std::string_view())});
    }
  }

 private:
  FbxFile& out_;
};

class BinaryFbx {
 public:
  BinaryFbx(std::string_view bytes, FbxFile& out) : bytes_(bytes), collector_(out) {
    wide_ = number<std::uint32_t>(kFbxHeader - 4) >= 7500;
    records(kFbxHeader, bytes_.size(), 0);
  }

 private:
  template <typename T>
  T number(std::size_t at) const {
    T value{};
    if (at <= bytes_.size() && sizeof value <= bytes_.size() - at)
      std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }
  std::size_t offset(std::size_t at) const {
    return wide_ ? static_cast<std::size_t>(number<std::uint64_t>(at)) : number<std::uint32_t>(at);
  }

  void records(std::size_t at, std::size_t end, int depth) {
    constexpr int kDepthMax = 4;  // Objects, Model, Properties70, P
    const std::size_t word = wide_ ? 8 : 4, head = 3 * word + 1;
    while (depth < kDepthMax && at + head <= end) {
      const std::size_t next = offset(at), count = offset(at + word), length = offset(at + 2 * word);
      const std::size_t name_length = static_cast<unsigned char>(bytes_[at + head - 1]);
      if (next < at + head || next > end) return;
      if (name_length > next - at - head || length > next - at - head - name_length) return;
      const std::string_view name = bytes_.substr(at + head, name_length);
      const std::size_t values = at + head + name_length;
      const bool matters = depth > 0 || name == "Objects" || name == "Connections";
      if (matters && name != "Geometry" && name != "AnimationCurve" && name != "Deformer") {
        collector_.take(name, values_of(bytes_.substr(values, length), count));
        records(values + length, next, depth + 1);
      }
      at = next;
    }
  }

  static std::vector<FbxValue> values_of(std::string_view bytes, std::size_t count) {
    std::vector<FbxValue> out;
    const auto take = [&](auto& value) {
      if (bytes.size() < sizeof value) return false;
      std::memcpy(&value, bytes.data(), sizeof value);
      bytes.remove_prefix(sizeof value);
      return true;
    };
    const auto take_whole = [&](auto value) {
      if (!take(value)) return false;
      out.push_back({static_cast<double>(value), static_cast<std::int64_t>(value), {}});
      return true;
    };
    const auto take_real = [&](auto value) {
      if (!take(value)) return false;
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
      if (type == 'S' && take(length) && length <= bytes.size()) {
        const std::string_view text = bytes.substr(0, length);
        out.push_back({{}, {}, text.substr(0, text.find(std::string_view("\0\1", 2)))});
        bytes.remove_prefix(length);
        good = true;
      }
      if (!good) break;  // arrays and raw bytes come last, if at all
    }
    return out;
  }

  std::string_view bytes_;
  FbxCollector collector_;
  bool wide_ = false;
};

// A line such as `Model: 1001, "Model::Hips", "LimbNode" {`.
void take_line(std::string_view line, FbxCollector& collector) {
  const std::size_t colon = line.find(':');
  const std::size_t start = line.find_first_not_of(" \t");
  if (colon == std::string_view::npos || start >= colon) return;
  std::vector<FbxValue> values;
  std::string_view rest = line.substr(colon + 1);
  while (!(rest = rest.substr(std::min(rest.find_first_not_of(" \t\r,"), rest.size()))).empty() && rest[0] != '{') {
    if (rest[0] == '"') {
      const std::size_t end = rest.find('"', 1);
      if (end == std::string_view::npos) return;
      std::string_view text = rest.substr(1, end - 1);
      if (const std::size_t kind = text.find("::"); values.size() == 1 && kind != std::string_view::npos)
        text.remove_prefix(kind + 2);
      values.push_back({{}, {}, text});
      rest.remove_prefix(end + 1);
      continue;
    }
    const std::string word(rest.substr(0, std::min(rest.find_first_of(" \t,{\r"), rest.size())));
    if (word.empty()) return;
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (end == word.c_str()) return;
    const bool is_whole = word.find_first_of(".eE") == std::string::npos;
    values.push_back(
        {number, is_whole ? std::optional<std::int64_t>(std::strtoll(word.c_str(), nullptr, 10)) : std::nullopt, {}});
    rest.remove_prefix(word.size());
  }
  collector.take(line.substr(start, colon - start), values);
}

}  // namespace

bool is_fbx(std::string_view bytes) {
  constexpr std::size_t kFirst = 4096;
  return bytes.starts_with(kBinaryFbx) || bytes.substr(0, kFirst).find("FBXHeaderExtension") != std::string_view::npos;
}

FbxFile read_fbx(std::string_view bytes) {
  FbxFile out;
  if (bytes.starts_with(kBinaryFbx)) {
    BinaryFbx(bytes, out);
    return out;
  }
  FbxCollector collector(out);
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    constexpr std::size_t kLineMax = 4096;  // of arrays, which are of no interest
    if (end < kLineMax) take_line(bytes.substr(0, end), collector);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return out;
}

}  // namespace spherechain::baker
