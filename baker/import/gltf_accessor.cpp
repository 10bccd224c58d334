// SPDX-License-Identifier: GPL-3.0-or-later
// Accessors: section 3.6.2 of the specification.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "baker/import/gltf_file.h"

namespace spherechain::baker {
namespace {

template <typename T>
double number_at(const unsigned char* at, bool normalized) {
  T value;
  std::memcpy(&value, at, sizeof value);
  if constexpr (std::is_floating_point_v<T>) return static_cast<double>(value);
  if (!normalized) return static_cast<double>(value);
  return std::max(static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

double number_at(const unsigned char* at, int component, bool normalized) {
  switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return number_at<std::int8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return number_at<std::uint8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return number_at<std::int16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return number_at<std::uint16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return number_at<std::uint32_t>(at, normalized);
    default:
      return number_at<float>(at, normalized);
  }
}

// `count` elements of `size` bytes in a buffer view.
struct Elements {
  const unsigned char* first;
  std::size_t stride;
};

Elements elements(const GltfFile& file, const std::string& where, std::size_t view_index, std::size_t offset,
                  std::size_t count, std::size_t size, bool strided) {
  const tinygltf::BufferView& view = file.model.bufferViews[view_index];
  const std::vector<unsigned char>& data = file.model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (data.empty() && view.byteLength > 0) {
    const bool meshopt = view.extensions.count("EXT_meshopt_compression") > 0;
    file.fail(where + " lies in buffers[" + std::to_string(view.buffer) + "], which has no data" +
              (meshopt ? " (EXT_meshopt_compression is not read: export without it)" : ""));
  }
  if (view.byteOffset + view.byteLength > data.size()) {
    file.fail("bufferViews[" + std::to_string(view_index) + "] reaches past its buffer");
  }
  const std::size_t stride = strided && view.byteStride > 0 ? view.byteStride : size;
  if (stride < size) file.fail("bufferViews[" + std::to_string(view_index) + "].byteStride is less than an element");
  // All are below 2^32 and strides below 2^8: no overflow.
  if (count > 0 && offset + stride * (count - 1) + size > view.byteLength) {
    file.fail(where + " reaches past its buffer view");
  }
  return {data.data() + view.byteOffset + offset, stride};
}

std::string list_of(const std::vector<int>& components) {
  std::string list;
  for (const int component : components) list += (list.empty() ? "" : ", ") + std::to_string(component);
  return list;
}

}  // namespace

std::vector<double> GltfFile::numbers(int index, int type, const std::vector<int>& components) const {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const std::string where = "accessors[" + std::to_string(index) + "]";
  if (accessor.type != type) fail(where + ".type is not what its use asks for");
  if (std::find(components.begin(), components.end(), accessor.componentType) == components.end()) {
    fail(where + ".componentType is " + std::to_string(accessor.componentType) + ", but its use allows " +
         list_of(components));
  }
  const auto width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  if (accessor.count * width > 4 * kGltfElementsMax) {
    fail(where + ".count is " + std::to_string(accessor.count) + ", too many for a character");
  }
  const auto bytes =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const auto read = [&](const Elements& from, std::size_t element, double* out) {
    for (std::size_t k = 0; k < width; ++k) {
      out[k] = number_at(from.first + element * from.stride + k * bytes, accessor.componentType, accessor.normalized);
      if (!std::isfinite(out[k])) {
        fail(where + " holds a number that is not finite, in its element " + std::to_string(element));
      }
    }
  };
  // The view is looked at before memory is asked for.
  Elements dense{};
  if (accessor.bufferView >= 0) {
    dense = elements(*this, where, static_cast<std::size_t>(accessor.bufferView), accessor.byteOffset, accessor.count,
                     width * bytes, true);
  }
  std::vector<double> out(accessor.count * width, 0.0);
  if (accessor.bufferView >= 0) {
    for (std::size_t i = 0; i < accessor.count; ++i) read(dense, i, &out[i * width]);
  }
  if (!accessor.sparse.isSparse) return out;

  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  if (count > accessor.count) fail(where + ".sparse.count is more than count");
  const int index_type = sparse.indices.componentType;
  if (index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    fail(where + ".sparse.indices.componentType is " + std::to_string(index_type));
  }
  const Elements indices = elements(
      *this, where + ".sparse.indices", static_cast<std::size_t>(sparse.indices.bufferView),
      static_cast<std::size_t>(sparse.indices.byteOffset), count,
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(index_type))), false);
  const Elements values = elements(*this, where + ".sparse.values", static_cast<std::size_t>(sparse.values.bufferView),
                                   static_cast<std::size_t>(sparse.values.byteOffset), count, width * bytes, false);
  for (std::size_t i = 0; i < count; ++i) {
    const auto target = static_cast<std::size_t>(number_at(indices.first + i * indices.stride, index_type, false));
    if (target >= accessor.count) fail(where + ".sparse.indices lead past its count");
    read(values, i, &out[target * width]);
  }
  return out;
}

}  // namespace spherechain::baker
