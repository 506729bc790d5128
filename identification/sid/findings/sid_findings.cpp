#include "identification/sid/findings/sid_findings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "identification/findings/prior_bound.hpp"
#include "identification/sid/findings/sid_fit_verdict.hpp"
#include "identification/sid/findings/sid_windows.hpp"
#include "identification/sid/sid_record.hpp"
#include "identification/sid/sid_units.hpp"

namespace wheeltap::identification {
namespace {

using inference::Posterior;

constexpr double kWorthJudging = 0.05;  // less probable models are not judged
constexpr double kNotReached = 0.9;     // share of draws in which the gap never closes

/// The models that remarks discuss.
std::vector<int> judged_models(const SidFindings& findings) {
  std::vector<int> list;
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    if (findings.models[m].probability() >= kWorthJudging && findings.of_models[m]) {
      list.push_back(static_cast<int>(m));
    }
  }
  return list;
}

const SidModelFinding& finding(const SidFindings& findings, int m) {
  return *findings.of_models[static_cast<std::size_t>(m)];
}

/// Reports models whose mean parameters fit badly: the posterior has several peaks or is curved, so
/// that its mean is outside the probable regions.
void judge_means(const SidProblem& problem, const Posterior& posterior, SidFindings& findings) {
  const auto likelihood = problem.problem.likelihood();
  for (const int m : judged_models(findings)) {
    const SidModelFinding& found = finding(findings, m);
    const double lost = likelihood->log_likelihood(m, found.best_draw) -
                        likelihood->log_likelihood(m, mean_draw(problem, posterior, m));
    const auto dimension = static_cast<double>(found.best_draw.size());
    if (lost < 10.0 + 3.0 * dimension) continue;  // for a normal posterior: about d / 2
    remark::MeansDoNotGoTogether remark{.model = problem.problem.space[m].name, .channels = {}};
    for (std::size_t c = 0; c < found.at_mean.size(); ++c) {
      const ChannelFit &mean = found.at_mean[c], &best = found.at_best[c];
      if (!std::isfinite(mean.nrmse) || !std::isfinite(best.nrmse)) continue;
      remark.channels.push_back({mean.channel, mean.nrmse, best.nrmse});
    }
    findings.remarks.push_back(std::move(remark));
  }
}

/// True if the fit verdict already names this response of the model.
bool is_named(const FitVerdict& verdict, int model, const ChannelFit& fit) {
  const auto& why = verdict.instead_of == model ? verdict.why_not : verdict.why;
  return (verdict.model == model || verdict.instead_of == model) &&
         std::ranges::any_of(why, [&](const auto& reason) {
           return std::visit(
               [&](const auto& r) {
                 if constexpr (requires { r.channel; }) return r.channel == fit.channel;
                 return false;
               },
               reason);
         });
}

/// True if the residuals of two models are so similar that one remark covers both models.
bool are_similar(const remark::ColouredResiduals& a, const remark::ColouredResiduals& b) {
  return a.residual_model == b.residual_model &&
         std::ranges::equal(a.channels, b.channels, [](const auto& x, const auto& y) {
           return x.name == y.name && x.lag == y.lag &&
                  std::abs(x.autocorrelation - y.autocorrelation) < 0.05 &&
                  std::abs(x.share - y.share) < 0.05 * x.share;
         });
}

void add_remark(remark::ColouredResiduals coloured, std::vector<Remark>& remarks) {
  for (Remark& remark : remarks) {
    auto* before = std::get_if<remark::ColouredResiduals>(&remark);
    if (before != nullptr && are_similar(*before, coloured)) {
      before->others.push_back(std::move(coloured.model));
      return;
    }
  }
  remarks.emplace_back(std::move(coloured));
}

/// Adds remarks on noise and residuals, from the forward runs of the important models.
void judge_fits(const SidProblem& problem, SidFindings& findings) {
  const double n = static_cast<double>(problem.misfits.front().samples());
  for (const int m : judged_models(findings)) {
    const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
    remark::NoiseMisstated off{.model = model.name, .channels = {}};
    remark::ColouredResiduals coloured{.model = model.name, .channels = {}};
    if (!model.residuals.model->is_white()) {
      coloured.residual_model = model.residuals.model->words().name;
      coloured.remedy = model.residuals.model->words().remedy;
    }
    const std::vector<ChannelFit>& fits = finding(findings, m).at_best;
    for (std::size_t c = 0; c < fits.size(); ++c) {
      const ChannelFit& fit = fits[c];
      if (fit.whiteness && !fit.whiteness->white() && !is_named(findings.fit_verdict, m, fit)) {
        coloured.channels.push_back({fit.channel, fit.whiteness->worst_lag, fit.whiteness->worst,
                                     fit.nrmse, fit.whiteness->test.p_value});
      }
      const bool white = fit.plain_whiteness && fit.plain_whiteness->test.p_value >= kMisfit;
      if (fit.r2 < 0.5 && white) {
        findings.remarks.push_back(remark::MostlyNoise{model.name, fit.channel, fit.r2});
      }
      const double ratio = fit.mse / std::pow(fit.noise_sd, 2);
      if (model.noise[c].is_constant() && std::abs(ratio - 1.0) > 6.0 * std::sqrt(2.0 / n)) {
        off.channels.push_back({fit.channel, std::sqrt(ratio)});
      }
    }
    if (!off.channels.empty()) findings.remarks.push_back(std::move(off));
    if (!coloured.channels.empty()) add_remark(std::move(coloured), findings.remarks);
  }
}

/// Fraction of the model's draws in which the law acts only beyond `reach`; 0 for laws without a
/// threshold.
double share_beyond(const SidProblem& problem, const Posterior& posterior, int m,
                    const dynamics::Law& law, double reach) {
  double share = 0.0;
  dynamics::LawList::visit(law.kind, [&]<class L>(L) {
    if constexpr (dynamics::kPiecewiseLinear<L>) {
      const auto width = static_cast<std::size_t>(posterior.dimension);
      long beyond = 0, all = 0;
      for (const auto& chain : posterior.chains) {
        for (std::size_t i = 0; i < chain.model.size(); ++i) {
          if (chain.model[i] != m) continue;
          const auto theta = problem.theta(m, {chain.theta.data() + i * width, width});
          std::array<double, dynamics::kMaxLawCoefficients> c{};
          for (std::size_t j = 0; j < c.size(); ++j) c[j] = law.coefficients[j].at(theta);
          ++all, beyond += L::threshold(c.data()) > reach ? 1 : 0;
        }
      }
      share = all > 0 ? static_cast<double>(beyond) / static_cast<double>(all) : 0.0;
    }
  });
  return share;
}

/// Reports posteriors that pile up at a bound of their prior.
void judge_bounds(const SidProblem& problem, const Posterior& posterior, SidFindings& findings) {
  const auto& space = problem.problem.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  for (const int m : judged_models(findings)) {
    for (int p = 0; p < space[m].dimension; ++p) {
      const inference::Prior& prior = space.prior(m, p);
      std::vector<double> draws;
      for (const auto& chain : posterior.chains)
        for (std::size_t i = 0; i < chain.model.size(); ++i)
          if (chain.model[i] == m)
            draws.push_back(chain.theta[i * width + static_cast<std::size_t>(p)]);
      if (const PriorBound bound = bound_of(prior, draws); bound != PriorBound::none) {
        findings.remarks.push_back(remark::ParameterAtBound{.model = space[m].name,
                                                            .parameter = space.parameter_name(m, p),
                                                            .prior = prior.describe(),
                                                            .upper = bound == PriorBound::upper});
      }
    }
  }
}

/// Extends the curves to the extensions in the further records; false if a simulation fails.
bool widen(const SidProblem& problem, const Posterior& posterior, int m,
           std::vector<LinkCurve>& curves) {
  for (const auto& record : problem.further) {
    const auto more = link_laws(*record, posterior, m);
    if (!more || more->size() != curves.size()) return false;
    for (std::size_t l = 0; l < curves.size(); ++l) {
      std::vector<double>& e = curves[l].extension;
      const std::vector<double>& other = (*more)[l].extension;
      e.front() = std::min(e.front(), other.front());
      e.back() = std::max(e.back(), other.back());
    }
  }
  return true;
}

/// Reports stops that the motion never reaches: the data give only a lower bound of the gap.
void judge_stops(const SidRun& run, SidFindings& findings) {
  const SidProblem& problem = *run.problem;
  const Posterior& posterior = run.posterior;
  if (run.engine.prior_only) return;
  for (const int m : judged_models(findings)) {
    auto curves = finding(findings, m).links;
    if (!curves || !widen(problem, posterior, m, *curves)) continue;
    const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
    for (const dynamics::Link& link : model.chain.links) {
      const auto curve = std::ranges::find_if(
          *curves, [&](const LinkCurve& c) { return c.a == link.a && c.b == link.b; });
      if (curve == curves->end()) continue;
      for (const dynamics::Law& law : link.laws) {
        const bool opening = law.side == dynamics::Side::opening;
        const double reach = opening ? curve->extension.back() : -curve->extension.front();
        const double share = share_beyond(problem, posterior, m, law, reach);
        if (share < kNotReached) continue;
        findings.remarks.push_back(remark::StopNotReached{
            .model = model.name,
            .law = std::string(dynamics::law_infos()[static_cast<std::size_t>(law.kind)].name),
            .a = link.a,
            .b = link.b,
            .opening = opening,
            .reach = reach,
            .share = share});
      }
    }
  }
}

std::vector<std::vector<ChannelFit>> further_fits(const SidProblem& problem, int model,
                                                  std::span<const double> theta) {
  std::vector<std::vector<ChannelFit>> out;
  for (const auto& record : problem.further) out.push_back(forward_run(*record, model, theta));
  return out;
}

/// Fits the windows separately and reports the agreement of the estimates.
void judge_windows(const SidRun& run, SidFindings& findings) {
  const SidProblem& problem = *run.problem;
  if (problem.sid_case.windows == 0 && problem.further.empty()) return;
  if (run.engine.quick || run.posterior.stopped_early || run.engine.prior_only) return;
  for (const int m : judged_models(findings)) {
    ModelFinding& model = findings.models[static_cast<std::size_t>(m)];
    const ModelWindows windows =
        fit_windows(problem, m, finding(findings, m).best_draw, run.engine.threads);
    findings.windows_evaluations += windows.likelihood_evaluations;
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      model.parameters[p].between_windows = windows.parameters[p];
    }
    for (Remark& remark : window_remarks(problem, m, windows)) {
      findings.remarks.push_back(std::move(remark));
    }
  }
}

