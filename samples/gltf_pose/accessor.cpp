// SPDX-License-Identifier: MIT
#include "accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace samples {
namespace {

template <typename T>
float number_at(const unsigned char* bytes, bool is_normalized) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  const auto number = static_cast<float>(value);
  return is_normalized ? std::max(-1.0F, number / static_cast<float>(std::numeric_limits<T>::max())) : number;
}

float number_of(int component, const unsigned char* bytes, bool is_normalized) {
  switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return number_at<std::int8_t>(bytes, is_normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return number_at<std::uint8_t>(bytes, is_normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return number_at<std::int16_t>(bytes, is_normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return number_at<std::uint16_t>(bytes, is_normalized);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return number_at<float>(bytes, false);
    default:
      throw std::runtime_error("an accessor has a component type that this sample does not read");
  }
}

}  // namespace

std::vector<float> read_accessor(const tinygltf::Model& model, int index, std::size_t width) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  if (accessor.sparse.isSparse || accessor.bufferView < 0) {
    throw std::runtime_error("a sparse accessor: this sample does not read it");
  }
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  const std::vector<unsigned char>& bytes = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  const int stride = accessor.ByteStride(view);
  const auto size =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const std::size_t begin = view.byteOffset + accessor.byteOffset;
  const bool fits = stride > 0 && begin <= bytes.size() &&
                    (accessor.count == 0 ||
                     (accessor.count - 1) * static_cast<std::size_t>(stride) + width * size <= bytes.size() - begin);
  if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) != static_cast<int>(width) || !fits) {
    throw std::runtime_error("an accessor is of another type, or reaches past its buffer");
  }
  std::vector<float> numbers;
  numbers.reserve(accessor.count * width);
  for (std::size_t i = 0; i < accessor.count; ++i) {
    for (std::size_t k = 0; k < width; ++k) {
      const unsigned char* const at = bytes.data() + begin + i * static_cast<std::size_t>(stride) + k * size;
      numbers.push_back(number_of(accessor.componentType, at, accessor.normalized));
    }
  }
  return numbers;
}

}  // namespace samples
