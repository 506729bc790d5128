// Serialisation of the results of jobs for other ranks of the same program. The serialised bytes
// are not meant for files.
#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/eigen.hpp"
#include "base/ranks.hpp"

namespace wheeltap::base {

template <class T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Packs the arguments of each call one after the other. An argument is a number, a string, a
/// vector or matrix of numbers, an optional value, or a struct for which its namespace declares
/// `carry(parcel, object)`. Vectors of all these types are allowed too. The length of a span is not
/// packed, because sender and receiver know the length.
class Packer {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  [[nodiscard]] std::string bytes() && { return std::move(bytes_); }

 private:
  template <PlainNumber T>
  void put(const T& number) {
    put(&number, 1);
  }
  template <PlainNumber T>
  void put(std::span<T> numbers) {
    put(numbers.data(), numbers.size());
  }
  void put(const std::string& text) {
    put(text.size());
    put(text.data(), text.size());
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(list.size());
    if constexpr (PlainNumber<T>) {
      put(list.data(), list.size());
    } else {
      for (const T& entry : list) put(entry);
    }
  }
  template <class T>
  void put(const std::optional<T>& value) {
    (*this)(value.has_value());
    if (value) (*this)(*value);
  }
  template <class T>
  requires requires(Packer& to, const T& value) { carry(to, value); }
  void put(const T& value) { carry(*this, value); }
  template <class S, int R, int C, int O, int MR, int MC>
  void put(const Eigen::Matrix<S, R, C, O, MR, MC>& matrix) {
    (*this)(matrix.rows(), matrix.cols());
    put(matrix.data(), static_cast<std::size_t>(matrix.size()));
  }
  template <PlainNumber T>
  void put(const T* numbers, std::size_t n) {
    bytes_.append(reinterpret_cast<const char*>(numbers), n * sizeof(T));
  }

  std::string bytes_;
};

/// Unpacks values of the same types in the order in which a Packer packed them.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] bool empty() const { return bytes_.empty(); }

  template <class... T>
  void operator()(T&&... values) {
    (get(values), ...);
  }

 private:
  template <PlainNumber T>
  void get(T& number) {
    get(&number, 1);
  }
  template <PlainNumber T>
  void get(std::span<T> numbers) {
    get(numbers.data(), numbers.size());
  }
  void get(std::string& text) {
    text.resize(length());
    get(text.data(), text.size());
  }
  template <class T>
  void get(std::vector<T>& list) {
    list.resize(length());
    if constexpr (PlainNumber<T>) {
      get(list.data(), list.size());
    } else {
      for (T& entry : list) get(entry);
    }
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    (*this)(there);
    value.reset();
    if (there) (*this)(value.emplace());
  }
  template <class T>
  requires requires(Unpacker& from, T& value) { carry(from, value); }
  void get(T& value) { carry(*this, value); }
  template <class S, int R, int C, int O, int MR, int MC>
  void get(Eigen::Matrix<S, R, C, O, MR, MC>& matrix) {
    Eigen::Index rows = 0, columns = 0;
    (*this)(rows, columns);
    matrix.resize(rows, columns);
    get(matrix.data(), static_cast<std::size_t>(matrix.size()));
  }
  template <PlainNumber T>
  void get(T* numbers, std::size_t n) {
    if (bytes_.size() < n * sizeof(T)) throw std::logic_error("a parcel is too short");
    if (n > 0) std::memcpy(numbers, bytes_.data(), n * sizeof(T));
    bytes_.remove_prefix(n * sizeof(T));
  }
  [[nodiscard]] std::size_t length() {
    std::size_t n = 0;
    get(n);
    if (n > bytes_.size()) throw std::logic_error("a parcel is too short");
    return n;
  }

  std::string_view bytes_;
};

/// Creates a Carriage (base/ranks.hpp) that transfers the values that `members` lists for a job.
/// The same function `members` is used for packing and unpacking: `[&](int unit, auto& parcel) {
/// parcel(x[unit], y[unit]); }`.
template <class Members>
[[nodiscard]] Carriage carriage(Members members) {
  return {.pack =
              [members](int unit) {
                Packer parcel;
                members(unit, parcel);
                return std::move(parcel).bytes();
              },
          .unpack =
              [members](int unit, std::string_view bytes) {
                Unpacker parcel(bytes);
                members(unit, parcel);
              }};
}

}  // namespace wheeltap::base
