#include "apps/remote/served_case.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// Frequencies of a structure as a function of its parameters.
class StructureForward final : public OutsideModel {
 public:
  explicit StructureForward(std::shared_ptr<const UpdateProblem> problem)
      : problem_(std::move(problem)), predictor_(*problem_) {
    if (problem_->basis() != nullptr) workspace_ = problem_->basis()->make_workspace();
    for (const auto& parameter : problem_->problem.space.parameters())
      x_.push_back(parameter.prior.from_standard_normal(0.0));
  }
  [[nodiscard]] int inputs() const override { return problem_->structural; }
  [[nodiscard]] int outputs() const override {
    const ModalData& data = problem_->update_case.data;
    return data.modes() + (problem_->states() != nullptr ? 0 : data.predict);
  }
  void evaluate(std::span<const double> theta, std::span<double> y) override {
    std::ranges::copy(theta, x_.begin());
    if (!predictor_.predict(0, x_, ForwardModel::Quantity::modes, predicted_))
      throw std::invalid_argument("the structure is not valid for these parameter values");
    if (problem_->states() != nullptr) {
      const auto score = problem_->modes().score(predicted_, problem_->modal_noise(x_));
      for (std::size_t i = 0; i < y.size(); ++i) y[i] = score.matches[i].frequency_hz;
      return;
    }
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] = std::sqrt(predicted_.modes[0].eigenvalues[static_cast<Eigen::Index>(i)]) / kTwoPi;
  }
  // f = √λ / 2π:  ∂f = ∂λ / (8π² f).
  bool gradient(std::span<const double> theta, std::span<const double> sensitivity,
                std::span<double> slope) override {
    if (problem_->basis() == nullptr ||
        !problem_->basis()->differentiate(theta, *workspace_, modes_, slopes_))
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
  StructuralPredictor predictor_;
  Prediction predicted_;
  std::optional<fem::ParametricModes::Workspace> workspace_;
  fem::ParametricModes::Modes modes_;
  fem::ParametricModes::Slopes slopes_;
  std::vector<double> x_;
};

/// The log density ln p(data | x) or, for "posterior", ln p(data | x) + ln p(x).
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
    // Outside the support of its prior, a parameter may be invalid for the structure.
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

/// Number of inputs for the location of a defect. Beam: coordinate [m]. Members of other
/// structures: member (index from 0 in the order of the case) and distance [m] from its first node.
/// Joints, storeys and similar sites: their index.
std::size_t place_numbers(const DefectKind& kind) {
  return !kind.line.is_beam() && kind.type->sites == DefectType::Sites::members ? 2 : 1;
}

/// Number of inputs of a defect.
std::size_t defect_numbers(const DefectKind& kind) {
  return place_numbers(kind) + static_cast<std::size_t>(kind.parameters()) - 1;
}

/// The segment of the line of sites with this site number. Throws std::invalid_argument for an
/// unknown number.
const SiteLine::Stretch& stretch_of(const DefectKind& kind, std::span<const double> said) {
  for (const SiteLine::Stretch& stretch : kind.line.stretches())
    if (static_cast<double>(stretch.site) == said[0]) return stretch;
  std::string allowed;
  for (const SiteLine::Stretch& stretch : kind.line.stretches())
    allowed += (allowed.empty() ? "" : ", ") + std::to_string(stretch.site);
  throw std::invalid_argument(kind.site_name() + " = " + base::number(said[0]) +
                              ": must be one of " + allowed);
}

