// What is asked of chains of masses in time: a record, and equations of motion that may explain it.
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

/// One column of the record and what it means. Coefficients here and below index
/// SidCase::parameters.
struct SidChannel {
  enum class Role { time, force, base_acceleration, base_displacement, response, ignore };

  std::string column;  ///< header text or 1-based number
  int record = 1;      ///< of several records, the one it is of
  Role role = Role::ignore;
  int mass = 0;
  dynamics::Quantity quantity = dynamics::Quantity::displacement;
  dynamics::Frame frame = dynamics::Frame::absolute;
  /// Raw samples from the start of the lead-in; an excitation's are upsampled by SidCase::stride.
  dynamics::Signal signal = {};
  /// What follows the window in the record and is not used: SidCase::beyond samples, raw; an
  /// excitation's upsampled as in the window.
  std::vector<double> beyond = {};
  std::string unit = {};     ///< as the case has it, else the file's header
  bool unit_given = false;   ///< by the case
  bool scale_given = false;  ///< `signal.scale` was asked for, whatever the unit
  /// Where the window is a part of the record: how their spectra compare.
  std::optional<signals::SpectrumComparison> window = {};

  [[nodiscard]] bool is_excitation() const {
    return role == Role::force || role == Role::base_acceleration ||
           role == Role::base_displacement;
  }
  /// What its samples are; meaningless for what is ignored.
  [[nodiscard]] signals::Dimension dimension() const;
  /// The unit is the header's where the case gives none. The scale becomes the unit's where it is 1
  /// and was not asked for, and the unit is known.
  void take_unit(const std::string& header_unit);
  /// The unit where the samples are used in it though it is not known, or is of something
  /// else; empty where they are in SI units.
  [[nodiscard]] std::string foreign_unit() const;
  /// What its values are in once scaled: "m", or a foreign unit.
  [[nodiscard]] std::string used_unit() const;
  /// The unit of its raw numbers and what was made of them; a factor of 1 where the scale is a
  /// parameter.
  [[nodiscard]] signals::Conversion conversion() const;
  /// The column is called by its number.
  [[nodiscard]] bool is_numbered() const {
    return column.find_first_not_of("0123456789") == std::string::npos;
  }
  /// Its header, or "column 3".
  [[nodiscard]] std::string header() const { return is_numbered() ? "column " + column : column; }
  /// The same, with the record's number from the second on.
  [[nodiscard]] std::string name() const {
    return header() + (record > 1 ? " (record " + std::to_string(record) + ")" : std::string());
  }
};

/// A law that a link may have or not (sid_discovery.hpp).
struct SidTerm {
  std::string name = {};  ///< "cubic", "contact closing"; "cubic 0-1" where several links are asked
  int link = 0;           ///< index among the links of the base model
  dynamics::Law law = {};
  /// Coefficients of the law, by index, that are parameters whose priors the record sets.
  std::vector<std::size_t> by_default = {};
};

/// How a link moves and what it carries, RMS, as far as the record shows it.
struct LinkMotion {
  double extension = 0.0;               ///< [m]
  double rate = 0.0;                    ///< [m/s]
  double tension = 0.0;                 ///< [N]
  double opening = 0.0, closing = 0.0;  ///< largest extensions of either sign, both > 0 [m]
};

/// The question which of these terms a chain has: every subset of them is a model.
struct SidDiscovery {
  std::vector<SidTerm> terms = {};
  double inclusion = 0.5;  ///< prior probability of each term, by itself
  /// Of each link of the base model; empty before there is a record.
  std::vector<LinkMotion> motions = {};
};

/// The residual model of a SidModel, with the parameters of the case that it uses.
struct SidResiduals {
  std::shared_ptr<const ResidualModel> model = white_residuals();
  /// Of each response channel, in the order of ResidualModel::parameters; empty: none.
  std::vector<std::vector<dynamics::Coefficient>> coefficients = {};
  /// The kind whose value choose_residuals determines; null: `model` is given.
  const ResidualKind* chosen_kind = nullptr;

  /// The values of response channel c.
  [[nodiscard]] std::vector<double> at(std::size_t c, std::span<const double> theta) const;
};

