#include <algorithm>
#include <cmath>

#include "apps/report/digest_draws.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kMostLinks = 6;
constexpr std::size_t kMostPoints = 2400;  // points per link

Report number_or_null(const std::vector<double>& values, std::size_t at) {
  return at < values.size() && std::isfinite(values[at]) ? Report(compact(values[at])) : Report();
}

}  // namespace

Report digest_links(const io::NetcdfReader& file) {
  Report out = Report::array();
  const auto group = file.group("link_paths");
  if (!group) return out;
  const std::string first = "extension_";
  for (const std::string& name : file.variables(*group)) {
    if (!name.starts_with(first) || out.size() == kMostLinks) continue;
    const std::string ends = name.substr(first.size());
    const std::size_t split = ends.find('_');
    if (split == std::string::npos) continue;
    const auto values = [&](const std::string& what) {
      const std::string variable = what + ends;
      return file.has(*group, variable) ? file.read(*group, variable).values
                                        : std::vector<double>();
    };
    const std::vector<double> extension = values(first), rate = values("rate_"),
                              tension = values("tension_"), measured = values("measured_tension_"),
                              at = values("measured_extension_");
    if (extension.empty() || rate.size() != extension.size() ||
        tension.size() != extension.size()) {
      continue;
    }
    const std::size_t points = std::min(extension.size(), kMostPoints);
    Report rows = Report::array();
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t n = i * extension.size() / points;
      rows.push_back({compact(extension[n]), compact(rate[n]), compact(tension[n]),
                      number_or_null(measured, n), number_or_null(at, n)});
    }
    out.push_back({{"between", ends.substr(0, split) + " – " + ends.substr(split + 1)},
                   {"differentiated", !file.text(*group, name, "differentiated").empty()},
                   {"samples", extension.size()},
                   {"measured", !measured.empty()},
                   {"measured_extension", !at.empty()},
                   {"units",
                    {{"extension", file.text(*group, name, "units")},
                     {"rate", file.text(*group, "rate_" + ends, "units")},
                     {"tension", file.text(*group, "tension_" + ends, "units")}}},
                   // [model: extension, rate, tension; data: tension, extension]
                   {"rows", std::move(rows)}});
  }
  return out;
}

}  // namespace wheeltap::apps