/// The coordinate x of a location on the line of all sites, and ln of the length on this line per
/// unit of the inputs (per metre of a member, or per joint). Throws std::invalid_argument for an
/// invalid location.
struct LinePlace {
  double x = 0.0, log_measure = 0.0;
};
LinePlace line_place(const DefectKind& kind, std::span<const double> said) {
  if (kind.line.is_beam()) return {.x = said[0]};
  const SiteLine::Stretch& stretch = stretch_of(kind, said);
  const double s = place_numbers(kind) > 1 ? said[1] : 0.0;
  if (!(s >= 0.0 && s <= stretch.size))
    throw std::invalid_argument("location = " + base::number(s) + ": must lie in [0, " +
                                base::number(stretch.size) + "] m, the length of member " +
                                std::to_string(stretch.site));
  const double one = stretch.size > 0.0 ? stretch.size : 1.0;
  return {.x = kind.line.x_of(stretch.site, s),
          .log_measure = std::log((stretch.end - stretch.start) / one)};
}

/// Frequencies of a damaged structure as a function of its defects, from the predictor of the
/// likelihood.
class DamageForward final : public OutsideModel {
 public:
  explicit DamageForward(std::shared_ptr<const DamageProblem> problem)
      : problem_(std::move(problem)), predictor_(*problem_, problem_->predicting()) {
    for (const DefectKind& kind : problem_->damage_case.kinds) {
      if (kind.severity_prior() == nullptr)
        throw std::invalid_argument(
            "a " + kind.name +
            " has a known severity: the inputs cannot represent a structure "
            "without defects");
      inputs_ += static_cast<int>(defect_numbers(kind)) * kind.max_count;
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
      const std::size_t width = defect_numbers(kind), places = place_numbers(kind);
      counts.push_back(0);
      for (int c = 0; c < kind.max_count; ++c, defects = defects.subspan(width)) {
        if (defects[places] == 0.0) continue;
        ++counts.back();
        present.push_back(line_place(kind, defects).x);
        const auto rest = defects.subspan(places, width - places);
        present.insert(present.end(), rest.begin(), rest.end());
      }
    }
    int model = 0;
    while (model < space.size() && space[model].counts != counts) ++model;
    if (model == space.size())
      throw std::invalid_argument("the case has no model with this number of defects");
    std::vector<double> x;
    for (int p = 0; p < problem_->common; ++p)
      x.push_back(space.prior(model, p).from_standard_normal(0.0));
    x.insert(x.end(), present.begin(), present.end());
    predictor_.solve(model, x, y);
    if (!std::ranges::all_of(y, [](double f) { return std::isfinite(f); }))
      throw std::invalid_argument("the structure is not valid for these parameter values");
  }

 private:
  std::shared_ptr<const DamageProblem> problem_;
  StructuralPredictor predictor_;
  int inputs_ = 0;
};

/// ln p(data | x), or ln p(data | x) + ln p(x) for "posterior", with the inputs of DamageForward.
class DamageDensity final : public OutsideModel {
 public:
  DamageDensity(std::shared_ptr<const DamageProblem> problem, int model, bool with_prior)
      : problem_(std::move(problem)),
        density_(problem_->problem, model, with_prior),
        with_prior_(with_prior) {
    const std::vector<int>& counts = problem_->problem.space[model].counts;
    inputs_ = problem_->common;
    for (std::size_t k = 0; k < counts.size(); ++k)
      for (int c = 0; c < counts[k]; ++c) {
        defects_.push_back(&problem_->damage_case.kinds[k]);
        inputs_ += static_cast<int>(defect_numbers(*defects_.back()));
      }
  }
  [[nodiscard]] int inputs() const override { return inputs_; }
  [[nodiscard]] int outputs() const override { return 1; }
  void evaluate(std::span<const double> said, std::span<double> y) override {
    x_.assign(said.begin(), said.begin() + problem_->common);
    said = said.subspan(x_.size());
    double log_measure = 0.0;
    for (const DefectKind* kind : defects_) {
      const std::size_t places = place_numbers(*kind), width = defect_numbers(*kind);
      const LinePlace place = line_place(*kind, said);
      x_.push_back(place.x);
      log_measure += place.log_measure;
      const auto rest = said.subspan(places, width - places);
      x_.insert(x_.end(), rest.begin(), rest.end());
      said = said.subspan(width);
    }
    density_.evaluate(x_, y);
    if (with_prior_) y[0] += log_measure;
  }
  // For a beam, the gradient is available: the parameters are the inputs.
  bool gradient(std::span<const double> said, std::span<const double> sensitivity,
                std::span<double> slope) override {
    const bool alike =
        std::ranges::all_of(defects_, [](const DefectKind* kind) { return kind->line.is_beam(); });
    return alike && density_.gradient(said, sensitivity, slope);
  }

