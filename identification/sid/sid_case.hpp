// The case of a system identification: records of a chain of masses, and candidate equations of
// motion.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "dynamics/simulate.hpp"
#include "identification/sid/residuals/residual_model.hpp"
#include "inference/model/model_space.hpp"
#include "signals/excitation.hpp"
#include "signals/record.hpp"
#include "signals/spectra.hpp"
#include "signals/units.hpp"

namespace wheeltap::identification {

/// One column of the record and its use. The coefficients in this header are indices into
/// SidCase::parameters.
struct SidChannel {
  enum class Role { time, force, base_acceleration, base_displacement, response, ignore };

  std::string column;  ///< header text, or column number from 1
  int record = 1;      ///< number of the record with this channel
  Role role = Role::ignore;
  int mass = 0;
  dynamics::Quantity quantity = dynamics::Quantity::displacement;
  dynamics::Frame frame = dynamics::Frame::absolute;
  /// Raw samples, from the start of the lead-in before the window. Excitations are upsampled by the
  /// factor SidCase::stride.
  dynamics::Signal signal = {};
  /// Raw samples after the window, which do not enter the likelihood. SidCase::beyond gives the
  /// number of these samples. Excitations are upsampled as in the window.
  std::vector<double> beyond = {};
  std::string unit = {};     ///< unit from the case, otherwise from the header of the file
  bool unit_given = false;   ///< true if the case gives the unit
  bool scale_given = false;  ///< true if the case gives `signal.scale`, for any unit
  /// Comparison of the spectra of the window and of the record; empty if the window is the record.
  std::optional<signals::SpectrumComparison> window = {};

  [[nodiscard]] bool is_excitation() const {
    return role == Role::force || role == Role::base_acceleration ||
           role == Role::base_displacement;
  }
  /// Physical dimension of the samples; undefined for ignored channels.
  [[nodiscard]] signals::Dimension dimension() const;
  /// If the case gives no unit, sets the unit to that of the header. If the unit is known and the
  /// case gives no scale, sets the scale to the factor that converts this unit to SI units.
  void take_unit(const std::string& header_unit);
  /// The unit of samples that are not converted to SI units, because the unit is unknown or has
  /// another dimension. The result is empty if the samples are in SI units.
  [[nodiscard]] std::string foreign_unit() const;
  /// Unit of the scaled values: "m", or a unit that is not converted to SI units.
  [[nodiscard]] std::string used_unit() const;
  /// Unit of the raw samples, and its conversion to SI units. The conversion factor is 1 if the
  /// scale is a parameter.
  [[nodiscard]] signals::Conversion conversion() const;
  /// True if the column is identified by its number.
  [[nodiscard]] bool is_numbered() const {
    return column.find_first_not_of("0123456789") == std::string::npos;
  }
  /// Header of the column, or "column 3" for a column that is identified by its number.
  [[nodiscard]] std::string header() const { return is_numbered() ? "column " + column : column; }
  /// Header of the column; for the second and further records, followed by the number of the
  /// record.
  [[nodiscard]] std::string name() const {
    return header() + (record > 1 ? " (record " + std::to_string(record) + ")" : std::string());
  }
};

/// An optional force law of a link (sid_discovery.hpp).
struct SidTerm {
  std::string name = {};  ///< "cubic", "contact closing"; "cubic 0-1" if terms are on several links
  int link = 0;           ///< index among the links of the base model
  dynamics::Law law = {};
  /// Indices of the coefficients whose priors are the default priors, computed from the record.
  std::vector<std::size_t> by_default = {};
};

/// RMS values and extremes of a link's motion and tension, estimated from the record.
struct LinkMotion {
  double extension = 0.0;               ///< RMS extension [m]
  double rate = 0.0;                    ///< RMS rate [m/s]
  double tension = 0.0;                 ///< RMS tension [N]
  double opening = 0.0, closing = 0.0;  ///< largest extension and compression, both > 0 [m]
};

/// Optional terms of a chain of masses. Every subset of the terms is a model.
struct SidDiscovery {
  std::vector<SidTerm> terms = {};
  double inclusion = 0.5;  ///< prior probability of each term; terms are independent a priori
  /// One entry per link of the base model; empty before a record is loaded.
  std::vector<LinkMotion> motions = {};
};

/// The residual model of a SidModel and the case parameters that it uses.
struct SidResiduals {
  std::shared_ptr<const ResidualModel> model = white_residuals();
  /// Coefficients per response channel, in the order of ResidualModel::parameters; empty if the
  /// residual model has no parameters.
  std::vector<std::vector<dynamics::Coefficient>> coefficients = {};
  /// The kind of residual model whose value (order) choose_residuals determines; null if the case
  /// gives `model`.
  const ResidualKind* chosen_kind = nullptr;

