#include "identification/planning/planned_structure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "base/random.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/invalid_input.hpp"
#include "identification/structural/forward/assembled_model.hpp"
#include "identification/structural/likelihood/mode_matching.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Additional computed modes, with which measured modes may also be matched.
constexpr int kFurther = 3;
/// The shapes of close modes that may rotate by more than this [rad] are not used.
constexpr double kLargestTurn = 0.3;

double log_frequency(double eigenvalue) {
  return std::log(std::sqrt(std::max(eigenvalue, 1e-300)) / kTwoPi);
}

/// P(x < bound) of a prior.
double probability_below(const inference::Prior& prior, double bound) {
  const double z = prior.to_standard_normal(bound);
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Standard deviation of a mode's rotation towards another mode due to model errors, from the
/// eigenvalues of both modes; see ModalLikelihood.
double turn_between(double one, double other) {
  const double mean = 0.5 * (one + other);
  const double gap = std::max(std::abs(one - other) / mean, 1e-2 * ModalLikelihood::kMixing);
  if (gap >= ModalLikelihood::kClose) return 0.0;
  return ModalLikelihood::kMixing *
         std::sqrt(1.0 / (gap * gap) - 1.0 / (ModalLikelihood::kClose * ModalLikelihood::kClose));
}

int elastic_modes(const DamageCase& damage_case, const AnyStructure& structure) {
  int elastic =
      static_cast<int>(fem::mode_count(discretise(structure))) - damage_case.rigid_body_modes;
  for (const DefectKind& kind : damage_case.kinds)
    elastic -= kind.type->may_be_known ? kind.max_count : 0;
  return elastic;
}

std::string place_name(const DefectKind& kind, const TestPlace& place) {
  const SiteLine::Stretch& stretch = kind.line.stretches()[index(place.stretch)];
  const double middle = 0.5 * (place.start + place.end);
  if (kind.line.is_beam()) return base::significant(middle, 4) + " m";
  if (stretch.size == 0.0) return stretch.name;
  return stretch.name + " at " + base::significant(middle, 4) + " m";
}

void check(const DamageCase& damage_case) {
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    if (kind.extent_prior)
      throw InvalidInput(InvalidInput::Part::severity,
                         "a plan needs a known extent: give a length or \"element\"",
                         static_cast<int>(k));
    const inference::Prior* severity = kind.severity_prior();
    if (severity == nullptr || severity->lower() < 0.0)
      throw InvalidInput(InvalidInput::Part::severity,
                         severity == nullptr
                             ? "a plan needs a prior of the severity (lower limit at least 0)"
                             : "a plan needs severities of at least 0, but the prior begins at " +
                                   base::number(severity->lower()),
                         static_cast<int>(k));
    if (!kind.type->has_low_rank)
      throw InvalidInput(InvalidInput::Part::location,
                         "a plan allows defects of members, joints, links and masses; \"" +
                             std::string(kind.type->name) + "\" changes whole substructures",
                         static_cast<int>(k));
  }
}

}  // namespace

PlannedStructure::PlannedStructure(DamageCase damage_case, PlannedStructureOptions options)
    : damage_case_(std::move(damage_case)), options_(std::move(options)) {
  check(damage_case_);
  if (unknowns() > 0 && !options_.masses.empty())
    throw InvalidInput(InvalidInput::Part::data,
                       "added masses need known coefficients: remove \"masses\", or replace the "
                       "names of \"parameters\" by numbers");
  choose_modes();
  find_places();
  Solver solver(*this);
  if (!solver.predict({}, intact_))
    throw InvalidInput(InvalidInput::Part::beam, "the intact structure has no modes");
  draw_unknowns();
}

int PlannedStructure::unknowns() const {
  return options_.unknown ? static_cast<int>(options_.unknown->parameters.size()) : 0;
}

