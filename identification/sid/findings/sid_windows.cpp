#include "identification/sid/findings/sid_windows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"
#include "inference/evidence/laplace.hpp"
#include "inference/statistics/grouped_scores.hpp"

namespace wheeltap::identification {
namespace {

using inference::GroupEstimate, inference::LineMixture;

constexpr double kFurthest = 6.0;       // start points, in standard deviations of the prior
constexpr double kWorthKeeping = 1e-3;  // likelihood's precision over the prior's

/// The posterior mode for the whole record, and the inverse of the negative Hessian at this mode;
/// not finite if there is no mode.
struct WholeFit {
  std::vector<double> z;
  Eigen::MatrixXd covariance;
  long likelihood_evaluations = 0;
};

/// One window's posterior of a model's parameters, in normal approximation.
struct WindowFit {
  inference::GroupScore at_whole;  ///< its likelihood near the whole record's mode
  bool normal = false;
  std::vector<double> z, variance;
  std::vector<bool> rough;
  long likelihood_evaluations = 0;
};

/// True if ln π, two sds of parameter i away from the mode, differs from that of a normal density.
bool is_rough(inference::ModelPosterior& posterior, const inference::Laplace& at, double top,
              Eigen::Index i) {
  for (const double side : {-2.0, 2.0}) {
    std::vector<double> z = at.z;
    for (std::size_t j = 0; j < z.size(); ++j) {
      z[j] +=
          side * at.covariance(static_cast<Eigen::Index>(j), i) / std::sqrt(at.covariance(i, i));
    }
    const double fall = top - posterior(z).log_posterior();
    if (!(fall > 1.0 && fall < 4.0)) return true;
  }
  return false;
}

WholeFit fit_whole(const SidProblem& problem, int model, std::vector<double> start) {
  try {
    inference::Laplace at =
        inference::laplace(problem.problem, model, {.start = start, .check = false});
    return {.z = std::move(at.z),
            .covariance = std::move(at.covariance),
            .likelihood_evaluations = at.evidence.likelihood_evaluations};
  } catch (const inference::LikelihoodError&) {
    return {.z = std::move(start), .covariance = Eigen::MatrixXd::Constant(1, 1, kNaN)};
  }
}

/// Score and information of the likelihood at the whole record's mode, by differences over 0.3
/// conditional standard deviations of each parameter.
inference::GroupScore whole_score(inference::ModelPosterior& posterior, const WholeFit& whole) {
  const auto d = static_cast<Eigen::Index>(whole.z.size());
  const Eigen::VectorXd h = 0.3 * whole.covariance.inverse().diagonal().cwiseSqrt().cwiseInverse();
  const auto at = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
    std::vector<double> z = whole.z;
    z[static_cast<std::size_t>(i)] += a * h[i];
    z[static_cast<std::size_t>(j)] += b * h[j];
    return posterior(z).log_likelihood;
  };
  const double top = at(0, 0.0, 0, 0.0);
  inference::GroupScore out{.score = Eigen::VectorXd(d), .information = Eigen::MatrixXd(d, d)};
  Eigen::VectorXd both(d);  // second differences
  for (Eigen::Index i = 0; i < d; ++i) {
    const double up = at(i, 1.0, i, 0.0), down = at(i, -1.0, i, 0.0);
    both[i] = up + down - 2.0 * top;
    out.score[i] = (up - down) / (2.0 * h[i]);
    out.information(i, i) = -both[i] / (h[i] * h[i]);
    for (Eigen::Index j = 0; j < i; ++j) {
      const double together = at(i, 1.0, j, 1.0) + at(i, -1.0, j, -1.0) - 2.0 * top;
      out.information(i, j) = out.information(j, i) =
          -(together - both[i] - both[j]) / (2.0 * h[i] * h[j]);
    }
  }
  return out;
}

WindowFit fit_window(const SidCase& sid_case, int model, const WholeFit& whole) {
  SidCase alone = sid_case;
  alone.models = {sid_case.models[static_cast<std::size_t>(model)]};
  const auto problem = make_sid_problem(std::move(alone));
  WindowFit out;
  try {
    inference::ModelPosterior posterior(problem->problem, 0);
    if (whole.covariance.allFinite()) out.at_whole = whole_score(posterior, whole);
    const inference::Laplace at =
        inference::laplace(problem->problem, 0, {.start = whole.z, .check = false});
    out.likelihood_evaluations = at.evidence.likelihood_evaluations + posterior.evaluations();
    if (!at.covariance.allFinite()) return out;
    out.normal = true;
    out.z = at.z;
    const double top = posterior(at.z).log_posterior();
    for (Eigen::Index i = 0; i < at.covariance.rows(); ++i) {
      out.variance.push_back(at.covariance(i, i));
      out.rough.push_back(is_rough(posterior, at, top, i));
    }
    out.likelihood_evaluations = at.evidence.likelihood_evaluations + posterior.evaluations();
  } catch (const inference::LikelihoodError&) {
    out.normal = false;  // the model cannot reproduce this window near `start`
  }
  return out;
}

/// Divides a window's posterior N(z, variance) by the prior N(0, 1).
GroupEstimate without_prior(double z, double variance) {
  const double precision = 1.0 / variance - 1.0;
  if (precision < kWorthKeeping) return {0.0, std::numeric_limits<double>::infinity()};
  return {z / variance / precision, 1.0 / std::sqrt(precision)};
}

Interval physical(const LineMixture& z, const inference::Prior& prior) {
  const auto x = [&](double at) { return prior.from_standard_normal(at); };
  const double mean = z.expectation(x);
  const double variance = z.expectation([&](double at) { return std::pow(x(at) - mean, 2); });
  return {.mean = mean,
          .sd = std::sqrt(variance),
          .q2_5 = x(z.quantile(0.025)),
          .q5 = x(z.quantile(0.05)),
          .q50 = x(z.quantile(0.5)),
          .q95 = x(z.quantile(0.95)),
          .q97_5 = x(z.quantile(0.975))};
}

/// Error of the whole record's mode; empty if the score of a window is not finite at this mode.
std::vector<inference::GroupedError> whole_errors(const WholeFit& whole,
                                                  const std::vector<WindowFit>& fits) {
  const auto d = static_cast<Eigen::Index>(whole.z.size());
  std::vector<inference::GroupScore> groups;
  for (const WindowFit& fit : fits) {
    groups.push_back(fit.at_whole);
    const auto& [score, information] = groups.back();
    if (score.size() != d || !score.allFinite() || !information.allFinite()) return {};
  }
  return inference::grouped_errors(groups, Eigen::MatrixXd::Identity(d, d));
}

Interval about(double z, const inference::GroupedError& error, const inference::Prior& prior) {
  const auto x = [&](double p) { return prior.from_standard_normal(z + error.quantile(p)); };
  return {.mean = prior.from_standard_normal(z),
          .sd = error.sd * prior.slope(z),
          .q2_5 = x(0.025),
          .q5 = x(0.05),
          .q50 = x(0.5),
          .q95 = x(0.95),
          .q97_5 = x(0.975)};
}

std::optional<BetweenWindows> between(const std::vector<WindowFit>& fits, std::size_t i,
                                      const inference::Prior& prior) {
  std::vector<GroupEstimate> groups;
  BetweenWindows out;
  for (const WindowFit& fit : fits) {
    out.value.push_back(kNaN), out.sd.push_back(kNaN);
    if (!fit.normal) continue;
    groups.push_back(without_prior(fit.z[i], fit.variance[i]));
    if (!std::isfinite(groups.back().sd)) continue;
    out.value.back() = prior.from_standard_normal(groups.back().mean);
    out.sd.back() = groups.back().sd * prior.slope(groups.back().mean);
  }
  if (std::ranges::count_if(groups, [](const auto& g) { return std::isfinite(g.sd); }) < 2) {
    return {};
  }
  const auto h = inference::hierarchical_posterior(groups);
  out.next = physical(h.estimate, prior);
  out.scatter = inference::birge_ratio(groups);
  return out;
}

/// True if a parameter of the case is a part of the initial state.
bool is_initial(const SidModel& model, int parameter) {
  const auto holds = [&](const std::vector<dynamics::Coefficient>& state) {
    return std::ranges::any_of(state, [&](const auto& c) { return c.parameter == parameter; });
  };
  return holds(model.initial.displacement) || holds(model.initial.velocity);
}

}  // namespace

