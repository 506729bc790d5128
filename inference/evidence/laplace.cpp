#include "inference/evidence/laplace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/search/differential_evolution.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kSearchBound = 8.0;
constexpr long kLaplaceSamples = 50;  // first length of a growing record

std::span<const double> values_of(const Eigen::VectorXd& z) {
  return {z.data(), static_cast<std::size_t>(z.size())};
}

using Function = std::function<double(const Eigen::VectorXd&)>;

// The step along each coordinate, at most 1, that lowers f by about `drop`.
Eigen::VectorXd steps(const Function& f, const Eigen::VectorXd& z, double value, double drop) {
  Eigen::VectorXd h(z.size());
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    double step = 0.1;
    for (int iteration = 0; iteration < 40; ++iteration) {
      Eigen::VectorXd up = z, down = z;
      up[i] += step;
      down[i] -= step;
      const double fall = value - 0.5 * (f(up) + f(down));
      if (fall > 2.0 * drop) {
        // Step from the parabola, with a lower limit in case of a discontinuity.
        step *= std::max(0.1, std::sqrt(drop / fall));
      } else if (fall < 0.5 * drop && step < 1.0) {
        step = std::min(1.0, step * (fall > 0.0 ? std::min(4.0, std::sqrt(drop / fall)) : 4.0));
      } else {
        break;
      }
      if (step < 1e-9) break;
    }
    h[i] = step;
  }
  return h;
}

struct Derivatives {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

Derivatives derivatives(const Function& f, const Eigen::VectorXd& z, double value,
                        const Eigen::VectorXd& h) {
  const Eigen::Index d = z.size();
  Derivatives result{Eigen::VectorXd(d), Eigen::MatrixXd(d, d)};
  const auto at = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
    Eigen::VectorXd p = z;
    p[i] += a * h[i];
    p[j] += b * h[j];
    return f(p);
  };
  for (Eigen::Index i = 0; i < d; ++i) {
    const double up = at(i, 1.0, i, 0.0), down = at(i, -1.0, i, 0.0);
    result.gradient[i] = (up - down) / (2.0 * h[i]);
    result.hessian(i, i) = (up - 2.0 * value + down) / (h[i] * h[i]);
    for (Eigen::Index j = 0; j < i; ++j)
      result.hessian(i, j) = result.hessian(j, i) =
          (at(i, 1, j, 1) - at(i, 1, j, -1) - at(i, -1, j, 1) + at(i, -1, j, -1)) /
          (4.0 * h[i] * h[j]);
  }
  return result;
}

// Newton's method with step halving. The differences become shorter from pass to pass.
void polish(const Function& f, Eigen::VectorXd& z, double& value) {
  double drop = 0.05;
  for (int iteration = 0; iteration < 20; ++iteration, drop = std::max(1e-4, 0.5 * drop)) {
    const Derivatives at = derivatives(f, z, value, steps(f, z, value, drop));
    if (!at.gradient.allFinite() || !at.hessian.allFinite()) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Eigen::MatrixXd(-at.hessian));
    // Ascends along every direction, for both signs of the curvature.
    const Eigen::VectorXd curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-6);
    const Eigen::VectorXd step =
        eigen.eigenvectors() *
        (eigen.eigenvectors().transpose() * at.gradient).cwiseQuotient(curvature);
    double gain = 0.0;
    for (double scale = 1.0; scale > 1e-4; scale *= 0.5) {
      const Eigen::VectorXd to = z + scale * step;
      const double there = f(to);
      if (there > value) {
        gain = there - value;
        z = to;
        value = there;
        break;
      }
    }
    if (gain < 1e-10) return;
  }
}

// Refines `best` by Newton steps.
void climb_to_mode(const Objective& objective, const std::string& name, Optimum& best) {
  if (best.value == -kInfinity)
    throw LikelihoodError("model '" + name + "': no point of the search has a finite likelihood");
  Eigen::VectorXd z =
      Eigen::Map<const Eigen::VectorXd>(best.z.data(), static_cast<Eigen::Index>(best.z.size()));
  polish(
      [&](const Eigen::VectorXd& at) {
        if (at.cwiseAbs().maxCoeff() > kSearchBound) return -kInfinity;
        ++best.evaluations;
        return objective(values_of(at));
      },
      z, best.value);
  best.z.assign(z.begin(), z.end());
}

