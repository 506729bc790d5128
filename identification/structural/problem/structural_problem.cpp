#include "identification/structural/problem/structural_problem.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace wheeltap::identification {
namespace {

class StructuralLikelihood final : public inference::Likelihood {
 public:
  StructuralLikelihood(const StructuralProblem& problem, const ForwardModel& model)
      : problem_(problem),
        differentiates_(model.differentiates_modes() && problem.by_modes() &&
                        problem.kinds.empty() && problem.observations.size() == 1),
        predictor_(problem, model) {}

  double log_likelihood(int model, std::span<const double> x) override {
    evaluate(-kInfinity, model, x, own_);
    return own_.log_likelihood;
  }

  void evaluate(double /*floor*/, int model, std::span<const double> x,
                inference::Evaluation& out) override {
    out.clear();
    const bool by_modes = problem_.by_modes();
    const auto rows = static_cast<std::size_t>(problem_.rows());
    predicted_.frequencies_hz.resize(rows);
    if (!predictor_.predict(
            model, x,
            by_modes ? ForwardModel::Quantity::modes : ForwardModel::Quantity::frequencies,
            predicted_)) {
      // An impossible structure has likelihood 0.
      if (by_modes) return out.prediction.assign(rows, kInfinity);
      std::ranges::fill(predicted_.frequencies_hz, kInfinity);
      predicted_.error_variance.clear();
    }
    for (const auto& placed : problem_.observations) {
      const double part =
          placed.observation->log_density(predicted_, problem_.noise_of(placed, x), out);
      const bool first = &placed == &problem_.observations.front();
      out.log_likelihood = first ? part : out.log_likelihood + part;
      if (out.log_likelihood == -kInfinity) return;
    }
  }

  bool gradient(int model, std::span<const double> x, std::span<double> out) override {
    return problem_.observations.size() == 1 && predictor_.gradient(model, x, out);
  }

  [[nodiscard]] bool has_exact_derivatives() const override { return differentiates_; }
  bool gauss_newton(int /*model*/, std::span<const double> x, std::span<const double> steps,
                    std::span<double> gradient, std::span<double> information) override {
    return differentiates_ && predictor_.gauss_newton(x, steps, gradient, information);
  }

 private:
  const StructuralProblem& problem_;
  bool differentiates_;
  StructuralPredictor predictor_;
  Prediction predicted_;
  inference::Evaluation own_;
};

}  // namespace

StructuralProblem::Row StructuralProblem::row(int mode) const {
  if (states() == nullptr) return {.mode = mode + 1};
  const auto place = states()->place(mode);
  return {.state = states()->states().list[static_cast<std::size_t>(place.state)].name,
          .mode = place.mode + 1};
}

Eigen::MatrixXd StructuralProblem::covariance(const ModalNoise& noise) const {
  return states() != nullptr ? states()->covariance(noise) : modes().of(0).covariance(noise);
}

const std::optional<ShapeDensity>& StructuralProblem::shape(int mode) const {
  if (states() == nullptr) return modes().of(0).shape(mode);
  const auto at = states()->place(mode);
  return states()->of(at.state).shape(at.mode);
}

int StructuralProblem::measured() const {
  return states() != nullptr ? states()->measured() : modes().of(0).measured();
}

void StructuralProblem::components(int m, std::span<const double> x,
                                   std::vector<PlacedDefect>& to) const {
  to.clear();
  const inference::Model& of = problem.space[m];
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const DefectKind& kind = kinds[k];
    const auto width = static_cast<std::size_t>(kind.parameters());
    for (int c = 0; c < of.counts[k]; ++c) {
      const auto at = static_cast<std::size_t>(of.offsets[k]) + width * static_cast<std::size_t>(c);
      to.push_back({.kind = static_cast<int>(k),
                    .location = x[at],
                    .severity = kind.severity_prior() ? x[at + 1] : kind.known_severity(),
                    .extent = kind.extent_prior ? x[at + width - 1] : 0.0});
    }
  }
}

std::vector<inference::Parameter> StructuralProblem::place_parameters(
    First first, const std::vector<inference::Parameter>& intact,
    const std::vector<std::shared_ptr<const Observation>>& added) {
  std::vector<inference::Parameter> out;
  const auto add = [&](std::shared_ptr<const Observation> observation) {
    const std::vector<inference::Parameter> own = observation->parameters();
    observations.push_back({std::move(observation), out.size(), own.size()});
    out.insert(out.end(), own.begin(), own.end());
  };
  const auto add_structure = [&] {
    first_theta = static_cast<int>(out.size());
    structural = static_cast<int>(intact.size());
    out.insert(out.end(), intact.begin(), intact.end());
  };
  observations.clear();
  if (first == First::structure) add_structure();
  std::visit(add, observed);
  if (first == First::noise) add_structure();
  for (const auto& observation : added) add(observation);
  return out;
}

bool StructuralPredictor::predict(int model, std::span<const double> x,
                                  ForwardModel::Quantity quantity, Prediction& out) {
  problem_.components(model, x, defects_);
  out.error_variance.clear();
  return solver_->predict(problem_.theta(x), defects_, quantity, out);
}

bool StructuralPredictor::score(int model, std::span<const double> x,
                                ModeObservation::Scored& out) {
  if (!predict(model, x, ForwardModel::Quantity::modes, out)) return false;
  out.score = problem_.modes().score(out, problem_.modal_noise(x));
  return true;
}

