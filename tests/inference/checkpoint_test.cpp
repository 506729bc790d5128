// A run that is interrupted at any safe point and resumed from its columns equals the uninterrupted
// run.
#include "inference/engine/checkpoint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "inference/engine/reversible_jump.hpp"
#include "tests/inference/hard_problems.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// y(t) = 1 + t + a small term, by a constant and any of `terms` powers of t: 2^terms nested models.
Problem powers(int terms, long samples, bool shortens) {
  class Powers : public Likelihood {
   public:
    Powers(int terms, long samples) : terms_(terms) {
      for (long i = 0; i < samples; ++i) {
        t_.push_back(std::sin(0.7 * static_cast<double>(i)));
        y_.push_back(1.0 + t_.back() + 0.1 * std::sin(7.0 * static_cast<double>(i * i % 1000)));
      }
    }
    double log_likelihood(int model, std::span<const double> x) override {
      double sum = 0.0;
      for (std::size_t i = 0; i < t_.size(); ++i) {
        const double t = t_[i];
        double r = y_[i] - x[0];
        double power = 1.0;
        for (int j = 0, at = 1; j < terms_; ++j) {
          power *= t;
          if ((model >> j) & 1) r -= x[static_cast<std::size_t>(at++)] * power;
        }
        sum -= 0.5 * r * r / 0.04;
      }
      return sum;
    }

   private:
    int terms_;
    std::vector<double> t_, y_;
  };
  std::vector<Parameter> parameters{{"level", Normal{0.0, 2.0}}};
  for (int j = 1; j <= terms; ++j)
    parameters.push_back({"b" + std::to_string(j), Normal{0.0, 2.0}});
  std::vector<ModelSpace::ListedModel> models;
  for (int m = 0; m < 1 << terms; ++m) {
    ModelSpace::ListedModel& model = models.emplace_back();
    model = {"m" + std::to_string(m), 1.0, {"level"}};
    for (int j = 0; j < terms; ++j)
      if ((m >> j) & 1) model.parameters.push_back("b" + std::to_string(j + 1));
  }
  Problem problem{.space = ModelSpace::of_models(parameters, models),
                  .likelihood = [=] { return std::make_unique<Powers>(terms, samples); }};
  if (shortens) {
    problem.samples = samples;
    problem.shortened = [=](long first) {
      return std::make_shared<const Problem>(powers(terms, first, true));
    };
  }
  return problem;
}

const std::vector<double> kData{0.9, 1.0, 0.2, -0.7, -0.9, -0.3};

Problem one_bump() {
  return toy::bump_problem(kData, {1, 1});
}

Problem screened() {
  return toy::screened_bump_problem(kData, {1, 1});
}

struct Case {
  const char* name;
  Problem (*problem)();
  Options options;
};

// WHEELTAP_LONG_TESTS=1: from every safe point of every run. Otherwise from an evenly spaced
// subset.
bool is_long() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

// Every possible path of a run through its stages.
std::vector<Case> cases() {
  const Options brief{
      .seed = 3, .chains = 2, .threads = 2, .warmup = 80, .draws = 16, .thin = 2, .searches = 2};
  std::vector<Case> all;
  const auto add = [&](const char* name, Problem (*problem)()) -> Options& {
    return all.emplace_back(Case{name, problem, brief}).options;
  };
  add("Components", toy::bumps);
  add("ComponentsBalanced", one_bump).balance = true;
  add("ComponentsTempered", one_bump).tempered_draws = true;
  add("Screened", screened).chains = 3;
  add("PriorOnly", one_bump).prior_only = true;
  add("Look", one_bump).quick = true;
  add("List", [] { return powers(2, 20, false); }).chains = 4;
  add("ListTempered", [] { return powers(1, 20, false); }).tempered_draws = true;
  add("ListBalanced", [] { return powers(1, 20, true); }).balance = true;
  add("NestedList", [] { return powers(3, 60, true); });
  add("LongList", [] { return powers(6, 10, false); });
  add("LongRecord", [] { return powers(1, 20000, true); }).quick = true;
  return all;
}

