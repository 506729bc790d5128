#include "identification/structural/defects/site_line.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/index.hpp"
#include "base/number.hpp"

namespace wheeltap::identification {
namespace {

/// Distance, relative to a stretch, below which a place counts as a boundary.
constexpr double kSamePlace = 1e-9;

}  // namespace

void SiteLine::add_stretch(int site, std::string name, double size, double extent,
                           const std::vector<double>& boundaries) {
  const double start = stretches_.empty() ? 0.0 : length();
  stretches_.push_back({.site = site,
                        .name = std::move(name),
                        .start = start,
                        .end = start + extent,
                        .size = size,
                        .first_cell = cells()});
  for (std::size_t i = 1; i + 1 < boundaries.size(); ++i)
    bounds_.push_back(start + extent * boundaries[i] / boundaries.back());
  bounds_.push_back(start + extent);
}

SiteLine SiteLine::of_beam(const fem::Beam& beam) {
  SiteLine line;
  line.is_beam_ = true;
  std::vector<double> boundaries;
  for (int e = 0; e <= beam.elements; ++e) boundaries.push_back(e * beam.element_length());
  line.add_stretch(0, "beam", beam.length, beam.length, boundaries);
  for (int e = 0; e < beam.elements; ++e) line.bounds_[index(e)] = e * beam.element_length();
  return line;
}

SiteLine SiteLine::of_members(const fem::Mesh& mesh, const std::vector<int>& members,
                              const std::vector<double>& weights) {
  SiteLine line;
  double all = 0.0;
  for (const int m : members) all += mesh.member_length(m);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const double size = mesh.member_length(members[i]);
    std::vector<double> boundaries = {0.0};
    for (int e = mesh.first_element(members[i]); e < mesh.first_element(members[i] + 1); ++e)
      boundaries.push_back(mesh.elements()[index(e)].to);
    line.add_stretch(members[i], mesh.structure().members[index(members[i])].name, size,
                     weights.empty() ? size : all * weights[i] / sum, boundaries);
  }
  return line;
}

SiteLine SiteLine::of_points(const std::vector<int>& sites, const std::vector<std::string>& names,
                             const std::vector<double>& weights) {
  SiteLine line;
  for (std::size_t i = 0; i < sites.size(); ++i)
    line.add_stretch(sites[i], names[i], 0.0, weights.empty() ? 1.0 : weights[i], {0.0, 1.0});
  return line;
}

int SiteLine::cell_at(double x) const {
  if (!(x >= 0.0 && x <= length()))
    throw std::invalid_argument("location = " + base::number(x) + ": must lie in [0, " +
                                base::number(length()) + "]");
  const auto above = std::upper_bound(bounds_.begin() + 1, bounds_.end() - 1, x);
  auto cell = static_cast<int>(above - bounds_.begin()) - 1;
  if (above != bounds_.end() && cell + 1 < cells() && *above - x <= kSamePlace * length()) ++cell;
  return cell;
}

int SiteLine::stretch_of_cell(int c) const {
  const auto after =
      std::upper_bound(stretches_.begin(), stretches_.end(), c,
                       [](int cell, const Stretch& s) { return cell < s.first_cell; });
  return static_cast<int>(after - stretches_.begin()) - 1;
}

SiteLine::Spot SiteLine::spot(double x) const {
  const int stretch = stretch_of_cell(cell_at(x));
  const Stretch& s = stretches_[index(stretch)];
  const double share = std::clamp((x - s.start) / (s.end - s.start), 0.0, 1.0);
  return {.stretch = stretch, .site = s.site, .s = share * s.size};
}

double SiteLine::x_of(int site, double s) const {
  for (const Stretch& stretch : stretches_) {
    if (stretch.site != site) continue;
    const double share = stretch.size > 0.0 ? s / stretch.size : 0.5;
    return stretch.start + share * (stretch.end - stretch.start);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace wheeltap::identification
