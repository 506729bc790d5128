// JSON from outside: cases, values of --set, summaries of runs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

namespace wheeltap::apps {

/// Lists and objects within one another: more than any case has, and few enough for whoever walks
/// them by recursion.
constexpr std::size_t kDeepestJson = 100;
/// Bytes of a case, which names its data instead of holding them.
constexpr std::size_t kLargestCase = std::size_t{64} << 20U;
/// Bytes of what another program or a server answers: a million numbers.
constexpr std::size_t kLargestAnswer = std::size_t{16} << 20U;
/// Keys of one object where their order is kept, which makes finding one of them linear.
constexpr std::size_t kMostOrderedKeys = 20'000;

/// Reads `text`, all of it; AnyJson is nlohmann::json or ordered_json. Throws Failure (65), naming
/// `path`: line and column of what is not JSON, the key that stands twice in one object, a number
/// too large, nesting too deep.
template <class AnyJson>
[[nodiscard]] AnyJson parse_json(const std::filesystem::path& path, std::string_view text);

/// What another program said; discarded where that is no JSON, a number is too large, or lists and
/// objects stand deeper within one another than kDeepestJson.
[[nodiscard]] nlohmann::json parse_answer(std::string_view text);

extern template nlohmann::json parse_json(const std::filesystem::path&, std::string_view);
extern template nlohmann::ordered_json parse_json(const std::filesystem::path&, std::string_view);

}  // namespace wheeltap::apps