std::shared_ptr<const ForwardModel> PlannedStructure::model_at(const VectorXd& z) const try {
  std::vector<double> values;
  for (Index i = 0; i < z.size(); ++i)
    values.push_back(options_.unknown->parameters[index(i)].prior.from_standard_normal(z[i]));
  return std::make_shared<const AssembledModel>(options_.unknown->at(values), damage_case_.kinds,
                                                model_modes_, damage_case_.rigid_body_modes,
                                                motions_);
} catch (const std::invalid_argument& error) {
  throw InvalidInput(InvalidInput::Part::beam,
                     std::string("the priors of the unknown coefficients allow an impossible "
                                 "structure: ") +
                         error.what());
}

void PlannedStructure::draw_unknowns() {
  const Index n = unknowns();
  if (n == 0) return;
  z_.resize(n, kDraws);
  for (Index i = 0; i < n; ++i) {
    // Random pairing of the centres of kDraws intervals of equal probability.
    base::Random random(0, 5, static_cast<std::uint64_t>(i), base::Purpose::simulation);
    std::vector<int> order(index(kDraws));
    std::iota(order.begin(), order.end(), 0);
    for (int k = kDraws - 1; k > 0; --k)
      std::swap(order[index(k)], order[index(random.index(k + 1))]);
    for (int k = 0; k < kDraws; ++k)
      z_(i, k) = inference::normal_quantile((order[index(k)] + 0.5) / kDraws);
  }
  for (Index k = 0; k < kDraws; ++k) draws_.push_back(model_at(z_.col(k)));
  const auto modes_at = [&](const VectorXd& z) {
    Prediction prediction;
    TestModes out;
    if (!model_at(z)->make_solver()->predict({}, {}, ForwardModel::Quantity::modes, prediction))
      throw InvalidInput(InvalidInput::Part::beam,
                         "the structure has no modes for a value that a prior allows");
    label(prediction.modes[0], out);
    out.with_mass.resize(out.in_order.size(), 0);
    return out;
  };
  for (Index i = 0; i < n; ++i)
    steps_.push_back({modes_at(VectorXd::Unit(n, i)), modes_at(-VectorXd::Unit(n, i))});
}

void PlannedStructure::choose_modes() try {
  const AnyStructure structure = damage_case_.solved_structure();
  const int rigid = damage_case_.rigid_body_modes,
            available = elastic_modes(damage_case_, structure);
  std::vector<fem::SparseRow> motions;
  for (const Sensor& sensor : options_.candidates) motions.push_back(sensor.motion);
  // The model computes shapes only if it has a sensor: use any degree of freedom.
  fem::SparseRow any{.dofs = {0}, .coefficients = {1.0}};
  if (motions.empty()) motions.push_back(std::move(any));
  int wanted = std::min(available, options_.modes + kFurther);
  VectorXd eigenvalues;
  for (;;) {
    model_modes_ = rigid + wanted;
    model_ = std::make_shared<const AssembledModel>(structure, damage_case_.kinds, model_modes_,
                                                    rigid, motions);
    Prediction prediction;
    if (!model_->make_solver()->predict({}, {}, ForwardModel::Quantity::modes, prediction)) break;
    eigenvalues = prediction.modes.at(0).eigenvalues;
    chosen_.clear();
    for (Index i = 0; i < eigenvalues.size(); ++i) {
      const double f = std::sqrt(std::max(eigenvalues[i], 0.0)) / kTwoPi;
      if (f >= options_.low_hz && f <= options_.high_hz &&
          chosen_.size() < static_cast<std::size_t>(options_.modes))
        chosen_.push_back(static_cast<int>(i));
    }
    const bool beyond = wanted == available ||
                        std::sqrt(eigenvalues[eigenvalues.size() - 1]) / kTwoPi > options_.high_hz;
    if (chosen_.size() == static_cast<std::size_t>(options_.modes) || beyond) break;
    wanted = std::min(available, 2 * wanted);
  }
  motions_ = motions;
  if (chosen_.empty())
    throw InvalidInput(InvalidInput::Part::data, "the structure has no mode in the band");
  for (const AddedMass& mass : options_.masses)
    with_mass_.push_back(std::make_shared<const AssembledModel>(mass.structure, damage_case_.kinds,
                                                                rigid + chosen_.back() + 1, rigid));
  close_.assign(chosen_.size(), -1);
  turns_.resize(chosen_.size());
  const int first = chosen_.front(), count = static_cast<int>(chosen_.size());
  for (int j = std::max(first - 1, 0); j < first + count && j + 1 < eigenvalues.size(); ++j) {
    const double tau = turn_between(eigenvalues[j], eigenvalues[j + 1]);
    if (tau == 0.0) continue;
    // One of the two modes may lie outside the measured ones: below or above them.
    const int a = j - first, b = a + 1;
    const bool has_a = a >= 0, has_b = b < count;
    if (tau > kLargestTurn) {
      if (has_a && close_[index(a)] < 0) close_[index(a)] = a;
      if (has_b) close_[index(b)] = has_a ? close_[index(a)] : b;
    }
    int other_a = a, other_b = b;  // columns of the shapes
    if (!has_a || !has_b) {
      neighbours_.push_back(has_a ? j + 1 : j);
      (has_a ? other_b : other_a) = count + static_cast<int>(neighbours_.size()) - 1;
    }
    if (has_a && tau > turns_[index(a)].tau) turns_[index(a)] = {other_b, tau};
    if (has_b && tau > turns_[index(b)].tau) turns_[index(b)] = {other_a, tau};
  }
} catch (const fem::InvalidStructure& error) {
  throw InvalidInput(InvalidInput::Part::beam, error.what());
}

