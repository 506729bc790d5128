#include "identification/sid/sid_problem.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>

#include "base/eigen.hpp"
#include "identification/invalid_input.hpp"
#include "signals/residuals.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Misfit;

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

void scatter(const SidCase& sid_case, int model, std::span<const double> x,
             std::vector<double>& theta) {
  theta.assign(sid_case.parameters.size(), 0.0);
  const auto& used = sid_case.models[static_cast<std::size_t>(model)].parameters;
  for (std::size_t i = 0; i < used.size(); ++i) theta[static_cast<std::size_t>(used[i])] = x[i];
}

class RecordLikelihood final : public inference::Likelihood {
 public:
  explicit RecordLikelihood(const SidProblem& problem) : problem_(problem) {}

  double log_likelihood(int m, std::span<const double> x) override {
    return log_likelihood_above(kImpossible, m, x);
  }

  /// Upper bound of ln p over all records at x, from a perfect fit of the data; NaN if unknown.
  double bound(int m, std::span<const double> x) {
    const SidModel& model = problem_.sid_case.models[static_cast<std::size_t>(m)];
    const Misfit& misfit = problem_.misfits[static_cast<std::size_t>(m)];
    if (!model.residuals.model->is_white()) return std::numeric_limits<double>::quiet_NaN();
    scatter(problem_.sid_case, m, x, theta_);
    return white_density(model, misfit, {});
  }

  double log_likelihood_above(double floor, int m, std::span<const double> x) override {
    const SidModel& model = problem_.sid_case.models[static_cast<std::size_t>(m)];
    const Misfit& misfit = problem_.misfits[static_cast<std::size_t>(m)];
    scatter(problem_.sid_case, m, x, theta_);
    const auto channels = static_cast<std::size_t>(misfit.channels());
    const auto samples = static_cast<std::size_t>(misfit.samples());
    if (model.residuals.model->is_white()) {
      sums_.resize(channels);
      weights_.clear();
      const double best = perfect_fit(model, misfit);
      if (!std::isfinite(best) || best < floor) return kImpossible;
      if (!misfit.sums_of_squares_within(theta_, weights_, best - floor, sums_)) return kImpossible;
      return white_density(model, misfit, sums_);
    }
    double sum = log_scales(misfit);
    residuals_.resize(channels * samples);
    if (!misfit.residuals(theta_, residuals_)) return kImpossible;
    for (std::size_t c = 0; c < channels; ++c) {
      sum += model.log_density(c, {residuals_.data() + c * samples, samples}, theta_);
    }
    return std::isnan(sum) ? kImpossible : sum;
  }

  void log_likelihoods(int m, std::span<const double> xs, std::span<double> out) override {
    log_likelihoods_above({}, m, xs, out);
  }

  void log_likelihoods_above(std::span<const double> floors, int m, std::span<const double> xs,
                             std::span<double> out) override {
    const SidModel& model = problem_.sid_case.models[static_cast<std::size_t>(m)];
    if (!model.residuals.model->is_white()) {
      Likelihood::log_likelihoods(m, xs, out);
      return;
    }
    const Misfit& misfit = problem_.misfits[static_cast<std::size_t>(m)];
    const auto channels = static_cast<std::size_t>(misfit.channels());
    const std::size_t d = xs.size() / out.size();
    thetas_.clear();
    weights_.clear();
    limits_.clear();
    for (std::size_t i = 0; i < out.size(); ++i) {
      scatter(problem_.sid_case, m, xs.subspan(i * d, d), theta_);
      thetas_.insert(thetas_.end(), theta_.begin(), theta_.end());
      if (floors.empty()) continue;
      const double best = perfect_fit(model, misfit);
      limits_.push_back(std::isfinite(best) ? best - floors[i] : -1.0);
    }
    sums_.resize(out.size() * channels);
    misfit.sums_of_squares_within(thetas_, static_cast<int>(out.size()), weights_, limits_, sums_);
    for (std::size_t i = 0; i < out.size(); ++i) {
      scatter(problem_.sid_case, m, xs.subspan(i * d, d), theta_);
      out[i] = white_density(model, misfit, std::span(sums_).subspan(i * channels, channels));
    }
  }

