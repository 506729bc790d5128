#include "dynamics/chain.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace wheeltap::dynamics {

namespace {

template <class Visitor>
void for_each_coefficient(const Chain& chain, Visitor visit) {
  for (const Coefficient& mass : chain.masses) visit(mass);
  for (const Link& link : chain.links) {
    visit(link.stiffness);
    visit(link.damping);
    for (const Law& law : link.laws)
      for (const Coefficient& c : law.coefficients) visit(c);
  }
}

std::array<double, kMaxLawCoefficients> values(const Law& law, std::span<const double> theta) {
  std::array<double, kMaxLawCoefficients> c;
  std::transform(law.coefficients.begin(), law.coefficients.end(), c.begin(),
                 [&](const Coefficient& coefficient) { return coefficient.at(theta); });
  return c;
}

/// True if the constant coefficients are feasible for some values of the other coefficients.
bool constants_feasible(const Law& law) {
  const LawInfo& info = law_infos()[static_cast<std::size_t>(law.kind)];
  std::array<double, kMaxLawCoefficients> c{};
  bool all_known = true;
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.size()); ++i) {
    const Coefficient& coefficient = law.coefficients[i];
    all_known = all_known && coefficient.is_constant();
    c[i] = coefficient.value;
    if (coefficient.is_constant() && !info.coefficients[i].allows(c[i])) return false;
  }
  return !all_known || is_feasible(law.kind, c.data());
}

}  // namespace

bool Chain::is_linear() const {
  return std::all_of(links.begin(), links.end(),
                     [](const Link& link) { return link.laws.empty(); });
}

int Chain::parameters() const {
  int count = 0;
  for_each_coefficient(*this,
                       [&](const Coefficient& c) { count = std::max(count, c.parameter + 1); });
  return count;
}

void validate(const Chain& chain) {
  const auto fail = [](const std::string& what) { throw std::invalid_argument("chain: " + what); };
  const int n = chain.size();
  if (n < 1) fail("no masses, must be at least 1");
  if (chain.links.empty()) fail("no links, must be at least 1");
  for (int i = 0; i < n; ++i) {
    const Coefficient& mass = chain.masses[static_cast<std::size_t>(i)];
    if (mass.is_constant() && !(mass.value > 0.0 && std::isfinite(mass.value)))
      fail("mass " + std::to_string(i + 1) + " = " + std::to_string(mass.value) + ", must be > 0");
  }
  for (std::size_t l = 0; l < chain.links.size(); ++l) {
    const Link& link = chain.links[l];
    const std::string name = "link " + std::to_string(l);
    for (int end : {link.a, link.b})
      if (end < 0 || end > n)
        fail(name + " ends at mass " + std::to_string(end) + ", must be in [0, " +
             std::to_string(n) + "]");
    if (link.a == link.b) fail(name + " joins mass " + std::to_string(link.a) + " to itself");
    for (const Coefficient* c : {&link.stiffness, &link.damping})
      if (c->is_constant() && !std::isfinite(c->value))
        fail(name + " has a coefficient that is not finite");
    for (const Law& law : link.laws) {
      if (law.kind < 0 || law.kind >= LawList::kSize)
        fail(name + " has a law of kind " + std::to_string(law.kind) + ", must be in [0, " +
             std::to_string(LawList::kSize) + ")");
      if (!constants_feasible(law))
        fail(name + ": infeasible coefficients for its law " +
             std::string(law_infos()[static_cast<std::size_t>(law.kind)].name));
    }
  }
}

std::string impossibility(const Chain& chain, std::span<const double> theta) {
  const auto shown = [](double x) {
    std::ostringstream out;
    out << std::setprecision(6) << x;
    return out.str();
  };
  for (std::size_t i = 0; i < chain.masses.size(); ++i) {
    const double mass = chain.masses[i].at(theta);
    if (!(mass > 0.0))
      return "mass " + std::to_string(i + 1) + " = " + shown(mass) + ", must be > 0";
  }
  for (const Link& link : chain.links) {
    const std::string where =
        " of the link between " + std::to_string(link.a) + " and " + std::to_string(link.b);
    for (const auto& [what, coefficient] :
         {std::pair{"stiffness", link.stiffness}, std::pair{"damping", link.damping}})
      if (const double value = coefficient.at(theta); !std::isfinite(value))
        return what + where + " = " + shown(value) + ", must be finite";
    for (const Law& law : link.laws) {
      const LawInfo& info = law_infos()[static_cast<std::size_t>(law.kind)];
      const std::string name = std::string(info.name) + where;
      const auto c = values(law, theta);
      for (std::size_t i = 0; i < static_cast<std::size_t>(info.size()); ++i) {
        const LawCoefficient& known = info.coefficients[i];
        if (known.allows(c[i])) continue;
        const std::string bound =
            !std::isfinite(c[i]) ? "must be finite"
            : c[i] <= known.lower
                ? "must be " + std::string(known.above_lower ? "> " : ">= ") + shown(known.lower)
                : "must be <= " + shown(known.upper);
        return name + ": " + std::string(known.name) + " = " + shown(c[i]) + ", " + bound;
      }
      if (!is_feasible(law.kind, c.data()))
        return name + ": its coefficients are not feasible together";
      if (has_zero_creep_speed(law, c.data()))
        return name +
               ": velocity = 0 as a parameter's value, must be > 0 (omit velocity for exact "
               "friction)";
    }
  }
  return "";
}

