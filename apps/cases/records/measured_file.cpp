#include "apps/cases/records/measured_file.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/records/record_reading.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kShown = 5;  // largest number of listed dropouts or spikes

std::string where(long sample, std::optional<double> rate) {
  return rate ? base::significant(static_cast<double>(sample) / *rate, 5) + " s"
              : "sample " + std::to_string(sample);
}

}  // namespace

std::vector<std::string> left_out_in_words(const MeasuredTable& table) {
  std::vector<std::string> out;
  for (const signals::LeftOutColumn& c : table.left_out)
    out.push_back(
        "Column " + std::to_string(c.number) + " (" + c.header + ") holds " +
        (c.is_time_stamp ? "further time stamps" : "no numbers") + " and is not used" +
        (c.maybe_time
             ? "; if the column contains times, give the format of the times with --time-format"
             : "") +
        ".");
  return out;
}

std::vector<std::string> reading_in_words(const MeasuredTable& table) {
  std::vector<std::string> out;
  if (table.layout) out.push_back(layout_in_words(*table.layout));
  for (const std::string& text :
       {sampling_in_words(table.sampling), jitter_in_words(table.sampling)})
    if (!text.empty()) out.push_back(text);
  std::vector<std::string> units;
  for (const MeasuredChannel& c : table.channels) {
    const signals::Conversion conversion = signals::conversion_of(c.unit);
    if (conversion.basis != signals::Conversion::Basis::unit || conversion.factor == 1.0) continue;
    std::string text = conversion_in_words(conversion);
    if (std::ranges::find(units, text) == units.end()) units.push_back(std::move(text));
  }
  if (!units.empty()) {
    std::string text = "Cases convert these units to SI: ";
    for (std::size_t i = 0; i < units.size(); ++i) text += (i > 0 ? "; " : "") + units[i];
    out.push_back(text + ".");
  }
  for (const MeasuredChannel& c : table.channels)
    if (!c.possible_unit.empty())
      out.push_back(c.name + ": if its numbers are in " + c.possible_unit + ", state \"unit\": \"" +
                    c.possible_unit + "\" in its channel, or name the column \"" + c.name + " [" +
                    c.possible_unit + "]\".");
  for (std::string& text : left_out_in_words(table)) out.push_back(std::move(text));
  return out;
}

std::vector<std::string> oddities(const MeasuredTable& table, const MeasuredChannel& channel) {
  using enum signals::ChannelFault;
  const std::optional<double> rate = table.sample_rate_hz;
  const signals::ChannelQuality& q = channel.quality;
  const auto first_of = [&](auto&& list, auto&& begin) {
    std::vector<std::string> places;
    for (std::size_t i = 0; i < std::min(list.size(), kShown); ++i)
      places.push_back(where(begin(list[i]), rate));
    if (list.size() > kShown) places.push_back(std::to_string(list.size() - kShown) + " more");
    return in_words(places);
  };
  const auto in_sd = [](double x) { return base::significant(std::abs(x), 2); };
  const auto text_of = [&](const signals::FoundFault& found) -> std::string {
    switch (found.fault) {
      case missing:
        return std::to_string(q.missing) + " of " + std::to_string(q.samples) +
               " samples are missing (not a number)";
      case constant:
        return "is constant at " + base::significant(q.mean, 4) +
               "; a disconnected sensor is a possible cause";
      case dropouts:
        return "is constant " +
               std::string(q.dropouts.size() == 1 ? "once"
                                                  : std::to_string(q.dropouts.size()) + " times") +
               " for longer than expected by chance (" + base::fixed(found.value, 0) +
               " samples, from " +
               first_of(q.dropouts, [](const signals::Stretch& d) { return d.begin; }) +
               "): possible dropouts";
      case clipped:
        return "is clipped: " + std::to_string(q.clipped_high) + " samples are at " +
               base::significant(q.highest, 4) + " and " + std::to_string(q.clipped_low) + " at " +
               base::significant(q.lowest, 4) + "; the measuring range was too small";
      case spikes:
        return "has " + std::to_string(q.spikes.size()) +
               (q.spikes.size() == 1 ? " spike" : " spikes") + " of a single sample, at " +
               first_of(q.spikes, [](long s) { return s; });
      case counter:
        return "increases by constant steps: the column is an index or a time rather than a "
               "channel";
      case drift:
        return "drifts: over the record its mean " +
               std::string(found.value > 0.0 ? "rises" : "falls") + " by " + in_sd(found.value) +
               " standard deviations";
      case wander:
        return "wanders: the mean values of twenty blocks have a standard deviation of " +
               in_sd(100.0 * found.value) + " % of the standard deviation of all samples";
      case offset:
        return "has a DC offset of " + in_sd(found.value) + " standard deviations";
      case coarse:
        return "is coarse: the quantisation step is " + in_sd(100.0 * found.value) +
               " % of the standard deviation";
    }
    return {};
  };
  std::vector<std::string> out;
  for (const signals::FoundFault& found : signals::channel_faults(q, table.is_record(channel)))
    out.push_back(text_of(found));
  return out;
}

}  // namespace wheeltap::apps
