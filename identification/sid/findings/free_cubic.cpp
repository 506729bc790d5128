#include "identification/sid/findings/free_cubic.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unsupported/Eigen/LevenbergMarquardt>

#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;

constexpr int kMostSteps = 40;   // steps of the minimisation
constexpr double kStep = 1e-5;   // step of differences, relative to each term's scale
constexpr double kFailed = 1e3;  // residual relative to its response, if the simulation fails

double rms(const Eigen::VectorXd& x) {
  return std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

/// Residuals relative to their responses, r_n / ‖y - ȳ‖, for the model with added springs.
struct Residuals : Eigen::DenseFunctor<double> {
  Residuals(const dynamics::Misfit& model, std::vector<double> known, std::vector<double> units,
            std::vector<double> response_norms)
      : Eigen::DenseFunctor<double>(static_cast<int>(units.size()),
                                    model.channels() * model.samples()),
        misfit(model),
        theta(std::move(known)),
        scales(std::move(units)),
        norms(std::move(response_norms)) {}

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& out) const {
    std::vector<double> all = theta;
    for (std::size_t i = 0; i < scales.size(); ++i) {
      all.push_back(scales[i] * x[static_cast<Eigen::Index>(i)]);
    }
    out.resize(values());
    if (!misfit.residuals(all, {out.data(), static_cast<std::size_t>(out.size())})) {
      out.setConstant(kFailed / std::sqrt(static_cast<double>(misfit.samples())));
      return 0;
    }
    for (int c = 0; c < misfit.channels(); ++c) {
      out.segment(c * misfit.samples(), misfit.samples()) /= norms[static_cast<std::size_t>(c)];
    }
    return 0;
  }

  /// The Jacobian, by forward differences.
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const {
    Eigen::VectorXd here, there, moved = x;
    (*this)(x, here);
    jacobian.resize(values(), inputs());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      moved[i] = x[i] + kStep;
      (*this)(moved, there);
      jacobian.col(i) = (there - here) / kStep;
      moved[i] = x[i];
    }
    return 0;
  }

  const dynamics::Misfit& misfit;
  std::vector<double> theta, scales, norms;
};

/// ‖y - ȳ‖ of each response.
std::vector<double> norms_of(const SidProblem& problem, std::span<const double> theta) {
  std::vector<double> out;
  for (std::size_t c = 0; c < problem.sid_case.responses().size(); ++c) {
    const std::vector<double> y = observed(problem, c, theta);
    const double mean = std::accumulate(y.begin(), y.end(), 0.0) / static_cast<double>(y.size());
    double sum = 0.0;
    for (const double value : y) sum += (value - mean) * (value - mean);
    out.push_back(std::sqrt(sum));
  }
  return out;
}

/// Scales at which each term is as large as the inertia force. ω is a link's RMS speed divided by
/// its RMS extension e, and m the smaller mass at its ends: k = m ω², c = m ω, k₂ = m ω² / e, k₃ =
/// m ω² / e².
std::vector<double> natural_scales(const SidProblem& problem, int m,
                                   std::span<const double> theta) {
  const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
  const dynamics::Simulator& simulator = problem.misfits[static_cast<std::size_t>(m)].simulator();
  std::vector<dynamics::Sensor> sensors;
  for (const auto quantity : {dynamics::Quantity::displacement, dynamics::Quantity::velocity}) {
    for (int mass = 1; mass <= model.chain.size(); ++mass) {
      sensors.push_back({.mass = mass, .quantity = quantity, .frame = dynamics::Frame::relative});
    }
  }
  const Eigen::MatrixXd motion =
      simulator.with(sensors, simulator.options()).simulate(theta).values;
  if (motion.rows() == 0) return {};
  const auto of_mass = [&](int mass, int offset) -> Eigen::VectorXd {
    return mass == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(motion.rows()))
                     : Eigen::VectorXd(motion.col(offset + mass - 1));
  };
  std::vector<double> out;
  for (const dynamics::Link& link : model.chain.links) {
    const double e = rms(of_mass(link.b, 0) - of_mass(link.a, 0));
    const double v = rms(of_mass(link.b, model.chain.size()) - of_mass(link.a, model.chain.size()));
    if (!(e > 0.0 && v > 0.0)) return {};
    double mass = std::numeric_limits<double>::infinity();
    for (const int end : {link.a, link.b}) {
      if (end == 0) continue;
      mass = std::min(mass, model.chain.masses[static_cast<std::size_t>(end - 1)].at(theta));
    }
    const double omega = v / e, k = mass * omega * omega;
    for (const double scale : {k, mass * omega, k / e, k / (e * e)}) out.push_back(scale);
  }
  return out;
}

}  // namespace

std::vector<double> free_cubic_residual(const SidProblem& problem, int m,
                                        std::span<const double> theta) {
  const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
  const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
  const std::vector<double> norms = norms_of(problem, theta);
  if (std::ranges::any_of(norms, [](double norm) { return !(norm > 0.0); })) return {};
  const std::vector<double> scales = natural_scales(problem, m, theta);
  if (scales.empty()) return {};
  dynamics::Chain chain = model.chain;
  int next = static_cast<int>(theta.size());
  for (std::size_t l = 0; l < model.chain.links.size(); ++l) {
    const dynamics::Link& link = model.chain.links[l];
    const auto free = [&] { return Coefficient::of_parameter(next++); };
    dynamics::Link beside{.a = link.a, .b = link.b, .stiffness = free(), .damping = free()};
    for (const char* law : {"quadratic", "cubic"}) {
      const Coefficient coefficient = free();
      beside.laws.push_back(dynamics::make_law(law, {&coefficient, 1}));
    }
    chain.links.push_back(std::move(beside));
  }
  dynamics::SimulatorOptions options = misfit.simulator().options();
  if (!options.extension.empty()) {
    const std::vector<double> again = options.extension;
    options.extension.insert(options.extension.end(), again.begin(), again.end());
  }
  std::vector<dynamics::Signal> observations;
  for (const SidChannel* channel : problem.sid_case.responses()) {
    observations.push_back(channel->signal);
  }
  std::optional<dynamics::Misfit> free;
  try {
    free.emplace(dynamics::Simulator(chain, problem.sid_case.excitation(),
                                     problem.sid_case.sensors(), model.initial, options),
                 observations, problem.sid_case.lead_in);
  } catch (const std::invalid_argument&) {
    return {};
  }
  Residuals residuals(*free, {theta.begin(), theta.end()}, scales, norms);
  Eigen::LevenbergMarquardt<Residuals> minimiser(residuals);
  minimiser.setMaxfev(kMostSteps);
  minimiser.setFactor(1.0);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(scales.size()));
  minimiser.minimize(x);
  Eigen::VectorXd left;
  residuals(x, left);
  std::vector<double> out;
  for (int c = 0; c < free->channels(); ++c) {
    out.push_back(left.segment(c * free->samples(), free->samples()).norm());
  }
  return out;
}

}  // namespace wheeltap::identification
