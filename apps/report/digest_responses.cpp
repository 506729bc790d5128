#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/report/digest_draws.hpp"
#include "signals/residuals.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::apps {

using identification::quantile;

namespace {

constexpr std::size_t kTimePoints = 8000;  // all channels together
constexpr std::size_t kMostDrivers = 2;    // excitations with frequency response functions
constexpr double kExcited = 1e-4;          // spectrum / peak; smaller values count as zero

// An excitation of the chain of masses, as stored by the run.
struct Driver {
  std::string name, role, unit;
  std::vector<double> values;
};

std::vector<Driver> drivers(const io::NetcdfReader& file, std::size_t samples) {
  std::vector<Driver> out;
  const auto group = file.group("constant_data");
  if (!group) return out;
  for (const std::string& name : file.variables(*group)) {
    if (name == "sample") continue;
    Driver one{name, file.text(*group, name, "role"), file.text(*group, name, "units"),
               file.read(*group, name).values};
    const auto [low, high] = std::ranges::minmax(one.values);
    if (one.values.size() == samples && high > low) out.push_back(std::move(one));
  }
  // Omit a base displacement if the base acceleration exists: both describe the same motion.
  if (std::ranges::any_of(out, [](const Driver& d) { return d.role == "base acceleration"; })) {
    std::erase_if(out, [](const Driver& d) { return d.role == "base displacement"; });
  }
  return out;
}

// Predictions of a response at each sample: replicates (with noise), and predictions without noise.
// Older runs stored only replicates; their median replaces the missing prediction.
struct Predicted {
  std::vector<double> low, high;            // 95 % band of replicates
  std::vector<double> median, q2_5, q97_5;  // without noise; the quantiles may be empty
};

std::optional<Predicted> predicted(const io::NetcdfReader& file, int replicates,
                                   const std::string& name, std::size_t samples) {
  const io::NetcdfArray replicated = file.read(replicates, name);
  if (replicated.shape.size() != 3 || replicated.inner() != samples) return {};
  Predicted out{std::vector<double>(samples), std::vector<double>(samples), {}, {}, {}};
  std::vector<double> medians(samples), column(replicated.shape[0] * replicated.shape[1]);
  for (std::size_t n = 0; n < samples; ++n) {
    for (std::size_t d = 0; d < column.size(); ++d) {
      column[d] = replicated.values[d * samples + n];
    }
    std::ranges::sort(column);
    out.low[n] = quantile(column, 0.025);
    medians[n] = quantile(column, 0.5);
    out.high[n] = quantile(column, 0.975);
  }
  const auto group = file.group("noise_free");
  if (group && file.has(*group, name)) {
    const io::NetcdfArray kept = file.read(*group, name);
    if (kept.values.size() == 3 * samples) {
      const auto row = [&](long q) {
        const auto from = kept.values.begin() + q * static_cast<long>(samples);
        return std::vector<double>(from, from + static_cast<long>(samples));
      };
      out.q2_5 = row(0), out.median = row(1), out.q97_5 = row(2);
      return out;
    }
  }
  out.median = std::move(medians);
  return out;
}

// Over time: [t, measured, replicates 2.5 %, without noise 2.5 %, 50 %, 97.5 %, replicates 97.5 %,
// residual]. Long records are divided into buckets that keep the extremes.
Report history(const std::vector<double>& time, const std::vector<double>& y, const Predicted& p,
               const std::vector<double>& residual, std::size_t points) {
  const std::size_t samples = time.size();
  const auto extreme = [](const std::vector<double>& x, std::size_t from, std::size_t to,
                          bool high) -> Report {
    if (x.empty()) return {};
    const auto begin = x.begin() + static_cast<long>(from), end = x.begin() + static_cast<long>(to);
    return compact(high ? *std::max_element(begin, end) : *std::min_element(begin, end));
  };
  Report rows = Report::array();
  for (std::size_t b = 0; b < points; ++b) {
    const std::size_t from = b * samples / points, to = (b + 1) * samples / points;
    // Minimum, then maximum of the bucket: a line through both points covers its range.
    for (const bool high : {false, true}) {
      const double t = high ? 0.5 * (time[to - 1] + time[from]) : time[from];
      rows.push_back({t, extreme(y, from, to, high), extreme(p.low, from, to, false),
                      extreme(p.q2_5, from, to, false), extreme(p.median, from, to, high),
                      extreme(p.q97_5, from, to, true), extreme(p.high, from, to, true),
                      extreme(residual, from, to, high)});
      if (to - from == 1) break;
    }
  }
  return rows;
}

// Frequency responses H1 of the data and of the predicted median to one excitation, estimated with
// the same windows. Rows: frequency, |H1| and phase of both, coherence of the data. Frequencies
// that the excitation does not contain are omitted.
Report transfer(const Driver& driver, const std::vector<double>& y,
                const std::vector<double>& median, double rate, const std::string& unit) {
  // Use at least fifteen half-overlapping segments; with few segments, any coherence is near 1.
  const int segment = static_cast<int>(std::clamp<std::size_t>(y.size() / 8, 8, 1024));
  const auto data = signals::frequency_response(driver.values, y, rate, {.segment = segment});
  const auto model = signals::frequency_response(driver.values, median, rate, {.segment = segment});
  const auto excited = signals::welch(driver.values, rate, {.segment = segment});
  const double enough = kExcited * std::ranges::max(excited.density);
  Report rows = Report::array();
  for (std::size_t f = 1; f < data.frequencies_hz.size(); ++f) {
    if (excited.density[f] < enough) continue;
    rows.push_back({compact(data.frequencies_hz[f]), compact(std::abs(data.h1[f])),
                    compact(std::abs(model.h1[f])), compact(std::arg(data.h1[f])),
                    compact(std::arg(model.h1[f])), compact(data.coherence[f])});
  }
  return {{"name", driver.name},
          {"role", driver.role},
          {"unit", unit + " / " + driver.unit},
          {"segments", data.segments},
          {"rows", rows}};
}

}  // namespace

