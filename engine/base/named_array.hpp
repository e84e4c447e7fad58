// A table of numbers with a name, a shape and a meaning: how parts and other inputs travel between the folders that
// know what they mean and the one that stores them (record), without either knowing the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {

enum class Dtype : std::uint8_t { f64, f32, u64, u32, u16, u8, i32, i8 };

[[nodiscard]] constexpr std::size_t size_of(Dtype t) {
  switch (t) {
    case Dtype::f64:
    case Dtype::u64:
      return 8;
    case Dtype::f32:
    case Dtype::u32:
    case Dtype::i32:
      return 4;
    case Dtype::u16:
      return 2;
    case Dtype::u8:
    case Dtype::i8:
      return 1;
  }
  return 0;
}

template <typename T>
constexpr Dtype dtype_of() {
  if constexpr (std::is_same_v<T, double>)
    return Dtype::f64;
  else if constexpr (std::is_same_v<T, float>)
    return Dtype::f32;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return Dtype::u64;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return Dtype::u32;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return Dtype::i32;
  else if constexpr (std::is_same_v<T, std::uint16_t>)
    return Dtype::u16;
  else if constexpr (std::is_same_v<T, std::int8_t>)
    return Dtype::i8;
  else {
    static_assert(std::is_same_v<T, std::uint8_t>, "no Dtype stands for this type");
    return Dtype::u8;
  }
}

struct NamedArray {
  std::string name;  ///< path below its group, e.g. "triangles"
  Dtype dtype = Dtype::f64;
  std::vector<std::size_t> shape;  ///< row-major
  std::vector<std::byte> bytes;    ///< native byte order
  std::string units;               ///< "m", "1", …
  std::string description;         ///< one sentence

  /// @pre the product of `shape` is the number of values
  template <typename T>
  static NamedArray from(std::string name, std::span<const T> values, std::vector<std::size_t> shape, std::string units,
                         std::string description) {
    NamedArray a{std::move(name), dtype_of<T>(), std::move(shape), {}, std::move(units), std::move(description)};
    VERISIM_ASSERT(a.count() == values.size());
    a.bytes.resize(values.size_bytes());
    if (!values.empty()) std::memcpy(a.bytes.data(), values.data(), values.size_bytes());
    return a;
  }

  /// Number of values that the shape promises; 1 for a scalar (no dimensions).
  [[nodiscard]] std::size_t count() const {
    std::size_t n = 1;
    for (const std::size_t extent : shape) n *= extent;
    return n;
  }

  /// The values as T. Throws Error(input) if the array holds another type or another number of values than its shape
  /// promises.
  template <typename T>
  [[nodiscard]] std::vector<T> as() const {
    if (dtype != dtype_of<T>())
      fail(ErrorKind::input, "'{}' holds another number type than expected; the run file is damaged", name);
    if (bytes.size() != count() * sizeof(T))
      fail(ErrorKind::input, "'{}' holds {} bytes but its shape promises {}; the run file is damaged", name,
           bytes.size(), count() * sizeof(T));
    std::vector<T> values(count());
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }
};

}  // namespace verisim