// Compared by bits, so that NaN equals NaN.
template <class Sequence>
void expect_bits(const Sequence& a, const Sequence& b, const char* what) {
  using T = typename Sequence::value_type;
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if constexpr (std::same_as<T, double>) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i]))
          << what << ' ' << i << ": " << a[i] << ", " << b[i];
    } else if constexpr (std::same_as<T, float>) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i])) << what;
    } else {
      ASSERT_EQ(a[i], b[i]) << what << ' ' << i;
    }
  }
}

void expect_same(const Evidence& a, const Evidence& b) {
  expect_bits<std::vector<double>>({a.log_evidence, a.standard_error},
                                   {b.log_evidence, b.standard_error}, "evidence");
  EXPECT_EQ(a.warnings, b.warnings);
}

void expect_same(const Posterior& a, const Posterior& b) {
  ASSERT_EQ(a.chains.size(), b.chains.size());
  for (std::size_t c = 0; c < a.chains.size(); ++c) {
    expect_bits(a.chains[c].model, b.chains[c].model, "model");
    expect_bits(a.chains[c].theta, b.chains[c].theta, "theta");
    expect_bits(a.chains[c].log_prior, b.chains[c].log_prior, "log prior");
    expect_bits(a.chains[c].log_likelihood, b.chains[c].log_likelihood, "log likelihood");
    expect_bits(a.chains[c].move, b.chains[c].move, "move");
    expect_bits(a.chains[c].accepted, b.chains[c].accepted, "accepted");
    expect_bits(a.chains[c].prediction, b.chains[c].prediction, "prediction");
  }
  expect_bits(a.log_weight, b.log_weight, "weight");
  ASSERT_EQ(a.moves.size(), b.moves.size());
  for (std::size_t i = 0; i < a.moves.size(); ++i) {
    EXPECT_EQ(a.moves[i].name, b.moves[i].name);
    EXPECT_EQ(a.moves[i].proposed, b.moves[i].proposed);
    EXPECT_EQ(a.moves[i].accepted, b.moves[i].accepted);
  }
  EXPECT_EQ(a.jumps_proposed, b.jumps_proposed);
  EXPECT_EQ(a.jumps_accepted, b.jumps_accepted);
  const auto numbers = [](const Posterior& p) {
    const Calls& c = p.calls;
    return std::vector<long>{p.draws,
                             p.warmup,
                             p.thin,
                             p.dimension,
                             p.predictions,
                             p.warmup_evaluations,
                             c.explore,
                             c.search,
                             c.anneal,
                             c.weigh,
                             c.tune,
                             c.sample,
                             c.evidence,
                             p.likelihood_evaluations,
                             p.full_evaluations,
                             p.stopped_early,
                             p.quick,
                             p.tempered_draws,
                             p.ladder_round_trips,
                             p.impossible};
  };
  EXPECT_EQ(numbers(a), numbers(b));
  expect_bits<std::vector<double>>({a.barrier}, {b.barrier}, "barrier");
  EXPECT_EQ(a.choices, b.choices);
  ASSERT_EQ(a.found.size(), b.found.size());
  for (std::size_t m = 0; m < a.found.size(); ++m) {
    const ModelFindings &one = a.found[m], &other = b.found[m];
    EXPECT_EQ(one.climbs, other.climbs);
    EXPECT_EQ(one.glanced, other.glanced);
    expect_same(one.annealed, other.annealed);
    expect_same(one.sampled, other.sampled);
    expect_same(one.bridged, other.bridged);
    ASSERT_EQ(one.modes.size(), other.modes.size());
    for (std::size_t k = 0; k < one.modes.size(); ++k) {
      expect_bits(one.modes[k].x, other.modes[k].x, "mode");
      expect_bits(one.modes[k].drawn, other.modes[k].drawn, "draws of a mode");
      expect_bits<std::vector<double>>({one.modes[k].log_posterior, one.modes[k].share},
                                       {other.modes[k].log_posterior, other.modes[k].share},
                                       "mode");
      EXPECT_EQ(one.modes[k].climbs, other.modes[k].climbs);
    }
  }
}

