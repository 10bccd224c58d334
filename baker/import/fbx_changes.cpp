// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_changes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace spherechain::baker {
namespace {

template <typename T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string joined(const std::vector<std::string>& items, const char* between) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : between) + item;
  return out;
}

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  out.resize(size);
  return out;
}

class BinaryWriter {
 public:
  explicit BinaryWriter(bool is_wide) : is_wide_(is_wide) {}

  std::size_t head() const { return is_wide_ ? 25 : 13; }

  // The record as it stands at a place in the file.
  std::string record(const FbxNewRecord& record, std::size_t at) const {
    std::string values;
    for (const FbxNewRecord::Value& value : record.values)
      std::visit([&](const auto& one) { put_value(values, one); }, value);
    std::string inside;
    for (const FbxNewRecord& one : record.inside)
      inside += this->record(one, at + head() + record.name.size() + values.size() + inside.size());
    if (!record.inside.empty()) inside.append(head(), '\0');
    std::string out;
    put_offset(out, at + head() + record.name.size() + values.size() + inside.size());
    put_offset(out, record.values.size());
    put_offset(out, values.size());
    put(out, static_cast<std::uint8_t>(record.name.size()));
    return out + record.name + values + inside;
  }

  void put_offset(std::string& out, std::size_t value) const {
    if (is_wide_) return put(out, std::uint64_t{value});
    if (value > std::numeric_limits<std::uint32_t>::max()) throw std::length_error("an FBX file above 4 GB");
    put(out, static_cast<std::uint32_t>(value));
  }

 private:
  static void put_value(std::string& out, std::int32_t value) {
    out += 'I';
    put(out, value);
  }
  static void put_value(std::string& out, std::int64_t value) {
    out += 'L';
    put(out, value);
  }
  static void put_value(std::string& out, double value) {
    out += 'D';
    put(out, value);
  }
  static void put_value(std::string& out, const std::string& text) {
    out += 'S';
    put(out, static_cast<std::uint32_t>(text.size()));
    out += text;
  }
  static void put_value(std::string& out, const FbxNewArray& array) {
    std::string bytes = joined(array.items, "");
    if (array.is_packed) bytes = packed(bytes);
    out += array.type;
    put(out, static_cast<std::uint32_t>(array.items.size()));
    put(out, std::uint32_t{array.is_packed});
    put(out, static_cast<std::uint32_t>(bytes.size()));
    out += bytes;
  }

  bool is_wide_;
};

// "R\0\1AnimCurveNode" is "AnimCurveNode::R" in a text.
std::string in_text(const std::string& text) {
  const std::size_t end = text.find(std::string("\0\1", 2));
  return '"' + (end == std::string::npos ? text : text.substr(end + 2) + "::" + text.substr(0, end)) + '"';
}

std::string text_of(const FbxNewRecord& record, const std::string& line_end, std::size_t depth) {
  const std::string indent(depth, '\t');
  std::string out = indent + record.name + ":", block;
  for (const FbxNewRecord::Value& value : record.values) {
    // As the FBX SDK does: some readers do not know numbers after a space.
    out += &value == record.values.data() ? " " : std::holds_alternative<std::string>(value) ? ", " : ",";
    if (const auto* const text = std::get_if<std::string>(&value)) out += in_text(*text);
    if (const auto* const number = std::get_if<std::int32_t>(&value)) out += fmt::format("{}", *number);
    if (const auto* const number = std::get_if<std::int64_t>(&value)) out += fmt::format("{}", *number);
    if (const auto* const number = std::get_if<double>(&value)) out += fmt::format("{}", *number);
    if (const auto* const array = std::get_if<FbxNewArray>(&value)) {
      out += fmt::format("*{}", array->items.size());
      block += indent + "\ta: " + joined(array->items, ",") + line_end;
    }
  }
  for (const FbxNewRecord& one : record.inside) block += text_of(one, line_end, depth + 1);
  if (!block.empty()) out += " {" + line_end + block + indent + "}";
  return out + line_end;
}

}  // namespace

void FbxChanges::set_array(const FbxRecord& record, FbxNewArray array) {
  if (tree_.is_binary) {
    changes_.push_back({record.begin, record.end, FbxNewRecord{std::string(record.name), {std::move(array)}}});
    return;
  }
  const auto replace = [&](std::string_view old, const std::string& by) {
    const auto begin = static_cast<std::size_t>(old.data() - tree_.bytes.data());
    changes_.push_back({begin, begin + old.size(), " " + by});
  };
  const FbxRecord* const list = record.find("a");
  if (list != nullptr) replace(record.values, fmt::format("*{}", array.items.size()));
  replace(list != nullptr ? list->values : record.values, joined(array.items, ","));
}