  bool gauss_newton(int m, std::span<const double> x, std::span<const double> steps,
                    std::span<double> gradient, std::span<double> information) override {
    const SidModel& model = problem_.sid_case.models[static_cast<std::size_t>(m)];
    const Misfit& misfit = problem_.misfits[static_cast<std::size_t>(m)];
    const std::size_t d = x.size();
    const auto each =
        static_cast<std::size_t>(misfit.channels()) * static_cast<std::size_t>(misfit.samples());
    // x itself, and one vector per parameter of the response, with a step in that parameter.
    std::vector<std::size_t> moving;
    for (std::size_t i = 0; i < d; ++i)
      if (misfit.depends_on(model.parameters[i])) moving.push_back(i);
    scatter(problem_.sid_case, m, x, theta_);
    thetas_ = theta_;
    for (const std::size_t i : moving) {
      thetas_.insert(thetas_.end(), theta_.begin(), theta_.end());
      const auto p = static_cast<std::size_t>(model.parameters[i]);
      thetas_[thetas_.size() - theta_.size() + p] += steps[i];
    }
    const std::size_t sets = moving.size() + 1;
    residuals_.resize(sets * each);
    done_.resize(sets);
    misfit.residuals(thetas_, static_cast<int>(sets), residuals_, done_);
    if (done_[0] == 0) return false;
    std::ranges::fill(gradient, 0.0);
    std::ranges::fill(information, 0.0);
    add_noise(model, misfit, x, steps, gradient, information);
    // Jacobian J by differences, one row per parameter; then whitens residuals and J.
    for (std::size_t k = 1; k < sets; ++k)
      for (std::size_t n = 0; n < each; ++n)
        residuals_[k * each + n] = done_[k] != 0 ? residuals_[k * each + n] - residuals_[n] : 0.0;
    whiten(model, misfit, sets);
    const Eigen::Map<const Eigen::MatrixXd> all(residuals_.data(), static_cast<Eigen::Index>(each),
                                                static_cast<Eigen::Index>(sets));
    const Eigen::MatrixXd products = all.transpose() * all;
    for (std::size_t a = 0; a < moving.size(); ++a) {
      const auto row = static_cast<Eigen::Index>(a) + 1;
      gradient[moving[a]] -= products(row, 0);
      for (std::size_t b = 0; b < moving.size(); ++b)
        information[moving[a] * d + moving[b]] += products(row, static_cast<Eigen::Index>(b) + 1);
    }
    return true;
  }

 private:
  /// ln p for white residuals with these sums of squares, one per channel; empty: all sums are 0.
  double white_density(const SidModel& model, const Misfit& misfit,
                       std::span<const double> sums) const {
    double sum = log_scales(misfit);
    for (std::size_t c = 0; c < model.noise.size(); ++c) {
      sum += signals::gaussian_log_likelihood(sums.empty() ? 0.0 : sums[c], misfit.samples(),
                                              model.noise[c].at(theta_));
    }
    return sum;
  }

  /// ln p of a perfect fit; also appends the weights of the sums of squares, 1 / (2 σ²).
  double perfect_fit(const SidModel& model, const Misfit& misfit) {
    for (const auto& noise : model.noise)
      weights_.push_back(0.5 / (noise.at(theta_) * noise.at(theta_)));
    return white_density(model, misfit, {});
  }

  /// Whitens the residuals of the first `sets` vectors: innovations in units of their sd.
  void whiten(const SidModel& model, const Misfit& misfit, std::size_t sets) {
    const auto channels = static_cast<std::size_t>(misfit.channels());
    const auto samples = static_cast<std::size_t>(misfit.samples());
    for (std::size_t c = 0; c < channels; ++c) {
      const std::vector<double> own = model.residuals.at(c, theta_);
      const double sigma = model.noise[c].at(theta_);
      for (std::size_t set = 0; set < sets; ++set) {
        const std::span<double> r(residuals_.data() + (set * channels + c) * samples, samples);
        model.residuals.model->standardise(r, own, r);
        for (double& e : r) e /= sigma;
      }
    }
  }