void PlannedStructure::find_places() {
  int cells = 0;
  for (const DefectKind& kind : kinds()) cells += kind.line.cells();
  const int together = std::max(1, (cells + options_.most_places - 1) / options_.most_places);
  for (std::size_t k = 0; k < kinds().size(); ++k) {
    const DefectKind& kind = kinds()[k];
    std::vector<int>& of_cell =
        place_of_cell_.emplace_back(static_cast<std::size_t>(kind.line.cells()), -1);
    double sum = 0.0;
    for (int c = 0; c < kind.line.cells();) {
      const int stretch = kind.line.stretch_of_cell(c);
      int end = c;
      while (end < kind.line.cells() && end < c + together &&
             kind.line.stretch_of_cell(end) == stretch)
        ++end;
      const SiteLine::Stretch& s = kind.line.stretches()[index(stretch)];
      TestPlace place{.kind = static_cast<int>(k),
                      .from = kind.line.cell_start(c),
                      .to = kind.line.cell_start(end),
                      .stretch = stretch};
      const auto metres = [&](double x) { return (x - s.start) / (s.end - s.start) * s.size; };
      place.start = metres(place.from);
      place.end = metres(place.to);
      // The middle of the middle cell, within the support of the prior.
      const int middle = (c + end - 1) / 2;
      const double low = std::max(kind.line.cell_start(middle), kind.location.lower());
      const double high = std::min(kind.line.cell_start(middle + 1), kind.location.upper());
      place.location = low < high ? 0.5 * (low + high) : 0.5 * (place.from + place.to);
      place.prior =
          probability_below(kind.location, place.to) - probability_below(kind.location, place.from);
      place.name = place_name(kind, place);
      if (place.prior > 1e-12) {
        for (int cell = c; cell < end; ++cell)
          of_cell[index(cell)] = static_cast<int>(places_.size());
        sum += place.prior;
        places_.push_back(std::move(place));
      }
      c = end;
    }
    int count = 0;
    for (TestPlace& place : places_)
      if (place.kind == static_cast<int>(k)) {
        place.prior /= sum;
        ++count;
      }
    if (kind.max_count > 1 && count < 2)
      throw InvalidInput(
          InvalidInput::Part::models,
          "two damages of one kind need two possible locations; there is " + std::to_string(count),
          static_cast<int>(k));
  }
}

int PlannedStructure::place_of(int kind, double location) const {
  return place_of_cell_[index(kind)][index(kinds()[index(kind)].line.cell_at(location))];
}

std::vector<double> PlannedStructure::frequencies_hz() const {
  std::vector<double> out;
  for (const double f : intact_.in_order) out.push_back(std::exp(f));
  return out;
}

