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

/// One column of the record and its meaning. Coefficients here and below index SidCase::parameters.
struct SidChannel {
  enum class Role { time, force, base_acceleration, base_displacement, response, ignore };

  std::string column;  ///< header text or 1-based number
  int record = 1;      ///< number of the record that it belongs to
  Role role = Role::ignore;
  int mass = 0;
  dynamics::Quantity quantity = dynamics::Quantity::displacement;
  dynamics::Frame frame = dynamics::Frame::absolute;
  /// Raw samples from the start of the lead-in; excitations are upsampled by SidCase::stride.
  dynamics::Signal signal = {};
  /// SidCase::beyond unused raw samples after the window; excitations are upsampled as in the
  /// window.
  std::vector<double> beyond = {};
  std::string unit = {};     ///< from the case, else from the file's header
  bool unit_given = false;   ///< by the case
  bool scale_given = false;  ///< the case gives `signal.scale`, whatever the unit
  /// Comparison of the spectra of window and record, if the window is a part of the record.
  std::optional<signals::SpectrumComparison> window = {};

  [[nodiscard]] bool is_excitation() const {
    return role == Role::force || role == Role::base_acceleration ||
           role == Role::base_displacement;
  }
  /// Dimension of the samples; undefined for ignored channels.
  [[nodiscard]] signals::Dimension dimension() const;
  /// Uses the unit of the header if the case does not give a unit. If the unit is known and the
  /// case does not give a scale, sets the scale to the conversion factor of the unit.
  void take_unit(const std::string& header_unit);
  /// The unit of the samples if they are not converted to SI because the unit is unknown or has
  /// another dimension; empty if they are in SI units.
  [[nodiscard]] std::string foreign_unit() const;
  /// Unit of the scaled values: "m", or a foreign unit.
  [[nodiscard]] std::string used_unit() const;
  /// Unit of the raw numbers and the conversion applied; factor 1 if the scale is a parameter.
  [[nodiscard]] signals::Conversion conversion() const;
  /// True if the column is identified by its number.
  [[nodiscard]] bool is_numbered() const {
    return column.find_first_not_of("0123456789") == std::string::npos;
  }
  /// Its header, or "column 3".
  [[nodiscard]] std::string header() const { return is_numbered() ? "column " + column : column; }
  /// The header, followed by the record's number from the second record on.
  [[nodiscard]] std::string name() const {
    return header() + (record > 1 ? " (record " + std::to_string(record) + ")" : std::string());
  }
};

/// An optional law of a link (sid_discovery.hpp).
struct SidTerm {
  std::string name = {};  ///< "cubic", "contact closing"; "cubic 0-1" if several links have terms
  int link = 0;           ///< index among the links of the base model
  dynamics::Law law = {};
  /// Indices of the law's coefficients that are parameters with default priors, set from the
  /// record.
  std::vector<std::size_t> by_default = {};
};

/// RMS motion and tension of a link, estimated from the record.
struct LinkMotion {
  double extension = 0.0;               ///< [m]
  double rate = 0.0;                    ///< [m/s]
  double tension = 0.0;                 ///< [N]
  double opening = 0.0, closing = 0.0;  ///< largest extension and compression, both > 0 [m]
};

/// Optional terms of a chain: every subset of them is a model.
struct SidDiscovery {
  std::vector<SidTerm> terms = {};
  double inclusion = 0.5;  ///< prior probability of each term, independent of the others
  /// One entry per link of the base model; empty before a record is loaded.
  std::vector<LinkMotion> motions = {};
};

/// The residual model of a SidModel and the case parameters that it uses.
struct SidResiduals {
  std::shared_ptr<const ResidualModel> model = white_residuals();
  /// Per response channel, in the order of ResidualModel::parameters; empty: none.
  std::vector<std::vector<dynamics::Coefficient>> coefficients = {};
  /// The kind for which choose_residuals determines the value; null: `model` is given.
  const ResidualKind* chosen_kind = nullptr;

  /// Parameter values for response channel c.
  [[nodiscard]] std::vector<double> at(std::size_t c, std::span<const double> theta) const;
};