  /// Adds the effect of noise and scale parameters on ln p for fixed residuals (the first entry of
  /// residuals_). The curvature for a standard deviation is that of the chord to its
  /// maximum-likelihood estimate for these residuals, at distance ln √(S/N). Second differences
  /// give the curvature for parameters of residual models.
  void add_noise(const SidModel& model, const Misfit& misfit, std::span<const double> x,
                 std::span<const double> steps, std::span<double> gradient,
                 std::span<double> information) {
    constexpr double kLongest = 3.0;  // in ln sd
    const auto channels = static_cast<std::size_t>(misfit.channels());
    const auto samples = static_cast<std::size_t>(misfit.samples());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const int p = model.parameters[i];
      double &slope = gradient[i], &bend = information[i * x.size() + i];
      double squares = 0.0, count = 0.0;
      for (std::size_t c = 0; c < channels; ++c) {
        const std::span<const double> r(residuals_.data() + c * samples, samples);
        if (model.noise[c].parameter == p) {
          innovations_.resize(samples);
          model.residuals.model->standardise(r, model.residuals.at(c, theta_), innovations_);
          for (const double e : innovations_) squares += e * e / (x[i] * x[i]);
          count += static_cast<double>(samples);
        }
        const auto& own = model.residuals.coefficients;
        if (!own.empty() && std::ranges::count(own[c], p, &dynamics::Coefficient::parameter) > 0) {
          const auto value = [&](double at) {
            theta_[static_cast<std::size_t>(p)] = at;
            return model.log_density(c, r, theta_);
          };
          const double up = value(x[i] + steps[i]), down = value(x[i] - steps[i]),
                       here = value(x[i]);
          if (std::isfinite(up) && std::isfinite(down)) {
            slope += 0.5 * (up - down);
            bend += std::max(2.0 * here - up - down, 0.0);
          } else {  // a neighbouring value is impossible
            slope += std::isfinite(down) ? here - down : std::isfinite(up) ? up - here : 0.0;
            bend += 1.0;
          }
        }
      }
      if (count > 0.0) {
        const double unit = steps[i] / x[i], rise = squares - count;
        const double best = std::clamp(0.5 * std::log(squares / count), -kLongest, kLongest);
        slope += rise * unit;
        bend += (std::abs(best) > 1e-3 ? rise / best : 2.0 * count) * unit * unit;
      }
      for (const SidChannel* channel : problem_.sid_case.responses()) {
        if (channel->signal.scale.parameter != p) continue;
        slope += misfit.samples() * steps[i] / x[i];
        bend += misfit.samples() * std::pow(steps[i] / x[i], 2);
      }
    }
  }

  double log_scales(const Misfit& misfit) const {
    double sum = 0.0;
    for (const SidChannel& channel : problem_.sid_case.channels) {
      if (channel.role != SidChannel::Role::response || channel.signal.scale.is_constant())
        continue;
      sum += misfit.samples() * std::log(std::abs(channel.signal.scale.at(theta_)));
    }
    return sum;
  }

  const SidProblem& problem_;
  std::vector<double> theta_, thetas_, weights_, limits_, sums_, residuals_, innovations_;
  std::vector<char> done_;
};

/// The records of one structure are independent given the parameters.
class SumOfRecords final : public inference::Likelihood {
 public:
  explicit SumOfRecords(const SidProblem& first) {
    parts_.push_back(std::make_unique<RecordLikelihood>(first));
    for (const auto& record : first.further) {
      parts_.push_back(std::make_unique<RecordLikelihood>(*record));
    }
  }

  double log_likelihood(int m, std::span<const double> x) override {
    return log_likelihood_above(kImpossible, m, x);
  }

