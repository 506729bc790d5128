#include "apps/sid_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/sid_links.hpp"
#include "signals/residuals.hpp"

namespace wheeltap::apps {
namespace {

using inference::Posterior;

constexpr double kWorthTelling = 0.05;  // models with less probability are not judged
constexpr double kWhite = 0.01;         // p-value below which residuals are called coloured
constexpr std::size_t kMaxPredicted = 6'000'000;
constexpr int kFewestDraws = 20;

double probability(const Report& models, int m) {
  return models[static_cast<std::size_t>(m)]["probability"];
}

/// Whether there are draws of a model to look at, however probable its evidence makes it.
bool drawn(const Report& models, int m) {
  return models[static_cast<std::size_t>(m)]["visited"].get<int>() > 0;
}

/// Residuals freed of their fitted autoregression (all but the first p).
std::vector<double> innovations(std::span<const double> residuals,
                                const std::vector<dynamics::Coefficient>& autocorrelations,
                                std::span<const double> theta) {
  if (autocorrelations.empty()) return {residuals.begin(), residuals.end()};
  std::vector<double> pacf;
  for (const auto& pi : autocorrelations) pacf.push_back(pi.at(theta));
  const std::vector<double> phi = signals::ar_coefficients(pacf);
  std::vector<double> out;
  for (std::size_t n = phi.size(); n < residuals.size(); ++n) {
    double e = residuals[n];
    for (std::size_t j = 0; j < phi.size(); ++j) e -= phi[j] * residuals[n - 1 - j];
    out.push_back(e);
  }
  return out;
}

std::string channel_name(const SidChannel& channel) {
  return channel.column.find_first_not_of("0123456789") == std::string::npos
             ? "column " + channel.column
             : channel.column;
}

/// The mean of a model's draws.
std::vector<double> mean_draw(const SidProblem& problem, const Posterior& posterior, int model) {
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<double> mean(static_cast<std::size_t>(problem.problem.space[model].dimension));
  double draws = 0.0;
  for (const auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.model.size(); ++i) {
      if (chain.model[i] != model) continue;
      ++draws;
      for (std::size_t p = 0; p < mean.size(); ++p) mean[p] += chain.theta[i * width + p];
    }
  }
  for (double& x : mean) x /= std::max(draws, 1.0);
  return mean;
}

/// A forward run of a model against the record, channel by channel.
Report forward_run(const SidProblem& problem, int m, std::span<const double> theta) {
  const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
  const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
  const auto samples = static_cast<std::size_t>(misfit.samples());
  const auto responses = problem.sid_case.responses();
  std::vector<double> residuals(responses.size() * samples);
  Report rows = Report::array();
  if (!misfit.residuals(theta, residuals)) return rows;
  for (std::size_t c = 0; c < responses.size(); ++c) {
    const std::span<const double> r(residuals.data() + c * samples, samples);
    const std::vector<double> y = observed(problem, c, theta);
    const double n = static_cast<double>(samples);
    const double mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
    double squares = 0.0, total = 0.0;
    for (std::size_t i = 0; i < samples; ++i) {
      squares += r[i] * r[i];
      total += (y[i] - mean) * (y[i] - mean);
    }
    const int order =
        model.autocorrelations.empty() ? 0 : static_cast<int>(model.autocorrelations[c].size());
    const auto white = innovations(
        r, order > 0 ? model.autocorrelations[c] : std::vector<dynamics::Coefficient>{}, theta);
    const int lags = std::clamp(static_cast<int>(white.size()) / 5, 2, 20) + order;
    Report whiteness;
    if (static_cast<int>(white.size()) > lags + 1) {
      const auto test = signals::ljung_box(white, lags, order);
      whiteness = {{"test", "Ljung-Box"},
                   {"of", order > 0 ? "innovations" : "residuals"},
                   {"lags", lags},
                   {"statistic", test.statistic},
                   {"degrees_of_freedom", test.degrees_of_freedom},
                   {"p_value", test.p_value},
                   {"lag_1_autocorrelation", signals::autocorrelation(white, 1)[0]},
                   {"white", test.p_value >= kWhite}};
    }
    rows.push_back({{"channel", channel_name(*responses[c])},
                    {"mass", responses[c]->mass},
                    {"mse", squares / n},
                    {"rmse", std::sqrt(squares / n)},
                    {"nrmse", total > 0.0 ? Report(std::sqrt(squares / total)) : Report()},
                    {"r2", total > 0.0 ? Report(1.0 - squares / total) : Report()},
                    {"noise_sd", model.noise[c].at(theta)},
                    {"whiteness", whiteness}});
  }
  return rows;
}

/// The draw of a visited model that has the highest posterior density.
std::span<const double> best_draw(const SidProblem& problem, const Posterior& posterior,
                                  int model) {
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::span<const double> best;
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.model.size(); ++i) {
      const double density = chain.log_prior[i] + chain.log_likelihood[i];
      if (chain.model[i] != model || !(density > most)) continue;
      most = density;
      best = {&chain.theta[i * width],
              static_cast<std::size_t>(problem.problem.space[model].dimension)};
    }
  }
  return best;
}

