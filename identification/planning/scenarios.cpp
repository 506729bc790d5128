#include "identification/planning/scenarios.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "identification/invalid_input.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;

/// Number of scenarios in one unit of parallel work.
constexpr int kBlock = 256;
/// Number of draws after which an impossible structure is an error of the case.
constexpr int kMostDraws = 100;

}  // namespace

ScenarioSource::ScenarioSource(const PlannedStructure& structure, std::uint64_t seed)
    : structure_(structure), seed_(seed), models_(count_models(structure.kinds())) {}

Scenario ScenarioSource::draw(std::uint64_t number, PlannedStructure::Solver& solver) const {
  Scenario out;
  out.truth.model = static_cast<int>(number % models_.size());
  const std::vector<int>& counts = models_[index(out.truth.model)].counts;
  base::Random random(seed_, 0, number, base::Purpose::simulation);
  if (structure_.unknowns() > 0) {
    base::Random of_unknowns(seed_, 4, number, base::Purpose::simulation);
    out.draw = of_unknowns.index(PlannedStructure::kDraws);
  }
  for (int attempt = 0; attempt < kMostDraws; ++attempt) {
    out.defects.clear();
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const DefectKind& kind = structure_.kinds()[k];
      const auto begin = static_cast<std::ptrdiff_t>(out.defects.size());
      for (int c = 0; c < counts[k]; ++c) {
        const double location = kind.location.from_standard_normal(random.normal());
        const inference::Prior* prior = kind.severity_prior();
        const double severity =
            prior ? prior->from_standard_normal(random.normal()) : kind.known_severity();
        out.defects.push_back({static_cast<int>(k), location, severity});
      }
      std::sort(out.defects.begin() + begin, out.defects.end(),
                [](const auto& a, const auto& b) { return a.location < b.location; });
    }
    if (solver.predict(out.defects, out.modes, out.draw)) break;
    if (attempt + 1 == kMostDraws)
      throw InvalidInput(InvalidInput::Part::severity,
                         "the damaged structure has no modes in any of " +
                             std::to_string(kMostDraws) +
                             " draws of the prior: narrow the prior of the severity");
  }
  out.numbers = TestNumbers::draw(structure_, seed_, number);
  out.truth.defects.clear();
  for (const PlacedDefect& d : out.defects)
    out.truth.defects.push_back({.place = std::max(0, structure_.place_of(d.kind, d.location)),
                                 .at = structure_.kinds()[index(d.kind)].line.spot(d.location).s,
                                 .severity = d.severity});
  return out;
}

std::vector<Scenario> ScenarioSource::draw(std::uint64_t first, int count, int threads) const {
  std::vector<Scenario> out(index(count));
  base::parallel_for((count + kBlock - 1) / kBlock, threads, [&](int block) {
    PlannedStructure::Solver solver(structure_);
    for (int i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i)
      out[index(i)] = draw(first + static_cast<std::uint64_t>(i), solver);
  });
  return out;
}

std::vector<PlaceSpan> ScenarioSource::spans() const {
  std::vector<PlaceSpan> out;
  int sites = 0;
  std::vector<int> first;
  for (const DefectKind& kind : structure_.kinds()) {
    first.push_back(sites);
    sites += static_cast<int>(kind.line.stretches().size());
  }
  for (const TestPlace& place : structure_.places())
    out.push_back({first[index(place.kind)] + place.stretch, place.start, place.end});
  return out;
}

PreparedDesign prepare(const PlannedStructure& structure, const PlacePredictions& predictions,
                       const TestNoise& noise, const TestDesign& design) {
  TestData data(structure, noise, design);
  NormalTest test = make_normal_test(structure, predictions, data);
  return {std::move(data), std::move(test)};
}

std::vector<TestOutcome> simulate_tests(const ScenarioSource& source, const PreparedDesign& design,
                                        std::span<const Scenario> scenarios, double tolerance) {
  const TestScorer scorer(design.test, source.spans(), tolerance);
  Eigen::MatrixXd measured(design.data.size(), static_cast<Index>(scenarios.size()));
  for (std::size_t i = 0; i < scenarios.size(); ++i)
    design.data.measured(scenarios[i].modes, scenarios[i].numbers,
                         measured.col(static_cast<Index>(i)));
  const Eigen::MatrixXd products = design.test.products(measured);
  std::vector<TestOutcome> out;
  NormalTest::Answer answer;
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    const auto n = static_cast<Index>(i);
    const NormalTest::Measured test{measured.col(n).data(), products.col(n).data()};
    design.test.answer(test, answer);
    out.push_back(scorer.score(scenarios[i].truth, test, answer));
  }
  return out;
}

std::vector<TestScores> score_designs(const ScenarioSource& source,
                                      const PlacePredictions& predictions, const TestNoise& noise,
                                      const std::vector<TestDesign>& designs,
                                      const ScoringOptions& options, std::uint64_t first) {
  std::vector<PreparedDesign> prepared;
  for (const TestDesign& design : designs)
    prepared.push_back(prepare(source.structure(), predictions, noise, design));
  const int blocks = (options.scenarios + kBlock - 1) / kBlock;
  std::vector<std::vector<std::vector<TestOutcome>>> found(
      designs.size(), std::vector<std::vector<TestOutcome>>(index(blocks)));
  std::atomic<int> done{0};
  std::mutex telling;
  base::parallel_for(blocks, options.threads, [&](int block) {
    PlannedStructure::Solver solver(source.structure());
    std::vector<Scenario> scenarios;
    for (int i = block * kBlock; i < std::min(options.scenarios, (block + 1) * kBlock); ++i)
      scenarios.push_back(source.draw(first + static_cast<std::uint64_t>(i), solver));
    for (std::size_t d = 0; d < prepared.size(); ++d)
      found[d][index(block)] = simulate_tests(source, prepared[d], scenarios, options.tolerance);
    ++done;
    if (!options.progress) return;
    const std::lock_guard lock(telling);
    options.progress(static_cast<double>(done) / blocks);
  });
  std::vector<TestScores> out;
  for (auto& blocks_of : found) {
    std::vector<TestOutcome> all;
    for (auto& block : blocks_of) all.insert(all.end(), block.begin(), block.end());
    out.push_back(summarise(all, source.models(), options.false_alarm));
  }
  return out;
}

}  // namespace wheeltap::identification::planning