/// Reports integration steps so long that they change the posterior.
void judge_integration(const SidProblem& problem, SidFindings& findings) {
  for (const int m : judged_models(findings)) {
    const double error = finding(findings, m).step_error.value_or(0.0);
    if (error <= kLargestStepError) continue;
    findings.remarks.push_back(
        remark::StepsTooLong{.model = findings.models[static_cast<std::size_t>(m)].name,
                             .error = error,
                             .fixed = problem.sid_case.fixed_integration});
  }
}

/// Bayes factors from the model probabilities. If either probability comes from evidences, the
/// evidences are used instead, because they do not underflow.
std::vector<BayesFactor> bayes_factors(const Posterior& posterior,
                                       const std::vector<ModelFinding>& models) {
  const inference::ModelSpace& space = *posterior.space;
  using inference::Basis;
  const inference::ModelStanding& first = models[0].standing;
  std::vector<BayesFactor> out;
  for (int m = 1; m < space.size(); ++m) {
    const inference::ModelStanding& one = models[static_cast<std::size_t>(m)].standing;
    const bool by_evidence = one.basis == Basis::evidence || first.basis == Basis::evidence;
    BayesFactor factor{.model = m,
                       .against = 0,
                       .log = {},
                       .error = std::nan(""),
                       .basis = by_evidence ? Basis::evidence : Basis::draws};
    if (by_evidence && std::isfinite(one.log_evidence) && std::isfinite(first.log_evidence)) {
      factor.log = one.log_evidence - first.log_evidence;
      factor.error = std::hypot(one.log_evidence_se, first.log_evidence_se);
    } else if (!by_evidence && one.probability > 0.0 && first.probability > 0.0) {
      factor.log = std::log(one.probability) - std::log(first.probability) -
                   (space[m].log_prior - space[0].log_prior);
      // Model probabilities add to 1 and are correlated; log_bayes_factor includes this.
      factor.error = inference::log_bayes_factor(posterior, m, 0).mcse;
    }
    out.push_back(factor);
  }
  return out;
}