// All checkpoints of a run, and its result.
struct Whole {
  std::vector<std::shared_ptr<const Checkpoint>> checkpoints;
  Posterior posterior;
};
Whole run_whole(const Problem& problem, Options options) {
  Whole whole;
  options.checkpoints.save = [&](const Checkpoint& checkpoint) {
    whole.checkpoints.push_back(std::make_shared<const Checkpoint>(checkpoint));
  };
  whole.posterior = reversible_jump(problem, options);
  return whole;
}

// The same with draws in parts: every part that was saved, by its number.
struct InParts {
  int part = 0;  // draws per chain
  std::map<long, Checkpoint> parts;
  Whole whole;

  [[nodiscard]] Options reading(Options options) const {
    options.checkpoints.part = part;
    options.checkpoints.saved_draws = [this](long number) { return parts.at(number); };
    return options;
  }
};
InParts run_in_parts(const Problem& problem, Options options, int part = 3) {
  InParts out;
  out.part = part;
  int offered = 0;
  options.checkpoints.part = part;
  options.checkpoints.save_draws = [&](const Checkpoint& draws, long number) {
    if (++offered % 3 == 0) return false;  // as on a disk that is temporarily full
    EXPECT_TRUE(out.parts.emplace(number, draws).second) << "part " << number << " comes twice";
    return true;
  };
  out.whole = run_whole(problem, options);
  return out;
}

Posterior resumed(const Problem& problem, Options options,
                  std::shared_ptr<const Checkpoint> checkpoint) {
  options.checkpoints.from = std::move(checkpoint);
  return reversible_jump(problem, options);
}

template <class Number>
Number first(const Checkpoint& checkpoint, const char* column) {
  return std::get<std::vector<Number>>(checkpoint.columns.at(column)).at(0);
}
int stage(const Checkpoint& checkpoint) {
  return first<std::int32_t>(checkpoint, "at.stage");
}

class CheckpointOf : public testing::TestWithParam<Case> {};

TEST_P(CheckpointOf, EverySafePointGivesTheSamePosterior) {
  const Problem problem = GetParam().problem();
  const Options options = GetParam().options;
  const Posterior straight = reversible_jump(problem, options);
  const Whole whole = run_whole(problem, options);
  expect_same(straight, whole.posterior);
  ASSERT_GT(whole.checkpoints.size(), 10U);
  std::vector<int> stages(3);
  for (const auto& checkpoint : whole.checkpoints)
    ++stages[static_cast<std::size_t>(stage(*checkpoint))];
  EXPECT_THAT(stages, testing::Each(testing::Gt(0)));
  constexpr std::size_t kPart = 5;
  const std::size_t every = is_long() ? 1 : 1 + whole.checkpoints.size() / kPart;
  for (std::size_t i = 0; i < whole.checkpoints.size(); i += every) {
    SCOPED_TRACE(i);
    const Problem again = GetParam().problem();  // nothing of the earlier one remains
    Options other = options;
    other.threads = 1 + static_cast<int>(i % 2);
    expect_same(straight, resumed(again, other, whole.checkpoints[i]));
    if (HasFailure()) return;
  }
}

