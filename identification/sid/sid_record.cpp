#include "identification/sid/sid_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "identification/invalid_input.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::identification {
namespace {

using Part = InvalidInput::Part;
using Role = SidChannel::Role;

constexpr int kComparable = 128;        // fewest samples for a comparison of spectra
constexpr double kPeculiar = 3.0;       // differences of spectra, relative to their scatter
constexpr double kWorthWarning = 0.05;  // loss of an excitation's amplitude
constexpr int kFewestBeyond = 64;       // fewest samples after a window for predictions
/// Acceptable loss of an excitation's amplitude by linear interpolation.
constexpr double kUpsampledLoss = 3e-3;
constexpr int kMostUpsampling = 16;

/// True if one signal is the other times a factor plus an offset, within rounding errors.
bool are_proportional(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kAlikeSquared = 1.0 - 2e-9;
  const auto n = static_cast<double>(a.size());
  double mean_a = 0.0, mean_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return ab * ab > kAlikeSquared * aa * bb;
}

class RecordTaker {
 public:
  RecordTaker(SidCase& out, const signals::Record& record, const RecordUse& use)
      : out_(out), record_(record), use_(use) {}

  void take() {
    for (std::size_t i = 0; i < out_.channels.size(); ++i) columns_.push_back(find_column(i));
    refuse_repeated_columns();
    read_rate();
    read_window();
    if (use_.band_limited) out_.stride = choose_stride();
    out_.beyond = samples_beyond();
    for (std::size_t i = 0; i < out_.channels.size(); ++i) load_channel(i);
    if (!out_.simulated) refuse_copies();
    out_.integration.stride = out_.stride;
  }

 private:
  [[nodiscard]] int find_column(std::size_t channel) const {
    try {
      return record_.find(out_.channels[channel].column);
    } catch (const io::FileError& error) {
      throw InvalidInput(Part::channel, error.what(), static_cast<int>(channel));
    }
  }

  void read_rate() {
    const SidChannel* time = out_.find(Role::time);
    int column = time != nullptr ? columns_[static_cast<std::size_t>(time - out_.channels.data())]
                                 : record_.find_time();
    // A column with the name of a time column is not time if the case uses it as another channel.
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (out_.channels[i].role != Role::time && column == columns_[i]) column = -1;
    }
    std::optional<signals::Sampling> said;
    if (column < 0 && !use_.sample_rate_hz) said = signals::sampling_from_header(record_);
    if (column < 0 && !use_.sample_rate_hz && !said) {
      throw InvalidInput(
          Part::sample_rate,
          "is missing: no channel is \"time\", so the sampling rate in Hz must be given");
    }
    // Scale of the time column, if the case gives a scale; a resampled record is in seconds.
    std::optional<double> seconds;
    if (time != nullptr && time->scale_given && !use_.resample) seconds = time->signal.scale.value;
    out_.sampling = {.rate_hz = use_.sample_rate_hz.value_or(0.0)};
    if (column >= 0)
      out_.sampling = signals::sampling_of(record_, column, use_.sample_rate_hz, seconds);
    if (said) out_.sampling = *said;
    out_.sample_rate_hz = out_.sampling.rate_hz;
    out_.layout = record_.layout;
  }

  void read_window() {
    const std::string there =
        record_.file + " has " + std::to_string(record_.samples()) + " samples";
    out_.end = record_.samples();
    if (use_.samples) {
      std::tie(out_.begin, out_.end) = *use_.samples;
      if (out_.begin >= out_.end) {
        throw InvalidInput(Part::samples,
                           "must be [first, one past the last], at least one sample");
      }
      if (out_.end > record_.samples()) {
        throw InvalidInput(Part::samples, "reaches beyond the record; " + there);
      }
    }
    if (out_.end - out_.begin < 4) {
      throw InvalidInput(Part::samples, "must be a window of at least 4 samples; " + there);
    }
    out_.lead_in = use_.lead_in;
    if (out_.lead_in > out_.begin) {
      throw InvalidInput(Part::lead_in, "must be at most " + std::to_string(out_.begin) +
                                            " samples, the part of the record before the window");
    }
  }

  /// Number of finite samples after the window, at most the length of the window; 0 if too few.
  [[nodiscard]] int samples_beyond() const {
    if (out_.simulated) return 0;
    int most = std::min(out_.end - out_.begin, record_.samples() - out_.end);
    for (std::size_t i = 0; i < out_.channels.size(); ++i) {
      const Role role = out_.channels[i].role;
      if (role == Role::ignore || role == Role::time) continue;
      const auto& values = record_.columns[static_cast<std::size_t>(columns_[i])].values;
      const auto after = values.begin() + out_.end;
      most = static_cast<int>(
          std::find_if_not(after, after + most, [](double x) { return std::isfinite(x); }) - after);
    }
    return most < kFewestBeyond ? 0 : most;
  }