struct SidModel {
  std::string name;
  double weight = 1.0;
  dynamics::Chain chain = {};
  dynamics::InitialState initial = {};
  std::vector<dynamics::Coefficient> noise = {};  ///< sd, one a response channel
  SidResiduals residuals = {};
  std::vector<int> parameters = {};  ///< those it uses, increasing
  std::vector<int> terms = {};       ///< those of SidCase::discovery that it has, increasing

  /// ResidualModel::log_density and innovations of response channel c.
  [[nodiscard]] double log_density(std::size_t c, std::span<const double> r,
                                   std::span<const double> theta) const {
    return residuals.model->log_density(r, noise[c].at(theta), residuals.at(c, theta));
  }
  [[nodiscard]] Innovations innovations(std::size_t c, std::span<const double> r,
                                        std::span<const double> theta) const {
    return residuals.model->innovations(r, noise[c].at(theta), residuals.at(c, theta));
  }
};

/// What drives a simulated chain, and where: several on one mass (or on the base) add up.
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

/// A simulation asked for by the case.
struct SidTruth {
  int model = 0;
  std::vector<double> theta = {};  ///< one value a parameter of the case; NaN where not given
  std::vector<double> noise = {};  ///< sd, one a response channel
  int samples = 0;
  double sample_rate_hz = 0.0;
  std::uint64_t seed = 1;
  std::vector<TrueExcitation> excitations = {};
  /// Points at which an excitation is followed, a sample: 1 where it is linear between its samples;
  /// more where it is band-limited there (signals::upsample), as the record says of itself.
  int points_a_sample = 1;
};

struct SidCase {
  std::string title = {};
  std::vector<inference::Parameter> parameters = {};
  std::vector<SidChannel> channels = {};
  std::vector<SidModel> models = {};
  std::optional<SidDiscovery> discovery = {};
  std::optional<SidTruth> truth = {};

  /// Further records of the same rig: cases with the same models and table of parameters, but
  /// with channels, windows, initial states and integration of their own.
  std::vector<SidCase> further = {};
  int number = 1;  ///< of this record

  double sample_rate_hz = 0.0;
  signals::Sampling sampling = {};             ///< how that was found
  std::optional<io::FoundLayout> layout = {};  ///< of a record in delimited text
  int begin = 0, end = 0;                      ///< samples scored, in the record
  int lead_in = 0;                             ///< samples before those
  int stride = 1;                              ///< excitation samples a response sample
  int beyond = 0;   ///< samples kept of what follows the window, to predict
  int windows = 0;  ///< to be fitted each by itself, too; 0: none
  bool simulated = false;
  /// Why the initial state is inferred though the case does not ask: how far the responses move at
  /// the window's start (moves_at_start).
  std::optional<double> starts_moving = {};
  bool base_integrated = false;  ///< the base's displacement was (base_integration.hpp)
  std::string origin = {};       ///< in words
  double band = 0.97;
  bool balance = false;  ///< sample models evenly and reweight
  dynamics::SimulatorOptions integration = {};
  /// The steps are the user's: a run whose steps were too long says so and is not repeated.
  bool fixed_integration = false;

  [[nodiscard]] std::vector<const SidChannel*> responses() const;
  /// The first channel of this role, or none.
  [[nodiscard]] const SidChannel* find(SidChannel::Role role) const;
  /// Its signals, as loaded.
  [[nodiscard]] dynamics::Excitation excitation() const;
  [[nodiscard]] std::vector<dynamics::Sensor> sensors() const;
  /// Indices of the parameters that a model and the channels use, increasing.
  [[nodiscard]] std::vector<int> parameters_of(const SidModel& model) const;
  /// Brings the table of parameters to all records, and to each model's list what any of them uses:
  /// to be called once the last coefficient has its place.
  void unite();
  /// This one and the further ones.
  [[nodiscard]] std::vector<const SidCase*> records() const;
  /// The parameter of this name, added where there is none.
  dynamics::Coefficient parameter(const std::string& name, inference::Prior prior);
};

}  // namespace wheeltap::identification
