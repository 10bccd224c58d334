// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_names.h"

#include <algorithm>
#include <map>
#include <set>

namespace spherechain::baker {
namespace {

// `number` with `length` digits; empty where there is no such name.
std::string numbered(std::size_t number, std::size_t length) {
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  std::string out(length, '0');
  for (std::size_t k = length; k-- > 0; number /= kDigits.size()) out[k] = kDigits[number % kDigits.size()];
  return number > 0 ? std::string() : out;
}

}  // namespace

std::unordered_map<std::string, std::string> make_names_unique(std::string& bytes, const FbxFile& file) {
  std::map<std::string_view, std::vector<const FbxObject*>> of_name;
  for (const FbxObject& object : file.objects) {
    if (object.kind == FbxKind::kModel) of_name[object.name].push_back(&object);
  }
  std::set<std::string> taken;
  for (const auto& [name, models] : of_name) taken.emplace(name);
  std::unordered_map<std::string, std::string> name_of;
  std::map<std::size_t, std::size_t> next;  // number to try, by length
  std::map<std::string, std::vector<const FbxObject*>> shared;
  for (auto& [name, models] : of_name) {
    if (models.size() > 1 && !name.empty()) shared.emplace(name, std::move(models));
  }
  for (auto& [name, models] : shared) {
    std::stable_partition(models.begin(), models.end(), [](const FbxObject* model) { return model->is_joint; });
    for (std::size_t k = 1; k < models.size(); ++k) {
      std::string own;
      do own = numbered(next[name.size()]++, name.size());
      while (!own.empty() && !taken.insert(own).second);
      if (own.empty()) break;
      name_of.emplace(own, name);
      std::copy(own.begin(), own.end(), bytes.begin() + (models[k]->name.data() - bytes.data()));
    }
  }
  return name_of;
}

}  // namespace spherechain::baker
