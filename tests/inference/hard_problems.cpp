// Each problem is a density of known mass g as likelihood: ln L = c + ln g - ln p under the prior
// p, so that Z = e^c · (mass of g where p > 0), against a model without parameters and with Z = 1.
//
// Longer than 600 lines: it is one list of independent entries that share the densities and
// helper functions.
#include "tests/inference/hard_problems.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

using std::numbers::pi;
using Vector = std::vector<double>;
using Point = std::span<const double>;

// ∫ f over [from, to] by Simpson's rule.
double integral(const std::function<double(double)>& f, double from, double to, int steps) {
  double sum = f(from) + f(to);
  for (int i = 1; i < steps; ++i) {
    sum += (i % 2 == 1 ? 4.0 : 2.0) * f(from + (to - from) * i / steps);
  }
  return sum * (to - from) / (3.0 * steps);
}

double log_sum(const Vector& terms) {
  const double top = *std::max_element(terms.begin(), terms.end());
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - top);
  return top + std::log(sum);
}

// ln N(x; mean, sd²).
double log_normal(double x, double mean, double sd) {
  const double r = (x - mean) / sd;
  return -0.5 * r * r - std::log(sd) - kLogSqrt2Pi;
}

// P(from < N(mean, sd²) < to).
double normal_mass(double from, double to, double mean, double sd) {
  const double a = (from - mean) / sd, b = (to - mean) / sd;
  return a > 0.0 ? normal_cdf(-a) - normal_cdf(-b) : normal_cdf(b) - normal_cdf(a);
}

// Volume of the unit ball.
double ball(int d) {
  return std::exp(0.5 * d * std::log(pi) - std::lgamma(0.5 * d + 1.0));
}

// A density on R^d: normalised, ∫ over the box = mass.
struct Density {
  int dimension;
  std::function<double(Point)> log;
  std::function<void(base::Random&, std::span<double>)> draw;
  double mass = 1.0;
};

class OneDensity : public Likelihood {
 public:
  OneDensity(std::function<double(Point)> log, double constant)
      : log_(std::move(log)), constant_(constant) {}
  double log_likelihood(int model, Point x) override {
    return model == 0 ? 0.0 : constant_ + log_(x);
  }

 private:
  std::function<double(Point)> log_;
  double constant_;
};

void set_probabilities(HardProblem& of) {
  Vector terms;
  for (std::size_t m = 0; m < of.log_evidence.size(); ++m) {
    terms.push_back(of.problem.space[static_cast<int>(m)].log_prior + of.log_evidence[m]);
  }
  const double total = log_sum(terms);
  for (const double term : terms) of.probability.push_back(std::exp(term - total));
}

std::string dimensions(int d) {
  return std::to_string(d) + "-d";
}

// `density` in a box with uniform prior, against a model without parameters, whose probability is 1
// - p if all the mass is in the box.
HardProblem against_nothing(const std::string& family, const std::string& variant,
                            const Density& density, const Vector& lower, const Vector& upper,
                            double p) {
  const int d = density.dimension;
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  double log_volume = 0.0;
  for (int i = 0; i < d; ++i) {
    const auto j = static_cast<std::size_t>(i);
    names.push_back("x" + std::to_string(i + 1));
    parameters.push_back({names.back(), Uniform{lower[j], upper[j]}});
    log_volume += std::log(upper[j] - lower[j]);
  }
  const double log_odds = std::log(p) - std::log1p(-p);
  HardProblem out{.name = family + ", " + variant,
                  .family = family,
                  .dimension = d,
                  .problem = {.space = ModelSpace::of_models(
                                  parameters, {{"nothing", 1.0, {}}, {"density", 1.0, names}}),
                              .likelihood =
                                  [=] {
                                    return std::make_unique<OneDensity>(density.log,
                                                                        log_odds + log_volume);
                                  }},
                  .probability = {},
                  .log_evidence = {0.0, log_odds + std::log(density.mass)},
                  .draw =
                      [=](int, base::Random& random, std::span<double> x) {
                        const auto outside = [&] {
                          for (std::size_t i = 0; i < x.size(); ++i) {
                            if (x[i] <= lower[i] || x[i] >= upper[i]) return true;
                          }
                          return false;
                        };
                        do {
                          density.draw(random, x);
                        } while (outside());
                      },
                  .hidden = {}};
  set_probabilities(out);
  return out;
}

HardProblem against_nothing(const std::string& family, const std::string& variant,
                            const Density& density, double lower, double upper, double p) {
  const auto d = static_cast<std::size_t>(density.dimension);
  return against_nothing(family, variant, density, Vector(d, lower), Vector(d, upper), p);
}

// -- the densities
// ---------------------------------------------------------------------------------

struct Blob {
  double share;
  Vector mean;
  double width;
};