  [[nodiscard]] std::vector<double> window(std::size_t channel) const {
    return signals::window(record_, columns_[channel], out_.begin - out_.lead_in, out_.end);
  }

  /// Largest loss of an excitation's amplitude by linear interpolation between samples at `factor`
  /// times the rate.
  [[nodiscard]] double loss(int factor) const {
    double most = 0.0;
    for (std::size_t i = 0; i < out_.channels.size(); ++i) {
      if (!out_.channels[i].is_excitation()) continue;
      std::vector<double> samples = window(i);
      signals::detrend(samples, 0);
      const auto spectrum = signals::welch(samples, out_.sample_rate_hz);
      most = std::max(most,
                      signals::linear_interpolation_loss(spectrum, out_.sample_rate_hz * factor));
    }
    return most;
  }

  [[nodiscard]] int choose_stride() const {
    if (use_.upsample) return *use_.upsample;
    int factor = 1;
    while (factor < kMostUpsampling && loss(factor) > kUpsampledLoss) factor *= 2;
    return factor;
  }

  /// Rejects a constant response, because any model with little motion would explain it.
  void refuse_constant(std::size_t i) const {
    const SidChannel& channel = out_.channels[i];
    const std::vector<double>& x = channel.signal.samples;
    if (channel.role != Role::response || out_.simulated ||
        !std::ranges::all_of(x, [&](double value) { return value == x.front(); }))
      return;
    throw InvalidInput(Part::channel,
                       "the response is " + base::number(x.front()) + " in every sample from " +
                           std::to_string(out_.begin - out_.lead_in) + " to " +
                           std::to_string(out_.end) +
                           ": it has no information. Choose other samples, give the "
                           "channel the role \"ignore\", or repair its sensor",
                       static_cast<int>(i));
  }

  /// Rejects a column that is the response, or the force on one mass, in two channels: its data
  /// would count twice.
  void refuse_repeated_columns() const {
    for (std::size_t i = 0; i < columns_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const SidChannel &channel = out_.channels[i], &before = out_.channels[j];
        if (columns_[i] != columns_[j] || channel.role != before.role) continue;
        const std::string mass = "mass " + std::to_string(before.mass);
        if (channel.role == Role::response)
          throw InvalidInput(Part::channel,
                             "the same column is the response of " + mass + " in channel " +
                                 std::to_string(j) +
                                 ", and its data would count twice: leave one "
                                 "channel out",
                             static_cast<int>(i));
        if (channel.role == Role::force && channel.mass == before.mass)
          throw InvalidInput(Part::channel,
                             "the same column is the force on " + mass + " in channel " +
                                 std::to_string(j) +
                                 ", and the force would count twice: leave one "
                                 "channel out, or state a factor as \"scale\"",
                             static_cast<int>(i));
      }
  }

  /// Rejects a copy of a response of the same quantity and mass, with any scale and offset, and a
  /// copy of a force on the same mass.
  void refuse_copies() const {
    for (std::size_t i = 0; i < columns_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const SidChannel &channel = out_.channels[i], &before = out_.channels[j];
        if (channel.role != before.role || channel.mass != before.mass) continue;
        const bool is_copy =
            channel.role == Role::response
                ? channel.quantity == before.quantity && channel.frame == before.frame &&
                      are_proportional(channel.signal.samples, before.signal.samples)
                : channel.role == Role::force && channel.signal.samples == before.signal.samples;
        if (is_copy)
          throw InvalidInput(
              Part::channel,
              "equals channel " + std::to_string(j) +
                  (channel.role == Role::response ? " except for its scale and offset" : "") +
                  ", and its data would count twice: leave one channel out",
              static_cast<int>(i));
      }
  }

  void load_channel(std::size_t i) {
    SidChannel& channel = out_.channels[i];
    if (channel.role == Role::ignore || channel.role == Role::time) return;
    const auto& source = record_.columns[static_cast<std::size_t>(columns_[i])];
    channel.take_unit(signals::unit_of(source));
    const int begin = out_.begin - out_.lead_in;
    channel.signal.samples = window(i);
    refuse_constant(i);
    const bool whole =
        std::ranges::all_of(source.values, [](double x) { return std::isfinite(x); });
    const bool part = out_.begin > 0 || out_.end < record_.samples();
    if (whole && part && !out_.simulated && out_.end - out_.begin >= kComparable) {
      channel.window = signals::compare_window(source.values, out_.begin, out_.end,
                                               out_.sample_rate_hz, {.segment = kComparable / 2});
    }
    if (channel.is_excitation() && use_.band_limited) {
      channel.signal.samples =
          whole ? signals::upsample(source.values, begin, out_.end, out_.stride)
                : signals::upsample(channel.signal.samples, 0, out_.end - begin, out_.stride);
    }
    if (out_.beyond == 0) return;
    // Begins with the window's last sample, from which an upsampled excitation continues.
    channel.beyond = signals::window(record_, columns_[i], out_.end - 1, out_.end + out_.beyond);
    if (channel.is_excitation() && use_.band_limited) {
      channel.beyond = whole ? signals::upsample(source.values, out_.end - 1,
                                                 out_.end + out_.beyond, out_.stride)
                             : signals::upsample(channel.beyond, 0, out_.beyond + 1, out_.stride);
    }
    channel.beyond.erase(channel.beyond.begin());
  }