/// Steps so long that they move the posterior.
void judge_integration(const Report& models, const Report& errors,
                       std::vector<std::string>& warnings) {
  for (const auto& row : models) {
    const auto name = row["name"].get<std::string>();
    if (row["probability"].get<double>() < kWorthTelling || !errors.contains(name) ||
        !errors[name].is_number()) {
      continue;
    }
    const double error = errors[name];
    if (error <= kLargestStepError) continue;
    warnings.push_back(
        "Under \"" + name + "\" steps a quarter as long change the best draw's response by " +
        significant(error, 2) +
        " of the noise (root of the sum of squares): parameters may be off by up to " +
        significant(error, 2) +
        " standard deviations for the steps alone. Leave \"integration\" out of the case, and the "
        "run is repeated with better ones; or lower its \"step_limit\".");
  }
}

/// Where the mean of the parameters is itself no good set of parameters: it lies in a valley of a
/// posterior that has several peaks, or on the inside of a bend.
void judge_means(const SidProblem& problem, const Posterior& posterior, const Report& models,
                 const Report& at_mean, const Report& at_best, std::vector<std::string>& warnings) {
  const auto likelihood = problem.problem.likelihood();
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    const std::string& name = problem.problem.space[m].name;
    if (probability(models, m) < kWorthTelling || !at_mean.contains(name)) continue;
    const std::span<const double> best = best_draw(problem, posterior, m);
    const double lost = likelihood->log_likelihood(m, best) -
                        likelihood->log_likelihood(m, mean_draw(problem, posterior, m));
    if (lost < 10.0 + 3.0 * static_cast<double>(best.size())) continue;  // of a normal: about d / 2
    std::string errors;
    for (std::size_t c = 0; c < at_mean[name].size(); ++c) {
      const Report &mean = at_mean[name][c], &draw = at_best[name][c];
      if (!mean["nrmse"].is_number() || !draw["nrmse"].is_number()) continue;
      errors += (errors.empty() ? "" : ", ") + mean["channel"].get<std::string>() + " " +
                significant(100.0 * mean["nrmse"].get<double>(), 3) + " % against " +
                significant(100.0 * draw["nrmse"].get<double>(), 3) + " %";
    }
    warnings.push_back("Under \"" + name +
                       "\" the means of the parameters do not go together: a forward run with them "
                       "misses the record by more than the best draw does (" +
                       errors + "). Use draws, or \"best_draw\" in summary.json, not the means.");
  }
}

/// What the forward runs of the models that matter say about the data.
void judge_fits(const SidProblem& problem, const Report& models, const Report& fits,
                std::vector<std::string>& warnings) {
  const double n = static_cast<double>(problem.misfits.front().samples());
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
    if (probability(models, m) < kWorthTelling || !fits.contains(model.name)) continue;
    std::string coloured, off;
    for (std::size_t c = 0; c < fits[model.name].size(); ++c) {
      const Report& row = fits[model.name][c];
      const auto name = row["channel"].get<std::string>();
      if (row["whiteness"].is_object() && !row["whiteness"]["white"].get<bool>()) {
        coloured += (coloured.empty() ? "" : ", ") + std::string("\"") + name + "\" (lag-1 " +
                    fixed(row["whiteness"]["lag_1_autocorrelation"], 2) + ", p " +
                    significant(row["whiteness"]["p_value"], 1) + ")";
      }
      const double ratio = row["mse"].get<double>() / std::pow(row["noise_sd"].get<double>(), 2);
      if (model.noise[c].is_constant() && std::abs(ratio - 1.0) > 6.0 * std::sqrt(2.0 / n)) {
        off += (off.empty() ? "" : ", ") + std::string("\"") + name + "\" by a factor of " +
               significant(std::sqrt(ratio), 3);
      }
    }
    if (!off.empty()) {
      warnings.push_back("Under \"" + model.name +
                         "\" the residuals differ from the stated noise: " + off +
                         ". Either the noise is not what the case says (make it a parameter), or "
                         "no model here explains the record.");
    }
    if (!coloured.empty()) {
      warnings.push_back(
          "Under \"" + model.name + "\" the residuals are not white: " + coloured +
          ". The likelihood takes them for independent, so its probabilities and intervals are "
          "too sure; add \"residuals\": {\"ar\": 2} to the case, or a model that explains more.");
    }
  }
}