// Differential evolution with several seeds; Newton steps refine the best result.
Optimum search(const Objective& objective, int dimension, const ModeOptions& options,
               const std::string& name, const std::vector<std::vector<double>>& start = {}) {
  if (options.restarts < 1)
    throw std::invalid_argument("mode: restarts = " + std::to_string(options.restarts) +
                                ", must be >= 1");
  Optimum best;
  best.value = -kInfinity;
  long evaluations = 0;
  for (int r = 0; r < options.restarts; ++r) {
    Optimum found = maximise_by_differential_evolution(
        objective, dimension,
        {.seed = options.seed + static_cast<std::uint64_t>(r) * 0x9e3779b97f4a7c15ULL,
         .generations = options.generations,
         .start = start,
         .bound = kSearchBound,
         .tolerance = options.tolerance});
    evaluations += found.evaluations;
    if (r == 0 || found.value > best.value) best = std::move(found);
  }
  best.evaluations = evaluations;
  climb_to_mode(objective, name, best);
  return best;
}

// Checks by importance sampling from t₅ at the mode whether the posterior is nearly
// normal.
void check_shape(const Problem& problem, int model, std::uint64_t seed, const Eigen::VectorXd& z,
                 Laplace& result) {
  constexpr int kDraws = 1000;
  constexpr double kHalfNat = 0.5;
  const Eigen::LLT<Eigen::MatrixXd> llt(result.covariance);
  if (llt.info() != Eigen::Success) return;
  const NormalMixture proposal({{1.0, z, llt.matrixL()}}, 5.0);
  const ImportanceSampling drawn =
      importance_sampling(problem, model, proposal, {.seed = seed, .draws = kDraws, .threads = 1});
  result.evidence.likelihood_evaluations += drawn.evidence.likelihood_evaluations;
  const double difference = drawn.evidence.log_evidence - result.evidence.log_evidence;
  if (std::fabs(difference) > kHalfNat + 3.0 * drawn.evidence.standard_error ||
      drawn.pareto_k > 0.7)
    result.evidence.warnings.push_back(
        {.kind = EvidenceWarning::Kind::not_normal, .value = difference});
}

// A population about the mode of a shorter record, several of its standard deviations wide.
std::vector<std::vector<double>> about_mode(const Problem& problem, int model,
                                            const ModeOptions& options,
                                            const std::vector<std::vector<double>>& start,
                                            long& evaluations) {
  constexpr double kWidth = 2.0;
  ModelPosterior posterior(problem, model);
  const int d = posterior.dimension();
  ModeOptions once = options;
  once.restarts = 1;
  once.generations = 60;  // the next search starts from a wider population
  once.tolerance = 1.0;
  const auto log_posterior = [&](std::span<const double> z) {
    return posterior(z).log_posterior();
  };
  const Optimum mode = search(log_posterior, d, once, posterior.name(), start);
  const Function f = [&](const Eigen::VectorXd& z) { return log_posterior(values_of(z)); };
  const Eigen::VectorXd z = Eigen::Map<const Eigen::VectorXd>(mode.z.data(), d);
  const Eigen::MatrixXd h = -derivatives(f, z, mode.value, steps(f, z, mode.value, 0.5)).hessian;
  evaluations += posterior.evaluations();
  // If the width is unknown, the population has one member; the next search completes it.
  if (!h.allFinite()) return {mode.z};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(h);
  // No direction of the population is wider than the prior.
  const Eigen::VectorXd sd =
      eigen.eigenvalues().cwiseAbs().cwiseMax(1.0).cwiseSqrt().cwiseInverse();
  base::Random random(options.seed, static_cast<std::uint64_t>(problem.samples),
                      static_cast<std::uint64_t>(model), base::Purpose::start);
  std::vector<std::vector<double>> population{mode.z};
  for (int i = 1; i < std::max(30, 10 * d); ++i) {
    Eigen::VectorXd u(d);
    for (double& v : u) v = kWidth * random.normal();
    const Eigen::VectorXd member = z + eigen.eigenvectors() * sd.cwiseProduct(u);
    population.emplace_back(member.begin(), member.end());
  }
  return population;
}

