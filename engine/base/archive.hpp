// Values as bytes and back, for what a program keeps for itself and for others of the same build: native byte order, no
// version, no names. What it says of a type's fields is said once, for both directions:
//
//   void fields(auto& archive, Cluster& self) { archive(self.begin, self.end); }
//
// in the type's namespace, or as a static member of it, for private fields. Arithmetic types, enumerations, Eigen's
// fixed vectors and matrices, std::array, vector, string, optional and variant need none. Equal values are equal bytes:
// no padding is written.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {

/// A type without padding whose bytes are its value.
template <typename T>
inline constexpr bool kIsFlat = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <typename S, int R, int C>
inline constexpr bool kIsFlat<Eigen::Matrix<S, R, C>> = R > 0 && C > 0;
template <typename T, std::size_t N>
inline constexpr bool kIsFlat<std::array<T, N>> = kIsFlat<T>;

namespace detail {

template <typename T>
inline constexpr bool kIsVector = false;
template <typename T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <typename T>
inline constexpr bool kIsOptional = false;
template <typename T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <typename T>
inline constexpr bool kIsVariant = false;
template <typename... T>
inline constexpr bool kIsVariant<std::variant<T...>> = true;

template <typename Archive, typename T>
void archive_fields(Archive& archive, T& value) {
  if constexpr (requires { T::fields(archive, value); })
    T::fields(archive, value);
  else
    fields(archive, value);
}

}  // namespace detail

class ArchiveWriter {
 public:
  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  std::string bytes;

 private:
  void put_raw(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
  void put_size(std::size_t size) {
    const std::uint64_t n = size;
    put_raw(&n, sizeof n);
  }
  template <typename T>
  void put(const T& value) {
    if constexpr (kIsFlat<T>) {
      put_raw(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      put_size(value.size());
      put_raw(value.data(), value.size());
    } else if constexpr (detail::kIsVector<T>) {
      put_size(value.size());
      if constexpr (kIsFlat<typename T::value_type>) {
        if (!value.empty()) put_raw(value.data(), value.size() * sizeof(typename T::value_type));
      } else {
        for (const auto& element : value) put(element);
      }
    } else if constexpr (detail::kIsOptional<T>) {
      put_size(value ? 1 : 0);
      if (value) put(*value);
    } else if constexpr (detail::kIsVariant<T>) {
      put_size(value.index());
      std::visit([&](const auto& held) { put(held); }, value);
    } else {
      detail::archive_fields(*this,
                             const_cast<T&>(value));  // one function for both directions; this one changes nothing
    }
  }
};

class ArchiveReader {
 public:
  /// @param bytes  outlive it
  explicit ArchiveReader(std::string_view bytes) : left_(bytes) {}

  /// Error(input) if the bytes are too few; never reads beyond them, nor allocates more than they can hold.
  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  [[nodiscard]] bool is_at_end() const { return left_.empty(); }

 private:
  void get_raw(void* data, std::size_t size) {
    if (size > left_.size()) fail(ErrorKind::input, "an archive ends too early");
    std::memcpy(data, left_.data(), size);
    left_.remove_prefix(size);
  }
  std::size_t get_size(std::size_t least_bytes_each) {
    std::uint64_t n = 0;
    get_raw(&n, sizeof n);
    if (n > left_.size() / least_bytes_each) fail(ErrorKind::input, "an archive ends too early");
    return static_cast<std::size_t>(n);
  }
  std::size_t get_index(std::size_t count) {
    std::uint64_t n = 0;
    get_raw(&n, sizeof n);
    if (n >= count) fail(ErrorKind::input, "an archive holds another type");
    return static_cast<std::size_t>(n);
  }
  template <typename T>
  void get(T& value) {
    if constexpr (kIsFlat<T>) {
      get_raw(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value.resize(get_size(1));
      get_raw(value.data(), value.size());
    } else if constexpr (detail::kIsVector<T>) {
      using Element = typename T::value_type;
      if constexpr (kIsFlat<Element>) {
        value.resize(get_size(sizeof(Element)));
        if (!value.empty()) get_raw(value.data(), value.size() * sizeof(Element));
      } else {
        value.resize(get_size(1));
        for (Element& element : value) get(element);
      }
    } else if constexpr (detail::kIsOptional<T>) {
      value.reset();
      if (get_index(2) == 0) return;
      typename T::value_type held = typename T::value_type();
      get(held);
      value = std::move(held);
    } else if constexpr (detail::kIsVariant<T>) {
      get_variant(value, get_index(std::variant_size_v<T>), std::make_index_sequence<std::variant_size_v<T>>());
    } else {
      detail::archive_fields(*this, value);
    }
  }
  template <typename T, std::size_t... I>
  void get_variant(T& value, std::size_t index, std::index_sequence<I...> /*all*/) {
    const auto take = [&]<std::size_t J>() {
      if (index != J) return;
      std::variant_alternative_t<J, T> held{};
      get(held);
      value = std::move(held);
    };
    (take.template operator()<I>(), ...);
  }

  std::string_view left_;
};

}  // namespace verisim