/// Posteriors that lean on an end of their prior.
void judge_bounds(const SidProblem& problem, const Posterior& posterior, const Report& models,
                  std::vector<std::string>& warnings) {
  const auto& space = problem.problem.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  for (int m = 0; m < space.size(); ++m) {
    if (probability(models, m) < kWorthTelling || !drawn(models, m)) continue;
    for (int p = 0; p < space[m].dimension; ++p) {
      long above = 0, below = 0, all = 0;
      const inference::Prior& prior = space.prior(m, p);
      const double high = prior.from_standard_normal(2.326),
                   low = prior.from_standard_normal(-2.326);
      for (const auto& chain : posterior.chains) {
        for (std::size_t i = 0; i < chain.model.size(); ++i) {
          if (chain.model[i] != m) continue;
          const double x = chain.theta[i * width + static_cast<std::size_t>(p)];
          ++all, above += x > high ? 1 : 0, below += x < low ? 1 : 0;
        }
      }
      const bool leans_up = above > all / 4 && std::isfinite(prior.upper());
      const bool leans_down = below > all / 4 && std::isfinite(prior.lower()) && prior.lower() != 0;
      if (leans_up || leans_down) {
        warnings.push_back("Under \"" + space[m].name + "\" the parameter " +
                           space.parameter_name(m, p) + " leans on the " +
                           (leans_up ? "upper" : "lower") + " end of its prior, " +
                           prior.describe() + ": widen it unless that end is certain.");
      }
    }
  }
}

/// ln of the Bayes factor of each model against the first, from the probabilities.
Report bayes_factors(const inference::ModelSpace& space, const Report& models) {
  Report rows = Report::array();
  const bool drawn0 = drawn(models, 0);
  for (int m = 1; m < space.size(); ++m) {
    const Report &row = models[static_cast<std::size_t>(m)], &first = models[0];
    const double p = row["probability"], p0 = first["probability"];
    const bool by_evidence = row["basis"] == "evidence" || first["basis"] == "evidence";
    const bool both = row["log_evidence"].is_number() && first["log_evidence"].is_number();
    // Evidences keep what probabilities lose below the smallest number.
    const bool known = by_evidence ? both : p > 0.0 && p0 > 0.0;
    double log_factor = 0.0, error = std::nan("");
    if (known && by_evidence) {
      log_factor = row["log_evidence"].get<double>() - first["log_evidence"].get<double>();
      if (row["log_evidence_se"].is_number() && first["log_evidence_se"].is_number()) {
        error = std::hypot(row["log_evidence_se"].get<double>(),
                           first["log_evidence_se"].get<double>());
      }
    } else if (known) {
      log_factor = std::log(p) - std::log(p0) - (space[m].log_prior - space[0].log_prior);
      error = std::hypot(row["mcse"].get<double>() / p, first["mcse"].get<double>() / p0);
    }
    rows.push_back({{"model", space[m].name},
                    {"against", space[0].name},
                    {"log_bayes_factor", known ? Report(log_factor) : Report()},
                    {"mcse", known && std::isfinite(error) ? Report(error) : Report()},
                    {"basis", by_evidence ? "evidence" : "draws"},
                    {"never_visited", drawn(models, m) ? (drawn0 ? Report() : Report(space[0].name))
                                      : drawn0         ? Report(space[m].name)
                                                       : Report("both")}});
  }
  return rows;
}

}  // namespace

