#include "identification/structural/updating/mode_numbering.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/structure_family.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMissed = 0.05, kNoMode = 0.1;
constexpr double kModelError = 0.02;
constexpr int kFurther = 3;                  // number of modes that may have been missed
constexpr std::size_t kMostOthers = 20'000;  // largest number of compared numberings
constexpr int kNumberingDraws = 400, kFewNumberingDraws = 60;
/// Degrees of freedom times draws, at most. Larger structures have fewer draws; structures with too
/// many degrees of freedom for kFewNumberingDraws are not checked.
constexpr double kNumberingWork = 3e5;

/// All numberings, starting with the assumed one, and ln of their prior weights.
struct Numberings {
  std::vector<std::vector<int>> list;
  std::vector<double> log_weight;
};

void extend(const std::vector<int>& used, int modes, std::vector<int>& begun, int missed,
            double log_weight, Numberings& out) {
  if (out.list.size() == kMostOthers) return;
  const std::size_t i = begun.size();
  if (i == used.size()) {
    out.list.push_back(begun);
    out.log_weight.push_back(log_weight);
    return;
  }
  const int before = i == 0 ? -1 : begun[i - 1];
  const int known = used[i] - (i == 0 ? -1 : used[i - 1]) - 1;  // known gap
  const auto with = [&](int gap) {
    const int at = before + gap + 1, more = gap - known;
    if (at >= modes || gap < 0 || missed + std::max(0, more) > kFurther) return;
    begun.push_back(at);
    extend(used, modes, begun, missed + std::max(0, more),
           log_weight + (more > 0 ? more * std::log(kMissed) : -more * std::log(kNoMode)), out);
    begun.pop_back();
  };
  with(known);
  for (int off = 1; off <= std::max(known, kFurther); ++off) {
    with(known - off);
    with(known + off);
  }
}

}  // namespace

NumberingFinding judge_numbering(const MatrixXd& ln_f, const std::vector<int>& measured,
                                 const VectorXd& ln_measured, const MatrixXd& covariance) {
  const VectorXd mean = ln_f.colwise().mean();
  const MatrixXd centred = ln_f.rowwise() - mean.transpose();
  const MatrixXd spread =
      centred.transpose() * centred / static_cast<double>(std::max<Index>(1, ln_f.rows() - 1));
  Numberings numberings;
  std::vector<int> begun;
  extend(measured, static_cast<int>(ln_f.cols()), begun, 0, 0.0, numberings);
  std::vector<double> log_posterior;
  for (std::size_t k = 0; k < numberings.list.size(); ++k) {
    const std::vector<int>& b = numberings.list[k];
    MatrixXd c = spread(b, b) + covariance;
    c.diagonal().array() += kModelError * kModelError;
    const Eigen::LLT<MatrixXd> llt(c);
    const double square = llt.matrixL().solve(ln_measured - mean(b)).squaredNorm();
    log_posterior.push_back(numberings.log_weight[k] - 0.5 * square -
                            llt.matrixLLT().diagonal().array().log().sum());
  }
  const double top = std::ranges::max(log_posterior);
  double sum = 0.0;
  for (double& l : log_posterior) sum += l = std::exp(l - top);
  NumberingFinding out{.measured = measured,
                       .probability = log_posterior.front() / sum,
                       .likeliest = {},
                       .draws = static_cast<int>(ln_f.rows())};
  for (int& number : out.measured) ++number;
  for (std::size_t k = 1; k < log_posterior.size(); ++k)
    if (log_posterior[k] / sum > out.likeliest.probability)
      out.likeliest = {.modes = numberings.list[k], .probability = log_posterior[k] / sum};
  for (int& number : out.likeliest.modes) ++number;
  return out;
}

std::optional<NumberingFinding> numbering_of(const StructureModel& model, const ModalData& data,
                                             const MatrixXd& frequency_covariance) {
  if (data.has_shapes() || model.parameters.empty()) return {};
  std::vector<int> measured;
  for (int i = 0; i < data.modes(); ++i)
    if (!data.is_gap(i)) measured.push_back(i);
  if (measured.empty()) return {};
  std::vector<VectorXd> found;
  int modes = 0;
  // The work is a fixed number, not a time, so that the result does not depend on the computer.
  const auto size = static_cast<double>(std::max<Index>(1, discretise(model.nominal).size()));
  const int draws = std::min(kNumberingDraws, static_cast<int>(kNumberingWork / size));
  if (draws < kFewNumberingDraws) return {};
  for (const auto& values : prior_draws(model, draws)) {
    try {
      const fem::Discretisation d = discretise(model.at(values));
      const auto rigid = static_cast<int>(d.rigid_motions.cols());
      const auto available = static_cast<int>(fem::mode_count(d)) - rigid;
      const int wanted = std::min(data.modes() + kFurther, available);
      if (modes == 0) modes = wanted;
      if (wanted < modes) continue;
      const VectorXd f = fem::structure_modes(d, rigid + modes).frequencies_hz.tail(modes);
      if (f.allFinite() && f.minCoeff() > 0.0) found.emplace_back(f.array().log());
    } catch (const std::exception&) {
      continue;  // impossible structure
    }
  }
  if (static_cast<int>(found.size()) < std::max(kFewNumberingDraws, 3 * modes) ||
      measured.back() >= modes)
    return {};
  MatrixXd ln_f(static_cast<Index>(found.size()), modes);
  for (std::size_t s = 0; s < found.size(); ++s)
    ln_f.row(static_cast<Index>(s)) = found[s].transpose();
  VectorXd ln_measured(static_cast<Index>(measured.size()));
  for (std::size_t i = 0; i < measured.size(); ++i)
    ln_measured[static_cast<Index>(i)] =
        std::log(data.frequencies_hz[static_cast<std::size_t>(measured[i])]);
  const VectorXd f = ln_measured.array().exp();
  return judge_numbering(ln_f, measured, ln_measured,
                         frequency_covariance(measured, measured).cwiseQuotient(f * f.transpose()));
}

}  // namespace wheeltap::identification