// Σ share · N(mean, width² I), in the box [lower, upper]^d.
Density blobs(const std::vector<Blob>& all, double lower, double upper) {
  double mass = 0.0;
  for (const Blob& b : all) {
    double product = b.share;
    for (const double m : b.mean) product *= normal_mass(lower, upper, m, b.width);
    mass += product;
  }
  return {.dimension = static_cast<int>(all[0].mean.size()),
          .log =
              [all](Point x) {
                double sum = -kInfinity;
                for (const Blob& b : all) {
                  double squares = 0.0;
                  for (std::size_t i = 0; i < x.size(); ++i) {
                    const double r = (x[i] - b.mean[i]) / b.width;
                    squares += r * r;
                  }
                  sum = log_sum_exp(
                      sum, std::log(b.share) - 0.5 * squares -
                               static_cast<double>(x.size()) * (std::log(b.width) + kLogSqrt2Pi));
                }
                return sum;
              },
          .draw =
              [all](base::Random& random, std::span<double> x) {
                double u = random.uniform();
                std::size_t k = 0;
                while (k + 1 < all.size() && u >= all[k].share) u -= all[k++].share;
                for (std::size_t i = 0; i < x.size(); ++i) {
                  x[i] = all[k].mean[i] + all[k].width * random.normal();
                }
              },
          .mass = mass};
}

// Pairwise correlations ρ, unit variances: with x̄ the mean,
//   xᵀR⁻¹x = Σ (x - x̄)² / (1 - ρ) + d x̄² / (1 + (d - 1) ρ),
// and x_i = √ρ u + √(1-ρ) e_i.
Density correlated(int d, double rho, double box) {
  const double across = 1.0 - rho, along = 1.0 + (d - 1) * rho;
  const double log_root = 0.5 * ((d - 1) * std::log(across) + std::log(along)) + d * kLogSqrt2Pi;
  return {.dimension = d,
          .log =
              [=](Point x) {
                double mean = 0.0, squares = 0.0;
                for (const double v : x) mean += v / d;
                for (const double v : x) squares += (v - mean) * (v - mean);
                return -0.5 * (squares / across + d * mean * mean / along) - log_root;
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                const double u = std::sqrt(rho) * random.normal();
                for (double& v : x) v = u + std::sqrt(across) * random.normal();
              },
          .mass = integral(
              [=](double u) {
                return std::exp(log_normal(u, 0.0, 1.0)) *
                       std::pow(normal_mass(-box, box, std::sqrt(rho) * u, std::sqrt(across)), d);
              },
              -8.0, 8.0, 200000)};
}

// Rate λ on [0, 1], every coordinate.
Density edges(int d, double rate) {
  return {.dimension = d,
          .log =
              [=](Point x) {
                double sum = 0.0;
                for (const double v : x)
                  sum += std::log(rate) - rate * v - std::log(-std::expm1(-rate));
                return sum;
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                for (double& v : x) v = random.exponential() / rate;
              }};
}

// Pairs x1 ~ N(0, 1), x2 ~ N(x1², width²), in [-a, a] × [low, high].
Density bananas(int pairs, double width, double a, double low, double high) {
  const double one = integral(
      [=](double x) {
        return std::exp(log_normal(x, 0.0, 1.0)) * normal_mass(low, high, x * x, width);
      },
      -a, a, 400000);
  return {.dimension = 2 * pairs,
          .log =
              [=](Point x) {
                double sum = 0.0;
                for (std::size_t i = 0; i + 1 < x.size(); i += 2) {
                  sum += log_normal(x[i], 0.0, 1.0) + log_normal(x[i + 1], x[i] * x[i], width);
                }
                return sum;
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                for (std::size_t i = 0; i + 1 < x.size(); i += 2) {
                  x[i] = random.normal();
                  x[i + 1] = x[i] * x[i] + width * random.normal();
                }
              },
          .mass = std::pow(one, pairs)};
}

// Neal (2003, Annals of Statistics 31:705, section 8): v ~ N(0, 3²), x_i ~ N(0, e^v), in |v| < a,
// |x_i| < b.
Density funnel(int d, double a, double b) {
  return {.dimension = d,
          .log =
              [](Point x) {
                double sum = log_normal(x[0], 0.0, 3.0);
                const double sd = std::exp(0.5 * x[0]);
                for (std::size_t i = 1; i < x.size(); ++i) sum += log_normal(x[i], 0.0, sd);
                return sum;
              },
          .draw =
              [](base::Random& random, std::span<double> x) {
                x[0] = 3.0 * random.normal();
                for (std::size_t i = 1; i < x.size(); ++i)
                  x[i] = std::exp(0.5 * x[0]) * random.normal();
              },
          .mass = integral(
              [=](double v) {
                return std::exp(log_normal(v, 0.0, 3.0)) *
                       std::pow(normal_mass(-b, b, 0.0, std::exp(0.5 * v)), d - 1);
              },
              -a, a, 20000)};
}

// Scale 1, |x_i| < box.
Density cauchy(int d, double box) {
  return {.dimension = d,
          .log =
              [](Point x) {
                double sum = 0.0;
                for (const double v : x) sum -= std::log(pi) + std::log1p(v * v);
                return sum;
              },
          .draw =
              [](base::Random& random, std::span<double> x) {
                for (double& v : x) v = std::tan(pi * (random.uniform() - 0.5));
              },
          .mass = std::pow(2.0 / pi * std::atan(box), d)};
}

