// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/fbx_curve.h"

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr std::array<const char*, 5> kNames{"KeyTime", "KeyValueFloat", "KeyAttrFlags", "KeyAttrDataFloat",
                                            "KeyAttrRefCount"};
constexpr std::array<char, 5> kTypes{'l', 'f', 'i', 'f', 'i'};

// Bits of a key's flags, which hold up to the next key.
constexpr std::int64_t kInterpolation = 0xE, kLinear = 0x4;
// A linear key as common exporters write it: tangents that nobody uses, with weights of a third.
constexpr std::int64_t kLinearKey = 0x6104, kWeights = 0x0D050D05;

}  // namespace

FbxCurve::FbxCurve(const FbxTree& tree) {
  for (std::size_t p = 0; p < kParts; ++p) forms_[p].type = tree.is_binary ? kTypes[p] : 't';
}

FbxCurve::FbxCurve(const FbxTree& tree, const FbxRecord& record, const std::string& where) : FbxCurve(tree) {
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, where + " has " + what); };
  std::array<FbxArray, kParts> read;
  for (std::size_t p = 0; p < kParts; ++p) {
    records_[p] = record.find(kNames[p]);
    std::optional<FbxArray> array = records_[p] == nullptr ? std::nullopt : tree.array(*records_[p]);
    if (!array && p <= kValues) fail(std::string("no numbers in ") + kNames[p]);
    if (!array) continue;
    forms_[p] = {array->type, array->is_packed, {array->items.begin(), array->items.end()}};
    read[p] = std::move(*array);
  }
  const auto& [times, values, flags, data, counts] = read;
  if (times.items.size() != values.items.size())
    fail(std::to_string(times.items.size()) + " times and " + std::to_string(values.items.size()) + " values");
  // Keys that are alike and follow each other share an attribute.
  std::vector<std::size_t> attribute;
  for (std::size_t a = 0; a < counts.items.size() && attribute.size() < times.items.size(); ++a) {
    for (std::int64_t n = counts.whole(a); n > 0 && attribute.size() < times.items.size(); --n) attribute.push_back(a);
  }
  const bool has_attributes = attribute.size() == times.items.size() && flags.items.size() == counts.items.size() &&
                              data.items.size() == 4 * counts.items.size();
  for (std::size_t k = 0; k < times.items.size(); ++k) {
    const std::int64_t tick = times.whole(k);
    if (!is_fbx_time(tick)) fail("a time that is days away");
    if (!keys_.empty() && tick <= keys_.rbegin()->first) fail("times that do not ascend");
    set(tick, values.number(k));
    Key& key = keys_[tick];
    key.value = values.items[k];
    if (!has_attributes) continue;
    const std::size_t a = attribute[k];
    key.flags = flags.items[a];
    for (std::size_t d = 0; d < 4; ++d) key.data[d] = data.items[4 * a + d];
  }
}

std::vector<std::int64_t> FbxCurve::ticks() const {
  std::vector<std::int64_t> out;
  for (const auto& [tick, key] : keys_) out.push_back(tick);
  return out;
}

std::optional<std::int64_t> FbxCurve::before(std::int64_t tick) const {
  const auto found = keys_.lower_bound(tick);
  return found == keys_.begin() ? std::nullopt : std::optional(std::prev(found)->first);
}

std::optional<std::int64_t> FbxCurve::after(std::int64_t tick) const {
  const auto found = keys_.upper_bound(tick);
  return found == keys_.end() ? std::nullopt : std::optional(found->first);
}

double FbxCurve::at(std::int64_t tick) const {
  const auto next = keys_.lower_bound(tick);
  if (next == keys_.end()) return keys_.rbegin()->second.number;
  if (next == keys_.begin() || next->first == tick) return next->second.number;
  const auto& [time, key] = *std::prev(next);
  const double share = (static_cast<double>(tick) - static_cast<double>(time)) /
                       (static_cast<double>(next->first) - static_cast<double>(time));
  return (1 - share) * key.number + share * next->second.number;
}

void FbxCurve::set(std::int64_t tick, double value) {
  const auto [place, is_new] = keys_.try_emplace(tick);
  Key& key = place->second;
  key.number = value;
  key.value = fbx_item(forms_[kValues].type, value);
  if (!is_new) return make_linear(tick);
  key.flags = fbx_item(forms_[kFlags].type, kLinearKey);
  const char type = forms_[kData].type;
  for (std::size_t d = 0; d < 4; ++d) key.data[d] = fbx_item(type, std::int64_t{0});
  key.data[2] = fbx_item(type == 'f' ? 'i' : type, kWeights);  // the bits of two numbers, not a number
}

void FbxCurve::make_linear(std::int64_t tick) {
  std::string& flags = keys_.at(tick).flags;
  const std::int64_t before = FbxArray::whole(forms_[kFlags].type, flags);
  flags = fbx_item(forms_[kFlags].type, (before & ~kInterpolation) | kLinear);
}

std::array<FbxNewArray, FbxCurve::kParts> FbxCurve::arrays() const {
  std::array<FbxNewArray, kParts> out = forms_;
  for (FbxNewArray& array : out) array.items.clear();
  const Key* last = nullptr;
  std::int64_t alike = 0;
  const auto count = [&] {
    if (alike > 0) out[kCounts].items.push_back(fbx_item(forms_[kCounts].type, alike));
  };
  for (const auto& [tick, key] : keys_) {
    out[kTimes].items.push_back(fbx_item(forms_[kTimes].type, tick));
    out[kValues].items.push_back(key.value);
    if (last == nullptr || key.flags != last->flags || key.data != last->data) {
      count();
      alike = 0;
      out[kFlags].items.push_back(key.flags);
      out[kData].items.insert(out[kData].items.end(), key.data.begin(), key.data.end());
    }
    ++alike;
    last = &key;
  }
  count();
  return out;
}

void FbxCurve::write(FbxChanges& changes) const {
  auto all = arrays();
  for (std::size_t p = 0; p < kParts; ++p) {
    if (records_[p] != nullptr && all[p].items != forms_[p].items) changes.set_array(*records_[p], std::move(all[p]));
  }
}

FbxNewRecord FbxCurve::record(std::int64_t id) const {
  FbxNewRecord out{"AnimationCurve", {id, std::string("\0\1AnimCurve", 11), std::string()}, {}};
  out.inside.push_back({"Default", {keys_.empty() ? 0.0 : keys_.begin()->second.number}});
  out.inside.push_back({"KeyVer", {std::int32_t{4009}}});
  auto all = arrays();
  for (std::size_t p = 0; p < kParts; ++p) out.inside.push_back({kNames[p], {std::move(all[p])}});
  return out;
}

}  // namespace spherechain::baker