  SidCase& out_;
  const signals::Record& record_;
  const RecordUse& use_;
  std::vector<int> columns_;  ///< column index in the record, one per channel
};

/// RMS of a signal, and RMS frequency [rad/s] of its spectrum.
struct RecordedMotion {
  double rms = 0.0, omega = 1.0;
};
RecordedMotion motion_of(std::span<const double> centred, double sample_rate_hz) {
  const auto spectrum = signals::welch(centred, sample_rate_hz);
  double power = 0.0, moment = 0.0, squares = 0.0;
  for (std::size_t i = 1; i < spectrum.density.size(); ++i) {
    const double w = 2.0 * M_PI * spectrum.frequencies_hz[i];
    power += spectrum.density[i];
    moment += w * w * spectrum.density[i];
  }
  for (const double x : centred) squares += x * x;
  return {.rms = std::sqrt(squares / static_cast<double>(centred.size())),
          .omega = power > 0.0 ? std::sqrt(moment / power) : 1.0};
}

/// Value of a least-squares line at the first sample, and the standard error of this value.
std::pair<double, double> intercept(std::span<const double> y) {
  const auto n = static_cast<double>(y.size());
  const double middle = 0.5 * (n - 1.0);
  double mean = 0.0, slope = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    mean += y[i] / n;
    slope += x * y[i];
    spread += x * x;
  }
  slope /= spread;
  double squares = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double r = y[i] - mean - slope * (static_cast<double>(i) - middle);
    squares += r * r;
  }
  const double variance = squares / (n - 2.0);
  return {mean - slope * middle, std::sqrt(variance * (1.0 / n + middle * middle / spread))};
}

/// Adds remarks on implausible data of one channel.
void check_channel(const SidCase& record, const SidChannel& channel,
                   remark::PeculiarWindow& peculiar, remark::UnknownUnits& unknown,
                   remark::LinearExcitation& linear) {
  if (channel.window && channel.window->difference_db >= kPeculiar * channel.window->expected_db) {
    peculiar.channels.push_back(
        {channel.name(), channel.window->difference_db, channel.window->expected_db});
  }
  if (!channel.is_excitation() && channel.role != Role::response) return;
  if (!channel.foreign_unit().empty()) {
    unknown.channels.push_back({channel.name(), channel.unit,
                                std::string(name(channel.dimension())),
                                known_units(channel.dimension())});
  }
  if (!channel.is_excitation() || record.simulated || record.stride > 1) return;
  std::vector<double> samples = channel.signal.samples;
  signals::detrend(samples, 0);
  const double lost = signals::linear_interpolation_loss(
      signals::welch(samples, record.sample_rate_hz), record.sample_rate_hz);
  if (lost > linear.loss) linear = {channel.name(), lost};
}

}  // namespace

void take_record(SidCase& sid_case, const signals::Record& record, const RecordUse& use) {
  if (!use.resample) {
    RecordTaker(sid_case, record, use).take();
    return;
  }
  const SidChannel* time = sid_case.find(Role::time);
  const int column = time != nullptr ? record.find(time->column) : record.find_time();
  if (column < 0) throw InvalidInput(Part::sample_rate, "\"resample\" needs a time column");
  std::optional<double> seconds;
  if (time != nullptr && time->scale_given) seconds = time->signal.scale.value;
  RecordTaker(sid_case, signals::resampled(record, column, use.sample_rate_hz, seconds), use)
      .take();
}

