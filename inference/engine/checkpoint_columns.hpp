// Conversion of a struct's members to columns of numbers and back.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/eigen.hpp"
#include "inference/chains/draw_list.hpp"
#include "inference/engine/checkpoint.hpp"

namespace wheeltap::inference::columns {

// The type of the column that stores numbers of type Number.
template <class Number>
using Stored =
    std::conditional_t<std::same_as<Number, long> || std::same_as<Number, long long>, std::int64_t,
                       std::conditional_t<std::same_as<Number, bool> || std::same_as<Number, char>,
                                          std::uint8_t, Number>>;

template <class T>
inline constexpr bool kIsMatrix = false;
template <class Scalar, int R, int C, int O, int MR, int MC>
inline constexpr bool kIsMatrix<Eigen::Matrix<Scalar, R, C, O, MR, MC>> = true;
template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <class N>
inline constexpr bool kIsVector<DrawList<N>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsList = kIsVector<T> || std::same_as<T, std::string>;
template <class T>
concept Number = std::is_arithmetic_v<T>;

// Nested member names.
class Names {
 public:
  std::string operator()(const char* suffix = nullptr) const {
    return suffix == nullptr ? name_ : name_ + "." + suffix;
  }
  template <class Body>
  void within(const char* member, Body&& body) {
    const std::size_t before = name_.size();
    if (before > 0) name_ += '.';
    name_ += member;
    body();
    name_.resize(before);
  }

 private:
  std::string name_;
};

/// Writes named members of structs as columns. `Fields::of(archive, value)` lists the members of a
/// struct, for writing and reading.
template <class Fields>
class Writer {
 public:
  static constexpr bool kReads = false;
  explicit Writer(Checkpoint& to) : to_(to) {}
  /// Writes draws first, …, last - 1 of each chain. For a chain without an entry in `first`, all
  /// draws are written.
  Writer(Checkpoint& to, std::vector<std::size_t> first,
         std::size_t last = std::numeric_limits<std::size_t>::max())
      : to_(to), first_(std::move(first)), last_(last) {}

  /// Writes members of a struct. The arguments alternate between names and members.
  template <class T, class... More>
  void operator()(const char* member, const T& value, const More&... more) {
    names_.within(member, [&] { put(value); });
    if constexpr (sizeof...(more) > 0) (*this)(more...);
  }
  /// Starts to write the columns of the next chain, which has `draws` draws.
  void chain(std::size_t draws) {
    const std::size_t c = chains_++;
    draws_ = {.all = draws,
              .first = c < first_.size() ? std::min(first_[c], draws) : 0,
              .last = std::min(last_, draws)};
  }
  /// Writes `values`, a list of the current chain. The list has the same number of values for each
  /// draw.
  template <class N>
  void by_draw(const char* member, const DrawList<N>& values) {
    const std::size_t each = draws_.all > 0 ? values.size() / draws_.all : 0;
    names_.within(member, [&] {
      put_numbers(
          std::span(values).subspan(draws_.first * each, (draws_.last - draws_.first) * each));
    });
  }

 private:
  template <class N>
  void put_numbers(std::span<const N> values) {
    column<long>("size").push_back(static_cast<std::int64_t>(values.size()));
    auto& numbers = column<N>();
    numbers.insert(numbers.end(), values.begin(), values.end());
  }
  template <class N>
  std::vector<Stored<N>>& column(const char* suffix = nullptr) {
    const auto at = to_.columns.try_emplace(names_(suffix), std::vector<Stored<N>>{}).first;
    return std::get<std::vector<Stored<N>>>(at->second);
  }
  template <class T>
  void put(const T& value) {
    if constexpr (std::is_enum_v<T>) {
      put(static_cast<int>(value));
    } else if constexpr (std::same_as<T, std::size_t>) {
      put(static_cast<long>(value));
    } else if constexpr (Number<T>) {
      column<T>().push_back(static_cast<Stored<T>>(value));
    } else if constexpr (kIsMatrix<T>) {
      column<long>("rows").push_back(value.rows());
      column<long>("columns").push_back(value.cols());
      auto& numbers = column<double>();
      numbers.insert(numbers.end(), value.data(), value.data() + value.size());
    } else if constexpr (kIsOptional<T>) {
      column<bool>("there").push_back(value.has_value());
      if (value) put(*value);
    } else if constexpr (kIsList<T>) {
      if constexpr (Number<typename T::value_type>) {
        put_numbers(std::span<const typename T::value_type>(value));
      } else {
        column<long>("size").push_back(static_cast<std::int64_t>(value.size()));
        for (const auto& entry : value) {
          if constexpr (kIsList<typename T::value_type>) {
            // The lengths of `entry` and of `value` are in different columns
            (*this)("each", entry);
          } else {
            put(entry);
          }
        }
      }
    } else {
      Fields::of(*this, value);
    }
  }