/// The terms, and the force laws of their links, averaged over all models.
Discovery discovered(const SidProblem& problem, const Posterior& posterior,
                     const Findings& findings) {
  Discovery out{.terms = term_findings(problem.sid_case, posterior, findings), .laws = {}};
  if (out.terms.empty()) return out;
  std::set<int> links;
  for (const SidTerm& term : problem.sid_case.discovery->terms) links.insert(term.link);
  int shown = -1;
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    const ModelFinding& model = findings.models[static_cast<std::size_t>(m)];
    if (!model.drawn()) continue;
    if (shown < 0 ||
        model.probability() > findings.models[static_cast<std::size_t>(shown)].probability()) {
      shown = m;
    }
  }
  out.laws = averaged_laws(problem, posterior, shown, {links.begin(), links.end()});
  return out;
}

}  // namespace

SidFindings sid_findings(const SidRun& run, const SidPredictive& predictive,
                         const std::vector<MethodEvidence>& evidence) {
  const SidProblem& problem = *run.problem;
  const Posterior& posterior = run.posterior;
  const auto& space = problem.problem.space;
  SidFindings out;
  static_cast<Findings&>(out) =
      run_findings(posterior, inference::judge(posterior), run.engine.seed);
  const auto units = parameter_units(problem.sid_case);
  for (ModelFinding& model : out.models) {
    for (ParameterFinding& p : model.parameters) {
      p.unknown.unit = units.at(p.unknown.name);
    }
  }
  out.look = run.look;
  out.refined = run.refined;
  for (int m = 0; m < space.size(); ++m) {
    const ModelFinding& model = out.models[static_cast<std::size_t>(m)];
    out.of_models.emplace_back();
    if (!model.drawn()) continue;
    const std::span<const double> best = best_draw(problem, posterior, m);
    const auto mean = posterior_mean(problem, posterior, m);
    out.of_models.back() = SidModelFinding{
        .best_draw = {best.begin(), best.end()},
        .at_mean = forward_run(problem, m, mean),
        .at_best = forward_run(problem, m, problem.theta(m, best)),
        .further = further_fits(problem, m, problem.theta(m, best)),
        .substeps = problem.misfits[static_cast<std::size_t>(m)].simulator().substeps(mean),
        .step_error = step_error(problem, posterior, m),
        .links = {},
        .modes = {}};
    if (model.probability() >= kWorthJudging) {
      out.of_models.back()->links = link_laws(problem, posterior, m);
      out.of_models.back()->modes = chain_modes(problem, posterior, m);
    }
  }
  out.bayes_factors = bayes_factors(posterior, out.models);
  out.coverage = coverage(problem, predictive);
  out.predictive_draws = static_cast<int>(predictive.draws.size());
  out.discovery = discovered(problem, posterior, out);
  out.remarks = run.doubts;
  for (Remark& remark : record_remarks(problem.sid_case)) out.remarks.push_back(std::move(remark));
  out.fit_verdict = judge_fit(problem, posterior, predictive, out);
  if (const FitVerdict& fit = out.fit_verdict; fit.instead_of >= 0) {
    const auto name = [&](int m) { return out.models[static_cast<std::size_t>(m)].name; };
    out.remarks.push_back(
        remark::MostProbableFails{name(fit.instead_of), name(fit.model), fit.why_not});
  }
  judge_means(problem, posterior, out);
  judge_fits(problem, out);
  judge_bounds(problem, posterior, out);
  judge_stops(run, out);
  judge_integration(problem, out);
  judge_windows(run, out);
  conclude(out, space, evidence);
  return out;
}

}  // namespace wheeltap::identification
