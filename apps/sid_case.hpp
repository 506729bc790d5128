// A system-identification case, parsed once at the door: everything behind it works on these types.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/case_file.hpp"
#include "dynamics/simulate.hpp"
#include "inference/model_space.hpp"
#include "signals/record.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::apps {

/// One column of the record and what it means. Coefficients here and below index
/// SidCase::parameters.
struct SidChannel {
  enum class Role { time, force, base_acceleration, base_displacement, response, ignore };

  std::string column;  ///< header text or 1-based number
  Role role = Role::ignore;
  int mass = 0;
  dynamics::Quantity quantity = dynamics::Quantity::displacement;
  dynamics::Frame frame = dynamics::Frame::absolute;
  /// Raw samples from the start of the lead-in; an excitation's are upsampled by SidCase::stride.
  dynamics::Signal signal = {};
  std::string unit = {};  ///< as the file's header has it
  /// Where the window is a part of the record: how their spectra compare.
  std::optional<signals::SpectrumComparison> window = {};
  Pointer where = Pointer();

  [[nodiscard]] bool is_excitation() const {
    return role == Role::force || role == Role::base_acceleration ||
           role == Role::base_displacement;
  }
};

struct SidModel {
  std::string name;
  double weight = 1.0;
  dynamics::Chain chain = {};
  dynamics::InitialState initial = {};
  std::vector<dynamics::Coefficient> noise = {};  ///< sd, one a response channel
  /// Partial autocorrelations of each response channel's residuals; empty: white.
  std::vector<std::vector<dynamics::Coefficient>> autocorrelations = {};
  std::vector<int> parameters = {};  ///< those it uses, increasing
  Pointer where = Pointer();
};

/// A simulation asked for by the case.
struct SidTruth {
  int model = 0;
  std::vector<double> theta = {};  ///< one value a parameter of the case; NaN where not given
  std::vector<double> noise = {};  ///< sd, one a response channel
  int samples = 0;
  double sample_rate_hz = 0.0;
  std::uint64_t seed = 1;
};

struct SidCase {
  CaseFile file;
  std::string title = {};
  std::vector<std::string> notes = {};
  std::vector<inference::Parameter> parameters = {};
  std::vector<SidChannel> channels = {};
  std::vector<SidModel> models = {};
  std::optional<SidTruth> truth = {};

  double sample_rate_hz = 0.0;
  int begin = 0, end = 0;  ///< samples scored, in the record
  int lead_in = 0;         ///< samples before those
  int stride = 1;          ///< excitation samples a response sample
  bool simulated = false;
  std::string origin = {};  ///< in words
  double band = 0.97;
  bool balance = false;  ///< sample models evenly and reweight
  dynamics::SimulatorOptions integration = {};
  std::vector<std::string> warnings = {};

  [[nodiscard]] std::vector<const SidChannel*> responses() const;
  /// Its signals, as loaded.
  [[nodiscard]] dynamics::Excitation excitation() const;
  [[nodiscard]] std::vector<dynamics::Sensor> sensors() const;
};

/// Whether the record is read (or simulated) too.
enum class SidNeeds { models, record };

/// Reads, checks and parses. A case without a file is simulated from its truth, with `seed` in
/// place of the truth's where given. Throws Failure.
[[nodiscard]] SidCase parse_sid_case(CaseFile file, SidNeeds needs = SidNeeds::record);

/// The record that the case's truth produces: time, excitations, and responses with noise in raw
/// units. Throws Failure where the case has no truth, or the true model blows up.
[[nodiscard]] signals::Record simulate_record(const SidCase& sid_case, std::uint64_t seed);

/// A record as CSV text, units in the header.
[[nodiscard]] std::string record_csv(const signals::Record& record, const std::string& comment);

}  // namespace wheeltap::apps
