#include "apps/served_case.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "base/constants.hpp"
#include "identification/sid_predictive.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// Frequencies of a structure by its parameters.
class StructureForward final : public OutsideModel {
 public:
  explicit StructureForward(std::shared_ptr<const UpdateProblem> problem)
      : problem_(std::move(problem)), predictor_(*problem_) {
    if (problem_->modes) workspace_ = problem_->modes->make_workspace();
    for (const auto& parameter : problem_->problem.space.parameters())
      x_.push_back(parameter.prior.from_standard_normal(0.0));
  }
  [[nodiscard]] int inputs() const override { return problem_->structural; }
  [[nodiscard]] int outputs() const override {
    const ModalData& data = problem_->update_case.data;
    return data.modes() + (problem_->states ? 0 : data.predict);
  }
  void evaluate(std::span<const double> theta, std::span<double> y) override {
    std::ranges::copy(theta, x_.begin());
    if (!predictor_.solve(x_)) throw std::invalid_argument("there is no such structure");
    if (problem_->states) {
      const auto score = predictor_.score(x_);
      for (std::size_t i = 0; i < y.size(); ++i) y[i] = score.matches[i].frequency_hz;
      return;
    }
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] = std::sqrt(predictor_.modes().eigenvalues[static_cast<Eigen::Index>(i)]) / kTwoPi;
  }
  // f = √λ / 2π:  ∂f = ∂λ / (8π² f).
  bool gradient(std::span<const double> theta, std::span<const double> sensitivity,
                std::span<double> slope) override {
    if (!problem_->modes || !problem_->modes->differentiate(theta, *workspace_, modes_, slopes_))
      return by_differences(theta, sensitivity, slope);
    std::ranges::fill(slope, 0.0);
    for (std::size_t i = 0; i < sensitivity.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double f = std::sqrt(modes_.eigenvalues[at]) / kTwoPi;
      const double rate = 1.0 / (2.0 * kTwoPi * kTwoPi * f);
      for (std::size_t p = 0; p < slope.size(); ++p)
        slope[p] += sensitivity[i] * rate * slopes_.eigenvalues(at, static_cast<Eigen::Index>(p));
    }
    return true;
  }

 private:
  bool by_differences(std::span<const double> theta, std::span<const double> sensitivity,
                      std::span<double> slope) {
    std::vector<double> moved(theta.begin(), theta.end()), above(sensitivity.size()),
        below(sensitivity.size());
    for (std::size_t p = 0; p < slope.size(); ++p) {
      const double step = 1e-5 * std::max(std::abs(theta[p]), 1e-8);
      moved[p] = theta[p] + step;
      evaluate(moved, above);
      moved[p] = theta[p] - step;
      evaluate(moved, below);
      moved[p] = theta[p];
      slope[p] = 0.0;
      for (std::size_t i = 0; i < above.size(); ++i)
        slope[p] += sensitivity[i] * (above[i] - below[i]) / (2.0 * step);
    }
    return true;
  }

  std::shared_ptr<const UpdateProblem> problem_;
  ModePredictor predictor_;
  std::optional<fem::ParametricModes::Workspace> workspace_;
  fem::ParametricModes::Modes modes_;
  fem::ParametricModes::Slopes slopes_;
  std::vector<double> x_;
};

/// Frequencies of a damaged structure by its defects.
class DamageForward final : public OutsideModel {
 public:
  explicit DamageForward(std::shared_ptr<const DamageProblem> problem)
      : problem_(std::move(problem)), predictor_(*problem_) {
    for (const DefectKind& kind : problem_->damage_case.kinds) {
      if (kind.severity_prior() == nullptr)
        throw std::invalid_argument("a " + kind.name +
                                    " has a known severity: there is no number that says that "
                                    "there is none");
      inputs_ += kind.parameters() * kind.max_count;
    }
  }
  [[nodiscard]] int inputs() const override { return inputs_; }
  [[nodiscard]] int outputs() const override { return problem_->damage_case.modes(); }
  void evaluate(std::span<const double> defects, std::span<double> y) override {
    const auto& kinds = problem_->damage_case.kinds;
    const auto& space = problem_->problem.space;
    std::vector<int> counts;
    std::vector<double> present;
    for (const DefectKind& kind : kinds) {
      const auto width = static_cast<std::size_t>(kind.parameters());
      counts.push_back(0);
      for (int c = 0; c < kind.max_count; ++c, defects = defects.subspan(width)) {
        if (defects[1] == 0.0) continue;
        ++counts.back();
        present.insert(present.end(), defects.begin(),
                       defects.begin() + static_cast<std::ptrdiff_t>(width));
      }
    }
    int model = 0;
    while (model < space.size() && space[model].counts != counts) ++model;
    if (model == space.size())
      throw std::invalid_argument("the case has no model with so many defects");
    std::vector<double> x;
    for (int p = 0; p < problem_->common; ++p)
      x.push_back(space.prior(model, p).from_standard_normal(0.0));
    x.insert(x.end(), present.begin(), present.end());
    predictor_.solve(model, x, y);
    if (!std::ranges::all_of(y, [](double f) { return std::isfinite(f); }))
      throw std::invalid_argument("there is no such structure");
  }

 private:
  std::shared_ptr<const DamageProblem> problem_;
  FrequencyPredictor predictor_;
  int inputs_ = 0;
};