 private:
  std::shared_ptr<const DamageProblem> problem_;
  Density density_;
  bool with_prior_;
  std::vector<const DefectKind*> defects_;
  std::vector<double> x_;
  int inputs_ = 0;
};

/// The predicted motion at the measured channels as a function of the parameters, record by record.
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
  // Misfits are y - x(θ): the measurement minus the misfit is the predicted motion.
  void evaluate(std::span<const double> x, std::span<double> y) override {
    for (const SidProblem* record : records_) {
      const std::vector<double> theta = record->theta(model_, x);
      const auto own = y.first(static_cast<std::size_t>(samples_of(*record)));
      y = y.subspan(own.size());
      if (!misfit(*record).residuals(theta, own))
        throw std::invalid_argument(
            "the response of the chain of masses is unbounded with these parameters, or the "
            "parameters "
            "are invalid");
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

using MakeDensity = std::function<std::unique_ptr<OutsideModel>(int model, bool with_prior)>;

/// True if the inputs are the parameters and the model has derivatives at the medians of their
/// priors.
bool has_gradient(const inference::Problem& problem, int model, const MakeDensity& make) {
  const std::unique_ptr<OutsideModel> trial = make(model, false);
  const inference::ModelSpace& space = problem.space;
  if (trial->inputs() != space[model].dimension) return false;
  std::vector<double> x, slope(static_cast<std::size_t>(trial->inputs()));
  for (int p = 0; p < trial->inputs(); ++p)
    x.push_back(space.prior(model, p).from_standard_normal(0.0));
  const double one = 1.0;
  return !x.empty() && trial->gradient(x, {&one, 1}, slope);
}

void add_densities(const inference::Problem& asked, const MakeDensity& make,
                   std::vector<ServedModel>& out) {
  for (int m = 0; m < asked.space.size(); ++m) {
    if (asked.space[m].dimension == 0) continue;  // the protocol does not support empty vectors
    const std::string name = asked.space.size() > 1 ? " " + asked.space[m].name : "";
    for (const bool with_prior : {false, true})
      out.push_back({.name = (with_prior ? "posterior" : "log_likelihood") + name,
                     .has_gradient = !with_prior && has_gradient(asked, m, make),
                     .make = [make, m, with_prior] { return make(m, with_prior); }});
  }
}

template <class AnyProblem>
MakeDensity of_parameters(const std::shared_ptr<const AnyProblem>& problem) {
  return [problem](int model, bool with_prior) {
    return std::make_unique<Density>(problem->problem, model, with_prior);
  };
}

}  // namespace

std::vector<ServedModel> served(std::shared_ptr<const UpdateProblem> problem) {
  std::vector<ServedModel> out = {
      {.name = "forward", .has_gradient = problem->basis() != nullptr, .make = [problem] {
         return std::make_unique<StructureForward>(problem);
       }}};
  add_densities(problem->problem, of_parameters(problem), out);
  return out;
}

std::vector<ServedModel> served(std::shared_ptr<const DamageProblem> problem) {
  std::vector<ServedModel> out = {
      {.name = "forward", .make = [problem] { return std::make_unique<DamageForward>(problem); }}};
  add_densities(
      problem->problem,
      [problem](int model, bool with_prior) {
        return std::make_unique<DamageDensity>(problem, model, with_prior);
      },
      out);
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
  add_densities(problem->problem, of_parameters(problem), out);
  return out;
}

}  // namespace wheeltap::apps
