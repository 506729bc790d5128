#include "tests/inference/needle_problems.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <string>

#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kSlab = 0.1;

struct Needle {
  const char* name;
  int dimension;
  double slab, place;  // centres, on every axis
  double width;
  double basin;  // share of the prior from which steepest ascent leads to it
};

// ln [½ N(x; slab, .1²) + ½ N(x; place, width²)]
class InSlab final : public Likelihood {
 public:
  explicit InSlab(const Needle& needle) : needle_(needle) {}
  double log_likelihood(int model, std::span<const double> x) override {
    if (model == 0) return 0.0;
    return log_sum_exp(of(x, needle_.slab, kSlab), of(x, needle_.place, needle_.width)) +
           std::log(0.5);
  }

 private:
  static double of(std::span<const double> x, double mean, double width) {
    double sum = 0.0;
    for (const double v : x)
      sum -= 0.5 * std::pow((v - mean) / width, 2) + std::log(width) + kLogSqrt2Pi;
    return sum;
  }

  Needle needle_;
};

NeedleProblem needle_problem(const Needle& needle) {
  const int d = needle.dimension;
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 0; i < d; ++i) {
    names.push_back("x" + std::to_string(i + 1));
    parameters.push_back({names.back(), Uniform{0.0, 1.0}});
  }
  const double inside = normal_cdf((1.0 - needle.slab) / kSlab) - normal_cdf(-needle.slab / kSlab);
  const double mass = 0.5 + 0.5 * std::pow(inside, d);
  // Where ½ needle > ½ slab: a ball of this radius, in which the slab is nearly constant.
  const double apart = std::pow((needle.place - needle.slab) / kSlab, 2) * d;
  const double radius = needle.width * std::sqrt(2.0 * d * std::log(kSlab / needle.width) + apart);
  const double z = Prior(Uniform{0.0, 1.0}).to_standard_normal(needle.place);  // x = F(z)
  const double density = std::exp(-0.5 * z * z - kLogSqrt2Pi);
  HardProblem hard{.name = needle.name,
                   .family = "needle",
                   .dimension = d,
                   .problem = {.space = ModelSpace::of_models(
                                   parameters, {{"nothing", 1.0, {}}, {"density", 1.0, names}}),
                               .likelihood = [=] { return std::make_unique<InSlab>(needle); }},
                   .probability = {1.0 / (1.0 + mass), mass / (1.0 + mass)},
                   .log_evidence = {0.0, std::log(mass)},
                   .asked = Asked::found_or_flagged,
                   .basin = needle.basin,
                   .draw = {},
                   .hidden = std::vector<double>(static_cast<std::size_t>(d), needle.place)};
  return {.hard = std::move(hard),
          .width = 2.0 * radius / density,
          .concentric = needle.place == needle.slab};
}

}  // namespace

const std::vector<NeedleProblem>& needle_problems() {
  static const std::vector<NeedleProblem> all = [] {
    std::vector<NeedleProblem> out;
    // In one dimension the basin is everything on the far side of the needle from the broad mode;
    // otherwise, the flow lines of the broad mode that reach the needle's disc or ball.
    for (const Needle& needle : {
             Needle{"1-d, 1e-9, one centre", 1, 0.5, 0.5, 1e-9, 1.0},
             Needle{"1-d, 1e-10, one centre", 1, 0.5, 0.5, 1e-10, 1.0},
             Needle{"1-d, 1e-9, one centre at .43", 1, 0.43, 0.43, 1e-9, 0.43},
             Needle{"1-d, 1e-10, one centre at .62", 1, 0.62, 0.62, 1e-10, 0.38},
             Needle{"1-d, 1e-9 at .48", 1, 0.5, 0.48, 1e-9, 0.48},
             Needle{"1-d, 1e-10 at .531", 1, 0.5, 0.531, 1e-10, 0.469},
             Needle{"1-d, 1e-9 at .63", 1, 0.5, 0.63, 1e-9, 0.37},
             Needle{"1-d, 1e-6 at .3", 1, 0.5, 0.3, 1e-6, 0.3},
             Needle{"2-d, 1e-4, one centre", 2, 0.5, 0.5, 1e-4, 1.0},
             Needle{"2-d, 1e-4 at .54", 2, 0.5, 0.54, 1e-4, 0.003},
             Needle{"2-d, 1e-6 at .51", 2, 0.5, 0.51, 1e-6, 1e-4},
             Needle{"3-d, 1e-5, one centre", 3, 0.5, 0.5, 1e-5, 1.0},
         })
      out.push_back(needle_problem(needle));
    return out;
  }();
  return all;
}

}  // namespace wheeltap::inference
