// What a run found, as the JSON of summary.json: the part that does not know what the models mean.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/case_file.hpp"
#include "inference/diagnostics.hpp"
#include "inference/reversible_jump.hpp"

namespace wheeltap::apps {

/// JSON that keeps the order in which it is written.
using Report = nlohmann::ordered_json;

/// What the user asked for, to be repeated.
struct RunInfo {
  std::uint64_t seed = 1;
  std::string command_line;
};

/// Mean, sd, quantiles and histogram mode of one quantity, with its convergence where `chains` are
/// long enough to judge it (null otherwise).
[[nodiscard]] Report summarise(const inference::ChainsOf& chains);

/// Quantile of sorted draws, linear between order statistics.
[[nodiscard]] double quantile(const std::vector<double>& sorted, double p);

/// "location[1]"; with its kind's name before it where two kinds share the name.
[[nodiscard]] std::string parameter_label(const inference::ModelSpace& space, int model, int i);

/// Draws of something within one model: `value(chain, draw)` for every draw that is in it.
template <class Value>
[[nodiscard]] inference::ChainsOf draws_in_model(const inference::Posterior& posterior, int model,
                                                 const Value& value) {
  inference::ChainsOf out(posterior.chains.size());
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    const auto& models = posterior.chains[c].model;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i] == model) out[c].push_back(value(c, i));
    }
  }
  return out;
}

/// Draws of something that every draw has.
template <class Value>
[[nodiscard]] inference::ChainsOf all_draws(const inference::Posterior& posterior,
                                            const Value& value) {
  inference::ChainsOf out(posterior.chains.size());
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    out[c].resize(posterior.chains[c].model.size());
    for (std::size_t i = 0; i < out[c].size(); ++i) out[c][i] = value(c, i);
  }
  return out;
}

/// A quantity that means the same in every model, by which convergence is judged.
struct Watched {
  std::string name;
  inference::ChainsOf draws;
  bool is_count = false;  ///< tells models apart: not judged where one model holds everything
};

/// One row a model: name, prior, probability and its Monte Carlo standard error. The error is never
/// below 1 / (ESS of the model + 2), what one more or less effective visit would change; for a
/// model never visited it is that.
[[nodiscard]] Report model_table(const inference::Posterior& posterior, double ess_model);

/// Parameter summaries of every visited model.
[[nodiscard]] Report parameter_tables(const inference::Posterior& posterior);

/// ESS of the model: the smallest over the kinds' counts (over the models' indicators where there
/// are no kinds).
[[nodiscard]] double ess_of_model(const inference::Posterior& posterior);

/// Convergence, acceptance and mixing between models. `watched` should hold all that labels allow
/// (counts, predictions); the log posterior is added here. Converged means: R-hat < 1.01 for every
/// watched quantity, bulk and tail ESS of the log posterior > 400, and ESS of the model > 400;
/// where one model holds more than 0.999 of the probability, counts and ESS of the model are not
/// asked. `warnings` already known come first.
[[nodiscard]] Report diagnostics(const inference::Posterior& posterior,
                                 const std::vector<Watched>& watched, double ess_model,
                                 std::uint64_t seed, std::vector<std::string> warnings);

/// What repeats the run: version, command, seed, machine and case.
[[nodiscard]] Report about(const std::string& command, const RunInfo& info, const CaseFile& file);

/// Processor and number of cores, in words; nothing that tells one machine of its kind from
/// another.
[[nodiscard]] std::string machine();

/// What the run cost.
[[nodiscard]] Report cost(const inference::Posterior& posterior);

/// A number for people: `digits` significant ones, no trailing zeros.
[[nodiscard]] std::string significant(double x, int digits);
/// The same with as many digits as an interval of this width needs to be told from a point: two of
/// the width, at least three of the number, at most ten.
[[nodiscard]] std::string resolved(double x, double width);
/// A number for people: `decimals` after the point.
[[nodiscard]] std::string fixed(double x, int decimals);
/// A count for people, to three digits: "80500".
[[nodiscard]] std::string rounded_count(double x);
/// "75 %", "> 99.9 %", "< 0.1 %".
[[nodiscard]] std::string percent(double probability);
/// "P = 75 %", "P > 99.9 %".
[[nodiscard]] std::string probability_is(double probability);

}  // namespace wheeltap::apps
