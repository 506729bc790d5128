#include "apps/cases/records/free_decays.hpp"

#include <string>

#include "base/number.hpp"

namespace wheeltap::apps {

std::vector<std::pair<Eigen::Index, Eigen::Index>> parse_decays(const CaseFile& file,
                                                                const Pointer& where,
                                                                Eigen::Index samples) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> out;
  const Json& windows = file.json.at(where);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Eigen::Index begin = windows[i][0].get<int>(), end = windows[i][1].get<int>();
    if (begin >= end || end > samples)
      file.refuse(where / i, "must be [first, one past the last] within the " +
                                 base::grouped(samples) + " samples of the record");
    for (std::size_t j = 0; j < i; ++j)
      if (begin < out[j].second && out[j].first < end)
        file.refuse(where / i, "overlaps window " + std::to_string(j) +
                                   ", and the common samples would count twice: choose windows "
                                   "without common samples");
    out.emplace_back(begin, end);
  }
  return out;
}

}  // namespace wheeltap::apps
