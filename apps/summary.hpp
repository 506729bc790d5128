// What a run found, as the JSON of summary.json: the part that does not know what the models mean.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/case_file.hpp"
#include "inference/diagnostics.hpp"
#include "inference/reversible_jump.hpp"
#include "inference/verdict.hpp"

namespace wheeltap::apps {

/// JSON that keeps the order in which it is written.
using Report = nlohmann::ordered_json;

/// What the user asked for, to be repeated.
struct RunInfo {
  std::uint64_t seed = 1;
  std::string command_line;
};

/// Mean, sd, quantiles and histogram mode of one quantity, with its convergence where `chains` are
/// long enough to judge it (null otherwise). `weights`, one a draw, may be empty: all alike.
[[nodiscard]] Report summarise(const inference::ChainsOf& chains,
                               const inference::ChainsOf& weights = {});

/// Quantile of sorted draws, linear between order statistics.
[[nodiscard]] double quantile(const std::vector<double>& sorted, double p);
/// The same of weighted draws, in any order; of equal weights it is the above.
[[nodiscard]] double weighted_quantile(std::vector<std::pair<double, double>> draws_and_weights,
                                       double p);

/// What a draw of each model counts, 1 on average over the draws: not all alike only where models
/// were balanced (Posterior::log_weight). Whatever is averaged over models must use it.
[[nodiscard]] std::vector<double> model_weights(const inference::Posterior& posterior);
/// The same of every draw; empty where all are alike.
[[nodiscard]] inference::ChainsOf draw_weights(const inference::Posterior& posterior);

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

/// One row a model: name, prior, probability and its Monte Carlo standard error, and what both rest
/// on: "visited" (chains that drew it), "proposed" and "entered" (jumps into it), "log_evidence"
/// and "log_evidence_se", "basis" ("draws" or "evidence"). `mcse` is null where nothing is known.
[[nodiscard]] Report model_table(const inference::Posterior& posterior,
                                 const inference::Verdict& verdict);

/// "not entered in 123 456 proposals; its evidence puts it at P ≈ 0.21 ± 0.02", from a row of
/// `model_table`; empty for a model that its draws speak for.
[[nodiscard]] std::string told_by_evidence(const Report& row);

/// "a mode that less than 0.3 % of the prior climbs to would probably not have been seen", from
/// diagnostics; empty where nothing was searched.
[[nodiscard]] std::string resolution_in_words(const Report& diagnosed);

/// Parameter summaries of every visited model.
[[nodiscard]] Report parameter_tables(const inference::Posterior& posterior);

/// Convergence, acceptance and mixing between models. `warnings`: what is not established, then
/// those already known.
[[nodiscard]] Report diagnostics(const inference::Posterior& posterior,
                                 const inference::Verdict& verdict, std::uint64_t seed,
                                 std::vector<std::string> warnings);

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
/// All digits of a count, in threes: "123 456".
[[nodiscard]] std::string grouped(long n);
/// A count for people, to three digits: "80500".
[[nodiscard]] std::string rounded_count(double x);
/// "75 %", "> 99.9 %", "< 0.1 %".
[[nodiscard]] std::string percent(double probability);
/// "P = 75 %", "P > 99.9 %".
[[nodiscard]] std::string probability_is(double probability);

}  // namespace wheeltap::apps