LinearMatrices linear_matrices(const Chain& chain, std::span<const double> theta) {
  const int n = chain.size();
  LinearMatrices m{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n),
                   Eigen::MatrixXd::Zero(n, n)};
  for (int i = 0; i < n; ++i) m.mass(i, i) = chain.masses[static_cast<std::size_t>(i)].at(theta);
  for (const Link& link : chain.links) {
    const auto add = [a = link.a - 1, b = link.b - 1](Eigen::MatrixXd& matrix, double value) {
      if (a >= 0) matrix(a, a) += value;
      if (b >= 0) matrix(b, b) += value;
      if (a >= 0 && b >= 0) {
        matrix(a, b) -= value;
        matrix(b, a) -= value;
      }
    };
    add(m.stiffness, link.stiffness.at(theta));
    add(m.damping, link.damping.at(theta));
  }
  return m;
}

Rates stiffest_rates(const Chain& chain, std::span<const double> theta,
                     std::span<const double> extension) {
  // Row i of M⁻¹ K has the absolute sum (Σ k over links at i + Σ k over links to other masses) /
  // m_i. The memory is thread-local, so that a likelihood does not allocate.
  thread_local std::vector<Slopes> rows;
  rows.assign(chain.masses.size() + 1, {});
  for (std::size_t l = 0; l < chain.links.size(); ++l) {
    const Link& link = chain.links[l];
    Slopes slopes{std::abs(link.stiffness.at(theta)), std::abs(link.damping.at(theta))};
    const double e_max = l < extension.size() ? extension[l] : 0.0;
    for (const Law& law : link.laws) {
      const auto c = values(law, theta);
      LawList::visit(law.kind, [&](auto instance) {
        const Slopes more = decltype(instance)::slopes(c.data(), e_max);
        slopes.stiffness += more.stiffness;
        slopes.damping += more.damping;
      });
    }
    const double weight = link.a == 0 || link.b == 0 ? 1.0 : 2.0;
    for (int end : {link.a, link.b}) {
      rows[static_cast<std::size_t>(end)].stiffness += weight * slopes.stiffness;
      rows[static_cast<std::size_t>(end)].damping += weight * slopes.damping;
    }
  }
  Rates rates;
  for (std::size_t i = 1; i <= chain.masses.size(); ++i) {
    const double mass = chain.masses[i - 1].at(theta);
    rates.frequency = std::max(rates.frequency, std::sqrt(rows[i].stiffness / mass));
    rates.damping = std::max(rates.damping, rows[i].damping / mass);
  }
  return rates;
}

bool is_paced(const Chain& chain) {
  return std::any_of(chain.links.begin(), chain.links.end(), [](const Link& link) {
    return std::any_of(link.laws.begin(), link.laws.end(), [](const Law& law) {
      return law_infos()[static_cast<std::size_t>(law.kind)].paced;
    });
  });
}

void paces(const Chain& chain, std::span<const double> theta, std::span<double> pace) {
  const auto inverse_mass = [&](int mass) {
    return mass == 0 ? 0.0 : 1.0 / chain.masses[static_cast<std::size_t>(mass - 1)].at(theta);
  };
  for (std::size_t l = 0; l < chain.links.size(); ++l) {
    const Link& link = chain.links[l];
    pace[l] = 0.0;
    for (const Law& law : link.laws) {
      const auto c = values(law, theta);
      LawList::visit(law.kind, [&](auto instance) {
        const Slopes slopes = decltype(instance)::slopes(c.data(), 0.0);
        pace[l] += slopes.memory_per_speed +
                   slopes.damping_per_speed * (inverse_mass(link.a) + inverse_mass(link.b));
      });
    }
  }
}

}  // namespace wheeltap::dynamics
