#include "apps/runs/batch/batch_list.hpp"

#include <climits>
#include <string_view>
#include <system_error>

#include "apps/failure.hpp"
#include "io/bytes.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::size_t kLongestPath = PATH_MAX - 1;  // bytes, limit of the system

std::string_view trimmed(std::string_view line) {
  const std::size_t first = line.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_last_not_of(kBlank) - first + 1);
}

}  // namespace

std::vector<BatchCase> read_batch_list(const std::filesystem::path& list) {
  const std::string text = io::read_bytes(list);
  std::vector<BatchCase> cases;
  int number = 0;
  for (std::size_t at = text.starts_with(io::kByteOrderMark) ? io::kByteOrderMark.size() : 0;
       at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(at, end - at));
    at = end + 1;
    if (line.empty() || line.front() == '#') continue;
    if (const auto bad = io::first_unprintable(line)) {
      throw Failure(Exit::bad_input, list.string() + ":" + std::to_string(number + 1) +
                                         ": column " + std::to_string(*bad + 1) +
                                         ": paths must be UTF-8 without control characters");
    }
    const std::filesystem::path path = list.parent_path() / line;
    std::error_code too_long;  // for names that are too long (a line of JSON)
    if (cases.empty() && line.front() == '{' && !exists(path, too_long)) {
      throw Failure(Exit::bad_input,
                    list.string() + ":" + std::to_string(number + 1) +
                        ": is JSON, perhaps a case: a list must have the path of " +
                        "one case per line");
    }
    if (line.size() > kLongestPath) {
      throw Failure(Exit::bad_input, list.string() + ":" + std::to_string(number + 1) + ": has " +
                                         std::to_string(line.size()) + " bytes: a path may have " +
                                         std::to_string(kLongestPath) + " at most");
    }
    cases.push_back({.path = path});
  }
  if (cases.empty()) {
    throw Failure(Exit::bad_input, list.string() + ": contains no case: write one path per line");
  }
  return cases;
}

}  // namespace wheeltap::apps
