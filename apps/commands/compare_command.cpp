#include "apps/commands/compare_command.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <numeric>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/failure.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/words.hpp"
#include "inference/statistics/standard_normal.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

struct Compared {
  std::string name;
  std::string title = {}, command = {}, model = {};
  double log_evidence = 0.0, error = 0.0;
  double prior = 0.0, probability = 0.0, probability_error = 0.0;
  bool converged = false, fits = true;
  Report measured = {};
};

std::string with_error(double value, double error) {
  return fixed(value, 2) + " ± " + fixed(error, 2);
}

[[noreturn]] void refuse(const std::string& name, const std::string& message) {
  throw Failure(Exit::bad_input, io::printable(name) + ": " + message);
}

double number_at(const Report& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

/// The measured data of a case, without assumptions (noise parameters, locations of sensors in the
/// model). A file is identified by the content that the run read, not by its name.
class Measured {
 public:
  explicit Measured(const std::string& run, const Report& about)
      : run_(run), inputs_(about.value("inputs", Report::object())) {}

  [[nodiscard]] Report in(const Report& block) const {
    Report out = Report::object();
    for (const char* key :
         {"frequencies", "shapes", "columns", "row", "modes", "samples", "sample_rate",
          "temperature", "repeats", "decimal", "separator", "skip", "header", "units_row",
          "time_format", "time_unit", "rows_are_channels", "sheet"})
      if (block.contains(key)) out[key] = block[key];
    for (const char* key : {"from", "file"})
      if (block.contains(key)) out[key] = content_of(block[key]);
    for (const char* list : {"states", "channels"}) {
      if (!block.contains(list) || !block[list].is_array()) continue;
      for (const Report& one : block[list]) {
        Report kept = in(one);
        for (const char* key : {"column", "role", "quantity", "scale", "offset", "unit", "frame"})
          if (one.contains(key)) kept[key] = one[key];
        out[list].push_back(std::move(kept));
      }
    }
    if (const auto repeats = out.find("repeats");
        repeats != out.end() && repeats->is_object() && repeats->contains("file"))
      (*repeats)["file"] = content_of((*repeats)["file"]);
    return out;
  }

 private:
  [[nodiscard]] Report content_of(const Report& name) const {
    const auto found = name.is_string() ? inputs_.find(name.get<std::string>()) : inputs_.end();
    if (found == inputs_.end())
      refuse(run_, "has no checksum of its data file " + name.dump() +
                       ", so Wheeltap cannot compare the data of this run with the data of other "
                       "runs: repeat the run");
    return *found;
  }

  const std::string& run_;
  Report inputs_;
};

Report measured_of(const std::string& name, const Report& summary) {
  const Report& given = summary["wheeltap"]["case"];
  const bool own_data =
      (summary.contains("data") && summary["data"].is_object() &&
       summary["data"].value("simulated", false)) ||
      (given.contains("truth") && given.contains("record") && !given["record"].contains("file"));
  if (own_data)
    refuse(name,
           "the data of this run were simulated from its case: write the data to a file first "
           "(wheeltap simulate)");
  const Measured measured(name, summary["wheeltap"]);
  Report out = Report::object();
  for (const char* key : {"data", "record"})
    if (given.contains(key)) out[key] = measured.in(given[key]);
  if (given.contains("baseline")) out["baseline"] = measured.in(given["baseline"].at("data"));
  for (const Report& record : given.value("records", Report::array()))
    out["records"].push_back(measured.in(record));
  return out;
}

/// Reads a summary, which a user may have edited: throws nlohmann exceptions if keys are missing.
Compared compared(const std::string& name, const Report& s) {
  Compared out{.name = name};
  out.title = s.value("title", "");
  out.command = s["wheeltap"].value("command", "");
  out.measured = measured_of(out.name, s);
  const Report models = s.value("models", Report::array());
  const auto best = std::ranges::max_element(
      models, {}, [](const Report& m) { return number_at(m, "probability"); });
  if (best == models.end()) refuse(out.name, "compares no models, so it has no evidence");
  const double p = number_at(*best, "probability"), prior = number_at(*best, "prior"),
               log_z = number_at(*best, "log_evidence");
  if (!std::isfinite(log_z) || !(p > 0.0) || !(prior > 0.0))
    refuse(out.name,
           "the evidence of the most probable model of this run is not known; repeat the run with "
           "--evidence=bridge");
  out.model = models.size() > 1 ? best->value("name", "") : "";
  out.log_evidence = log_z + std::log(prior) - std::log(p);
  const double error = number_at(*best, "log_evidence_se"), mcse = number_at(*best, "mcse");
  out.error = std::hypot(std::isfinite(error) ? error : 0.0, std::isfinite(mcse) ? mcse / p : 0.0);
  if (s.contains("diagnostics")) out.converged = s["diagnostics"].value("converged", false);
  if (s.contains("fit") && s["fit"].is_object()) out.fits = s["fit"].value("ok", true);
  return out;
}

Compared read_run(const std::filesystem::path& folder) {
  const std::string name = folder.lexically_normal().string();
  io::finish_commit(folder);
  const std::optional<Report> summary = stored_summary(folder);
  if (!summary || !summary->contains("wheeltap") || !(*summary)["wheeltap"].contains("case"))
    throw Failure(Exit::no_input, io::printable(name) + ": does not contain a finished run");
  try {
    return compared(name, *summary);
  } catch (const nlohmann::json::exception& error) {
    refuse(name, std::string("summary.json does not have the format of a run's results: ") +
                     error.what());
  }
}

/// Weights normalised to the sum 1; equal weights if none are given. The function uses only ratios
/// of weights, because the sum of the weights may overflow.
std::vector<double> shares(std::vector<double> weights, std::size_t count) {
  if (weights.empty()) weights.assign(count, 1.0);
  const double largest = *std::ranges::max_element(weights);
  for (double& w : weights) w /= largest;
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& w : weights) w /= sum;
  return weights;
}

