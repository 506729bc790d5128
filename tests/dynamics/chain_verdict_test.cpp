// Three masses with one spring and damper for all links, or one for each: the probabilities of
// ../shared/validation/chain. The record is read as in its case file.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "dynamics/simulate.hpp"
#include "inference/diagnosis/verdict.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "signals/record.hpp"

namespace {

using namespace wheeltap;
using namespace wheeltap::dynamics;
using namespace wheeltap::signals;
using nlohmann::json;

// ln N(record; simulated, noise²), with one simulator per model. Coefficients are parameters of the
// model in the order of its names.
class Records : public inference::Likelihood {
 public:
  Records(std::vector<Misfit> misfits, double noise)
      : misfits_(std::move(misfits)), noise_(noise) {}
  double log_likelihood(int model, std::span<const double> x) override {
    const Misfit& misfit = misfits_[static_cast<std::size_t>(model)];
    std::vector<double> sums(static_cast<std::size_t>(misfit.channels()));
    misfit.sums_of_squares(x, 1, sums);
    double sum = 0.0;
    for (const double s : sums) {
      sum -= 0.5 * s / (noise_ * noise_) +
             misfit.samples() * (std::log(noise_) + 0.91893853320467274178);
    }
    return sum;
  }

 private:
  std::vector<Misfit> misfits_;
  double noise_;
};

struct Case {
  inference::Problem problem;
  std::vector<double> probability, log_evidence;
  double error = 0.0;  // error of the probabilities
};

Case read_case(const std::filesystem::path& folder) {
  const json file = json::parse(std::ifstream(folder / "shared_or_own.case.json"));
  const json exact = json::parse(std::ifstream(folder / "shared_or_own.exact.json"));
  const Record record = read_record(folder / file["record"]["file"].get<std::string>());
  const int first = file["record"]["samples"][0], last = file["record"]["samples"][1];
  Excitation excitation{.sample_rate_hz = sample_rate_hz(record, record.find_time())};
  std::vector<Sensor> sensors;
  std::vector<Signal> observed;
  for (const json& channel : file["record"]["channels"]) {
    const Signal signal{
        window(record, record.find(channel["column"].get<std::string>()), first, last)};
    if (channel["role"] == "force") {
      excitation.forces.push_back({channel["mass"], signal});
    } else {
      sensors.push_back({.mass = channel["mass"], .quantity = Quantity::displacement});
      observed.push_back(signal);
    }
  }
  std::vector<inference::Parameter> parameters;
  for (const auto& [name, prior] : file["parameters"].items()) {
    parameters.push_back({name, inference::Uniform{prior["uniform"][0], prior["uniform"][1]}});
  }
  std::vector<inference::ModelSpace::ListedModel> models;
  std::vector<Misfit> misfits;
  for (const json& m : file["models"]) {
    inference::ModelSpace::ListedModel& model =
        models.emplace_back(inference::ModelSpace::ListedModel{m["name"], 1.0, {}});
    const auto coefficient = [&](const std::string& name) {
      const auto at = std::find(model.parameters.begin(), model.parameters.end(), name);
      const auto index = static_cast<int>(at - model.parameters.begin());
      if (at == model.parameters.end()) model.parameters.push_back(name);
      return Coefficient::of_parameter(index);
    };
    Chain chain;
    for (const json& mass : m["masses"]) chain.masses.emplace_back(mass.get<double>());
    for (const json& link : m["links"]) {
      chain.links.push_back({.a = link["between"][0],
                             .b = link["between"][1],
                             .stiffness = coefficient(link["stiffness"]),
                             .damping = coefficient(link["damping"])});
    }
    misfits.emplace_back(Simulator(chain, excitation, sensors), observed);
  }
  const double noise = file["models"][0]["noise"];
  Case out{.problem = {.space = inference::ModelSpace::of_models(parameters, models),
                       .likelihood = [=] { return std::make_unique<Records>(misfits, noise); }},
           .probability = {},
           .log_evidence = exact["log_evidence"],
           .error = exact["error_of_probability"]};
  for (const auto& model : models) out.probability.push_back(exact["probabilities"][model.name]);
  return out;
}

TEST(ChainVerdict, FindsSharedOrSeparateSprings) {
  const auto folder = std::filesystem::path(WHEELTAP_SHARED_DIR) / "validation" / "chain";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const Case chain = read_case(folder);
  const int seeds = std::getenv("WHEELTAP_LONG_TESTS") != nullptr ? 5 : 1;
  for (int seed = 1; seed <= seeds; ++seed) {
    const inference::Posterior posterior =
        inference::reversible_jump(chain.problem, {.seed = static_cast<std::uint64_t>(seed)});
    const inference::Verdict verdict = inference::judge(posterior);
    EXPECT_TRUE(verdict.converged) << "seed " << seed;
    for (std::size_t m = 0; m < 2; ++m) {
      const inference::ModelStanding& ours = verdict.models[m];
      EXPECT_NEAR(ours.probability, chain.probability[m], 4.0 * std::hypot(ours.mcse, chain.error))
          << "seed " << seed;
      std::printf("    seed %d: P = %.4f ± %.4f, known %.4f ± %.4f; %ld calls, %.1f s\n", seed,
                  ours.probability, ours.mcse, chain.probability[m], chain.error,
                  posterior.likelihood_evaluations, posterior.wall_seconds);
    }
  }
}

}  // namespace