TEST_P(CheckpointOf, DrawsInPartsGiveTheSamePosterior) {
  const Problem problem = GetParam().problem();
  const InParts run = run_in_parts(problem, GetParam().options);
  const Options options = run.reading(GetParam().options);
  expect_same(reversible_jump(problem, GetParam().options), run.whole.posterior);
  EXPECT_GT(run.parts.size(), 2U);
  long most = 0;
  const std::size_t every = 1 + run.whole.checkpoints.size() / (is_long() ? 100 : 4);
  for (std::size_t i = run.whole.checkpoints.size(); i-- > 0;) {
    const auto& checkpoint = run.whole.checkpoints[i];
    const auto [first_part, parts] = parts_of(*checkpoint);
    most = std::max(most, parts);
    // The remainder of each chain is shorter than a part, or than two if saving failed.
    for (const std::int64_t tail :
         std::get<std::vector<std::int64_t>>(checkpoint->columns.at("posterior.chains.model.size")))
      EXPECT_LT(tail, 3 * run.part);
    if (i % every != 0) continue;
    SCOPED_TRACE(i);
    expect_same(run.whole.posterior, resumed(problem, options, checkpoint));
    if (HasFailure()) return;
  }
  EXPECT_GT(most, 2);
}

TEST_P(CheckpointOf, ColumnsRestoreTheState) {
  const Problem problem = GetParam().problem();
  const Whole whole = run_whole(problem, GetParam().options);
  for (const auto& checkpoint : whole.checkpoints) {
    const Checkpoint again =
        checkpoint_of(state_of(*checkpoint, problem.space, GetParam().options.chains));
    ASSERT_EQ(again.columns.size(), checkpoint->columns.size());
    for (const auto& [name, column] : checkpoint->columns) {
      std::visit(
          [&, &name = name](const auto& numbers) {
            using Numbers = std::decay_t<decltype(numbers)>;
            expect_bits(numbers, std::get<Numbers>(again.columns.at(name)), name.c_str());
          },
          column);
    }
  }
}

// Stopped repeatedly, each time after a little more work: the sessions together equal one run.
TEST_P(CheckpointOf, ManySessionsEqualOneRun) {
  const Problem problem = GetParam().problem();
  Options options = GetParam().options;
  const Posterior straight = reversible_jump(problem, options);
  int sessions = 0, calls = 0;
  options.checkpoints.every_seconds = 1e9;  // only when it is stopped
  std::shared_ptr<const Checkpoint> last;
  options.checkpoints.save = [&](const Checkpoint& checkpoint) {
    last = std::make_shared<const Checkpoint>(checkpoint);
  };
  options.progress = [&](const Options::Progress&) {
    return ++calls < 2 + sessions / (is_long() ? 4 : 2);
  };
  Posterior posterior;
  do {
    calls = 0;
    options.checkpoints.from = last;
    posterior = reversible_jump(problem, options);
    ASSERT_LT(++sessions, 500);
  } while (posterior.stopped_early);
  EXPECT_GT(sessions, 2);
  expect_same(straight, posterior);
}

INSTANTIATE_TEST_SUITE_P(Runs, CheckpointOf, testing::ValuesIn(cases()),
                         [](const auto& at) { return std::string(at.param.name); });

