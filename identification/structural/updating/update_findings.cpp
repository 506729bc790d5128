#include "identification/structural/updating/update_findings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "identification/structural/likelihood/mode_contributions.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using inference::ChainsOf;
using inference::Posterior;

/// Number of draws that are solved again, with shapes.
constexpr std::size_t kExamined = 2000;

/// Draws in standard normal coordinates, one per row; thinned above a million draws.
MatrixXd coordinates(const UpdateProblem& problem, const Posterior& posterior) {
  const auto& space = problem.problem.space;
  constexpr std::size_t kEnough = 1 << 20;
  std::size_t all = 0, kept = 0;
  for (const auto& chain : posterior.chains) all += chain.size();
  const std::size_t step = std::max<std::size_t>(1, (all + kEnough - 1) / kEnough);
  for (const auto& chain : posterior.chains) kept += (chain.size() + step - 1) / step;
  MatrixXd z(static_cast<Index>(kept), posterior.dimension);
  Index row = 0;
  for (std::size_t c = 0; c < posterior.chains.size(); ++c)
    for (std::size_t i = 0; i < posterior.chains[c].size(); i += step, ++row) {
      const auto x = posterior.theta(c, i);
      for (Index p = 0; p < z.cols(); ++p)
        z(row, p) = std::clamp(
            space.prior(0, static_cast<int>(p)).to_standard_normal(x[static_cast<std::size_t>(p)]),
            -8.0, 8.0);
    }
  return z;
}

void judge_parameters(const UpdateProblem& problem, const Posterior& posterior,
                      const MatrixXd& within, UpdateFindings& out) {
  const auto& space = problem.problem.space;
  const MatrixXd z = coordinates(problem, posterior);
  const VectorXd mean = z.colwise().mean();
  const MatrixXd centred = z.rowwise() - mean.transpose();
  const MatrixXd covariance =
      centred.transpose() * centred / static_cast<double>(std::max<Index>(1, z.rows() - 1));
  const auto d = static_cast<Index>(problem.structural);
  const auto name = [&](Index p) { return space.parameter_name(0, static_cast<int>(p)); };
  for (Index p = 0; p < z.cols(); ++p) {
    Contraction c{.name = name(p), .contraction = 1.0 - covariance(p, p), .shift = mean[p]};
    const inference::Prior& prior = space.prior(0, static_cast<int>(p));
    std::vector<double> x;
    for (std::size_t chain = 0; chain < posterior.chains.size(); ++chain)
      for (std::size_t i = 0; i < posterior.chains[chain].size(); ++i)
        x.push_back(posterior.theta(chain, i)[static_cast<std::size_t>(p)]);
    using Bound = Contraction::Bound;
    c.bound = bound_of(prior, x);
    if (c.bound != Bound::none)
      out.remarks.push_back(remark::ParameterAtBound{.model = space[0].name,
                                                     .parameter = c.name,
                                                     .prior = prior.describe(),
                                                     .upper = c.bound == Bound::upper});
    out.contractions.push_back(std::move(c));
  }
  for (Index a = 0; a < z.cols(); ++a)
    for (Index b = a + 1; b < z.cols(); ++b) {
      // Over several separate solutions, parameters are correlated even if each solution determines
      // them.
      const MatrixXd& c = within.size() > 0 ? within : covariance;
      const double r = c(a, b) / std::sqrt(c(a, a) * c(b, b));
      if (std::abs(r) > kEntangled) out.entangled.push_back({name(a), name(b), r});
    }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(MatrixXd(covariance.topLeftCorner(d, d)));
  for (Index k = d - 1; k >= 0; --k) {
    const double contraction = 1.0 - axes.eigenvalues()[k];
    if (contraction >= kUntouched) break;
    UntouchedDirection direction{.contraction = contraction, .weights = {}};
    VectorXd w = axes.eigenvectors().col(k);
    Index largest = 0;
    w.cwiseAbs().maxCoeff(&largest);
    if (w[largest] < 0.0) w = -w;
    for (Index p = 0; p < d; ++p)
      if (std::abs(w[p]) >= 0.3) direction.weights.emplace_back(name(p), w[p]);
    std::ranges::sort(direction.weights, std::ranges::greater{},
                      [](const auto& entry) { return std::abs(entry.second); });
    out.untouched.push_back(std::move(direction));
  }
}

