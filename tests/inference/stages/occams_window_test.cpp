#include "inference/exploration/occams_window.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "inference/diagnosis/verdict.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/exploration/nested_starts.hpp"

namespace wheeltap::inference::occams_window_test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

bool has(int model, int term) {
  return (model >> term & 1) != 0;
}

// All subsets of `terms`; every third term has two parameters.
ModelSpace subsets(int terms) {
  std::vector<Parameter> parameters{{"level", Normal{0.0, 1.0}}};
  const auto of = [](int t) {
    std::vector<std::string> names{"b" + std::to_string(t)};
    if (t % 3 == 2) names.push_back(names[0] + "'");
    return names;
  };
  for (int t = 0; t < terms; ++t)
    for (const std::string& name : of(t)) parameters.push_back({name, Normal{0.0, 1.0}});
  std::vector<ModelSpace::ListedModel> models;
  for (int m = 0; m < 1 << terms; ++m) {
    models.push_back({"m" + std::to_string(m), 1.0, {"level"}});
    for (int t = 0; t < terms; ++t)
      if (has(m, t))
        for (const std::string& name : of(t)) models.back().parameters.push_back(name);
  }
  return ModelSpace::of_models(std::move(parameters), std::move(models));
}

// y ~ N(X θ, 1), θ ~ N(0, 1): everything is known in closed form.
struct Regression {
  Matrix x;
  Vector y;

  [[nodiscard]] Matrix columns(const Model& model) const {
    return x(Eigen::indexing::all, model.parameters);
  }
  [[nodiscard]] ModelExploration explored(const Model& model) const {
    const Matrix of = columns(model);
    const auto d = of.cols();
    Mode mode;
    mode.covariance =
        (Matrix::Identity(d, d) + of.transpose() * of).llt().solve(Matrix::Identity(d, d));
    const Vector z = mode.covariance * (of.transpose() * y);
    mode.z.assign(z.begin(), z.end());
    const double log_2pi = std::log(2.0 * std::numbers::pi);
    mode.log_posterior = -0.5 * (y - of * z).squaredNorm() - 0.5 * z.squaredNorm() -
                         0.5 * static_cast<double>(d + y.size()) * log_2pi;
    mode.log_mass = mode.log_posterior + 0.5 * static_cast<double>(d) * log_2pi +
                    0.5 * std::log(mode.covariance.determinant());
    ModelExploration out;
    out.calls.search = 1;
    out.modes.push_back(std::move(mode));
    return out;
  }
};

constexpr double kClear = 4.0;  // a superfluous term costs ln (4 √60) = 3.4 nats

// Correlated terms, as those of a force law: `alike` is the shared part of each column.
Regression regression(const ModelSpace& space, int truth, double alike, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  constexpr Eigen::Index kRows = 60;
  const auto n = static_cast<Eigen::Index>(space.parameters().size());
  Regression out{Matrix(kRows, n), Vector(kRows)};
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double shared = random.normal();
    for (double& v : out.x.row(i))
      v = kClear * (alike * shared + std::sqrt(1.0 - alike * alike) * random.normal());
    out.y[i] = random.normal();
  }
  for (const int p : space[truth].parameters)
    out.y += out.x.col(p) * (random.uniform() < 0.5 ? -1.0 : 1.0) * (0.7 + random.uniform());
  return out;
}

struct Looked {
  double missed = 0.0;  // exact probability of the models that were not evaluated
  int models = 0;       // number of evaluated models
};