// The control: with any of these members reset to its initial value, the run differs.
TEST(Checkpoint, AMissingMemberChangesTheRun) {
  const Problem problem = toy::bumps();
  const Options options{
      .seed = 3, .chains = 2, .threads = 1, .warmup = 240, .draws = 40, .thin = 2};
  const Whole whole = run_whole(problem, options);
  // The first checkpoint that satisfies this, with one column of zeros.
  const auto without = [&](const char* column, auto&& where) {
    for (const auto& checkpoint : whole.checkpoints) {
      if (!where(*checkpoint)) continue;
      auto broken = std::make_shared<Checkpoint>(*checkpoint);
      std::visit([](auto& numbers) { std::ranges::fill(numbers, 0); }, broken->columns.at(column));
      return resumed(problem, options, broken);
    }
    ADD_FAILURE() << "no checkpoint to break " << column << " in";
    return Posterior{};
  };
  const auto differs = [&](const Posterior& posterior) {
    for (std::size_t c = 0; c < posterior.chains.size(); ++c)
      if (posterior.chains[c].log_likelihood != whole.posterior.chains[c].log_likelihood)
        return true;
    return false;
  };
  const auto tempering = [](const Checkpoint& c) {
    return first<std::uint8_t>(c, "at.tempering") == 1 &&
           first<std::int32_t>(c, "chains.adaptation.steps") > 5;
  };
  const auto tuning = [](const Checkpoint& c) {
    return stage(c) == 1 && first<std::int32_t>(c, "chains.adaptation.steps") > 5 &&
           first<std::int32_t>(c, "at.tuned") > 0;
  };
  const auto drawing = [](const Checkpoint& c) {
    return stage(c) == 2 && first<std::int64_t>(c, "chains.iteration") > 20;
  };
  EXPECT_TRUE(differs(without("chains.ladder.scans", tempering)));
  EXPECT_TRUE(differs(without("chains.adaptation.learnt.each", tempering)));
  EXPECT_TRUE(differs(without("chains.adaptation.learnt.each", tuning)));
  EXPECT_TRUE(differs(without("at.tuned", tuning)));
  EXPECT_TRUE(differs(without("chains.iteration", drawing)));
  EXPECT_TRUE(differs(without("pilot.efficiencies", drawing)));
}

TEST(Checkpoint, RejectsACheckpointOfAnotherProblem) {
  const Problem problem = toy::bumps();
  const Options options{.seed = 3, .chains = 2, .warmup = 240, .draws = 40};
  const Whole whole = run_whole(problem, options);
  const Checkpoint& good = *whole.checkpoints.back();
  for (const auto& [name, column] : good.columns) {
    if (std::visit([](const auto& numbers) { return numbers.empty(); }, column)) continue;
    Checkpoint missing = good;
    missing.columns.erase(name);
    EXPECT_THROW(static_cast<void>(state_of(missing, problem.space, 2)), CheckpointError) << name;
    Checkpoint shorter = good, longer = good;
    std::visit([](auto& numbers) { numbers.pop_back(); }, shorter.columns.at(name));
    std::visit([](auto& numbers) { numbers.push_back(numbers.back()); }, longer.columns.at(name));
    EXPECT_THROW(static_cast<void>(state_of(shorter, problem.space, 2)), CheckpointError) << name;
    EXPECT_THROW(static_cast<void>(state_of(longer, problem.space, 2)), CheckpointError) << name;
  }
  Checkpoint more = good;
  more.columns["moon"] = std::vector<double>{1.0};
  EXPECT_THAT([&] { static_cast<void>(state_of(more, problem.space, 2)); },
              ThrowsMessage<CheckpointError>(HasSubstr("\"moon\"")));
  EXPECT_THAT([&] { static_cast<void>(state_of(good, problem.space, 3)); },
              ThrowsMessage<CheckpointError>(HasSubstr("different chains")));
  EXPECT_THAT(
      [&] {
        static_cast<void>(state_of(good, toy::bump_space({1, 1}), 2));
      },
      ThrowsMessage<CheckpointError>(HasSubstr("different models")));
  // Other data: the same parameters have a different likelihood.
  EXPECT_THAT(
      [&] {
        static_cast<void>(resumed(toy::bump_problem({1, 0, 0, 0, 0, 0}, {1, 1, 1, 1}), options,
                                  whole.checkpoints.back()));
      },
      ThrowsMessage<CheckpointError>(HasSubstr("likelihood differs from that")));
}

