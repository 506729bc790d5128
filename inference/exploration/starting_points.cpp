#include "inference/exploration/starting_points.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

namespace {

constexpr int kReplicates = 4;        // replicates of TMCMC
constexpr long kStartSamples = 5000;  // samples of a long record at the beginning of a search
constexpr int kParticles = 100;       // samples per replicate, for the posterior of kStartSamples

/// Finds one mode of one model. Failure is not an error, because other models may have a mode.
template <typename Search>
Laplace find_mode(ProgressMonitor& monitor, Search&& search) {
  Laplace none;
  none.evidence.log_evidence = std::numeric_limits<double>::quiet_NaN();
  if (!monitor.advance(0.0)) return none;
  Laplace mode;
  try {
    mode = search();
  } catch (const LikelihoodError&) {
    return none;
  }
  monitor.evaluated(mode.evidence.likelihood_evaluations);
  monitor.advance(1.0);
  return mode;
}

}  // namespace

std::vector<Laplace> climb_with_record(const Problem& problem, const Options& options,
                                       ProgressMonitor& monitor) {
  const int models = problem.space.size();
  monitor.begin("searching", static_cast<double>(models));
  const std::shared_ptr<const Problem> shortened = problem.shortened(kStartSamples);
  const auto climb = [&](int m) {
    if (problem.space[m].dimension == 0) return laplace(problem, m, {.check = false});
    const Tmcmc samples = tmcmc(*shortened, m,
                                {.seed = options.seed,
                                 .replicates = kReplicates,
                                 .samples = kParticles,
                                 .path = TmcmcPath::growing,
                                 .threads = 1,
                                 .progress = [&](double) { return monitor.advance(0.0); },
                                 .stop = [&] { return monitor.stopped(); }});
    long evaluations = samples.evidence.likelihood_evaluations;
    ModeOptions mode_options{.check = false};
    double top = -std::numeric_limits<double>::infinity();
    ModelPosterior posterior(*shortened, m);
    for (Eigen::Index i = 0; i < samples.z.rows(); ++i) {
      const std::vector<double> z(samples.z.row(i).begin(), samples.z.row(i).end());
      const double value = posterior(z).log_posterior();
      if (value > top) mode_options.start = z, top = value;
    }
    for (long n = kStartSamples; n < problem.samples; n *= 4) {
      if (monitor.stopped() || mode_options.start.empty())
        throw LikelihoodError("no draw has a finite likelihood, so no search can start");
      const Optimum mode = maximum_a_posteriori(*problem.shortened(n), m, mode_options);
      mode_options.start = mode.z;
      evaluations += mode.evaluations;
    }
    Laplace mode = laplace(problem, m, mode_options);
    mode.evidence.likelihood_evaluations += evaluations + posterior.evaluations();
    return mode;
  };
  std::vector<Laplace> modes(static_cast<std::size_t>(models));
  base::parallel_for(
      models, options.threads,
      [&](int m) {
        modes[static_cast<std::size_t>(m)] = find_mode(monitor, [&] { return climb(m); });
      },
      base::carriage([&](int m, auto& parcel) {
        Laplace& mode = modes[static_cast<std::size_t>(m)];
        Evidence& e = mode.evidence;
        parcel(e.log_evidence, e.standard_error, e.likelihood_evaluations, e.warnings, mode.z,
               mode.x, mode.covariance);
      }));
  return modes;
}

}  // namespace wheeltap::inference