Looked look(const ModelSpace& space, const Regression& data) {
  const ModelLattice lattice(space);
  std::vector<ModelExploration> all, found(static_cast<std::size_t>(space.size()));
  double top = -std::numeric_limits<double>::infinity();
  for (const Model& model : space.models()) {
    all.push_back(data.explored(model));
    top = std::max(top, all.back().log_evidence());
  }
  for (;;) {
    const std::vector<int> next = next_in_window(space, lattice, found);
    if (next.empty()) break;
    for (const int m : next) {
      EXPECT_FALSE(found[static_cast<std::size_t>(m)].is_explored()) << "twice";
      found[static_cast<std::size_t>(m)] = all[static_cast<std::size_t>(m)];
    }
  }
  Looked out;
  double sum = 0.0;
  for (std::size_t m = 0; m < all.size(); ++m) {
    const double p = std::exp(all[m].log_evidence() - top);
    sum += p;
    if (found[m].is_explored()) {
      ++out.models;
    } else {
      out.missed += p;
    }
  }
  out.missed /= sum;
  return out;
}

TEST(OccamsWindow, LatticeLinksModelsThatDifferByOneTerm) {
  const ModelSpace space = subsets(4);
  const ModelLattice lattice(space);
  EXPECT_THAT(lattice.within(0), testing::IsEmpty());
  EXPECT_THAT(lattice.around(0), testing::UnorderedElementsAre(1, 2, 4, 8));
  EXPECT_THAT(lattice.within(0b1101), testing::UnorderedElementsAre(0b0101, 0b1001, 0b1100));
  EXPECT_THAT(lattice.around(0b1101), testing::ElementsAre(0b1111));
  EXPECT_EQ(lattice.level(0), 0);
  EXPECT_EQ(lattice.level(0b1101), 3);
  EXPECT_THAT(lattice.around(0b1111), testing::IsEmpty());
}

// 0 to 8 of 8 terms are true; the exact probability of all models not evaluated stays below the
// search threshold.
TEST(OccamsWindow, OmittedModelsAreImprobable) {
  const ModelSpace space = subsets(8);
  base::Random random(1, 0, 0, base::Purpose::test);
  int models = 0, problems = 0;
  for (const double alike : {0.0, 0.7, 0.95}) {
    for (std::uint64_t seed = 0; seed < 40; ++seed, ++problems) {
      const int truth = random.index(space.size());
      const Looked looked = look(space, regression(space, truth, alike, seed));
      EXPECT_LT(looked.missed, 1e-3) << "truth " << truth << ", " << alike << ", seed " << seed;
      models += looked.models;
    }
  }
  // Half of the 256 models are within four terms of the law, and within e^-12.
  EXPECT_LT(models, problems * space.size() / 2);
}

TEST(OccamsWindow, ExploresFewModelsBesidesAStrongLawAndItsExtensions) {
  const ModelSpace space = subsets(8);
  Regression data = regression(space, 0b01001001, 0.5, 3);
  data.x *= 10.0;
  data.y *= 10.0;
  const Looked looked = look(space, data);
  EXPECT_LT(looked.missed, 1e-6);
  EXPECT_LT(looked.models, 110);
}

// Three terms that matter only together, with columns that nearly cancel. A term costs ln 7700 = 9
// nats, so that no pair is in the window.
TEST(OccamsWindow, FindsTermsThatMatterOnlyTogetherFromTheLargestModel) {
  const ModelSpace space = subsets(8);
  Regression data = regression(space, 0, 0.0, 5);
  data.x.rightCols(data.x.cols() - 1) *= 250.0;
  constexpr int kThree = 0b001011;
  const std::vector<int> three = space[kThree].parameters;  // and the constant
  const Vector small = data.x.col(three[3]) / 1000.0;
  data.x.col(three[3]) = small - data.x.col(three[1]) - data.x.col(three[2]);
  data.y += 1.3 * small;
  const double best = data.explored(space[0]).log_evidence();
  // Otherwise the test proves nothing.
  EXPECT_GT(data.explored(space[kThree]).log_evidence(), best + 5.0);
  const Looked looked = look(space, data);
  EXPECT_LT(looked.missed, 1e-3);
  EXPECT_LT(looked.models, 200);
}

