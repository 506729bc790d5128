#include "inference/starting_points.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "inference/evidence/model_posterior.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "inference/parallel.hpp"

namespace wheeltap::inference {

namespace {

constexpr int kReplicates = 4;       // of TMCMC
constexpr long kGlance = 5000;       // samples of a long record that a search begins with
constexpr int kGlanceSamples = 100;  // a replicate, of its posterior

bool has_searches(const Problem& problem, const Options& options) {
  return problem.space.kinds().empty() && !options.prior_only;
}

/// One mode of one model, or none: other models will do.
template <typename Search>
Laplace find_mode(Reporter& reporter, Search&& search) {
  Laplace none;
  none.evidence.log_evidence = std::numeric_limits<double>::quiet_NaN();
  if (!reporter.advance(0.0)) return none;
  Laplace mode;
  try {
    mode = search();
  } catch (const LikelihoodError&) {
    return none;
  }
  reporter.evaluated(mode.evidence.likelihood_evaluations);
  reporter.advance(1.0);
  return mode;
}

}  // namespace

Populations growing_populations(const Problem& problem, const Options& options,
                                Reporter& reporter) {
  const ModelSpace& space = problem.space;
  Populations found;
  if (!has_searches(problem, options)) return found;
  reporter.begin("searching", static_cast<double>(space.size()));
  found.z.resize(static_cast<std::size_t>(space.size()));
  double most = -std::numeric_limits<double>::infinity();
  for (int m = 0; m < space.size() && reporter.advance(0.0); ++m) {
    try {
      Tmcmc samples = tmcmc(problem, m,
                            {.seed = options.seed,
                             .replicates = kReplicates,
                             .weight_cov = 1.0,  // for a start; an evidence asks for less
                             .threads = options.threads,
                             .progress = [&](double share) { return reporter.advance(share); }});
      found.likelihood_evaluations += samples.evidence.likelihood_evaluations;
      reporter.evaluated(samples.evidence.likelihood_evaluations);
      if (std::isnan(samples.evidence.log_evidence)) continue;  // no place for it, either
      const double worth = samples.evidence.log_evidence + space[m].log_prior;
      if (worth > most) {
        most = worth;
        found.best = m;
      }
      found.z[static_cast<std::size_t>(m)] = std::move(samples.z);
    } catch (const LikelihoodError&) {  // no place for this model: others will do
    }
  }
  return found;
}

Modes search_modes(const Problem& problem, const Options& options, Reporter& reporter,
                   int searchers) {
  if (!has_searches(problem, options)) return {};
  const int models = problem.space.size();
  reporter.begin("searching", static_cast<double>(models) * searchers);
  Modes modes(static_cast<std::size_t>(searchers));
  parallel_for(searchers, options.threads, [&](int c) {
    for (int m = 0; m < models; ++m) {
      modes[static_cast<std::size_t>(c)].push_back(find_mode(reporter, [&] {
        return laplace(problem, m,
                       {.seed = options.seed + 7919 * static_cast<std::uint64_t>(c + 1),
                        .restarts = 1,
                        .tolerance = 0.1,
                        .check = false});
      }));
    }
  });
  return modes;
}

Modes climb_with_record(const Problem& problem, const Options& options, Reporter& reporter) {
  const int models = problem.space.size();
  reporter.begin("searching", static_cast<double>(models));
  const std::shared_ptr<const Problem> glance = problem.shortened(kGlance);
  const auto climb = [&](int m) {
    const Tmcmc samples = tmcmc(*glance, m,
                                {.seed = options.seed,
                                 .replicates = kReplicates,
                                 .samples = kGlanceSamples,
                                 .path = TmcmcPath::growing,
                                 .threads = 1,
                                 .progress = [&](double) { return reporter.advance(0.0); }});
    long evaluations = samples.evidence.likelihood_evaluations;
    ModeOptions mode_options{.check = false};
    double top = -std::numeric_limits<double>::infinity();
    ModelPosterior posterior(*glance, m);
    for (Eigen::Index i = 0; i < samples.z.rows(); ++i) {
      const std::vector<double> z(samples.z.row(i).begin(), samples.z.row(i).end());
      const double value = posterior(z).log_posterior();
      if (value > top) mode_options.start = z, top = value;
    }
    for (long n = kGlance; n < problem.samples; n *= 4) {
      if (reporter.stopped() || mode_options.start.empty())
        throw LikelihoodError("no place to climb from");
      const Optimum mode = maximum_a_posteriori(*problem.shortened(n), m, mode_options);
      mode_options.start = mode.z;
      evaluations += mode.evaluations;
    }
    Laplace mode = laplace(problem, m, mode_options);
    mode.evidence.likelihood_evaluations += evaluations + posterior.evaluations();
    return mode;
  };
  Modes modes(1);
  modes.front().resize(static_cast<std::size_t>(models));
  parallel_for(models, options.threads, [&](int m) {
    modes.front()[static_cast<std::size_t>(m)] = find_mode(reporter, [&] { return climb(m); });
  });
  return modes;
}

}  // namespace wheeltap::inference