void PlannedStructure::label(const fem::ParametricModes::Modes& modes, TestModes& out) const {
  const auto n = static_cast<Index>(chosen_.size());
  const auto candidates = static_cast<Index>(options_.candidates.size());
  out.in_order.resize(n);
  out.log_frequencies.resize(n);
  const auto further = static_cast<Index>(neighbours_.size());
  out.shapes.resize(candidates, n + further);
  for (Index i = 0; candidates > 0 && i < further; ++i)
    out.shapes.col(n + i) = modes.shapes.col(neighbours_[index(i)]);
  for (Index i = 0; i < n; ++i) {
    const int j = chosen_[index(i)];
    out.in_order[i] = log_frequency(modes.eigenvalues[j]);
    out.log_frequencies[i] = out.in_order[i];
    if (candidates > 0) out.shapes.col(i) = modes.shapes.col(j);
  }
  if (candidates < 2 || intact_.shapes.size() == 0) return;
  const auto mac = [&](Index i, Index j) {
    const auto a = intact_.shapes.col(i);
    const auto b = modes.shapes.col(j);
    const double ab = a.dot(b), norms = a.squaredNorm() * b.squaredNorm();
    return norms > 0.0 ? ab * ab / norms : 0.0;
  };
  bool in_order = true;
  for (Index i = 0; i < n && in_order; ++i)
    in_order = close_[index(i)] >= 0 || mac(i, chosen_[index(i)]) > 0.9;
  if (!in_order) {
    const Index first = std::max(0, chosen_.front() - kFurther);
    const Index count =
        std::min<Index>(modes.eigenvalues.size(), chosen_.back() + 1 + kFurther) - first;
    MatrixXd costs(n, count);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < count; ++j)
        costs(i, j) =
            1.0 - mac(i, first + j) +
            0.5 * std::abs(log_frequency(modes.eigenvalues[first + j]) - intact_.in_order[i]);
    const std::vector<int> to = least_cost_assignment(costs);
    for (Index i = 0; i < n; ++i) {
      const Index j = first + to[index(i)];
      out.log_frequencies[i] = log_frequency(modes.eigenvalues[j]);
      out.shapes.col(i) = modes.shapes.col(j);
    }
  }
  for (Index i = 0; i < n; ++i) {
    if (intact_.shapes.col(i).dot(out.shapes.col(i)) < 0.0) out.shapes.col(i) *= -1.0;
    // Sort close modes by their frequencies.
    if (close_[index(i)] != i) continue;
    Index end = i;
    while (end < n && close_[index(end)] == i) ++end;
    std::sort(out.log_frequencies.data() + i, out.log_frequencies.data() + end);
  }
}

PlannedStructure::Solver::Solver(const PlannedStructure& structure)
    : structure_(structure), solver_(structure.model_->make_solver()) {
  for (const auto& model : structure.with_mass_) with_mass_.push_back(model->make_solver());
}

bool PlannedStructure::Solver::predict(const std::vector<PlacedDefect>& defects, TestModes& out,
                                       int draw) {
  ForwardModel::Solver* solver = solver_.get();
  if (draw >= 0) {
    draws_.resize(structure_.draws_.size());
    if (!draws_[index(draw)]) draws_[index(draw)] = structure_.draws_[index(draw)]->make_solver();
    solver = draws_[index(draw)].get();
  }
  if (!solver->predict({}, defects, ForwardModel::Quantity::modes, prediction_)) return false;
  structure_.label(prediction_.modes[0], out);
  const auto n = static_cast<Index>(structure_.chosen_.size());
  out.with_mass.resize(n, static_cast<Index>(with_mass_.size()));
  frequencies_.frequencies_hz.resize(index(structure_.chosen_.back() + 1));
  for (std::size_t m = 0; m < with_mass_.size(); ++m) {
    if (!with_mass_[m]->predict({}, defects, ForwardModel::Quantity::frequencies, frequencies_))
      return false;
    for (Index i = 0; i < n; ++i)
      out.with_mass(i, static_cast<Index>(m)) =
          std::log(frequencies_.frequencies_hz[index(structure_.chosen_[index(i)])]);
  }
  return true;
}

}  // namespace wheeltap::identification::planning