// Beaujean & Caldwell (2013, arXiv:1304.7808): the first coordinate two log-gammas at ±10, the
// second two normals at ±10, then log-gammas for 3 <= i <= (d+2)/2 and normals for the rest, all at
// 10, in |x_i| < 30. LogGamma(x; m, 1, 1) = exp(x - m - e^(x - m)), F = 1 - exp(-e^(x - m)).
Density log_gammas(int d) {
  const auto log_gamma = [](double x, double m) { return x - m - std::exp(x - m); };
  const auto log_gamma_mass = [](double m) {
    return std::exp(-std::exp(-30.0 - m)) - std::exp(-std::exp(30.0 - m));
  };
  const int last = (d + 2) / 2;  // log-gamma, counted from 1
  double mass =
      0.5 * (log_gamma_mass(10.0) + log_gamma_mass(-10.0)) * normal_mass(-30.0, 30.0, 10.0, 1.0);
  for (int i = 3; i <= d; ++i)
    mass *= i <= last ? log_gamma_mass(10.0) : normal_mass(-30.0, 30.0, 10.0, 1.0);
  return {.dimension = d,
          .log =
              [=](Point x) {
                double sum =
                    log_sum_exp(log_gamma(x[0], 10.0), log_gamma(x[0], -10.0)) +
                    log_sum_exp(log_normal(x[1], 10.0, 1.0), log_normal(x[1], -10.0, 1.0)) -
                    2.0 * std::log(2.0);
                for (int i = 3; i <= d; ++i) {
                  const double v = x[static_cast<std::size_t>(i - 1)];
                  sum += i <= last ? log_gamma(v, 10.0) : log_normal(v, 10.0, 1.0);
                }
                return sum;
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                const auto sign = [&] { return random.uniform() < 0.5 ? -10.0 : 10.0; };
                x[0] = sign() + std::log(random.exponential());
                x[1] = sign() + random.normal();
                for (int i = 3; i <= d; ++i) {
                  x[static_cast<std::size_t>(i - 1)] =
                      10.0 + (i <= last ? std::log(random.exponential()) : random.normal());
                }
              },
          .mass = mass};
}

// Two shells about (±3.5, 0, …), N(|x - c|; radius, width²) each, with half of the mass each. Less
// than 1e-9 lies outside of ±6: five widths in one direction.
Density shells(int d, double radius, double width) {
  // ∫ S_d ρ^(d-1) N(ρ; radius, width²) dρ, S_d = d · volume of the unit ball.
  const double log_norm =
      std::log(d * ball(d) *
               integral(
                   [=](double rho) {
                     return std::pow(rho, d - 1) * std::exp(log_normal(rho, radius, width));
                   },
                   std::max(0.0, radius - 12.0 * width), radius + 12.0 * width, 20000));
  const auto distance = [](Point x, double centre) {
    double squares = (x[0] - centre) * (x[0] - centre);
    for (std::size_t i = 1; i < x.size(); ++i) squares += x[i] * x[i];
    return std::sqrt(squares);
  };
  return {.dimension = d,
          .log =
              [=](Point x) {
                return log_sum_exp(log_normal(distance(x, 3.5), radius, width),
                                   log_normal(distance(x, -3.5), radius, width)) -
                       std::log(2.0) - log_norm;
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                // ρ ~ ρ^(d-1) N(ρ; radius, width²), by rejection from the normal.
                const double most = radius + 10.0 * width;
                double rho = 0.0;
                do {
                  rho = radius + width * random.normal();
                } while (rho <= 0.0 || random.uniform() > std::pow(rho / most, d - 1));
                double squares = 0.0;
                for (double& v : x) {
                  v = random.normal();
                  squares += v * v;
                }
                for (double& v : x) v *= rho / std::sqrt(squares);
                x[0] += random.uniform() < 0.5 ? -3.5 : 3.5;
              }};
}

// ∏ exp(½ depth cos(2π n (x - top)) - ½ (x - top)² / width²) / Z₁ on [0, 1].
Density ripples(int d, double depth, double n, double width, double top) {
  const auto log_one = [=](double x) {
    const double r = (x - top) / width;
    return 0.5 * depth * (std::cos(2.0 * pi * n * (x - top)) - 1.0) - 0.5 * r * r;
  };
  const double log_z =
      std::log(integral([&](double x) { return std::exp(log_one(x)); }, 0.0, 1.0, 200000));
  return {.dimension = d,
          .log =
              [=](Point x) {
                double sum = 0.0;
                for (const double v : x) sum += log_one(v) - log_z;
                return sum;
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                for (double& v : x) {
                  do {
                    v = random.uniform();
                  } while (std::log(random.uniform()) > log_one(v));
                }
              }};
}