Report digest_responses(const io::NetcdfReader& file) {
  Report out = Report::array();
  const auto group = file.group("posterior_predictive");
  const auto data = file.group("observed_data");
  if (!group || !data) return out;
  const auto observed_names = file.variables(*data);
  if (std::ranges::find(observed_names, "time") == observed_names.end()) return out;
  const std::vector<double> time = file.read(*data, "time").values;
  std::vector<std::string> names;
  for (const std::string& name : file.variables(*group)) {
    if (name != "time" && name != "sample" &&
        std::ranges::find(observed_names, name) != observed_names.end()) {
      names.push_back(name);
    }
  }
  const std::size_t samples = time.size();
  if (names.empty() || samples < 4) return out;
  const std::size_t points = std::min(samples, kTimePoints / names.size());
  const std::vector<Driver> driven = drivers(file, samples);
  for (const std::string& name : names) {
    const std::vector<double> y = file.read(*data, name).values;
    Report json = {{"name", name}, {"unit", file.text(*group, name, "units")}};
    if (y.size() != samples) continue;
    const auto found = predicted(file, *group, name, samples);
    if (!found) continue;
    const std::vector<double>& median = found->median;
    std::vector<double> residual(samples);
    for (std::size_t n = 0; n < samples; ++n) residual[n] = y[n] - median[n];
    json["noise_free"] = !found->q2_5.empty();
    json["bucket"] = (samples + points - 1) / points;
    json["history"] = history(time, y, *found, residual, points);
    const double rate = static_cast<double>(samples - 1) / (time.back() - time.front());
    const int segment = static_cast<int>(std::clamp<std::size_t>(samples / 4, 4, 1024));
    const auto s_y = signals::welch(y, rate, {.segment = segment});
    const auto s_m = signals::welch(median, rate, {.segment = segment});
    const auto s_r = signals::welch(residual, rate, {.segment = segment});
    Report spectrum = Report::array();
    for (std::size_t f = 1; f < s_y.frequencies_hz.size(); ++f) {
      spectrum.push_back({compact(s_y.frequencies_hz[f]), compact(s_y.density[f]),
                          compact(s_m.density[f]), compact(s_r.density[f])});
    }
    json["spectrum"] = std::move(spectrum);
    json["transfer"] = Report::array();
    for (const Driver& driver : driven) {
      if (json["transfer"].size() == kMostDrivers) break;
      json["transfer"].push_back(
          transfer(driver, y, median, rate, json["unit"].get<std::string>()));
    }
    const int lags = static_cast<int>(std::min<std::size_t>(50, samples / 4));
    Report correlation = Report::array();
    for (const double rho : signals::autocorrelation(residual, lags)) {
      correlation.push_back(compact(rho));
    }
    json["autocorrelation"] = std::move(correlation);
    json["samples"] = samples;
    out.push_back(std::move(json));
  }
  return out;
}

}  // namespace wheeltap::apps