/// Draws that were solved again.
struct Examined {
  std::vector<std::vector<double>> x;
  std::vector<double> log_likelihood;
  std::vector<ModalLikelihood::Score> scores;
  std::vector<VectorXd> densities;       // per draw, ln p of each mode given the others
  std::vector<MatrixXd> covariances;     // per draw, of the measured frequencies
  std::vector<VectorXd> frequencies_hz;  // per draw, all computed modes
  std::size_t best = 0;
};

Examined examine(const UpdateProblem& problem, const Posterior& posterior, UpdateFindings& out) {
  Examined seen;
  StructuralPredictor predictor(problem);
  ModeObservation::Scored scored;
  const auto add = [&](std::span<const double> x) {
    if (!predictor.score(0, x, scored)) return;
    const fem::ParametricModes::Modes& modes = scored.modes.back();
    seen.x.emplace_back(x.begin(), x.end());
    seen.scores.push_back(scored.score);
    std::vector<int> with;
    const ModalNoise noise = problem.noise(x);
    const ModeObservation& observed = problem.modes();
    seen.covariances.push_back(observed.covariance(scored, noise, with));
    seen.densities.push_back(observed.with_errors(noise)
                                 ? observed.single_mode_densities(scored, noise)
                                 : single_mode_densities(problem.update_case.data, with,
                                                         seen.covariances.back(), scored.score));
    seen.log_likelihood.push_back(scored.score.log_likelihood);
    seen.frequencies_hz.emplace_back(modes.eigenvalues.cwiseSqrt() / (2.0 * M_PI));
    out.in_full +=
        problem.basis() != nullptr && modes.in_full && !problem.basis()->training().complete;
  };
  const std::size_t chains = posterior.chains.size(), draws = posterior.chains[0].model.size();
  const std::size_t stride = std::max<std::size_t>(1, chains * draws / kExamined);
  for (std::size_t c = 0; c < chains; ++c)
    for (std::size_t i = 0; i < posterior.chains[c].model.size(); i += stride)
      add(posterior.theta(c, i));
  out.examined = static_cast<int>(seen.x.size());
  // Last, the best of all draws; it is not included in averages.
  const auto [chain, draw] = posterior.best_draw();
  add(posterior.theta(chain, draw));
  seen.best = seen.x.size() - 1;
  return seen;
}

template <class Value>
Marginal marginal_of(const UpdateFindings& out, const Value& value) {
  std::vector<double> draws;
  for (std::size_t i = 0; i < static_cast<std::size_t>(out.examined); ++i)
    draws.push_back(value(i));
  return marginal({draws});
}

void leave_one_out(const UpdateProblem& problem, const Examined& seen, UpdateFindings& out) {
  const auto draws = static_cast<std::size_t>(out.examined);
  std::vector<std::vector<double>> l(out.modes.size());
  for (std::size_t s = 0; s < draws; ++s) {
    for (std::size_t m = 0; m < l.size(); ++m)
      l[m].push_back(seen.densities[s][static_cast<Index>(m)]);
  }
  for (std::size_t m = 0; m < out.modes.size(); ++m) {
    const WithoutMode left = without_mode(l[m]);
    ModeFinding& finding = out.modes[m];
    finding.information = left.information;
    finding.reliable = left.reliable;
    for (int p = 0; p < problem.structural; ++p) {
      const auto place = static_cast<std::size_t>(p);
      double with = 0.0, without = 0.0, variance = 0.0;
      for (std::size_t s = 0; s < draws; ++s) {
        with += seen.x[s][place] / static_cast<double>(draws);
        without += seen.x[s][place] * left.weights[s];
      }
      for (std::size_t s = 0; s < draws; ++s)
        variance += std::pow(seen.x[s][place] - with, 2) / static_cast<double>(draws);
      const double moved = variance > 0.0 ? (without - with) / std::sqrt(variance) : 0.0;
      if (std::abs(moved) > std::abs(finding.moved)) {
        finding.moved = moved;
        finding.moves = problem.problem.space.parameter_name(0, p);
      }
    }
  }
}