// ½ of the mass is a plateau in x1 with exponential decay `edge` beyond x1 = end, and ½ is a peak
// beyond that end, in the unit square.
Density plateau(double end, double edge, const Vector& top, double width) {
  const double area = end + edge * -std::expm1(-(1.0 - end) / edge);
  const double inside = normal_mass(0.0, 1.0, top[0], width) * normal_mass(0.0, 1.0, top[1], width);
  return {.dimension = 2,
          .log =
              [=](Point x) {
                const double flat = -std::max(0.0, x[0] - end) / edge - std::log(area);
                return log_sum_exp(flat, log_normal(x[0], top[0], width) +
                                             log_normal(x[1], top[1], width)) -
                       std::log(2.0);
              },
          .draw =
              [=](base::Random& random, std::span<double> x) {
                if (random.uniform() < 0.5) {
                  for (std::size_t i = 0; i < 2; ++i) x[i] = top[i] + width * random.normal();
                  return;
                }
                x[1] = random.uniform();
                if (random.uniform() * area < end) {
                  x[0] = end * random.uniform();
                } else {
                  do {
                    x[0] = end + edge * random.exponential();
                  } while (x[0] >= 1.0);
                }
              },
          .mass = 0.5 * (1.0 + inside)};
}

// -- the families
// ----------------------------------------------------------------------------------

Vector along_diagonal(int d, double distance) {
  return Vector(static_cast<std::size_t>(d), 0.5 + distance / std::sqrt(static_cast<double>(d)));
}

// The narrower of two blobs is higher in a ball (Apollonius): its share of the unit box.
double share_of_narrow(const Blob& wide, const Blob& narrow) {
  const double a = 1.0 / (narrow.width * narrow.width), b = 1.0 / (wide.width * wide.width);
  const int d = static_cast<int>(wide.mean.size());
  double apart = 0.0;
  for (std::size_t i = 0; i < wide.mean.size(); ++i)
    apart += (wide.mean[i] - narrow.mean[i]) * (wide.mean[i] - narrow.mean[i]);
  const double log_ratio =
      std::log(narrow.share / wide.share) + d * std::log(wide.width / narrow.width);
  return ball(d) * std::pow((2.0 * log_ratio + a * b / (a - b) * apart) / (a - b), 0.5 * d);
}

// Two blobs at a distance of .6 in the unit box. If one is narrower, it is the second.
HardProblem two_modes(const std::string& family, const std::string& variant, int d, double share,
                      double width, double second_width) {
  const Blob first{1.0 - share, along_diagonal(d, -0.3), width};
  const Blob second{share, along_diagonal(d, 0.3), second_width};
  HardProblem out =
      against_nothing(family, variant, blobs({first, second}, 0.0, 1.0), 0.0, 1.0, 0.5);
  if (second_width < width) {
    out.core = share_of_narrow(first, second);
    out.hidden = second.mean;
  }
  return out;
}

// A point null θ = 0 against θ ~ N(0, I), one datum y per coordinate with noise .1. At this y each
// coordinate's Bayes factor is 1.
class NestedNormal : public Likelihood {
 public:
  NestedNormal(int d, double y, double noise) : d_(d), y_(y), noise_(noise) {}
  double log_likelihood(int model, Point x) override {
    if (model == 0) return d_ * log_normal(y_, 0.0, noise_);
    double sum = 0.0;
    for (const double v : x) sum += log_normal(y_, v, noise_);
    return sum;
  }

 private:
  int d_;
  double y_, noise_;
};

HardProblem nested_normal(int d) {
  constexpr double kY = 0.2158998, kNoise = 0.1, kVariance = 1.0 + kNoise * kNoise;
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 0; i < d; ++i) {
    names.push_back("theta" + std::to_string(i + 1));
    parameters.push_back({names.back(), Normal{0.0, 1.0}});
  }
  HardProblem out{
      .name = "nested normal, " + dimensions(d),
      .family = "nested normal",
      .dimension = d,
      .problem = {.space =
                      ModelSpace::of_models(parameters, {{"zero", 1.0, {}}, {"free", 1.0, names}}),
                  .likelihood = [=] { return std::make_unique<NestedNormal>(d, kY, kNoise); }},
      .probability = {},
      .log_evidence = {d * log_normal(kY, 0.0, kNoise),
                       d * log_normal(kY, 0.0, std::sqrt(kVariance))},
      .draw =
          [](int, base::Random& random, std::span<double> x) {
            for (double& v : x)
              v = kY / kVariance + kNoise / std::sqrt(kVariance) * random.normal();
          },
      .hidden = {}};
  set_probabilities(out);
  return out;
}

// y ~ N(X θ, σ² I), θ ~ N(μ, V): ln Z = ln N(y; X μ, X V Xᵀ + σ² I).
struct LinearModel {
  Eigen::MatrixXd x;
  Eigen::VectorXd mean, sd;  // mean and sd of the prior
};

class Linear : public Likelihood {
 public:
  Linear(std::vector<LinearModel> models, Eigen::VectorXd y, double noise)
      : models_(std::move(models)), y_(std::move(y)), noise_(noise) {}
  double log_likelihood(int model, Point x) override {
    const Eigen::Map<const Eigen::VectorXd> theta(x.data(), static_cast<Eigen::Index>(x.size()));
    const LinearModel& m = models_[static_cast<std::size_t>(model)];
    return -0.5 * (y_ - m.x * theta).squaredNorm() / (noise_ * noise_) -
           static_cast<double>(y_.size()) * (std::log(noise_) + kLogSqrt2Pi);
  }