std::optional<double> step_error(const SidProblem& problem, const Posterior& posterior, int m) {
  constexpr int kFiner = 4;
  const auto theta = problem.theta(m, best_draw(problem, posterior, m));
  const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
  const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
  const dynamics::Simulator& simulator = misfit.simulator();
  if (simulator.substeps(theta) <= 0) return {};  // exact
  if (simulator.options().substeps > dynamics::kMaxSubsteps / kFiner) return {};
  const dynamics::Misfit finer = misfit.refined(kFiner);
  const auto samples = static_cast<std::size_t>(misfit.samples());
  const auto channels = static_cast<std::size_t>(misfit.channels());
  std::vector<double> residuals(channels * samples), better(channels * samples);
  if (!misfit.residuals(theta, residuals) || !finer.residuals(theta, better)) return {};
  for (std::size_t i = 0; i < better.size(); ++i) better[i] -= residuals[i];
  double sum = 0.0;
  for (std::size_t c = 0; c < channels; ++c) {
    double variance = std::pow(model.noise[c].at(theta), 2);
    if (!model.autocorrelations.empty()) {
      for (const auto& pi : model.autocorrelations[c]) variance *= 1.0 - std::pow(pi.at(theta), 2);
    }
    const auto change =
        innovations({better.data() + c * samples, samples},
                    model.autocorrelations.empty() ? std::vector<dynamics::Coefficient>{}
                                                   : model.autocorrelations[c],
                    theta);
    for (const double value : change) sum += value * value / variance;
  }
  return std::sqrt(sum);
}

std::vector<double> observed(const SidProblem& problem, std::size_t response,
                             std::span<const double> theta) {
  const SidChannel& channel = *problem.sid_case.responses()[response];
  const double scale = channel.signal.scale.at(theta), offset = channel.signal.offset.at(theta);
  std::vector<double> y;
  for (std::size_t n = static_cast<std::size_t>(problem.sid_case.lead_in);
       n < channel.signal.samples.size(); ++n) {
    y.push_back(scale * channel.signal.samples[n] + offset);
  }
  return y;
}

std::vector<double> posterior_mean(const SidProblem& problem, const Posterior& posterior,
                                   int model) {
  return problem.theta(model, mean_draw(problem, posterior, model));
}

namespace {

// Where the sum of the weights so far passes this share of them all: systematic resampling.
std::size_t reached(const std::vector<double>& weights, double share) {
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    if (sum > wanted) return i;
  }
  return weights.size() - 1;
}

}  // namespace

SidPredictive predict(const SidProblem& problem, const Posterior& posterior, int draws) {
  const std::size_t length = problem.sid_case.responses().size() *
                             static_cast<std::size_t>(problem.misfits.front().samples());
  const std::size_t chains = posterior.chains.size();
  const auto affordable = static_cast<int>(kMaxPredicted / std::max<std::size_t>(length, 1));
  const auto wanted = static_cast<std::size_t>(std::max(kFewestDraws, std::min(draws, affordable)));
  const std::size_t each = std::max<std::size_t>(1, wanted / chains);
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const inference::ChainsOf weights = draw_weights(posterior);
  SidPredictive out;
  std::vector<double> residuals(length);
  for (std::size_t c = 0; c < chains; ++c) {
    const auto& chain = posterior.chains[c];
    for (std::size_t j = 0; j < each; ++j) {
      const std::size_t i =
          weights.empty()
              ? (2 * j + 1) * chain.model.size() / (2 * each)
              : reached(weights[c], (static_cast<double>(j) + 0.5) / static_cast<double>(each));
      const int m = chain.model[i];
      const auto theta = problem.theta(m, {chain.theta.data() + i * width, width});
      if (!problem.misfits[static_cast<std::size_t>(m)].residuals(theta, residuals)) continue;
      SidPredictive::Draw draw{.chain = c, .draw = i, .residuals = {}, .noise = {}};
      draw.residuals.assign(residuals.begin(), residuals.end());
      for (const auto& sd : problem.sid_case.models[static_cast<std::size_t>(m)].noise) {
        draw.noise.push_back(sd.at(theta));
      }
      out.draws.push_back(std::move(draw));
    }
  }
  return out;
}

namespace {

/// Share of the samples that lie within the central band of the predictive mixture
/// 1/D Σ_d N(prediction_d, σ_d²): their probability integral transform lies within the level.
Report coverage(const SidProblem& problem, const SidPredictive& predictive) {
  const auto responses = problem.sid_case.responses();
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  const double tail = 0.5 * (1.0 - problem.sid_case.band);
  Report rows = Report::array();
  for (std::size_t c = 0; c < responses.size(); ++c) {
    long inside = 0;
    for (std::size_t n = 0; n < samples; ++n) {
      double p = 0.0;
      for (const auto& draw : predictive.draws) {
        p += 0.5 * std::erfc(-draw.residuals[c * samples + n] / (draw.noise[c] * M_SQRT2));
      }
      p /= static_cast<double>(predictive.draws.size());
      inside += p >= tail && p <= 1.0 - tail ? 1 : 0;
    }
    rows.push_back({{"channel", channel_name(*responses[c])},
                    {"coverage", static_cast<double>(inside) / static_cast<double>(samples)}});
  }
  return {{"level", problem.sid_case.band}, {"draws", predictive.draws.size()}, {"channels", rows}};
}

Report prior_list(const SidCase& sid_case) {
  Report out = Report::object();
  for (const auto& parameter : sid_case.parameters) {
    out[parameter.name] = parameter.prior.describe();
  }
  return out;
}

}  // namespace