void judge_modes(const UpdateProblem& problem, const Examined& seen, UpdateFindings& out) {
  const ModalData& data = problem.update_case.data;
  for (int i = 0; i < data.modes(); ++i) {
    const auto m = static_cast<std::size_t>(i);
    ModeFinding f{.mode = i + 1, .measured_hz = data.frequencies_hz[m], .sd_hz = kNaN};
    if (problem.states() != nullptr) {
      StructuralProblem::Row row = problem.row(i);
      f.state = std::move(row.state);
      f.mode_of_state = row.mode;
    }
    const auto match = [&](std::size_t s) -> const auto& {
      return seen.scores[s].matches[m];
    };
    f.frequency_hz = marginal_of(out, [&](std::size_t s) { return match(s).frequency_hz; });
    std::map<int, int> tally;
    double residual = 0.0, sd = 0.0;
    for (std::size_t s = 0; s < static_cast<std::size_t>(out.examined); ++s) {
      ++tally[match(s).computed];
      const double here = std::sqrt(problem.covariance(problem.noise(seen.x[s]))(i, i));
      sd += here / out.examined;
      residual += (f.measured_hz - match(s).frequency_hz) / here / out.examined;
      f.spurious += match(s).spurious / out.examined;
    }
    const bool has_frequency = !std::isnan(f.measured_hz);
    f.sd_hz = has_frequency ? sd : kNaN;
    f.residual = has_frequency ? residual : kNaN;
    const auto most = std::ranges::max_element(tally, {}, [](const auto& e) { return e.second; });
    f.computed = most->first + 1;
    f.matched = static_cast<double>(most->second) / out.examined;
    if (const auto& shape = problem.shape(i)) {
      f.has_shape = true;
      f.shape_freedoms = shape->freedoms();
      f.mac = marginal_of(out, [&](std::size_t s) { return match(s).shape->mac; });
      double p = 0.0;
      for (std::size_t s = 0; s < static_cast<std::size_t>(out.examined); ++s) {
        f.shape_chi_square += match(s).shape->chi_square / out.examined;
        p += chi_square_tail(f.shape_freedoms, match(s).shape->chi_square) / out.examined;
      }
      f.shape_p = p;
    }
    if (f.spurious > kSpurious && f.is_measured())
      out.remarks.push_back(
          remark::SpuriousMode{.mode = f.mode, .hz = f.measured_hz, .probability = f.spurious});
    out.modes.push_back(std::move(f));
  }
}

void judge_update_fit(const UpdateProblem& problem, const Examined& seen, UpdateFindings& out) {
  UpdateFit& fit = out.fit;
  fit.p = 0.0;
  double least = std::numeric_limits<double>::infinity();
  int numbers = 0;  // degrees of freedom at the draw with the smallest χ²
  for (std::size_t s = 0; s < seen.scores.size(); ++s) {
    const ModalLikelihood::Score& score = seen.scores[s];
    if (score.chi_square < least) {
      least = score.chi_square;
      numbers = score.freedoms;
    }
    if (s < static_cast<std::size_t>(out.examined))
      fit.p += chi_square_tail(score.freedoms, score.chi_square) / out.examined;
  }
  // Effective number of parameters: sum of the contractions.
  double used = 0.0;
  for (int p = 0; p < problem.structural; ++p)
    used += std::clamp(out.contractions[static_cast<std::size_t>(p)].contraction, 0.0, 1.0);
  const bool known = problem.modes().scatters().parameters().empty();
  if (known && numbers - used >= 1.0) fit.best_p = chi_square_tail(numbers - used, least);
  double rest = 0.0, spread = 0.0, mean = 0.0, count = 0.0;
  const auto counts = [](const ModeFinding& m) {
    return !std::isnan(m.measured_hz) && m.spurious < 0.5;
  };
  for (const ModeFinding& m : out.modes)
    if (counts(m)) mean += m.measured_hz, ++count;
  mean /= count;
  for (const ModeFinding& m : out.modes) {
    if (m.is_off()) fit.off.push_back(m.mode);
    if (!counts(m)) continue;
    rest += std::pow(m.measured_hz - m.frequency_hz.mean, 2);
    spread += std::pow(m.measured_hz - mean, 2);
  }
  fit.r2 = count >= 2.0 && spread > 0.0 ? 1.0 - rest / spread : kNaN;
  for (const PredictedMode& p : out.predictions)
    if (p.misses()) fit.missed.push_back(p.mode);
}