 private:
  std::vector<LinearModel> models_;
  Eigen::VectorXd y_;
  double noise_;
};

// Similar in size to the CD4 counts of the ddI/ddC study (Goldman et al. 1996; Carlin & Chib 1995
// and Han & Carlin 2001 compare such models): two patients on each of two drugs, five visits, a
// change of slope at two months,
//   y_ij = b0 + u0_i + (b1 + u1_i + drug · δ) t + (b2 + u2_i) (t - 2)₊ + noise     (16 parameters)
// against a straight line without drug,
//   y_ij = b0 + u0_i + (b1 + u1_i) t + noise                                       (10).
// Data and variances are invented to give a Bayes factor near 75; all distributions are Gaussian.
HardProblem change_point() {
  constexpr int kPatients = 4;
  constexpr double kNoise = 0.58;
  const Vector times{0.0, 2.0, 6.0, 12.0, 18.0};
  // √CD4 of the visits, patient by patient.
  const Vector data{8.9,  10.5, 9.2,  7.6,  5.9, 6.1, 7.3, 6.9, 4.2, 3.1,
                    10.8, 11.6, 10.1, 10.4, 8.8, 4.4, 5.7, 5.1, 4.0, 3.9};
  const auto rows = static_cast<Eigen::Index>(data.size());
  const auto visits = static_cast<Eigen::Index>(times.size());
  Eigen::VectorXd y(rows);
  for (Eigen::Index r = 0; r < rows; ++r) y[r] = data[static_cast<std::size_t>(r)];

  std::vector<Parameter> parameters{{"b0", Normal{8.0, 4.0}},
                                    {"b1", Normal{0.0, 1.0}},
                                    {"b2", Normal{0.0, 1.0}},
                                    {"delta", Normal{0.0, 0.5}}};
  std::vector<std::string> line{"b0", "b1"}, change{"b0", "b1", "b2", "delta"};
  for (int i = 1; i <= kPatients; ++i) {
    for (const auto& [name, sd] :
         {std::pair{"u0_", 2.0}, std::pair{"u1_", 0.1}, std::pair{"u2_", 0.1}}) {
      parameters.push_back({name + std::to_string(i), Normal{0.0, sd}});
      change.push_back(parameters.back().name);
      if (name != std::string("u2_")) line.push_back(parameters.back().name);
    }
  }
  ModelSpace space =
      ModelSpace::of_models(parameters, {{"line", 1.0, line}, {"change", 1.0, change}});

  std::vector<LinearModel> models;
  for (int m = 0; m < 2; ++m) {
    const int d = space[m].dimension;
    LinearModel& model = models.emplace_back(
        LinearModel{Eigen::MatrixXd::Zero(rows, d), Eigen::VectorXd(d), Eigen::VectorXd(d)});
    for (int j = 0; j < d; ++j) {
      const std::string name = space.parameter_name(m, j);
      model.mean[j] = space.prior(m, j).mean();
      model.sd[j] = space.prior(m, j).sd();
      const int whose = name[0] == 'u' ? std::stoi(name.substr(3)) - 1 : -1;
      for (Eigen::Index r = 0; r < rows; ++r) {
        const int patient = static_cast<int>(r / visits);
        if (whose >= 0 && whose != patient) continue;
        const double t = times[static_cast<std::size_t>(r % visits)];
        model.x(r, j) = name == "delta"  ? (patient >= 2 ? t : 0.0)
                        : name[1] == '0' ? 1.0
                        : name[1] == '1' ? t
                                         : std::max(0.0, t - 2.0);
      }
    }
  }
  HardProblem out{
      .name = "change point, 16-d against 10-d",
      .family = "change point",
      .dimension = space.max_dimension(),
      .problem = {.space = space,
                  .likelihood = [=] { return std::make_unique<Linear>(models, y, kNoise); }},
      .probability = {},
      .log_evidence = {},
      .draw = {},
      .hidden = {}};
  std::vector<Eigen::VectorXd> means;
  std::vector<Eigen::MatrixXd> factors;
  for (const LinearModel& m : models) {
    Eigen::MatrixXd s = m.x * m.sd.array().square().matrix().asDiagonal() * m.x.transpose();
    s.diagonal().array() += kNoise * kNoise;
    const Eigen::LLT<Eigen::MatrixXd> root(s);
    const Eigen::VectorXd r = root.matrixL().solve(y - m.x * m.mean);
    out.log_evidence.push_back(-0.5 * r.squaredNorm() -
                               Eigen::MatrixXd(root.matrixL()).diagonal().array().log().sum() -
                               static_cast<double>(rows) * kLogSqrt2Pi);
    // θ | y ~ N(A⁻¹ (Xᵀy/σ² + V⁻¹μ), A⁻¹), A = XᵀX/σ² + V⁻¹.
    Eigen::MatrixXd a = m.x.transpose() * m.x / (kNoise * kNoise);
    const Eigen::VectorXd precision = m.sd.array().square().inverse();
    a.diagonal() += precision;
    const Eigen::MatrixXd covariance = a.inverse();
    means.push_back(covariance * (m.x.transpose() * y / (kNoise * kNoise) +
                                  Eigen::VectorXd(precision.cwiseProduct(m.mean))));
    factors.emplace_back(Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL());
  }
  out.draw = [=](int m, base::Random& random, std::span<double> x) {
    const auto j = static_cast<std::size_t>(m);
    Eigen::VectorXd e(means[j].size());
    for (double& v : e) v = random.normal();
    Eigen::Map<Eigen::VectorXd>(x.data(), e.size()) = means[j] + factors[j] * e;
  };
  set_probabilities(out);
  return out;
}