void StructuralPredictor::solve(int model, std::span<const double> x, std::span<double> out) {
  const auto set_infinite = [&] { std::ranges::fill(out, kInfinity); };
  if (problem_.by_modes()) {
    if (!score(model, x, scratch_)) return set_infinite();
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = scratch_.score.matches[i].frequency_hz;
    return;
  }
  scratch_.frequencies_hz.resize(out.size());
  if (!predict(model, x, ForwardModel::Quantity::frequencies, scratch_)) return set_infinite();
  std::ranges::copy(scratch_.frequencies_hz, out.begin());
}

bool StructuralPredictor::gradient(int model, std::span<const double> x, std::span<double> out) {
  if (!problem_.by_modes()) return gradient_of_frequencies(model, x, out);
  return problem_.kinds.empty() && gradient_of_modes(x, out);
}

// With r = (f_obs - f) / sd:  ∂ ln p/∂f = r / sd,  ∂ ln p/∂cv = (r² - 1) cv f_obs² / sd².
bool StructuralPredictor::gradient_of_frequencies(int model, std::span<const double> x,
                                                  std::span<double> out) {
  const FrequencyData& data = std::get<StructuralProblem::Numbered>(problem_.observed)->data();
  scratch_.frequencies_hz.resize(data.frequencies_hz.size());
  if (!predict(model, x, ForwardModel::Quantity::slopes, scratch_)) return false;
  const inference::Model& m = problem_.problem.space[model];
  const NoiseModel noise(data);
  const std::size_t at_cv = problem_.observations.front().first;
  const double cv = data.cv_prior ? x[at_cv] : 0.0;
  std::ranges::fill(out, 0.0);
  for (std::size_t i = 0; i < data.frequencies_hz.size(); ++i) {
    const double observed = data.frequencies_hz[i];
    if (std::isnan(observed)) continue;
    const double sd = noise.sd(i, cv, 0.0);
    const double residual = (observed - scratch_.frequencies_hz[i]) / sd;
    std::size_t of = i * defects_.size();
    for (std::size_t k = 0; k < problem_.kinds.size(); ++k) {
      const auto width = static_cast<std::size_t>(problem_.kinds[k].parameters());
      auto at = static_cast<std::size_t>(m.offsets[k]);
      for (int c = 0; c < m.counts[k]; ++c, ++of, at += width) {
        out[at] += residual / sd * scratch_.by_location[of];
        if (width == 2) out[at + 1] += residual / sd * scratch_.by_severity[of];
      }
    }
    if (data.cv_prior)
      out[at_cv] += (residual * residual - 1.0) * cv * (observed / sd) * (observed / sd);
  }
  return true;
}

bool StructuralPredictor::gradient_of_modes(std::span<const double> x, std::span<double> out) {
  const auto first = static_cast<std::size_t>(problem_.first_theta);
  scratch_.error_variance.clear();
  if (!solver_->gradient(problem_.theta(x), problem_.modes().of(0), problem_.modal_noise(x),
                         scratch_,
                         out.subspan(first, static_cast<std::size_t>(problem_.structural))))
    return false;
  const auto& scatters = problem_.observations.front();
  for (std::size_t p = scatters.first; p < scatters.first + scatters.count; ++p)
    out[p] = by_scatter(x, p).slope;
  return true;
}

// Noise parameters do not change the modes, so that differences are cheap.
StructuralPredictor::Bend StructuralPredictor::by_scatter(std::span<const double> x,
                                                          std::size_t p) const {
  std::vector<double> moved(x.begin(), x.end());
  const auto value = [&](double at) {
    moved[p] = at;
    return problem_.modes().score(scratch_, problem_.modal_noise(moved)).log_likelihood;
  };
  const double size = std::max(std::abs(x[p]), 1e-8), step = 1e-5 * size, wide = 1e-3 * size;
  return {
      .slope = (value(x[p] + step) - value(x[p] - step)) / (2.0 * step),
      .curvature = (2.0 * value(x[p]) - value(x[p] + wide) - value(x[p] - wide)) / (wide * wide)};
}

bool StructuralPredictor::gauss_newton(std::span<const double> x, std::span<const double> steps,
                                       std::span<double> gradient, std::span<double> information) {
  scratch_.error_variance.clear();
  if (!solver_->differentiate_modes(problem_.theta(x), scratch_, slopes_)) return false;
  const auto first = static_cast<std::size_t>(problem_.first_theta);
  const auto structural = static_cast<std::size_t>(problem_.structural), d = x.size();
  const ModalLikelihood& likelihood = problem_.modes().of(0);
  const ModalNoise noise = problem_.modal_noise(x);
  std::ranges::fill(gradient, 0.0);
  std::ranges::fill(information, 0.0);
  likelihood.slope(scratch_.modes[0], slopes_, noise, gradient.subspan(first, structural));
  const Eigen::MatrixXd of_theta = likelihood.information(scratch_.modes[0], slopes_, noise);
  for (std::size_t i = 0; i < structural; ++i)
    for (std::size_t j = 0; j < structural; ++j)
      information[(first + i) * d + first + j] =
          steps[first + i] * steps[first + j] *
          of_theta(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  const auto& scatters = problem_.observations.front();
  for (std::size_t p = scatters.first; p < scatters.first + scatters.count; ++p) {
    const Bend bend = by_scatter(x, p);
    gradient[p] = bend.slope;
    information[p * d + p] = steps[p] * steps[p] * std::max(0.0, bend.curvature);
  }
  for (std::size_t i = 0; i < d; ++i) gradient[i] *= steps[i];
  return true;
}

inference::LikelihoodFactory likelihood_of(const StructuralProblem& problem,
                                           const ForwardModel& model) {
  return [&problem, &model] { return std::make_unique<StructuralLikelihood>(problem, model); };
}

}  // namespace wheeltap::identification
