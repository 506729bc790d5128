#include "identification/emulation/outside_emulator.hpp"

#include <algorithm>
#include <cmath>

#include "emulator/experiment.hpp"

namespace wheeltap::identification {
namespace {

using emulator::Factor;
using emulator::RowMatrix;

constexpr double kFarthestDesign = 4.0;  // z of the prior's quantiles
constexpr double kDecade = 10.0;

Factor factor_of(const inference::Parameter& unknown) {
  const inference::Prior& prior = unknown.prior;
  const auto end = [&](double bound, double z) {
    return std::isfinite(bound) ? bound : prior.from_standard_normal(z);
  };
  const double high = end(prior.upper(), kFarthestDesign);
  // On the support [0, ∞), the box does not begin at 0 but at the quantile z = -4.
  const bool half = prior.lower() == 0.0 && !std::isfinite(prior.upper());
  const double low =
      half ? prior.from_standard_normal(-kFarthestDesign) : end(prior.lower(), -kFarthestDesign);
  return {.name = unknown.name,
          .unit = "",
          .levels = {low, high},
          .scale = low > 0.0 && high > kDecade * low ? emulator::Scale::logarithm
                                                     : emulator::Scale::linear};
}

/// Rethrows the model's failure, which run_experiment wraps in another exception.
template <class Work>
auto unwrapped(const Work& work) {
  try {
    return work();
  } catch (const emulator::RunError& error) {
    std::rethrow_if_nested(error);
    throw;
  }
}

}  // namespace

int OutsideEmulatorSpec::runs_for(int unknowns) const {
  return runs > 0 ? runs : std::max(40, 20 * unknowns);
}

int OutsideEmulatorSpec::holdout_for(int unknowns) const {
  return holdout > 0 ? holdout : std::max(10, runs_for(unknowns) / 4);
}

OutsideEmulator::OutsideEmulator(OutsideModel& model,
                                 const std::vector<inference::Parameter>& unknowns,
                                 const OutsideEmulatorSpec& spec, int threads,
                                 const std::function<void(double)>& progress)
    : spec_(spec) {
  const auto d = static_cast<int>(unknowns.size());
  runs_ = spec.runs_for(d);
  fresh_ = spec.holdout_for(d);
  std::vector<Factor> factors;
  for (const auto& unknown : unknowns) factors.push_back(factor_of(unknown));
  const auto design = spec.sobol ? emulator::sobol(factors, runs_, spec.seed)
                                 : emulator::latin_hypercube(factors, runs_, spec.seed);
  const auto fresh = emulator::random_design(factors, fresh_, spec.seed);
  const emulator::ModelFactory factory = [&] {
    return [&](std::span<const double> x, std::span<double> y) { model.evaluate(x, y); };
  };
  const auto run = [&](const emulator::Design& of, int before) {
    return unwrapped([&] {
      return emulator::run_experiment(
          of, model.outputs(), factory,
          {.threads = threads, .progress = [&](Eigen::Index done, Eigen::Index) {
             if (progress) progress(static_cast<double>(before + done) / (runs_ + fresh_));
           }});
    });
  };
  const RowMatrix values = run(design, 0);
  process_ = std::make_unique<const emulator::GaussianProcess>(
      factors, design.points, values, emulator::GaussianProcessOptions{.threads = threads});
  const RowMatrix truth = run(fresh, runs_);
  RowMatrix predicted(truth.rows(), truth.cols()), variance(truth.rows(), truth.cols());
  const auto width = static_cast<std::size_t>(truth.cols());
  for (Eigen::Index i = 0; i < truth.rows(); ++i)
    process_->evaluate(fresh.point(i), {predicted.row(i).data(), width},
                       {variance.row(i).data(), width});
  error_ = measured_error(truth, std::move(predicted), std::move(variance), true);
  const RowMatrix residual = process_->leave_one_out().mean - values;
  for (Eigen::Index k = 0; k < residual.cols(); ++k)
    error_.leave_one_out.push_back(std::sqrt(residual.col(k).array().square().mean()));
}

void OutsideEmulator::evaluate(std::span<const double> x, std::span<double> out,
                               std::span<double> variance) const {
  if (!spec_.emulator_error) {
    process_->evaluate(x, out);
    std::ranges::fill(variance, 0.0);
    return;
  }
  process_->evaluate(x, out, variance);
  for (std::size_t i = 0; i < variance.size(); ++i) variance[i] *= error_.scale[i];
}

}  // namespace wheeltap::identification