// 30 models, each with two parameters of its own and a blob at a different place in the unit
// square. P ∝ 1, 2, …, 30.
class Disjoint : public Likelihood {
 public:
  double log_likelihood(int model, Point x) override {
    const auto [a, b] = centre(model);
    return std::log(model + 1.0) + log_normal(x[0], a, kWidth) + log_normal(x[1], b, kWidth);
  }
  static constexpr double kWidth = 0.003;
  static std::pair<double, double> centre(int model) {
    return {(model % 6 + 0.5) / 6.0, (model / 6 + 0.5) / 5.0};  // NOLINT: whole rows
  }
};

HardProblem disjoint_models() {
  constexpr int kModels = 30;
  std::vector<Parameter> parameters;
  std::vector<ModelSpace::ListedModel> models;
  for (int m = 0; m < kModels; ++m) {
    const std::string number = std::to_string(m + 1);
    parameters.push_back({"x" + number, Uniform{0.0, 1.0}});
    parameters.push_back({"y" + number, Uniform{0.0, 1.0}});
    models.push_back({number, 1.0, {"x" + number, "y" + number}});
  }
  HardProblem out{.name = "30 disjoint models",
                  .family = "disjoint models",
                  .dimension = 2,
                  .problem = {.space = ModelSpace::of_models(parameters, models),
                              .likelihood = [] { return std::make_unique<Disjoint>(); }},
                  .probability = {},
                  .log_evidence = {},
                  .asked = Asked::found_or_flagged,
                  .draw =
                      [](int m, base::Random& random, std::span<double> x) {
                        const auto [a, b] = Disjoint::centre(m);
                        x[0] = a + Disjoint::kWidth * random.normal();
                        x[1] = b + Disjoint::kWidth * random.normal();
                      },
                  .hidden = {}};
  for (int m = 0; m < kModels; ++m) {
    const auto [a, b] = Disjoint::centre(m);
    out.log_evidence.push_back(std::log((m + 1.0) * normal_mass(0.0, 1.0, a, Disjoint::kWidth) *
                                        normal_mass(0.0, 1.0, b, Disjoint::kWidth)));
  }
  set_probabilities(out);
  return out;
}

// 0 to 10 components in the unit square, L = 1 + B Σ_j N(x_j; top, width² I): uniform except for
// one narrow spot, and Z_k = 1 + B k.
class Spot : public Likelihood {
 public:
  static constexpr double kWidth = 1e-3, kB = 0.5, kX = 0.62, kY = 0.27;
  double log_likelihood(int, Point x) override {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < x.size(); i += 2) {
      sum = log_sum_exp(
          sum, std::log(kB) + log_normal(x[i], kX, kWidth) + log_normal(x[i + 1], kY, kWidth));
    }
    return sum;
  }
};

HardProblem counts_with_a_spot() {
  constexpr int kMost = 10;
  std::vector<ModelSpace::Counts> counts;
  for (int k = 0; k <= kMost; ++k) counts.push_back({{k}, 1.0});
  HardProblem out{
      .name = "counts 0..10 with a spot",
      .family = "counts with a spot",
      .dimension = 2 * kMost,
      .problem = {.space = ModelSpace::of_components(
                      {}, {{"spot", "spots", {{"x", Uniform{0.0, 1.0}}, {"y", Uniform{0.0, 1.0}}}}},
                      counts),
                  .likelihood = [] { return std::make_unique<Spot>(); }},
      .probability = {},
      .log_evidence = {},
      .asked = Asked::found_or_flagged,
      .draw =
          [](int k, base::Random& random, std::span<double> x) {
            for (double& v : x) v = random.uniform();
            if (k == 0 || random.uniform() * (1.0 + Spot::kB * k) < 1.0) return;
            const auto j = static_cast<std::size_t>(2 * random.index(k));
            x[j] = Spot::kX + Spot::kWidth * random.normal();
            x[j + 1] = Spot::kY + Spot::kWidth * random.normal();
          },
      .hidden = {}};
  for (int k = 0; k <= kMost; ++k) out.log_evidence.push_back(std::log(1.0 + Spot::kB * k));
  set_probabilities(out);
  return out;
}

class Pine : public Likelihood {
 public:
  Pine(Vector y, std::vector<Vector> x) : y_(std::move(y)), x_(std::move(x)) {}
  double log_likelihood(int model, Point p) override {
    double squares = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i) {
      const double r = y_[i] - p[0] - p[1] * x_[static_cast<std::size_t>(model)][i];
      squares += r * r;
    }
    return 0.5 * static_cast<double>(y_.size()) * std::log(p[2]) - 0.5 * p[2] * squares -
           static_cast<double>(y_.size()) * kLogSqrt2Pi;
  }

 private:
  Vector y_;
  std::vector<Vector> x_;  // relative to their mean
};