void weigh(std::vector<Compared>& runs) {
  double all = -std::numeric_limits<double>::infinity();
  for (const Compared& run : runs)
    all = inference::log_sum_exp(all, run.log_evidence + std::log(run.prior));
  for (Compared& run : runs)
    run.probability = std::exp(run.log_evidence + std::log(run.prior) - all);
  for (Compared& run : runs) {
    double variance = 0.0;
    for (const Compared& other : runs)
      variance += std::pow(((&other == &run ? 1.0 : 0.0) - other.probability) * other.error, 2.0);
    run.probability_error = run.probability * std::sqrt(variance);
  }
}

void print_comparison(const std::vector<Compared>& runs) {
  std::size_t widest = 0;
  for (const Compared& run : runs) widest = std::max(widest, io::printable(run.name).size());
  const Compared& best = *std::ranges::max_element(runs, {}, &Compared::probability);
  std::cout << "Most probable: " << io::printable(best.name) << " (" << percent(best.probability)
            << ").";
  if (!best.fits)
    std::cout
        << " This model does not explain the data: it is only the best of the compared models.";
  std::cout << "\n\n";
  for (const Compared& run : runs) {
    std::cout << "  " << std::left << std::setw(static_cast<int>(widest)) << io::printable(run.name)
              << "  P = " << percent(run.probability, run.probability_error)
              << "  ln Z = " << with_error(run.log_evidence, run.error);
    if (!run.model.empty())
      std::cout << "  (most probable model: " << io::printable(run.model) << ')';
    if (!run.fits) std::cout << "  does not fit";
    if (!run.converged) std::cout << "  NOT CONVERGED";
    std::cout << '\n';
  }
  std::cout << "  (prior probabilities:";
  for (std::size_t i = 0; i < runs.size(); ++i)
    std::cout << (i == 0 ? " " : ", ") << percent(runs[i].prior);
  std::cout << "; set by --prior)\n";
  for (const Compared& run : runs)
    if (&run != &best)
      std::cout << "  ln Bayes factor of " << io::printable(best.name) << " against "
                << io::printable(run.name) << ": "
                << with_error(best.log_evidence - run.log_evidence,
                              std::hypot(best.error, run.error))
                << '\n';
}

void print_json(const std::vector<Compared>& runs) {
  Report out = Report::array();
  for (const Compared& run : runs)
    out.push_back({{"run", io::printable(run.name)},
                   {"title", run.title},
                   {"prior", run.prior},
                   {"probability", run.probability},
                   {"mcse", run.probability_error},
                   {"log_evidence", run.log_evidence},
                   {"log_evidence_se", run.error},
                   {"converged", run.converged},
                   {"fits", run.fits}});
  std::cout << Report({{"runs", out}}).dump(2) << '\n';
}

}  // namespace

void run_compare(const CompareOptions& options) {
  if (options.folders.size() < 2)
    throw Failure(Exit::usage, "compare: give the folders of at least two runs");
  if (!options.prior.empty() && options.prior.size() != options.folders.size())
    throw Failure(Exit::usage, "--prior: " + std::to_string(options.prior.size()) +
                                   " numbers: must be one per folder, " +
                                   std::to_string(options.folders.size()));
  std::vector<Compared> runs;
  for (const auto& folder : options.folders) runs.push_back(read_run(folder));
  for (const Compared& run : runs) {
    if (run.command != runs[0].command)
      refuse(run.name, "is a run of " + run.command + ", but " + io::printable(runs[0].name) +
                           " is a run of " + runs[0].command);
    if (run.measured != runs[0].measured)
      refuse(run.name, "does not use the data of " + io::printable(runs[0].name) +
                           ": evidences are comparable for the same data only");
  }
  const std::vector<double> prior = shares(options.prior, runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i].prior = prior[i];
  weigh(runs);
  if (options.json) return print_json(runs);
  print_comparison(runs);
}

Command compare_command() {
  const auto comparing = std::make_shared<CompareOptions>();
  return {.name = "compare",
          .summary = "compare the models of finished runs on the same data by their evidence",
          .add_options =
              [comparing](CommandOptions& options) {
                CLI::App& app = options.app();
                app.add_option("DIR", comparing->folders, "results folders of the runs to compare")
                    ->required();
                app.add_option(
                       "--prior", comparing->prior,
                       "prior weights, one per folder, separated by commas (default: equal)")
                    ->delimiter(',')
                    ->check(positive());
                app.add_flag("--json", comparing->json, "print the comparison as JSON");
              },
          .run = [comparing](const Invocation&) { run_compare(*comparing); }};
}

}  // namespace wheeltap::apps