/// Mean and variance of f_obs - f of a mode without measurement noise, given the residuals of the
/// same mode in the other states, which share the model error.
struct Conditional {
  double mean = 0.0, variance = 0.0;
};
Conditional conditional(const UpdateProblem& problem, const ModalLikelihood::Score& score,
                        const ModalNoise& noise, std::size_t mode) {
  const ModalData& data = problem.update_case.data;
  const auto& of = score.matches[mode];
  const double common = noise.discrepancy * noise.discrepancy;
  Conditional out{.variance = common * of.frequency_hz * of.frequency_hz};
  if (common == 0.0) return out;
  std::vector<Index> same;
  const auto known = [&](std::size_t i) -> const auto& {
    const auto state = static_cast<std::size_t>(problem.states()->place(static_cast<int>(i)).state);
    return problem.states()->states().list[state].known;
  };
  for (std::size_t i = 0; i < data.frequencies_hz.size(); ++i)
    if (!std::isnan(data.frequencies_hz[i]) && score.matches[i].computed == of.computed &&
        known(i) == known(mode))
      same.push_back(static_cast<Index>(i));
  if (same.empty()) return out;
  const auto n = static_cast<Index>(same.size());
  MatrixXd c = problem.covariance(noise)(same, same);
  VectorXd f(n), r(n);
  for (Index k = 0; k < n; ++k) {
    const auto at = static_cast<std::size_t>(same[static_cast<std::size_t>(k)]);
    f[k] = data.frequencies_hz[at];
    r[k] = f[k] - score.matches[at].frequency_hz;
    for (Index l = 0; l < k; ++l) c(k, l) = c(l, k) = c(k, l) + common * f[k] * f[l];
  }
  const Eigen::LLT<MatrixXd> llt(c);
  const VectorXd cross = common * of.frequency_hz * f;
  out.mean = cross.dot(llt.solve(r));
  out.variance = std::max(0.0, out.variance - cross.dot(llt.solve(cross)));
  return out;
}

/// Mean relative variance of the measured frequencies.
double relative_variance(const ModalData& data, const MatrixXd& covariance) {
  double sum = 0.0, count = 0.0;
  for (int i = 0; i < data.modes(); ++i)
    if (const double f = data.frequencies_hz[static_cast<std::size_t>(i)]; !std::isnan(f))
      sum += covariance(i, i) / (f * f), ++count;
  return sum / std::max(1.0, count);
}

/// Sets the band of a mode's replicates, and the held-out measurement in `data`.
void set_band(std::vector<double>& replicates, const ModalData& data, std::size_t mode,
              PredictedMode& p) {
  std::ranges::sort(replicates);
  p.low_hz = quantile(replicates, 0.025);
  p.high_hz = quantile(replicates, 0.975);
  if (mode < data.held_out_hz.size() && !std::isnan(data.held_out_hz[mode]))
    p.measured_hz = data.held_out_hz[mode];
}

/// Predicts modes in states without measured frequencies, with the average measurement noise of the
/// other states.
void predict_states(const UpdateProblem& problem, const Examined& seen, std::uint64_t seed,
                    UpdateFindings& out) {
  const ModalData& data = problem.update_case.data;
  for (std::size_t m = 0; m < out.modes.size(); ++m) {
    if (!std::isnan(out.modes[m].measured_hz) || out.modes[m].has_shape) continue;
    const auto place = problem.states()->place(static_cast<int>(m));
    PredictedMode p{.mode = place.mode + 1, .state = out.modes[m].state};
    std::vector<double> means, replicates;
    for (std::size_t s = 0; s < static_cast<std::size_t>(out.examined); ++s) {
      ModalNoise noise = problem.noise(seen.x[s]);
      const Conditional error = conditional(problem, seen.scores[s], noise, m);
      noise.discrepancy = 0.0;
      const double relative = relative_variance(data, problem.covariance(noise));
      base::Random random(seed, m, s, base::Purpose::prediction);
      means.push_back(seen.scores[s].matches[m].frequency_hz + error.mean);
      replicates.push_back(means.back() +
                           std::sqrt(error.variance + relative * means.back() * means.back()) *
                               random.normal());
    }
    p.frequency_hz = marginal({means});
    const ModalData& own =
        problem.states()->states().list[static_cast<std::size_t>(place.state)].data;
    set_band(replicates, own, static_cast<std::size_t>(place.mode), p);
    out.predictions.push_back(std::move(p));
  }
}

