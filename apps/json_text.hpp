// Parsing of untrusted JSON: cases, values of --set, summaries of runs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

namespace wheeltap::apps {

/// Largest nesting depth of lists and objects. This limit is larger than the depth of any valid
/// case, and small enough for recursive functions.
constexpr std::size_t kDeepestJson = 100;
/// Largest size of a case file [bytes]. Data are in separate files.
constexpr std::size_t kLargestCase = std::size_t{64} << 20U;
/// Largest response of an external program or server [bytes]: a million numbers.
constexpr std::size_t kLargestAnswer = std::size_t{16} << 20U;
/// Largest number of keys per object in ordered JSON, where the search for a key is linear.
constexpr std::size_t kMostOrderedKeys = 20'000;

/// Parses all of `text`; AnyJson is nlohmann::json or ordered_json. Throws Failure (65), with the
/// file name `path`, for invalid JSON (with line and column), duplicate keys in an object, numbers
/// that are too large, and nesting that is too deep.
template <class AnyJson>
[[nodiscard]] AnyJson parse_json(const std::filesystem::path& path, std::string_view text);

/// Parses the response of an external program. For invalid JSON, numbers that are too large, or
/// nesting deeper than kDeepestJson, the result satisfies is_discarded().
[[nodiscard]] nlohmann::json parse_answer(std::string_view text);

extern template nlohmann::json parse_json(const std::filesystem::path&, std::string_view);
extern template nlohmann::ordered_json parse_json(const std::filesystem::path&, std::string_view);

}  // namespace wheeltap::apps
