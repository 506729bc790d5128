#include "dynamics/step_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wheeltap::dynamics {

namespace {

/// Factor by which the number of steps increases after a failed simulation.
constexpr int kMuchFiner = 4;
constexpr int kMostRetries = 3;

bool can_refine(const SimulatorOptions& options, int factor) {
  return options.substeps <= kMaxSubsteps / factor;
}

/// The largest extension of every link in a response of all masses relative to the base.
std::vector<double> extensions(const Chain& chain, const Eigen::MatrixXd& motion) {
  std::vector<double> largest;
  for (const Link& link : chain.links) {
    Eigen::VectorXd e = Eigen::VectorXd::Zero(motion.rows());
    if (link.b > 0) e += motion.col(link.b - 1);
    if (link.a > 0) e -= motion.col(link.a - 1);
    largest.push_back(e.cwiseAbs().maxCoeff());
  }
  return largest;
}

Simulator coarsened(const Simulator& simulator) {
  SimulatorOptions options = simulator.options();
  options.step_limit *= 2.0;
  options.substeps = (options.substeps + 1) / 2;
  return simulator.with(simulator.sensors(), std::move(options));
}

double change(const Eigen::MatrixXd& coarse, const Eigen::MatrixXd& fine) {
  double largest = 0.0;
  for (Eigen::Index c = 0; c < fine.cols(); ++c) {
    const double difference = (coarse.col(c) - fine.col(c)).norm();
    if (difference > 0.0) largest = std::max(largest, difference / fine.col(c).norm());
  }
  return largest;
}

/// Simulates the motion of all masses. Returns options with which the chain can be integrated, with
/// the extensions of its links, or the reason for the failure.
std::pair<SimulatorOptions, Outcome> first_pass(const Simulator& simulator,
                                                std::span<const double> theta) {
  std::vector<Sensor> masses;
  for (int i = 1; i <= simulator.chain().size(); ++i)
    masses.push_back({.mass = i, .frame = Frame::relative});
  Simulator motion = simulator.with(masses, simulator.options());
  Response response = motion.simulate(theta);
  const Outcome first = response.outcome;
  for (int retries = 0; response.failed && response.outcome != Outcome::impossible; ++retries) {
    if (retries == kMostRetries || !can_refine(motion.options(), kMuchFiner))
      return {simulator.options(), first};
    motion = motion.refined(kMuchFiner);
    response = motion.simulate(theta);
  }
  SimulatorOptions options = motion.options();
  if (response.failed) return {options, response.outcome};
  if (simulator.options().substeps > 0)  // the user fixed the number of steps
    return {simulator.options(), first == Outcome::complete ? first : Outcome::steps_too_long};
  if (!simulator.chain().is_linear())
    options.extension = extensions(simulator.chain(), response.values);
  return {options, Outcome::complete};
}

}  // namespace

CheckedResponse checked_response(const Simulator& simulator, std::span<const double> theta,
                                 const StepCheck& check) {
  const auto [options, outcome] = first_pass(simulator, theta);
  CheckedResponse out;
  out.options = options;
  const auto fail = [&](Outcome why) {
    out.response = {.values = {}, .outcome = why, .failed = true};
    return out;
  };
  if (outcome != Outcome::complete) return fail(outcome);
  Simulator now = simulator.with(simulator.sensors(), options);
  out.response = now.simulate(theta);
  if (out.response.failed) return fail(out.response.outcome);
  if (now.integrator() == Integrator::exact) return out;
  for (int halvings = 0;; ++halvings) {
    Simulator finer = can_refine(now.options(), 2) ? now.refined(2) : now;
    Response better = finer.simulate(theta);
    if (better.failed || !can_refine(now.options(), 2)) {
      // More steps are not possible. The change from steps twice as long is then an upper bound of
      // the change.
      if (halvings > 0) break;
      const Response worse = coarsened(now).simulate(theta);
      if (worse.failed) return fail(Outcome::steps_too_long);
      out.change = change(worse.values, out.response.values);
      break;
    }
    out.change = change(out.response.values, better.values);
    if (out.change <= check.wanted || halvings == check.most_halvings || options.substeps > 0)
      break;
    if (now.integrator() == Integrator::runge_kutta && has_series(now.chain()) &&
        options.integrator == Integrator::automatic) {
      SimulatorOptions series = now.options();
      series.prefer_series = true;
      finer = now.with(now.sensors(), series);
      better = finer.simulate(theta);
      if (better.failed) break;
    }
    now = std::move(finer);
    out.response = std::move(better);
    out.options = now.options();
  }
  if (out.change > check.tolerated && options.substeps == 0) return fail(Outcome::steps_too_long);
  return out;
}

}  // namespace wheeltap::dynamics