TEST(OccamsWindow, StartsASmallerModelFromTheMostProbableOneAroundIt) {
  const ModelSpace space = subsets(2);
  const ModelLattice lattice(space);
  std::vector<ModelExploration> found(4);
  EXPECT_TRUE(start_from_around(space, lattice, 1, found).empty());
  found[3].modes.push_back({.z = {0.1, 0.2, 0.3}, .log_posterior = 0.0, .covariance = {}});
  EXPECT_EQ(start_from_around(space, lattice, 1, found), (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(start_from_around(space, lattice, 2, found), (std::vector<double>{0.1, 0.3}));
}

// A run on the same data, as a record that can be shortened, so that its list counts as nested.
Problem problem_of(const ModelSpace& space, const Regression& data, long samples) {
  class Rows : public Likelihood {
   public:
    Rows(ModelSpace space, const Regression& data, long n)
        : space_(std::move(space)), data_{data.x.topRows(n), data.y.head(n)} {}
    double log_likelihood(int model, std::span<const double> x) override {
      const Eigen::Map<const Vector> theta(x.data(), static_cast<Eigen::Index>(x.size()));
      return -0.5 * (data_.y - data_.columns(space_[model]) * theta).squaredNorm() -
             0.5 * static_cast<double>(data_.y.size()) * std::log(2.0 * std::numbers::pi);
    }

   private:
    ModelSpace space_;
    Regression data_;
  };
  Problem problem{.space = space,
                  .likelihood = [=] { return std::make_unique<Rows>(space, data, samples); }};
  problem.samples = samples;
  problem.shortened = [=](long first) {
    return std::make_shared<const Problem>(problem_of(space, data, first));
  };
  return problem;
}

TEST(OccamsWindow, RunWithOmittedModelsHasTheExactProbabilities) {
  const ModelSpace space = subsets(6);
  const Regression data = regression(space, 0b001001, 0.7, 11);
  const Posterior posterior =
      reversible_jump(problem_of(space, data, data.y.size()),
                      {.seed = 4, .chains = 4, .warmup = 2000, .draws = 2000});
  const Verdict verdict = judge(posterior);
  EXPECT_GT(verdict.passed_over, 5);
  EXPECT_TRUE(verdict.converged);
  for (const Reason& reason : verdict.not_established) ADD_FAILURE() << describe(reason, space);
  double sum = 0.0, top = -std::numeric_limits<double>::infinity();
  std::vector<double> exact;
  for (const Model& model : space.models())
    top = std::max(top, exact.emplace_back(data.explored(model).log_evidence()));
  for (double& p : exact) sum += p = std::exp(p - top);
  for (int m = 0; m < space.size(); ++m) {
    const auto at = static_cast<std::size_t>(m);
    const ModelStanding& standing = verdict.models[at];
    if (standing.passed_over) {
      EXPECT_LT(exact[at] / sum, 1e-4) << m;
      continue;
    }
    EXPECT_NEAR(standing.probability, exact[at] / sum, 4.5 * standing.mcse + 1e-4) << m;
  }
}

// Regression: with few models, those not evaluated had an evidence that was far too low.
TEST(OccamsWindow, OmittedModelsOfAShortListHaveNoEvidence) {
  const ModelSpace space = subsets(5);
  const Regression data = regression(space, 0b00101, 0.7, 11);
  const Posterior posterior =
      reversible_jump(problem_of(space, data, data.y.size()),
                      {.seed = 4, .chains = 4, .warmup = 2000, .draws = 2000});
  const Verdict verdict = judge(posterior);
  ASSERT_GT(verdict.passed_over, 0);
  for (int m = 0; m < space.size(); ++m) {
    const ModelStanding& standing = verdict.models[static_cast<std::size_t>(m)];
    if (standing.passed_over) {
      EXPECT_TRUE(std::isnan(standing.log_evidence)) << m;
      continue;
    }
    EXPECT_NEAR(standing.log_evidence, data.explored(space[m]).log_evidence(), 3.5) << m;
  }
}

}  // namespace
}  // namespace wheeltap::inference::occams_window_test