std::vector<HardProblem> all_problems() {
  std::vector<HardProblem> out;
  const auto quick = [&](HardProblem problem) {
    problem.quick = true;
    out.push_back(std::move(problem));
  };
  // Required: found, or flagged, or a basin below the resolution.
  const auto flagged = [&](HardProblem problem, double basin, bool short_suite) {
    problem.asked = Asked::found_or_flagged;
    problem.basin = basin;
    problem.quick = short_suite;
    out.push_back(std::move(problem));
  };
  const auto add = [&](HardProblem problem) {
    if (problem.dimension <= 3) problem.quick = true;
    out.push_back(std::move(problem));
  };

  for (const int d : {2, 5, 10, 20, 40}) add(nested_normal(d));
  for (const int d : {2, 10, 20}) {
    add(against_nothing("correlated", dimensions(d), correlated(d, 0.9999, 5.0), -5.0, 5.0, 0.6));
  }
  for (const int d : {1, 3, 10, 20}) {
    const Vector top(static_cast<std::size_t>(d), 0.3712);
    add(against_nothing("spike", dimensions(d), blobs({{1.0, top, 1e-6}}, 0.0, 1.0), 0.0, 1.0,
                        0.4));
  }
  for (const int d : {1, 3, 8})
    add(against_nothing("exponential edges", dimensions(d), edges(d, 1e5), 0.0, 1.0, 0.7));
  add(against_nothing("banana", dimensions(2), bananas(1, 0.01, 4.0, -1.0, 10.0), {-4.0, -1.0},
                      {4.0, 10.0}, 0.5));
  add(against_nothing("funnel", dimensions(3), funnel(3, 10.0, 50.0), {-10.0, -50.0, -50.0},
                      {10.0, 50.0, 50.0}, 0.5));
  for (const int d : {1, 2, 5})
    add(against_nothing("Cauchy", dimensions(d), cauchy(d, 1000.0), -1000.0, 1000.0, 0.5));
  for (const int d : {2, 10})
    add(against_nothing("log-gamma mixture", dimensions(d), log_gammas(d), -30.0, 30.0, 0.5));
  for (const int d : {2, 5, 10, 20})
    add(two_modes("equal modes", dimensions(d), d, 0.5, 0.01, 0.01));
  for (const int d : {2, 5}) add(two_modes("a mode of 3 %", dimensions(d), d, 0.03, 0.01, 0.01));
  add(two_modes("widths 10:1", dimensions(3), 3, 0.5, 0.05, 0.005));
  out.back().basin = 0.0040;
  quick(against_nothing("improbable peak", dimensions(4),
                        blobs({{1.0, {0.31, 0.44, 0.58, 0.66}, 1e-3}}, 0.0, 1.0), 0.0, 1.0, 0.03));
  add(change_point());

  // Basins by steepest ascent in small steps, from 3000 to 100 000 draws of the prior: standard
  // errors of 1 to 25 %. If no ascent arrived, the bound 3/n is given: "widths 10:1" in 5-d, "3:1",
  // "1000:1" in 3-d, and the shifted spike.
  flagged(
      against_nothing("bananas", dimensions(6), bananas(3, 0.01, 4.0, -1.0, 10.0),
                      {-4.0, -1.0, -4.0, -1.0, -4.0, -1.0}, {4.0, 10.0, 4.0, 10.0, 4.0, 10.0}, 0.5),
      1.0, false);
  // As thin as the ridge of a Duffing spring with 2000 samples: straight for a hundredth of its
  // length.
  for (const auto& [width, said] : {std::pair{1e-3, "1e-3"}, std::pair{1e-4, "1e-4"}}) {
    flagged(against_nothing("bananas", dimensions(2) + ", " + said + " wide",
                            bananas(1, width, 4.0, -1.0, 10.0), {-4.0, -1.0}, {4.0, 10.0}, 0.5),
            1.0, false);
  }
  flagged(against_nothing("shells", dimensions(8), shells(8, 2.0, 0.1), -6.0, 6.0, 0.5), 1.0,
          false);
  flagged(
      against_nothing("ripples", dimensions(4), ripples(4, 15.0, 6.0, 0.15, 0.43), 0.0, 1.0, 0.5),
      8e-4, false);
  out.back().core = out.back().basin;
  out.back().hidden = Vector(4, 0.43);  // the highest of many
  {
    Vector lower(10, -50.0), upper(10, 50.0);
    lower[0] = -10.0;
    upper[0] = 10.0;
    flagged(against_nothing("funnel", dimensions(10), funnel(10, 10.0, 50.0), lower, upper, 0.5),
            1.0, false);
  }
  flagged(disjoint_models(), 1.0, false);
  flagged(counts_with_a_spot(), 6.5e-3, false);  // of one component
  out.back().core = pi * 2.0 * Spot::kWidth * Spot::kWidth *
                    std::log(Spot::kB / (2.0 * pi * Spot::kWidth * Spot::kWidth));
  out.back().hidden = {Spot::kX, Spot::kY};
  flagged(two_modes("widths 10:1", dimensions(5), 5, 0.5, 0.05, 0.005), 7.5e-5, false);
  flagged(two_modes("widths 3:1", dimensions(10), 10, 0.5, 0.03, 0.01), 1e-3, false);
  for (const auto& [d, basin] : {std::pair{1, 0.20}, std::pair{2, 2.9e-4}, std::pair{3, 3e-5}})
    flagged(two_modes("widths 1000:1", dimensions(d), d, 0.5, 0.05, 5e-5), basin, true);
  {
    constexpr double kEnd = 0.6, kEdge = 0.01, kWidth = 1e-4;
    const Vector top{0.85, 0.5};
    flagged(against_nothing("peak behind a plateau", dimensions(2),
                            plateau(kEnd, kEdge, top, kWidth), 0.0, 1.0, 0.5),
            2.2e-4, true);
    // A disc in which the peak is higher than the plateau's tail.
    const double log_ratio =
        -2.0 * (std::log(kWidth) + kLogSqrt2Pi) + (top[0] - kEnd) / kEdge + std::log(kEnd + kEdge);
    out.back().core = pi * 2.0 * log_ratio * kWidth * kWidth;
    out.back().hidden = top;
  }
  for (const double shift : {0.0, 0.031}) {
    const Blob slab{1.0 / 101.0, Vector(20, 0.5), 0.1};
    const Blob spike{100.0 / 101.0, Vector(20, 0.5 + shift), 0.01};
    flagged(against_nothing("spike and slab", dimensions(20) + (shift > 0.0 ? ", shifted" : ""),
                            blobs({slab, spike}, 0.0, 1.0), 0.0, 1.0, 0.5),
            shift > 0.0 ? 1e-3 : 1.0, false);
    out.back().core = share_of_narrow(slab, spike);
    out.back().hidden = spike.mean;
  }
  return out;
}

}  // namespace