TEST(Checkpoint, RejectsPartsOfOtherDraws) {
  const Problem problem = toy::bumps();
  const Options options{.seed = 3, .chains = 2, .warmup = 240, .draws = 40};
  const InParts run = run_in_parts(problem, options);
  const auto& last = run.whole.checkpoints.back();
  ASSERT_GT(parts_of(*last).second, 0);
  EXPECT_THAT([&] { static_cast<void>(resumed(problem, options, last)); },
              ThrowsMessage<CheckpointError>(HasSubstr("separate parts")));
  const auto refused = [&](const Checkpoint& part, const char* why) {
    Options other = run.reading(options);
    other.checkpoints.saved_draws = [&](long) { return part; };
    EXPECT_THAT([&] { static_cast<void>(resumed(problem, other, last)); },
                ThrowsMessage<CheckpointError>(HasSubstr(why)));
  };
  const Checkpoint& good = run.parts.begin()->second;
  refused(draws_of(run.whole.posterior.chains[0], 0, run.part - 1), "does not have 3 draws");
  Checkpoint shorter = good, more = good;
  std::get<std::vector<double>>(shorter.columns.at("theta")).pop_back();
  refused(shorter, "lacks a part of \"theta\"");
  more.columns["moon"] = std::vector<double>{1.0};
  refused(more, "\"moon\"");
  auto again = std::make_shared<Checkpoint>(*last);  // with parts of its own
  const auto& chains = std::get<std::vector<std::int32_t>>(last->columns.at("at.part_chains"));
  for (int i = 0; i < 20; ++i)
    std::get<std::vector<std::int32_t>>(again->columns.at("at.part_chains")).push_back(chains[0]);
  std::get<std::vector<std::int64_t>>(again->columns.at("at.part_chains.size"))[0] += 20;
  Options other = run.reading(options);
  other.checkpoints.saved_draws = [&](long) { return good; };
  EXPECT_THAT([&] { static_cast<void>(resumed(problem, other, again)); },
              ThrowsMessage<CheckpointError>(HasSubstr("more draws")));
}

// When a run starts tempering, or fits its proposals to its draws, these draws become warm-up:
// their parts on disk are obsolete, and later parts have other numbers.
TEST(Checkpoint, PartsBecomeObsoleteWhenDrawsBecomeWarmup) {
  const auto& all = hard_problems();
  const auto at = std::ranges::find(all, "bananas, 2-d, 1e-3 wide", &HardProblem::name);
  ASSERT_NE(at, all.end());
  Options options{.seed = 3, .chains = 2, .threads = 2, .warmup = 200, .searches = 2};
  options.checkpoints.every_seconds = 0.05;
  const InParts run = run_in_parts(at->problem, options, 1000);
  const auto& checkpoints = run.whole.checkpoints;
  EXPECT_GT(run.whole.posterior.warmup, 25'000);
  const auto again = [&](const Checkpoint& checkpoint) {
    const auto [first_part, parts] = parts_of(checkpoint);
    return first_part > 0 && parts > 0;
  };
  // Before and after each time that draws became warm-up, and the last.
  int forgotten = 0;
  for (std::size_t i = 0; i < checkpoints.size(); ++i) {
    const bool before = i + 1 < checkpoints.size() &&
                        parts_of(*checkpoints[i]).first < parts_of(*checkpoints[i + 1]).first;
    const bool after = i > 0 && again(*checkpoints[i]) && !again(*checkpoints[i - 1]);
    forgotten += before ? 1 : 0;
    if (!before && !after && i + 1 < checkpoints.size()) continue;
    SCOPED_TRACE(i);
    expect_same(run.whole.posterior, resumed(at->problem, run.reading(options), checkpoints[i]));
    if (HasFailure()) return;
  }
  EXPECT_GT(forgotten, 0);
  EXPECT_TRUE(again(*checkpoints.back()));
}

TEST(Checkpoint, SavesAtItsInterval) {
  int saved = 0;
  Options options{.seed = 3, .chains = 2, .warmup = 240, .draws = 200};
  options.checkpoints = {.save = [&](const Checkpoint&) { ++saved; }, .every_seconds = 3600.0};
  static_cast<void>(reversible_jump(toy::bumps(), options));
  EXPECT_EQ(saved, 0);
}

}  // namespace
}  // namespace wheeltap::inference
