#include "inference/model/simplex.hpp"

#include <cmath>
#include <stdexcept>

#include "base/number.hpp"

namespace wheeltap::inference {
namespace {

void require_count(const char* what, std::size_t got, std::size_t wanted) {
  if (got != wanted)
    throw std::invalid_argument("simplex: " + std::to_string(got) + " " + what + ", must be " +
                                std::to_string(wanted));
}

}  // namespace

Simplex::Simplex(std::string name, std::vector<double> alpha) {
  if (alpha.size() < 2)
    throw std::invalid_argument("simplex: alpha has " + std::to_string(alpha.size()) +
                                " values, must be 2 or more");
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    if (!(alpha[i] > 0.0 && std::isfinite(alpha[i])))
      throw std::invalid_argument("simplex: alpha[" + std::to_string(i) +
                                  "] = " + base::number(alpha[i]) + ", must be > 0 and finite");
  }
  double rest = 0.0;
  sticks_.reserve(alpha.size() - 1);
  std::vector<double> after(alpha.size(), 0.0);
  for (std::size_t i = alpha.size(); i-- > 0; rest += alpha[i]) after[i] = rest;
  for (std::size_t i = 0; i + 1 < alpha.size(); ++i)
    sticks_.push_back({name + "[" + std::to_string(i + 1) + "]", Beta{alpha[i], after[i]}});
}

std::vector<std::string> Simplex::names() const {
  std::vector<std::string> names;
  for (const Parameter& stick : sticks_) names.push_back(stick.name);
  return names;
}

std::vector<double> Simplex::shares(std::span<const double> sticks) const {
  require_count("sticks", sticks.size(), sticks_.size());
  std::vector<double> shares;
  double left = 1.0;
  for (const double v : sticks) {
    shares.push_back(left * v);
    left *= 1.0 - v;
  }
  shares.push_back(left);
  return shares;
}

}  // namespace wheeltap::inference