struct SidModel {
  std::string name;
  double weight = 1.0;
  dynamics::Chain chain = {};
  dynamics::InitialState initial = {};
  std::vector<dynamics::Coefficient> noise = {};  ///< sd, one per response channel
  SidResiduals residuals = {};
  std::vector<int> parameters = {};  ///< indices of the parameters that it uses, increasing
  std::vector<int> terms = {};       ///< indices of its terms in SidCase::discovery, increasing

  /// ResidualModel::log_density and innovations for response channel c.
  [[nodiscard]] double log_density(std::size_t c, std::span<const double> r,
                                   std::span<const double> theta) const {
    return residuals.model->log_density(r, noise[c].at(theta), residuals.at(c, theta));
  }
  [[nodiscard]] Innovations innovations(std::size_t c, std::span<const double> r,
                                        std::span<const double> theta) const {
    return residuals.model->innovations(r, noise[c].at(theta), residuals.at(c, theta));
  }
};

/// An excitation of a simulated chain; several on one mass (or on the base) add up.
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
  /// Given sample by sample [SI].
  struct Sampled {
    std::vector<double> samples;
  };
  SidChannel::Role role = SidChannel::Role::force;
  int mass = 0;  ///< 0: the base
  std::variant<White, BandLimited, Sine, signals::Multisine, Sampled> signal;
};

/// The simulation that a case defines.
struct SidTruth {
  int model = 0;
  std::vector<double> theta = {};  ///< one value per parameter of the case; NaN if not given
  std::vector<double> noise = {};  ///< sd, one per response channel
  int samples = 0;
  double sample_rate_hz = 0.0;
  std::uint64_t seed = 1;
  std::vector<TrueExcitation> excitations = {};
  /// Excitation points per sample: 1 for linear interpolation between samples, more for a
  /// band-limited excitation (signals::upsample), as declared for the record.
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
  /// with their own channels, windows, initial states and integration.
  std::vector<SidCase> further = {};
  int number = 1;  ///< number of this record

  double sample_rate_hz = 0.0;
  signals::Sampling sampling = {};             ///< how the rate was determined
  std::optional<io::FoundLayout> layout = {};  ///< for a record in delimited text
  int begin = 0, end = 0;                      ///< scored samples, in the record
  int lead_in = 0;                             ///< samples before `begin`
  int stride = 1;                              ///< excitation samples per response sample
  int beyond = 0;                              ///< samples kept after the window, to predict
  int windows = 0;                             ///< number of windows to fit separately; 0: none
  bool simulated = false;
  /// The amount of motion at the start of the window (moves_at_start), if this is the reason for
  /// inferring the initial state without a request of the case.
  std::optional<double> starts_moving = {};
  bool base_integrated = false;  ///< the base displacement was integrated (base_integration.hpp)
  std::string origin = {};       ///< description for texts
  double band = 0.97;
  bool balance = false;  ///< sample models evenly and reweight
  dynamics::SimulatorOptions integration = {};
  /// True if the case fixes the steps. Then a run with too long steps reports this and is not
  /// repeated.
  bool fixed_integration = false;

  [[nodiscard]] std::vector<const SidChannel*> responses() const;
  /// The first channel with this role, or null.
  [[nodiscard]] const SidChannel* find(SidChannel::Role role) const;
  /// The signals of the excitation channels, as loaded.
  [[nodiscard]] dynamics::Excitation excitation() const;
  [[nodiscard]] std::vector<dynamics::Sensor> sensors() const;
  /// Indices of the parameters used by the model and the channels, increasing.
  [[nodiscard]] std::vector<int> parameters_of(const SidModel& model) const;
  /// Makes all records consistent: copies the parameter table to all of them, and adds to each
  /// model's list the parameters that it uses in any record. Call this after the last coefficient
  /// is defined.
  void unite();
  /// This record and the further ones.
  [[nodiscard]] std::vector<const SidCase*> records() const;
  /// Returns the parameter of this name; adds it if it does not exist.
  dynamics::Coefficient parameter(const std::string& name, inference::Prior prior);
};

}  // namespace wheeltap::identification