const std::vector<HardProblem>& hard_problems() {
  static const std::vector<HardProblem> all = all_problems();
  return all;
}

std::string identifier(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      out += c;
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  return out;
}

HardProblem radiata_problem(const std::string& folder) {
  std::ifstream file(folder + "/pine.csv");
  std::string line;
  std::getline(file, line);
  Vector y;
  std::vector<Vector> x(2);
  char comma = 0;
  for (double a = 0.0, b = 0.0, c = 0.0; file >> a >> comma >> b >> comma >> c;) {
    y.push_back(a);
    x[0].push_back(b);
    x[1].push_back(c);
  }
  const auto n = static_cast<double>(y.size());
  for (Vector& column : x) {
    double mean = 0.0;
    for (const double v : column) mean += v / n;
    for (double& v : column) v -= mean;
  }
  const Gamma precision{3.0, 1.0 / 180000.0};
  HardProblem out{.name = "radiata pine",
                  .family = "radiata pine",
                  .dimension = 3,
                  .problem = {.space = ModelSpace::of_models(
                                  {{"alpha", Normal{3000.0, 1000.0}},
                                   {"beta", Normal{185.0, 100.0}},
                                   {"tau", precision},
                                   {"alpha'", Normal{3000.0, 1000.0}},
                                   {"beta'", Normal{185.0, 100.0}},
                                   {"tau'", precision}},
                                  {{"density", 1.0, {"alpha", "beta", "tau"}},
                                   {"adjusted density", 1.0, {"alpha'", "beta'", "tau'"}}}),
                              .likelihood = [=] { return std::make_unique<Pine>(y, x); }},
                  .probability = {},
                  .log_evidence = {},
                  .balance = true,
                  .draw = {},
                  .hidden = {}};
  // α and β are independent given τ, with x relative to its mean: y = α + β x + e has
  //   ∫∫ = ∏ over both of N(estimate; prior mean, prior variance + 1/(τ s)) · likelihood of the
  //   residual.
  double mean = 0.0;
  for (const double v : y) mean += v / n;
  for (const Vector& column : x) {
    double xx = 0.0, xy = 0.0, rest = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      xx += column[i] * column[i];
      xy += column[i] * y[i];
    }
    const double slope = xy / xx;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double r = y[i] - mean - slope * column[i];
      rest += r * r;
    }
    const Prior prior = precision;
    const auto log_f = [&](double t) {  // t = ln τ
      const double tau = std::exp(t);
      return 0.5 * (n - 2.0) * (t - 2.0 * kLogSqrt2Pi) - 0.5 * tau * rest - 0.5 * std::log(n * xx) +
             log_normal(mean, 3000.0, std::sqrt(1e6 + 1.0 / (tau * n))) +
             log_normal(slope, 185.0, std::sqrt(1e4 + 1.0 / (tau * xx))) + prior.log_density(tau) +
             t;
    };
    const double about = std::log(n / rest), top = log_f(about);
    out.log_evidence.push_back(top +
                               std::log(integral([&](double t) { return std::exp(log_f(t) - top); },
                                                 about - 6.0, about + 3.0, 20000)));
  }
  set_probabilities(out);
  return out;
}

}  // namespace wheeltap::inference