Report summarise_sid(const SidProblem& problem, const Posterior& posterior,
                     const SidPredictive& predictive, const std::vector<MethodEvidence>& evidence,
                     const RunInfo& info) {
  const SidCase& sid_case = problem.sid_case;
  const auto& space = problem.problem.space;
  const inference::Verdict verdict = inference::judge(posterior);
  const Report models = model_table(posterior, verdict);
  const Report parameters = parameter_tables(posterior);

  std::vector<std::string> warnings = sid_case.warnings;
  Report fits = Report::object(), best_fits = Report::object(), best_draws = Report::object();
  Report step_errors = Report::object();
  for (int m = 0; m < space.size(); ++m) {
    if (!drawn(models, m)) continue;
    const std::string& name = space[m].name;
    const std::span<const double> best = best_draw(problem, posterior, m);
    fits[name] = forward_run(problem, m, posterior_mean(problem, posterior, m));
    best_fits[name] = forward_run(problem, m, problem.theta(m, best));
    const std::optional<double> error = step_error(problem, posterior, m);
    step_errors[name] = error ? Report(*error) : Report();
    best_draws[name] = Report::object();
    for (int p = 0; p < space[m].dimension; ++p)
      best_draws[name][space.parameter_name(m, p)] = best[static_cast<std::size_t>(p)];
  }
  judge_means(problem, posterior, models, fits, best_fits, warnings);
  judge_fits(problem, models, best_fits, warnings);
  judge_bounds(problem, posterior, models, warnings);
  judge_integration(models, step_errors, warnings);
  const Report compared = evidence_report(space, models, evidence, warnings);

  Report channels = Report::array();
  for (const SidChannel* channel : sid_case.responses()) {
    channels.push_back({{"channel", channel_name(*channel)}, {"mass", channel->mass}});
  }
  Report window = Report::array();
  for (const SidChannel& channel : sid_case.channels) {
    if (!channel.window) continue;
    window.push_back({{"channel", channel_name(channel)},
                      {"power_ratio", channel.window->power_ratio},
                      {"spectrum_difference_db", channel.window->difference_db},
                      {"scatter_db", channel.window->expected_db}});
  }
  Report substeps = Report::object();
  for (int m = 0; m < space.size(); ++m) {
    if (!drawn(models, m)) continue;
    substeps[space[m].name] = problem.misfits[static_cast<std::size_t>(m)].simulator().substeps(
        posterior_mean(problem, posterior, m));
  }
  Report summary = {{"wheeltap", about("sid", info, sid_case.file)},
                    {"title", sid_case.title},
                    {"notes", sid_case.notes},
                    {"models", models},
                    {"log_bayes_factors", bayes_factors(space, models)},
                    {"parameters", parameters},
                    {"priors", prior_list(sid_case)},
                    {"fit", fits},
                    {"links", link_laws(problem, posterior, models)},
                    {"best_draw", best_draws},
                    {"fit_at_best_draw", best_fits},
                    {"predictive", coverage(problem, predictive)},
                    {"data",
                     {{"origin", sid_case.origin},
                      {"simulated", sid_case.simulated},
                      {"sample_rate", sid_case.sample_rate_hz},
                      {"samples", {sid_case.begin, sid_case.end}},
                      {"lead_in", sid_case.lead_in},
                      {"responses", channels},
                      {"window_against_record", window}}},
                    {"integration",
                     {{"upsampled", sid_case.stride},
                      {"substeps_at_posterior_mean", substeps},
                      {"step_limit", sid_case.integration.step_limit},
                      {"error_of_steps", step_errors},
                      {"seconds_a_likelihood", problem.seconds_a_likelihood}}},
                    {"diagnostics", diagnostics(posterior, verdict, info.seed, warnings)},
                    {"cost", cost(posterior)}};
  if (!evidence.empty()) summary["evidence"] = compared;
  if (sid_case.truth && sid_case.simulated) {
    summary["data"]["truth"] = sid_case.file.json["truth"];
  }
  return summary;
}

}  // namespace wheeltap::apps