/// The motion of a chain by its parameters, where it was measured: record after record.
class ChainForward final : public OutsideModel {
 public:
  ChainForward(std::shared_ptr<const SidProblem> problem, int model)
      : problem_(std::move(problem)), model_(model), records_{problem_.get()} {
    for (const auto& record : problem_->further) records_.push_back(record.get());
  }
  [[nodiscard]] int inputs() const override { return problem_->problem.space[model_].dimension; }
  [[nodiscard]] int outputs() const override {
    int sum = 0;
    for (const SidProblem* record : records_) sum += samples_of(*record);
    return sum;
  }
  // Misfits are y - x(θ): what is measured less these is the motion, whatever was measured.
  void evaluate(std::span<const double> x, std::span<double> y) override {
    for (const SidProblem* record : records_) {
      const std::vector<double> theta = record->theta(model_, x);
      const auto own = y.first(static_cast<std::size_t>(samples_of(*record)));
      y = y.subspan(own.size());
      if (!misfit(*record).residuals(theta, own))
        throw std::invalid_argument(
            "the chain has no such motion: it runs away, or makes no sense");
      for (std::size_t c = 0, at = 0; at < own.size(); ++c)
        for (const double measured : observed(*record, c, theta)) {
          own[at] = measured - own[at];
          ++at;
        }
    }
  }

 private:
  [[nodiscard]] const dynamics::Misfit& misfit(const SidProblem& record) const {
    return record.misfits[static_cast<std::size_t>(model_)];
  }
  [[nodiscard]] int samples_of(const SidProblem& record) const {
    return misfit(record).channels() * misfit(record).samples();
  }
  std::shared_ptr<const SidProblem> problem_;
  int model_;
  std::vector<const SidProblem*> records_;
};

/// ln p(data | x), and ln p(x) with it where it is the posterior's.
class Density final : public OutsideModel {
 public:
  Density(const inference::Problem& problem, int model, bool with_prior)
      : space_(problem.space),
        likelihood_(problem.likelihood()),
        model_(model),
        with_prior_(with_prior) {}
  [[nodiscard]] int inputs() const override { return space_[model_].dimension; }
  [[nodiscard]] int outputs() const override { return 1; }
  void evaluate(std::span<const double> x, std::span<double> y) override {
    double prior = 0.0;
    for (int p = 0; p < inputs(); ++p)
      prior += space_.prior(model_, p).log_density(x[static_cast<std::size_t>(p)]);
    // Beyond its prior a parameter may be no structure's.
    y[0] = std::isfinite(prior) ? likelihood_->log_likelihood(model_, x) : prior;
    if (with_prior_ && std::isfinite(prior)) y[0] += prior;
  }
  bool gradient(std::span<const double> x, std::span<const double> sensitivity,
                std::span<double> slope) override {
    if (with_prior_ || !likelihood_->gradient(model_, x, slope)) return false;
    for (double& s : slope) s *= sensitivity[0];
    return true;
  }

 private:
  const inference::ModelSpace& space_;
  std::unique_ptr<inference::Likelihood> likelihood_;
  int model_;
  bool with_prior_;
};

/// Whether there are derivatives: at the medians of the priors.
bool has_gradient(const inference::Problem& problem, int model) {
  Density trial(problem, model, false);
  std::vector<double> x, slope(static_cast<std::size_t>(trial.inputs()));
  for (int p = 0; p < trial.inputs(); ++p)
    x.push_back(problem.space.prior(model, p).from_standard_normal(0.0));
  const double one = 1.0;
  return !x.empty() && trial.gradient(x, {&one, 1}, slope);
}

template <class AnyProblem>
void add_densities(const std::shared_ptr<const AnyProblem>& problem,
                   std::vector<ServedModel>& out) {
  const inference::Problem& asked = problem->problem;
  for (int m = 0; m < asked.space.size(); ++m) {
    if (asked.space[m].dimension == 0) continue;  // the protocol has no empty vectors
    const std::string name = asked.space.size() > 1 ? " " + asked.space[m].name : "";
    for (const bool with_prior : {false, true})
      out.push_back({.name = (with_prior ? "posterior" : "log_likelihood") + name,
                     .has_gradient = !with_prior && has_gradient(asked, m),
                     .make = [problem, m, with_prior] {
                       return std::make_unique<Density>(problem->problem, m, with_prior);
                     }});
  }
}

}  // namespace

std::vector<ServedModel> served(std::shared_ptr<const UpdateProblem> problem) {
  std::vector<ServedModel> out = {
      {.name = "forward", .has_gradient = problem->modes != nullptr, .make = [problem] {
         return std::make_unique<StructureForward>(problem);
       }}};
  add_densities(problem, out);
  return out;
}

std::vector<ServedModel> served(std::shared_ptr<const DamageProblem> problem) {
  std::vector<ServedModel> out = {
      {.name = "forward", .make = [problem] { return std::make_unique<DamageForward>(problem); }}};
  add_densities(problem, out);
  return out;
}

std::vector<ServedModel> served(std::shared_ptr<const SidProblem> problem) {
  const inference::ModelSpace& space = problem->problem.space;
  std::vector<ServedModel> out;
  for (int m = 0; m < space.size(); ++m) {
    if (space[m].dimension == 0) continue;  // as below
    out.push_back({.name = space.size() > 1 ? "forward " + space[m].name : "forward",
                   .make = [problem, m] { return std::make_unique<ChainForward>(problem, m); }});
  }
  add_densities(problem, out);
  return out;
}

}  // namespace wheeltap::apps
