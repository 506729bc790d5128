#include "emulator/anova.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace wheeltap::emulator {
namespace {

double to_additive(Additive additive, double f) {
  switch (additive) {
    case Additive::response:
      return f;
    case Additive::logarithm:
      return std::log(f);
    case Additive::square:
      return f * f;
    case Additive::inverse_square:
      return -1.0 / (f * f);
  }
  throw std::invalid_argument("unknown additive quantity");
}

double from_additive(Additive additive, double g) {
  switch (additive) {
    case Additive::response:
      return g;
    case Additive::logarithm:
      return std::exp(g);
    case Additive::square:
      return std::sqrt(g);
    case Additive::inverse_square:
      return 1.0 / std::sqrt(-g);
  }
  throw std::invalid_argument("unknown additive quantity");
}

}  // namespace

std::string_view name(Additive additive) {
  constexpr std::array<std::string_view, 4> kNames{"response", "logarithm", "square",
                                                   "inverse-square"};
  return kNames.at(static_cast<std::size_t>(additive));
}

Additive additive_named(std::string_view text) {
  for (Additive additive :
       {Additive::response, Additive::logarithm, Additive::square, Additive::inverse_square})
    if (text == name(additive)) return additive;
  throw std::invalid_argument("additive quantity \"" + std::string(text) +
                              "\" is not one of response, logarithm, square, inverse-square");
}

AnovaEmulator::AnovaEmulator(std::vector<double> baseline, std::size_t factors_per_component,
                             Predictor single, Predictor pair, Additive additive)
    : baseline_(std::move(baseline)),
      factors_(factors_per_component),
      single_(std::move(single)),
      pair_(std::move(pair)),
      additive_(additive) {
  if (baseline_.empty()) throw std::invalid_argument("an ANOVA emulator needs responses");
  if (factors_ < 1) throw std::invalid_argument("factors per component = 0 must be >= 1");
  for (double& f : baseline_) {
    if (additive_ != Additive::response && !(f > 0.0))
      throw std::invalid_argument("baseline response " + std::to_string(f) + " has no " +
                                  std::string(name(additive_)) + ": it must be > 0");
    f = to_additive(additive_, f);
  }
}

void AnovaEmulator::evaluate(std::span<const double> x, std::span<double> out) const {
  if (x.size() % factors_ != 0)
    throw std::invalid_argument(std::to_string(x.size()) + " values: must be a multiple of the " +
                                std::to_string(factors_) + " factors of a component");
  if (out.size() != responses())
    throw std::invalid_argument("the output array has " + std::to_string(out.size()) +
                                " responses, must have " + std::to_string(responses()));
  const std::size_t count = x.size() / factors_;
  if (count == 1) return single_(x, out);
  if (count == 2) return pair_(x, out);

  // Thread-local memory for the prediction of one term, and for its argument of two components.
  thread_local std::vector<double> part, both;
  part.resize(responses());
  both.resize(2 * factors_);
  const auto k = static_cast<double>(count);
  for (std::size_t r = 0; r < out.size(); ++r)
    out[r] = (count == 0 ? 1.0 : 0.5 * (k - 1) * (k - 2)) * baseline_[r];
  const auto add = [&](double weight) {
    for (std::size_t r = 0; r < out.size(); ++r) out[r] += weight * to_additive(additive_, part[r]);
  };
  const auto component = [&](std::size_t i) { return x.subspan(i * factors_, factors_); };
  for (std::size_t i = 0; i < count; ++i) {
    single_(component(i), part);
    add(-(k - 2));
    for (std::size_t j = 0; j < i; ++j) {
      std::copy_n(component(j).begin(), factors_, both.begin());
      std::copy_n(component(i).begin(), factors_,
                  both.begin() + static_cast<std::ptrdiff_t>(factors_));
      pair_(both, part);
      add(1.0);
    }
  }
  for (double& value : out) value = from_additive(additive_, value);
}

}  // namespace wheeltap::emulator
