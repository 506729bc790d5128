#include "identification/sid/sid_simulation.hpp"

#include <algorithm>
#include <utility>

#include "dynamics/step_check.hpp"
#include "identification/invalid_input.hpp"
#include "signals/excitation.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::identification {
namespace {

using Role = SidChannel::Role;

/// Step limit with an integration error far below any noise.
constexpr double kTruthStepLimit = 0.05;

/// An excitation of one mass or of the base [SI].
struct Acting {
  Role role;
  int mass;
  std::vector<double> samples;
};

std::vector<double> samples_of(const TrueExcitation& excitation, const SidTruth& truth,
                               signals::Noise& noise) {
  struct Maker {
    const SidTruth& truth;
    signals::Noise& noise;

    std::vector<double> operator()(const TrueExcitation::White& e) const {
      return signals::white_noise(truth.samples, e.variance, noise);
    }
    std::vector<double> operator()(const TrueExcitation::BandLimited& e) const {
      return signals::band_limited_noise(truth.samples, truth.sample_rate_hz, e.low_hz, e.high_hz,
                                         e.variance, noise);
    }
    std::vector<double> operator()(const TrueExcitation::Sine& e) const {
      return signals::sine(truth.samples, truth.sample_rate_hz, e.amplitude, e.frequency_hz,
                           e.phase);
    }
    std::vector<double> operator()(const signals::Multisine& e) const {
      return signals::multisine(truth.samples, truth.sample_rate_hz, e, noise);
    }
    std::vector<double> operator()(const TrueExcitation::Sampled& e) const { return e.samples; }
  };
  return std::visit(Maker{truth, noise}, excitation.signal);
}

/// Separate random streams, so that a further channel or excitation does not change the others.
signals::Noise stream(std::uint64_t seed, std::uint64_t i) {
  return signals::Noise(seed * 4096 + i);
}

std::vector<Acting> make_excitations(const SidTruth& truth, std::uint64_t seed) {
  std::vector<Acting> acting;
  for (std::size_t i = 0; i < truth.excitations.size(); ++i) {
    const TrueExcitation& e = truth.excitations[i];
    signals::Noise noise = stream(seed, i);
    std::vector<double> x;
    try {
      x = samples_of(e, truth, noise);
    } catch (const std::invalid_argument& error) {
      throw InvalidInput(InvalidInput::Part::excitation, error.what(), static_cast<int>(i));
    }
    const auto same = std::ranges::find_if(
        acting, [&](const Acting& a) { return a.role == e.role && a.mass == e.mass; });
    if (same == acting.end()) {
      acting.push_back({e.role, e.mass, std::move(x)});
    } else {
      for (std::size_t n = 0; n < x.size(); ++n) same->samples[n] += x[n];
    }
  }
  return acting;
}

dynamics::Excitation excitation_of(const std::vector<Acting>& acting, const SidTruth& truth) {
  const int points = truth.points_a_sample;
  dynamics::Excitation out{.sample_rate_hz = truth.sample_rate_hz * points};
  for (const Acting& a : acting) {
    std::vector<double> samples =
        points > 1 ? signals::upsample(a.samples, 0, truth.samples, points) : a.samples;
    if (a.role == Role::force) {
      out.forces.push_back({a.mass, {.samples = std::move(samples)}});
      continue;
    }
    if (!out.base) out.base.emplace();
    (a.role == Role::base_acceleration ? out.base->acceleration : out.base->displacement).samples =
        std::move(samples);
  }
  if (out.forces.empty() && !out.base) {
    const auto samples = static_cast<std::size_t>((truth.samples - 1) * points + 1);
    out.forces.push_back({1, {.samples = std::vector<double>(samples)}});
  }
  return out;
}

/// The true model's noiseless response. Throws InvalidInput if the simulation fails.
dynamics::Response true_response(const SidCase& sid_case, const dynamics::Excitation& excitation) {
  const SidTruth& truth = *sid_case.truth;
  const SidModel& model = sid_case.models[static_cast<std::size_t>(truth.model)];
  dynamics::SimulatorOptions options = sid_case.integration;
  options.stride = truth.points_a_sample;
  options.step_limit = std::min(options.step_limit, kTruthStepLimit);
  const auto refuse = [](const std::string& message) {
    throw InvalidInput(InvalidInput::Part::truth, message);
  };
  dynamics::Response response;
  try {
    const dynamics::Simulator simulator(model.chain, excitation, sid_case.sensors(), model.initial,
                                        options);
    response = dynamics::checked_response(simulator, truth.theta).response;
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
  switch (response.outcome) {
    case dynamics::Outcome::complete:
      break;
    case dynamics::Outcome::impossible:
      if (const std::string why = dynamics::impossibility(model.chain, truth.theta); !why.empty())
        refuse("the true model's parameters are impossible: " + why);
      refuse("the true model's parameters are impossible: its natural frequencies overflow");
      break;
    case dynamics::Outcome::diverged:
      refuse("the true model's response grows without bound, even with a quarter of the time step");
      break;
    case dynamics::Outcome::steps_too_long:
      refuse(
          "the true model's response cannot be integrated to 0.1 %: the shortest permitted time "
          "steps are too long (a force law is too stiff or the motion too fast for the sample "
          "rate, or the motion is chaotic). Raise \"sample_rate\", shorten the record, or fix the "
          "steps yourself by \"integration\": {\"substeps\": …}");
      break;
  }
  return response;
}

io::Column column(const std::string& header, std::vector<double> values) {
  io::Column out = io::column_of_header(header);
  out.values = std::move(values);
  return out;
}

}  // namespace

signals::Record simulate_record(const SidCase& sid_case, std::uint64_t seed) {
  if (!sid_case.truth) {
    throw InvalidInput(InvalidInput::Part::truth, "is missing: there is nothing to simulate");
  }
  const SidTruth& truth = *sid_case.truth;
  const auto samples = static_cast<std::size_t>(truth.samples);
  const std::vector<Acting> acting = make_excitations(truth, seed);
  const dynamics::Response response = true_response(sid_case, excitation_of(acting, truth));

  signals::Record record;
  record.file = "truth";
  std::vector<double> time(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    time[n] = static_cast<double>(n) / truth.sample_rate_hz;
  }
  const SidChannel* clock = sid_case.find(Role::time);
  if (clock != nullptr) {
    for (double& t : time) t /= clock->signal.scale.value;
  }
  record.columns.push_back(
      column(clock != nullptr && !clock->is_numbered() ? clock->column : "time [s]", time));
  std::uint64_t responses = 0;
  for (const SidChannel& channel : sid_case.channels) {
    if (channel.role == Role::time) continue;
    std::vector<double> values(samples, 0.0);
    if (channel.is_excitation()) {
      for (const Acting& a : acting) {
        if (a.role == channel.role && a.mass == channel.mass) values = a.samples;
      }
    } else if (channel.role == Role::response) {
      signals::Noise noise = stream(seed, 2048 + responses);
      const double sd = truth.noise[responses];
      for (std::size_t n = 0; n < samples; ++n) {
        values[n] =
            response.values(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(responses)) +
            sd * noise.normal();
      }
      ++responses;
    }
    const double scale = channel.signal.scale.at(truth.theta);
    const double offset = channel.signal.offset.at(truth.theta);
    for (double& x : values) x = (x - offset) / scale;
    record.columns.push_back(column(channel.header(), std::move(values)));
  }
  return record;
}

}  // namespace wheeltap::identification
