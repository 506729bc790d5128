#include "apps/batch_list.hpp"

#include <climits>
#include <map>
#include <set>
#include <string_view>
#include <system_error>

#include "apps/batch_table.hpp"
#include "apps/failure.hpp"
#include "io/bytes.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::size_t kLongestPath = PATH_MAX - 1;  // bytes that the system takes

std::string_view trimmed(std::string_view line) {
  const std::size_t first = line.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_last_not_of(kBlank) - first + 1);
}

/// Names that no case before has, and that are no file of the batch itself.
class UniqueNames {
 public:
  std::string of(const std::filesystem::path& path) {
    std::string stem = path.stem().string();
    if (stem.empty() || stem == "." || stem == "..") stem = "case";
    if (taken_.insert(stem).second) return stem;
    // From where the last of this stem was found: a fleet's cases may all be called alike.
    for (int& n = last_.try_emplace(stem, 1).first->second;;) {
      std::string name = stem + "-" + std::to_string(++n);
      if (taken_.insert(name).second) return name;
    }
  }

 private:
  std::set<std::string> taken_{kBatchTable};
  std::map<std::string, int> last_;
};

}  // namespace

std::vector<BatchCase> read_batch_list(const std::filesystem::path& list) {
  const std::string text = io::read_bytes(list);
  std::vector<BatchCase> cases;
  UniqueNames names;
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
                                         ": paths are UTF-8 without control characters");
    }
    const std::filesystem::path path = list.parent_path() / line;
    std::error_code too_long;  // for a name, as JSON on a line may be
    if (cases.empty() && line.front() == '{' && !exists(path, too_long)) {
      throw Failure(Exit::bad_input, list.string() + ":" + std::to_string(number + 1) +
                                         ": is JSON, a case perhaps: a list has a path of a case " +
                                         "on each line");
    }
    if (line.size() > kLongestPath) {
      throw Failure(Exit::bad_input, list.string() + ":" + std::to_string(number + 1) + ": has " +
                                         std::to_string(line.size()) + " bytes: a path has " +
                                         std::to_string(kLongestPath) + " at most");
    }
    cases.push_back({path, names.of(path)});
  }
  if (cases.empty()) {
    throw Failure(Exit::bad_input, list.string() + ": names no case: one path a line");
  }
  return cases;
}

}  // namespace wheeltap::apps