  Checkpoint& to_;
  Names names_;
  std::vector<std::size_t> first_;
  std::size_t last_ = std::numeric_limits<std::size_t>::max();
  std::size_t chains_ = 0;  // number of chains written so far
  struct {
    std::size_t all, first, last;
  } draws_{};
};

/// Reads the columns. Throws CheckpointError if a column is missing, too short or of another type.
template <class Fields>
class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(const Checkpoint& from) : from_(from) {}

  template <class T, class... More>
  void operator()(const char* member, T& value, More&... more) {
    names_.within(member, [&] { get(value); });
    if constexpr (sizeof...(more) > 0) (*this)(more...);
  }
  void chain(std::size_t /*draws*/) {}
  template <class N>
  void by_draw(const char* member, DrawList<N>& values) {
    (*this)(member, values);
  }
  // Throws CheckpointError unless every number was read.
  void end() const {
    for (const auto& [name, column] : from_.columns) {
      const std::size_t size =
          std::visit([](const auto& numbers) { return numbers.size(); }, column);
      const auto read = read_.find(name);
      if (size != (read == read_.end() ? 0 : read->second)) {
        throw CheckpointError("it has more of \"" + name + "\" than a run has");
      }
    }
  }

 private:
  // The next `n` numbers of a column.
  template <class N>
  const Stored<N>* take(std::size_t n, const char* suffix = nullptr) {
    if (n == 0) return nullptr;
    const std::string name = names_(suffix);
    const auto at = from_.columns.find(name);
    const auto* numbers =
        at == from_.columns.end() ? nullptr : std::get_if<std::vector<Stored<N>>>(&at->second);
    if (numbers == nullptr) throw CheckpointError("it lacks \"" + name + "\"");
    std::size_t& read = read_[name];
    if (n > numbers->size() - read) throw CheckpointError("it lacks a part of \"" + name + "\"");
    read += n;
    return numbers->data() + read - n;
  }
  std::size_t length(const char* suffix) {
    const std::int64_t n = *take<long>(1, suffix);
    if (n < 0 || n > kLongest) {
      throw CheckpointError("\"" + names_(suffix) + "\" = " + std::to_string(n) + " is no length");
    }
    return static_cast<std::size_t>(n);
  }
  template <class T>
  void get(T& value) {
    if constexpr (std::is_enum_v<T>) {
      int number = 0;
      get(number);
      value = static_cast<T>(number);
    } else if constexpr (std::same_as<T, std::size_t>) {
      value = static_cast<std::size_t>(*take<long>(1));
    } else if constexpr (Number<T>) {
      value = static_cast<T>(*take<T>(1));
    } else if constexpr (kIsMatrix<T>) {
      const std::size_t rows = length("rows"), columns = length("columns");
      const double* numbers = take<double>(rows * columns);
      value.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
      std::copy_n(numbers, rows * columns, value.data());
    } else if constexpr (kIsOptional<T>) {
      value.reset();
      if (*take<bool>(1, "there") == 0) return;
      using Inner = typename T::value_type;
      Inner inner = Fields::template make<Inner>();
      get(inner);
      value = std::move(inner);
    } else if constexpr (kIsList<T>) {
      const std::size_t n = length("size");
      using Entry = typename T::value_type;
      value.clear();
      if constexpr (Number<Entry>) {
        const auto* numbers = take<Entry>(n);
        if (n > 0) value.assign(numbers, numbers + n);
      } else {
        for (std::size_t i = 0; i < n; ++i) {
          Entry entry = Fields::template make<Entry>();
          if constexpr (kIsList<Entry>) {
            (*this)("each", entry);
          } else {
            get(entry);
          }
          value.push_back(std::move(entry));
        }
      }
    } else {
      Fields::of(*this, value);
    }
  }

  static constexpr std::int64_t kLongest = std::int64_t{1} << 40;

  const Checkpoint& from_;
  Names names_;
  std::map<std::string, std::size_t> read_;
};

}  // namespace wheeltap::inference::columns
