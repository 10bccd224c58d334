// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_file.h"

#include <optional>

namespace spherechain::baker {
namespace {

std::optional<FbxKind> kind_of(std::string_view record) {
  if (record == "Model") return FbxKind::kModel;
  if (record == "AnimationCurveNode") return FbxKind::kCurveNode;
  if (record == "AnimationCurve") return FbxKind::kCurve;
  if (record == "AnimationLayer") return FbxKind::kLayer;
  if (record == "AnimationStack") return FbxKind::kStack;
  return {};
}

void read_properties(const FbxTree& tree, const FbxRecord& record, FbxObject& object) {
  const FbxRecord* const properties = record.find("Properties70");
  if (properties == nullptr) return;
  for (const FbxRecord& property : properties->inside) {
    const std::vector<FbxValue> values = tree.values(property);
    if (property.name != "P" || values.size() < 5 || !values[4].number) continue;
    std::array<double, 3> numbers{};
    for (std::size_t k = 0; k < 3 && 4 + k < values.size(); ++k) numbers[k] = values[4 + k].number.value_or(0);
    object.values.emplace(values[0].text, numbers);
  }
}

}  // namespace

std::array<double, 3> FbxObject::value(const std::string& property, const std::array<double, 3>& otherwise) const {
  const auto found = values.find(property);
  return found == values.end() ? otherwise : found->second;
}

FbxFile read_fbx(std::string_view bytes) {
  FbxFile out;
  out.tree = parse_fbx(bytes);
  for (const FbxRecord& list : out.tree.records) {
    for (const FbxRecord& record : list.inside) {
      if (list.name == "Objects") {
        const std::optional<FbxKind> kind = kind_of(record.name);
        if (!kind) continue;
        const std::vector<FbxValue> values = out.tree.values(record);
        if (values.size() < 3 || !values[0].whole) continue;
        const bool is_joint = values[2].text == "LimbNode" || values[2].text == "Root";
        out.objects.push_back({*values[0].whole, values[1].text, *kind, is_joint, {}, &record});
        if (*kind != FbxKind::kCurve) read_properties(out.tree, record, out.objects.back());
      } else if (list.name == "Connections" && record.name == "C") {
        const std::vector<FbxValue> values = out.tree.values(record);
        if (values.size() < 3 || !values[1].whole || !values[2].whole) continue;
        out.links.push_back(
            {*values[1].whole, *values[2].whole, std::string(values.size() > 3 ? values[3].text : std::string_view())});
      }
    }
  }
  return out;
}

std::array<int, 3> rotation_order(const FbxObject& model) {
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}}};
  const double number = model.value("RotationOrder")[0];
  return number >= 0 && number < 6 ? kOrders[static_cast<std::size_t>(number)] : kOrders[0];
}

}  // namespace spherechain::baker