void FbxChanges::set_whole(const FbxRecord& record, std::int32_t value) {
  if (tree_.is_binary) {
    changes_.push_back({record.begin, record.end, FbxNewRecord{std::string(record.name), {value}}});
  } else {
    const auto begin = static_cast<std::size_t>(record.values.data() - tree_.bytes.data());
    changes_.push_back({begin, begin + record.values.size(), fmt::format(" {}", value)});
  }
}

void FbxChanges::append(const FbxRecord& parent, FbxNewRecord record) {
  std::size_t at = parent.inside_end;
  if (tree_.is_binary) {
    changes_.push_back({at, at, std::move(record)});
    return;
  }
  while (tree_.bytes[at - 1] == ' ' || tree_.bytes[at - 1] == '\t') --at;  // before the bracket's own line
  const std::string line_end = tree_.bytes.find("\r\n") == std::string_view::npos ? "\n" : "\r\n";
  const bool is_line_start = tree_.bytes[at - 1] == '\n';
  changes_.push_back({at, at, (is_line_start ? "" : line_end) + text_of(record, line_end, 1)});
}

std::string FbxChanges::bytes() const {
  const BinaryWriter writer(tree_.is_wide);
  std::vector<const Change*> ordered;
  for (const Change& change : changes_) ordered.push_back(&change);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Change* a, const Change* b) { return a->begin < b->begin; });

  std::string out;
  std::size_t at = 0;
  std::vector<std::pair<std::size_t, std::size_t>> places;  // where a change begins, and how long the file is after it
  std::vector<std::size_t> ends;                            // of what they replace
  for (const Change* change : ordered) {
    out.append(tree_.bytes, at, change->begin - at);
    const auto* const record = std::get_if<FbxNewRecord>(&change->by);
    out += record != nullptr ? writer.record(*record, out.size()) : std::get<std::string>(change->by);
    at = change->end;
    places.emplace_back(change->begin, out.size());
    ends.push_back(at);
  }
  if (!tree_.is_binary) return out.append(tree_.bytes, at);
  out.append(tree_.bytes, at, tree_.end - at);

  // Where a place of the old file, outside of what was replaced, is now.
  const auto moved = [&](std::size_t place) {
    const auto after = std::lower_bound(places.begin(), places.end(), std::pair(place, std::size_t{0}));
    if (after == places.begin()) return place;
    const auto last = static_cast<std::size_t>(after - places.begin()) - 1;
    return places[last].second + (place - ends[last]);
  };
  const auto is_replaced = [&](const FbxRecord& record) {
    const auto found = std::lower_bound(places.begin(), places.end(), std::pair(record.begin, std::size_t{0}));
    return found != places.end() && found->first == record.begin &&
           ends[static_cast<std::size_t>(found - places.begin())] == record.end;
  };
  const auto move_ends = [&](const auto& self, const std::vector<FbxRecord>& records) -> void {
    for (const FbxRecord& record : records) {
      if (is_replaced(record)) continue;
      std::string end;
      writer.put_offset(end, moved(record.end));
      out.replace(moved(record.begin), end.size(), end);
      self(self, record.inside);
    }
  };
  move_ends(move_ends, tree_.records);

  // The footer: 16 bytes, zeros that align what follows, the version, and 136 bytes.
  constexpr std::size_t kFirst = 16, kLast = 140, kAlignment = 16, kZerosMin = 4;
  const std::string_view footer = tree_.bytes.substr(tree_.end);
  const std::size_t zeros = footer.size() - std::min(footer.size(), kFirst + kLast);
  const bool is_aligned = zeros >= kZerosMin && zeros <= kZerosMin + kAlignment &&
                          footer.substr(kFirst, zeros).find_first_not_of('\0') == std::string_view::npos;
  if (!is_aligned) return out.append(footer);
  const std::size_t moved_by = (kAlignment + out.size() % kAlignment - tree_.end % kAlignment) % kAlignment;
  const std::size_t new_zeros = zeros - moved_by + (zeros < moved_by + kZerosMin ? kAlignment : 0);
  return out.append(footer.substr(0, kFirst)).append(new_zeros, '\0').append(footer.substr(kFirst + zeros));
}

}  // namespace spherechain::baker