  /// Values of the residual model's parameters for response channel c.
  [[nodiscard]] std::vector<double> at(std::size_t c, std::span<const double> theta) const;
};

struct SidModel {
  std::string name;
  double weight = 1.0;
  dynamics::Chain chain = {};
  dynamics::InitialState initial = {};
  /// Standard deviation of the noise of each response channel
  std::vector<dynamics::Coefficient> noise = {};
  SidResiduals residuals = {};
  std::vector<int> parameters = {};  ///< indices of the model's parameters, ascending
  /// Indices of the model's terms in SidCase::discovery, ascending
  std::vector<int> terms = {};

  /// Evaluate ResidualModel::log_density and innovations for response channel c.
  [[nodiscard]] double log_density(std::size_t c, std::span<const double> r,
                                   std::span<const double> theta) const {
    return residuals.model->log_density(r, noise[c].at(theta), residuals.at(c, theta));
  }
  [[nodiscard]] Innovations innovations(std::size_t c, std::span<const double> r,
                                        std::span<const double> theta) const {
    return residuals.model->innovations(r, noise[c].at(theta), residuals.at(c, theta));
  }
};

/// An excitation of a simulated chain of masses. All excitations of the same mass (or of the base)
/// are added.
struct TrueExcitation {
  struct White {
    double variance;
  };
  struct BandLimited {
    double low_hz, high_hz, variance;
  };
  struct Sine {
    double amplitude, frequency_hz, phase;
  };
  /// An excitation given sample by sample [SI].
  struct Sampled {
    std::vector<double> samples;
  };
  SidChannel::Role role = SidChannel::Role::force;
  int mass = 0;  ///< number of the mass; 0: the base
  std::variant<White, BandLimited, Sine, signals::Multisine, Sampled> signal;
};

/// The true values with which a case simulates its record.
struct SidTruth {
  int model = 0;
  std::vector<double> theta = {};  ///< one value per parameter of the case; NaN if not given
  std::vector<double> noise = {};  ///< standard deviation of the noise of each response channel
  int samples = 0;
  double sample_rate_hz = 0.0;
  std::uint64_t seed = 1;
  std::vector<TrueExcitation> excitations = {};
  /// Number of excitation values per sample, as the case declares for the record: 1 for linear
  /// interpolation, more for a band-limited excitation (signals::upsample).
  int points_a_sample = 1;
};

struct SidCase {
  std::string title = {};
  std::vector<inference::Parameter> parameters = {};
  std::vector<SidChannel> channels = {};
  std::vector<SidModel> models = {};
  std::optional<SidDiscovery> discovery = {};
  std::optional<SidTruth> truth = {};

  /// Further records of the same structure: cases with the same models and parameter table, but
  /// with separate channels, windows, initial states and integration settings.
  std::vector<SidCase> further = {};
  int number = 1;  ///< number of this record, from 1

  double sample_rate_hz = 0.0;
  signals::Sampling sampling = {};             ///< sampling rate and its source
  std::optional<io::FoundLayout> layout = {};  ///< layout of a record in delimited text
  /// Indices in the record: first sample of the window, and one past its last sample. Only samples
  /// of the window enter the likelihood.
  int begin = 0, end = 0;
  /// Number of samples before the window over which the motion is integrated
  int lead_in = 0;
  int stride = 1;  ///< number of excitation samples per response sample
  /// Number of samples after the window that are predicted
  int beyond = 0;
  int windows = 0;  ///< number of windows to fit separately; 0: none
  bool simulated = false;
  /// Response at the start of the window, divided by its RMS (moves_at_start). Set only if the
  /// initial state is inferred because of motion at the start, and not by request of the case.
  std::optional<double> starts_moving = {};
  /// True if the base displacement was integrated (base_integration.hpp)
  bool base_integrated = false;
  std::string origin = {};  ///< origin of the record, in words
  double band = 0.97;
  bool balance = false;  ///< true: sample all models about equally often, reweight the draws
  dynamics::SimulatorOptions integration = {};
  /// True if the case fixes the time steps. If the steps are too long, the run reports the
  /// integration error, but is not repeated with shorter steps.
  bool fixed_integration = false;

  [[nodiscard]] std::vector<const SidChannel*> responses() const;
  /// The first channel with this role; null if there is no such channel.
  [[nodiscard]] const SidChannel* find(SidChannel::Role role) const;
  /// The signals of the excitation channels, as loaded.
  [[nodiscard]] dynamics::Excitation excitation() const;
  [[nodiscard]] std::vector<dynamics::Sensor> sensors() const;
  /// Indices of the parameters that the model and the channels use, ascending.
  [[nodiscard]] std::vector<int> parameters_of(const SidModel& model) const;
  /// Makes all records consistent: copies the parameter table to all records, and adds to each
  /// model's list the parameters that it uses in any record. Call this function after all
  /// coefficients are defined.
  void unite();
  /// Returns all records: the record of this object and those in `further`.
  [[nodiscard]] std::vector<const SidCase*> records() const;
  /// Returns the parameter with this name; adds it with this prior if it does not exist.
  dynamics::Coefficient parameter(const std::string& name, inference::Prior prior);
};

}  // namespace wheeltap::identification