/// Predicts the modes above the modes that are matched to measured modes.
void predict_modes(const UpdateProblem& problem, const Examined& seen, std::uint64_t seed,
                   UpdateFindings& out) {
  if (problem.states() != nullptr) return predict_states(problem, seen, seed, out);
  const ModalData& data = problem.update_case.data;
  const auto candidates = static_cast<int>(seen.frequencies_hz.front().size());
  int first = 0;
  for (const ModeFinding& m : out.modes)
    if (m.spurious < 0.5 && (m.is_measured() || !data.has_shapes()))
      first = std::max(first, m.computed);
  for (int k = 0; k < data.predict && first + k < candidates; ++k) {
    const Index at = first + k;
    PredictedMode p{.mode = first + k + 1};
    p.frequency_hz = marginal_of(out, [&](std::size_t s) { return seen.frequencies_hz[s][at]; });
    // The replicates have the average relative noise of the measured modes.
    std::vector<double> replicates;
    for (std::size_t s = 0; s < static_cast<std::size_t>(out.examined); ++s) {
      const double relative = relative_variance(data, problem.covariance(problem.noise(seen.x[s])));
      base::Random random(seed, static_cast<std::uint64_t>(k), s, base::Purpose::prediction);
      const double f = seen.frequencies_hz[s][at];
      replicates.push_back(f * (1.0 + std::sqrt(relative) * random.normal()));
    }
    set_band(replicates, data, static_cast<std::size_t>(k), p);
    out.predictions.push_back(std::move(p));
  }
}

/// Measured and computed shapes at the best draw, and the MAC of all pairs.
void show_shapes(const UpdateProblem& problem, const Examined& seen, UpdateFindings& out) {
  out.best_draw = seen.x[seen.best];
  if (!problem.update_case.data.has_shapes()) return;
  StructuralPredictor predictor(problem);
  Prediction best;
  if (!predictor.predict(0, seen.x[seen.best], ForwardModel::Quantity::modes, best)) return;
  ShapesBeside beside =
      shapes_beside(problem.modes().of(0), best.modes.back(), seen.scores[seen.best].matches);
  out.mac = std::move(beside.mac);
  out.best_shapes = std::move(beside.computed);
}

}  // namespace

bool Contraction::at_prior() const {
  return contraction < kUntouched && std::abs(shift) < 0.2 && bound == Bound::none;
}

bool ModeFinding::is_off() const {
  if (spurious > 0.5) return false;
  return (!std::isnan(residual) && std::abs(residual) > 3.0) || (has_shape && shape_p < kMisfit);
}

bool UpdateFit::ok() const {
  return p >= kMisfit && best_p >= kMisfit && missed.empty();
}

UpdateFindings update_findings(const UpdateProblem& problem, const Posterior& posterior,
                               const std::vector<MethodEvidence>& evidence, std::uint64_t seed) {
  UpdateFindings out;
  static_cast<Findings&>(out) = run_findings(posterior, inference::judge(posterior), seed);
  if (problem.basis() != nullptr || problem.states() != nullptr)
    out.remarks = implausible(problem.update_case);
  out.numbers = problem.measured();
  SeparateSolutions solutions = separate_solutions(posterior, 0);
  judge_parameters(problem, posterior, solutions.covariance_within, out);
  out.solutions = std::move(solutions.list);
  StructuralPredictor predictor(problem);
  ModeObservation::Scored scored;
  for (Solution& solution : out.solutions)
    if (predictor.score(0, solution.best, scored)) solution.chi_square = scored.score.chi_square;
  const Examined seen = examine(problem, posterior, out);
  judge_modes(problem, seen, out);
  if (problem.basis() != nullptr)
    out.numbering = numbering_of(*problem.update_case.structure, problem.update_case.data,
                                 problem.covariance(problem.noise(seen.x[seen.best])));
  leave_one_out(problem, seen, out);
  predict_modes(problem, seen, seed, out);
  judge_update_fit(problem, seen, out);
  show_shapes(problem, seen, out);
  conclude(out, problem.problem.space, evidence);
  // Contractions are a more sensitive measure than this remark.
  std::erase_if(out.remarks, [](const Remark& remark) {
    return std::holds_alternative<remark::NearlyPrior>(remark);
  });
  return out;
}

}  // namespace wheeltap::identification