  double log_likelihood_above(double floor, int m, std::span<const double> x) override {
    bounds_.clear();
    double rest = 0.0;  // upper bound of ln p of the remaining records
    for (const auto& part : parts_) rest += bounds_.emplace_back(part->bound(m, x));
    double sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      rest -= bounds_[i];
      const double needed = std::isfinite(rest) ? floor - sum - rest : kImpossible;
      sum += parts_[i]->log_likelihood_above(needed, m, x);
      if (sum == kImpossible) break;
    }
    return sum;
  }

  void log_likelihoods(int m, std::span<const double> xs, std::span<double> out) override {
    std::ranges::fill(out, 0.0);
    values_.resize(out.size());
    for (const auto& part : parts_) {
      part->log_likelihoods(m, xs, values_);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += values_[i];
    }
  }

  bool gauss_newton(int m, std::span<const double> x, std::span<const double> steps,
                    std::span<double> gradient, std::span<double> information) override {
    std::ranges::fill(gradient, 0.0);
    std::ranges::fill(information, 0.0);
    std::vector<double> slope(gradient.size()), bend(information.size());
    for (const auto& part : parts_) {
      if (!part->gauss_newton(m, x, steps, slope, bend)) return false;
      std::ranges::transform(gradient, slope, gradient.begin(), std::plus{});
      std::ranges::transform(information, bend, information.begin(), std::plus{});
    }
    return true;
  }

 private:
  std::vector<std::unique_ptr<RecordLikelihood>> parts_;
  std::vector<double> bounds_, values_;
};

/// Largest extension of each link with measured displacements, used to choose the steps of
/// nonlinear laws; 0 if not measured.
std::vector<double> measured_extensions(const SidCase& sid_case, const dynamics::Chain& chain) {
  std::vector<const SidChannel*> of_mass(static_cast<std::size_t>(chain.size()) + 1, nullptr);
  bool base = false;
  for (const SidChannel& channel : sid_case.channels) {
    base = base || channel.role == SidChannel::Role::base_acceleration ||
           channel.role == SidChannel::Role::base_displacement;
  }
  for (const SidChannel* channel : sid_case.responses()) {
    const bool to_ground = channel->frame == dynamics::Frame::relative || !base;
    if (channel->quantity == dynamics::Quantity::displacement && to_ground &&
        channel->signal.scale.is_constant()) {
      of_mass[static_cast<std::size_t>(channel->mass)] = channel;
    }
  }
  std::vector<double> extensions;
  for (const dynamics::Link& link : chain.links) {
    double most = 0.0;
    const auto* a = of_mass[static_cast<std::size_t>(link.a)];
    const auto* b = of_mass[static_cast<std::size_t>(link.b)];
    if ((link.a == 0 || a != nullptr) && (link.b == 0 || b != nullptr)) {
      const auto at = [](const SidChannel* channel, std::size_t n) {
        if (channel == nullptr) return 0.0;
        const double offset =
            channel->signal.offset.is_constant() ? channel->signal.offset.value : 0.0;
        return channel->signal.scale.value * channel->signal.samples[n] + offset;
      };
      const std::size_t samples = (a != nullptr ? a : b)->signal.samples.size();
      for (std::size_t n = 0; n < samples; ++n)
        most = std::max(most, std::abs(at(b, n) - at(a, n)));
    }
    extensions.push_back(most);
  }
  return extensions;
}

}  // namespace

SidCase shortened(SidCase sid_case, int first) {
  const auto samples = static_cast<std::size_t>(sid_case.lead_in + first);
  for (SidChannel& channel : sid_case.channels) {
    const std::size_t kept = channel.is_excitation()
                                 ? (samples - 1) * static_cast<std::size_t>(sid_case.stride) + 1
                                 : samples;
    if (channel.signal.samples.size() > kept) channel.signal.samples.resize(kept);
    channel.beyond.clear();
  }
  sid_case.beyond = 0;
  sid_case.end = sid_case.begin + first;
  for (SidCase& record : sid_case.further) {
    record = shortened(std::move(record), std::min(first, record.end - record.begin));
  }
  return sid_case;
}

namespace {

/// Approximate run times per mass: of a Runge-Kutta step, of a segment of a Taylor series, and of a
/// step of the exact solution.
constexpr double kRungeKuttaNanoseconds = 12.0;
constexpr double kSeriesNanoseconds = 40.0;
constexpr double kExactNanoseconds = 3.0;

/// Mean cost over the models, at the medians of their priors. The function counts steps and does
/// not measure time, because the sampling effort must not depend on the machine's load.
double estimate_cost(const SidProblem& problem) {
  const SidCase& sid_case = problem.sid_case;
  double nanoseconds = 0.0;
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    std::vector<double> x;
    for (int p = 0; p < problem.problem.space[m].dimension; ++p) {
      x.push_back(problem.problem.space.prior(m, p).from_standard_normal(0.0));
    }
    const dynamics::Simulator& simulator = problem.misfits[static_cast<std::size_t>(m)].simulator();
    const int substeps = std::abs(simulator.substeps(problem.theta(m, x)));
    nanoseconds += static_cast<double>(simulator.samples()) * sid_case.stride *
                   simulator.chain().size() *
                   (substeps == 0 ? kExactNanoseconds
                    : simulator.integrator() == dynamics::Integrator::series
                        ? substeps * kSeriesNanoseconds
                        : substeps * kRungeKuttaNanoseconds);
  }
  return 1e-9 * nanoseconds / problem.problem.space.size();
}

}  // namespace