std::vector<Remark> record_remarks(const SidCase& sid_case) {
  std::vector<Remark> out;
  remark::PeculiarWindow peculiar;
  remark::UnknownUnits unknown;
  remark::LinearExcitation linear{.channel = {}, .loss = 0.0};
  bool base_integrated = false;
  std::optional<double> moving;
  for (const SidCase* record : sid_case.records()) {
    for (const SidChannel& channel : record->channels) {
      check_channel(*record, channel, peculiar, unknown, linear);
    }
    base_integrated = base_integrated || record->base_integrated;
    if (record->sampling.jitter > 0.0) out.emplace_back(remark::UnevenTime{record->sampling});
    if (record->starts_moving) moving = std::max(moving.value_or(0.0), *record->starts_moving);
  }
  if (base_integrated) out.emplace_back(remark::BaseIntegrated{});
  if (moving) out.emplace_back(remark::InitialStateInferred{*moving});
  if (!peculiar.channels.empty()) out.emplace_back(std::move(peculiar));
  if (linear.loss >= kWorthWarning) out.emplace_back(std::move(linear));
  if (!unknown.channels.empty()) out.emplace_back(std::move(unknown));
  return out;
}

std::optional<double> moves_at_start(const SidCase& sid_case) {
  constexpr double kStill = 0.1;  // relative to the RMS
  std::optional<double> out;
  for (const SidChannel* channel : sid_case.responses()) {
    const std::vector<double>& y = channel->signal.samples;
    // Remove offsets that the case states.
    const double scale = channel->signal.scale.is_constant() ? channel->signal.scale.value : 1.0;
    const bool offset_known = channel->signal.offset.is_constant();
    const double rest = offset_known ? -channel->signal.offset.value / scale : 0.0;
    std::vector<double> centred = y;
    signals::detrend(centred, 0);
    const RecordedMotion motion = motion_of(centred, sid_case.sample_rate_hz);
    if (!(motion.rms > 0.0)) continue;
    const double quarter = 0.5 * M_PI / motion.omega * sid_case.sample_rate_hz;
    const auto first = std::clamp<std::size_t>(static_cast<std::size_t>(quarter), 4, y.size());
    if (channel->quantity == dynamics::Quantity::acceleration) {
      if (sid_case.begin == 0 || sid_case.lead_in > 0) continue;
      double squares = 0.0;
      for (std::size_t n = 0; n < first; ++n) squares += centred[n] * centred[n];
      const double share = std::sqrt(squares / static_cast<double>(first)) / motion.rms;
      if (share > kStill) out = std::max(out.value_or(0.0), share);
      continue;
    }
    if (!offset_known) continue;
    const auto [value, error] =
        intercept({y.data(), std::max<std::size_t>(4, std::min(y.size(), first / 2))});
    const double share = std::abs(value - rest) / motion.rms;
    if (share > kStill && std::abs(value - rest) > 3.0 * error) {
      out = std::max(out.value_or(0.0), share);
    }
  }
  return out;
}

void infer_initial(SidCase& sid_case, SidModel& model) {
  const int masses = model.chain.size();
  std::vector<double> y(static_cast<std::size_t>(masses)), v(y.size());
  double top_y = 0.0, top_v = 0.0;
  for (const SidChannel* channel : sid_case.responses()) {
    std::vector<double> samples = channel->signal.samples;
    const double scale =
        channel->signal.scale.is_constant() ? std::abs(channel->signal.scale.value) : 1.0;
    signals::detrend(samples, 0);
    const RecordedMotion motion = motion_of(samples, sid_case.sample_rate_hz);
    const double omega = motion.omega;
    // A free decay starts with more than its RMS.
    constexpr double kPeriods = 3.0;
    const double of_start = kPeriods * kTwoPi / omega * sid_case.sample_rate_hz;
    const double length = std::min(of_start, static_cast<double>(samples.size()));
    const std::span start(samples.data(),
                          std::max<std::size_t>(1, static_cast<std::size_t>(length)));
    const double squares = std::inner_product(start.begin(), start.end(), start.begin(), 0.0);
    const double sd =
        scale * std::max(motion.rms, std::sqrt(squares / static_cast<double>(start.size())));
    const int order = static_cast<int>(channel->quantity);
    const auto at = static_cast<std::size_t>(channel->mass - 1);
    y[at] = std::max(y[at], sd / std::pow(omega, order));
    v[at] = std::max(v[at], sd / std::pow(omega, order - 1));
    top_y = std::max(top_y, y[at]);
    top_v = std::max(top_v, v[at]);
  }
  if (!(top_y > 0.0)) {
    throw InvalidInput(Part::initial, "cannot be inferred: the responses are constant");
  }
  for (std::size_t i = 0; i < y.size(); ++i) {
    const std::string index =
        "[" + std::to_string(i + 1) + "]" +
        (sid_case.number > 1 ? "@" + std::to_string(sid_case.number) : std::string());
    model.initial.displacement.push_back(
        sid_case.parameter("y0" + index, inference::Normal{0.0, y[i] > 0.0 ? y[i] : top_y}));
    model.initial.velocity.push_back(
        sid_case.parameter("v0" + index, inference::Normal{0.0, v[i] > 0.0 ? v[i] : top_v}));
  }
}

}  // namespace wheeltap::identification