// True if the population still contains the best points of the longer record. Then the mean log
// likelihood of the added samples is about that of the earlier samples. The fit of a chaotic
// response is suddenly lost.
bool holds(const Problem& problem, int model, const std::vector<std::vector<double>>& population,
           double per_sample, double before, long& evaluations) {
  ModelPosterior posterior(problem, model);
  double top = -kInfinity;
  for (const auto& z : population) top = std::max(top, posterior(z).log_likelihood);
  evaluations += posterior.evaluations();
  const double more = static_cast<double>(problem.samples) - before;
  return top > per_sample * (before + more) - 10.0 - 3.0 * std::sqrt(more);
}

Optimum nothing_to_search(ModelPosterior& posterior) {
  return {{}, posterior({}).log_posterior(), posterior.evaluations(), true};
}

}  // namespace

Optimum maximum_a_posteriori(const Problem& problem, int model, const ModeOptions& options) {
  ModelPosterior posterior(problem, model);
  if (posterior.dimension() == 0) return nothing_to_search(posterior);
  const Objective log_posterior = [&](std::span<const double> z) {
    return posterior(z).log_posterior();
  };
  if (!options.start.empty()) {
    Optimum found{options.start, log_posterior(options.start), 1, true};
    climb_to_mode(log_posterior, posterior.name(), found);
    return found;
  }
  long before = 0;
  std::vector<std::vector<double>> start;
  if (problem.shortened) {
    std::shared_ptr<const Problem> part =
        problem.shortened(std::min(kLaplaceSamples, problem.samples));
    for (long n = kLaplaceSamples, step = n; n < problem.samples; n += step) {
      start = about_mode(*part, model, options, start, before);
      const auto had = static_cast<double>(n);
      const double per_sample = ModelPosterior(*part, model)(start.front()).log_likelihood / had;
      step = std::min({2 * step, std::max(n / 5, 1L), problem.samples - n});
      for (part = problem.shortened(n + step);
           step > n / 20 && !holds(*part, model, start, per_sample, had, before);
           part = problem.shortened(n + step)) {
        step = std::max(step / 2, 1L);
      }
    }
  }
  Optimum found = search(log_posterior, posterior.dimension(), options, posterior.name(), start);
  found.evaluations += before;
  return found;
}

Laplace laplace(const Problem& problem, int model, const ModeOptions& options) {
  const Optimum mode = maximum_a_posteriori(problem, model, options);
  Laplace result;
  result.z = mode.z;
  result.evidence.log_evidence = mode.value;
  ModelPosterior posterior(problem, model);
  const Eigen::Index d = posterior.dimension();
  if (d > 0) {
    const Function f = [&](const Eigen::VectorXd& z) {
      return posterior(values_of(z)).log_posterior();
    };
    const Eigen::VectorXd z = Eigen::Map<const Eigen::VectorXd>(mode.z.data(), d);
    const Eigen::MatrixXd h = -derivatives(f, z, mode.value, steps(f, z, mode.value, 0.05)).hessian;
    const Eigen::LLT<Eigen::MatrixXd> llt(h);
    if (h.allFinite() && llt.info() == Eigen::Success) {
      result.covariance = llt.solve(Eigen::MatrixXd::Identity(d, d));
      const Eigen::MatrixXd factor = llt.matrixL();
      result.evidence.log_evidence +=
          static_cast<double>(d) * kLogSqrt2Pi - factor.diagonal().array().log().sum();
      if (options.check) check_shape(problem, model, options.seed, z, result);
    } else {
      result.evidence.log_evidence = std::numeric_limits<double>::quiet_NaN();
      result.covariance = Eigen::MatrixXd::Constant(d, d, std::numeric_limits<double>::quiet_NaN());
      result.evidence.warnings.push_back({.kind = EvidenceWarning::Kind::no_maximum});
    }
    (void)posterior(values_of(z));
    result.x.assign(posterior.x().begin(), posterior.x().end());
  }
  result.evidence.standard_error = d == 0 ? 0.0 : std::numeric_limits<double>::quiet_NaN();
  result.evidence.likelihood_evaluations += mode.evaluations + posterior.evaluations();
  return result;
}

}  // namespace wheeltap::inference