std::vector<double> SidProblem::theta(int model, std::span<const double> x) const {
  std::vector<double> theta;
  scatter(sid_case, model, x, theta);
  return theta;
}

std::unique_ptr<const SidProblem> make_sid_problem(SidCase sid_case) {
  std::vector<inference::ModelSpace::ListedModel> listed;
  for (const SidModel& model : sid_case.models) {
    listed.push_back({model.name, model.weight, {}});
    for (const int p : model.parameters) {
      listed.back().parameters.push_back(sid_case.parameters[static_cast<std::size_t>(p)].name);
    }
  }
  // Only parameters that a model uses; other parameters may occur only in the truth.
  std::vector<inference::Parameter> parameters;
  for (std::size_t p = 0; p < sid_case.parameters.size(); ++p) {
    if (std::ranges::any_of(sid_case.models, [&](const SidModel& model) {
          return std::ranges::count(model.parameters, static_cast<int>(p)) > 0;
        })) {
      parameters.push_back(sid_case.parameters[p]);
    }
  }
  const auto space = [&] {
    try {
      return inference::ModelSpace::of_models(parameters, listed);
    } catch (const std::invalid_argument& error) {
      throw InvalidInput(InvalidInput::Part::models, error.what());
    }
  };
  auto out = std::make_unique<SidProblem>(SidProblem{
      .sid_case = sid_case, .misfits = {}, .problem = {.space = space(), .likelihood = {}}});
  std::vector<dynamics::Signal> observed;
  for (const SidChannel* channel : sid_case.responses()) observed.push_back(channel->signal);
  for (std::size_t m = 0; m < sid_case.models.size(); ++m) {
    const SidModel& model = sid_case.models[m];
    dynamics::SimulatorOptions options = sid_case.integration;
    options.extension = measured_extensions(sid_case, model.chain);
    try {
      out->misfits.emplace_back(dynamics::Simulator(model.chain, sid_case.excitation(),
                                                    sid_case.sensors(), model.initial, options),
                                observed, sid_case.lead_in);
    } catch (const std::invalid_argument& error) {
      throw InvalidInput(InvalidInput::Part::model, error.what(), static_cast<int>(m));
    }
  }
  for (SidCase record : sid_case.further) {
    const int stride = record.integration.stride;
    record.integration = sid_case.integration;
    record.integration.stride = stride;
    out->further.push_back(make_sid_problem(std::move(record)));
  }
  out->problem.likelihood = [problem = out.get()]() -> std::unique_ptr<inference::Likelihood> {
    if (problem->further.empty()) return std::make_unique<RecordLikelihood>(*problem);
    return std::make_unique<SumOfRecords>(*problem);
  };
  out->problem.samples = out->misfits.front().samples();
  // The cache is useful because every model's search requests the same few lengths, and a problem
  // with hundreds of models is expensive to make.
  struct Parts {
    std::mutex mutex;
    std::map<long, std::shared_ptr<const SidProblem>> of_length;
  };
  out->problem.shortened = [problem = out.get(), parts = std::make_shared<Parts>()](long first) {
    const std::scoped_lock lock(parts->mutex);
    std::shared_ptr<const SidProblem>& part = parts->of_length[first];
    if (!part) part = make_sid_problem(shortened(problem->sid_case, static_cast<int>(first)));
    return std::shared_ptr<const inference::Problem>(part, &part->problem);
  };
  out->seconds_a_likelihood = estimate_cost(*out);
  for (const auto& record : out->further) out->seconds_a_likelihood += record->seconds_a_likelihood;
  return out;
}

}  // namespace wheeltap::identification