std::vector<std::pair<int, int>> window_bounds(const SidCase& sid_case) {
  std::vector<std::pair<int, int>> out;
  const long all = sid_case.end - sid_case.begin;
  const int windows = std::max(1, sid_case.windows);
  const auto at = [&](int w) { return sid_case.begin + static_cast<int>(all * w / windows); };
  for (int w = 0; w < windows; ++w) out.emplace_back(at(w), at(w + 1));
  return out;
}

SidCase window_case(SidCase sid_case, int first, int last) {
  sid_case.further.clear();
  const auto samples = static_cast<std::size_t>(last - sid_case.begin + sid_case.lead_in);
  for (SidChannel& channel : sid_case.channels) {
    const std::size_t kept = channel.is_excitation()
                                 ? (samples - 1) * static_cast<std::size_t>(sid_case.stride) + 1
                                 : samples;
    if (channel.signal.samples.size() > kept) channel.signal.samples.resize(kept);
    channel.beyond.clear();
  }
  sid_case.beyond = 0;
  sid_case.lead_in += first - sid_case.begin;
  sid_case.begin = first;
  sid_case.end = last;
  return sid_case;
}

ModelWindows fit_windows(const SidProblem& problem, int m, std::span<const double> start,
                         int threads) {
  const SidCase& sid_case = problem.sid_case;
  const auto& space = problem.problem.space;
  struct Window {
    const SidCase* record;
    int first, last;
  };
  std::vector<Window> windows;
  for (const SidCase* record : sid_case.records()) {
    for (const auto& [first, last] : window_bounds(*record)) {
      windows.push_back({record, first, last});
    }
  }
  std::vector<double> z;
  for (std::size_t p = 0; p < start.size(); ++p) {
    z.push_back(std::clamp(space.prior(m, static_cast<int>(p)).to_standard_normal(start[p]),
                           -kFurthest, kFurthest));
  }
  const WholeFit whole = fit_whole(problem, m, z);
  std::vector<WindowFit> fits(windows.size());
  base::parallel_for(static_cast<int>(windows.size()), threads, [&](int w) {
    const auto [record, first, last] = windows[static_cast<std::size_t>(w)];
    fits[static_cast<std::size_t>(w)] = fit_window(window_case(*record, first, last), m, whole);
  });
  ModelWindows out{.windows = static_cast<int>(windows.size())};
  out.likelihood_evaluations = whole.likelihood_evaluations;
  const auto errors = whole_errors(whole, fits);
  for (const WindowFit& fit : fits) {
    out.fitted += fit.normal ? 1 : 0;
    out.likelihood_evaluations += fit.likelihood_evaluations;
  }
  const std::vector<int>& used = sid_case.models[static_cast<std::size_t>(m)].parameters;
  for (std::size_t i = 0; i < z.size(); ++i) {
    const bool nuisance = std::ranges::any_of(sid_case.records(), [&](const SidCase* record) {
      return is_initial(record->models[static_cast<std::size_t>(m)], used[i]);
    });
    out.parameters.push_back(nuisance ? std::nullopt
                                      : between(fits, i, space.prior(m, static_cast<int>(i))));
    if (out.parameters.back() && !errors.empty()) {
      out.parameters.back()->whole =
          about(whole.z[i], errors[i], space.prior(m, static_cast<int>(i)));
    }
    out.rough.push_back(
        nuisance ? 0 : static_cast<int>(std::ranges::count_if(fits, [&](const WindowFit& fit) {
          return fit.normal && fit.rough[i];
        })));
  }
  return out;
}

std::vector<Remark> window_remarks(const SidProblem& problem, int m, const ModelWindows& windows) {
  const auto& space = problem.problem.space;
  const int all = windows.windows;
  remark::ScatterBetweenWindows scatter{.model = space[m].name, .windows = all, .parameters = {}};
  remark::WindowsUnsound unsound{
      .model = space[m].name, .windows = all, .failed = all - windows.fitted, .rough = {}};
  for (std::size_t i = 0; i < windows.parameters.size(); ++i) {
    const std::string name = space.parameter_name(m, static_cast<int>(i));
    if (4 * windows.rough[i] > windows.fitted) unsound.rough.push_back(name);
    if (!windows.parameters[i]) continue;
    const BetweenWindows& between = *windows.parameters[i];
    if (between.scatters()) scatter.parameters.push_back({name, between.scatter.ratio});
  }
  std::vector<Remark> out;
  if (!scatter.parameters.empty()) out.emplace_back(std::move(scatter));
  if (unsound.failed > 0 || !unsound.rough.empty()) out.emplace_back(std::move(unsound));
  return out;
}

}  // namespace wheeltap::identification
