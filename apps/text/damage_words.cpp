#include "apps/text/damage_words.hpp"

#include <cmath>

#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

constexpr double kMillimetres = 0.1;  // m: shorter lengths are in mm
constexpr double kBetter = 1.0;       // difference of ln likelihood

std::string number_words(int n) {
  static const char* words[] = {"no", "one", "two", "three", "four", "five"};
  return n >= 0 && n < 6 ? words[n] : std::to_string(n);
}

}  // namespace

std::string length_in_words(double metres) {
  return metres < kMillimetres ? significant(1000.0 * metres, 3) + " mm"
                               : significant(metres, 3) + " m";
}

std::string extent_in_words(const DefectKind& kind, double location, const Marginal* extent) {
  if (extent != nullptr && kind.extent_prior) {
    const bool small = extent->q97_5 < kMillimetres;
    const double unit = small ? 1000.0 : 1.0;
    const auto text = [&](double x) { return significant(unit * x, 2); };
    return "over " + text(extent->q50) + (small ? " mm (" : " m (") + text(extent->q2_5) + " to " +
           text(extent->q97_5) + (small ? " mm)" : " m)");
  }
  if (!has_fixed_extent(kind)) return {};
  return "over " + length_in_words(fixed_extent(kind, location)) +
         (kind.extent ? "" : " (one element)");
}

std::string merged_counts_in_words(const DefectKind& kind, const MergedFinding& merged) {
  constexpr double kWorth = 0.001;
  std::vector<std::string> parts;
  for (std::size_t n = 0; n < merged.count.size(); ++n)
    if (merged.count[n] >= kWorth)
      parts.push_back(std::to_string(n) + " " + (n == 1 ? kind.name : kind.plural) + " " +
                      percent(merged.count[n]));
  return in_words(parts);
}

std::string longer_in_words(const DefectKind& kind, int damages, const MergedModel& merged) {
  const int taken = damages - merged.count + 1;
  const SiteLine::Stretch& on = kind.line.stretches()[static_cast<std::size_t>(merged.stretch)];
  const Marginal& length = merged.length;
  return (damages == taken ? damages == 2 ? "These two" : "These " + number_words(damages)
          : taken == 2 ? std::string("Two of these")
                           : number_words(taken) + " of these") +
         " are adjacent: one longer " + kind.name + ", " + length_in_words(length.q50) + " (" +
         length_in_words(length.q2_5) + " to " + length_in_words(length.q97_5) + ") long, " +
         (kind.line.is_beam() ? "" : "on " + on.name + " ") + "near " +
         fixed(merged.location.q50, 3) + " m, with " + fixed(100.0 * merged.reduction.q50, 0) +
         " % of the stiffness lost, explains the data " +
         (merged.gain > kBetter ? "better" : "equally well") + ", with fewer unknowns.";
}

}  // namespace wheeltap::apps
