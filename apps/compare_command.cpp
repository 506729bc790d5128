#include "apps/compare_command.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <numeric>

#include "apps/failure.hpp"
#include "apps/stored_run.hpp"
#include "apps/words.hpp"
#include "inference/standard_normal.hpp"
#include "io/text.hpp"

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

/// What was measured, without what a case believes of it: its scatter, and where its own model has
/// the sensors.
Report measured_in(const Report& block) {
  Report out = Report::object();
  for (const char* key : {"frequencies", "shapes", "from", "file", "columns", "row", "modes",
                          "samples", "sample_rate", "temperature"})
    if (block.contains(key)) out[key] = block[key];
  for (const char* list : {"states", "channels"}) {
    if (!block.contains(list) || !block[list].is_array()) continue;
    for (const Report& one : block[list]) {
      Report kept = measured_in(one);
      for (const char* key : {"column", "role", "quantity", "scale", "frame"})
        if (one.contains(key)) kept[key] = one[key];
      out[list].push_back(std::move(kept));
    }
  }
  return out;
}

Report measured_of(const std::string& name, const Report& summary) {
  const Report& given = summary["wheeltap"]["case"];
  const bool own_data =
      (summary.contains("data") && summary["data"].is_object() &&
       summary["data"].value("simulated", false)) ||
      (given.contains("truth") && given.contains("record") && !given["record"].contains("file"));
  if (own_data)
    refuse(name, "its data were simulated by its own model: write them first (wheeltap simulate)");
  Report out = Report::object();
  for (const char* key : {"data", "record"})
    if (given.contains(key)) out[key] = measured_in(given[key]);
  if (given.contains("baseline")) out["baseline"] = measured_in(given["baseline"].at("data"));
  for (const Report& record : given.value("records", Report::array()))
    out["records"].push_back(measured_in(record));
  return out;
}

/// A summary that anybody may have edited: throws what JSON of another shape throws.
Compared compared(const std::string& name, const Report& s) {
  Compared out{.name = name};
  out.title = s.value("title", "");
  out.command = s["wheeltap"].value("command", "");
  out.measured = measured_of(out.name, s);
  const Report models = s.value("models", Report::array());
  const auto best = std::ranges::max_element(
      models, {}, [](const Report& m) { return number_at(m, "probability"); });
  if (best == models.end()) refuse(out.name, "compares no models: there is no evidence in it");
  const double p = number_at(*best, "probability"), prior = number_at(*best, "prior"),
               log_z = number_at(*best, "log_evidence");
  if (!std::isfinite(log_z) || !(p > 0.0) || !(prior > 0.0))
    refuse(out.name,
           "the evidence of its most probable model is not known; run it again with "
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
  const std::optional<Report> summary = stored_summary(folder);
  if (!summary || !summary->contains("wheeltap") || !(*summary)["wheeltap"].contains("case"))
    throw Failure(Exit::no_input, io::printable(name) + ": holds no finished run");
  try {
    return compared(name, *summary);
  } catch (const nlohmann::json::exception& error) {
    refuse(name, std::string("summary.json does not hold what a run writes: ") + error.what());
  }
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

void print(const std::vector<Compared>& runs) {
  std::size_t widest = 0;
  for (const Compared& run : runs) widest = std::max(widest, io::printable(run.name).size());
  const Compared& best = *std::ranges::max_element(runs, {}, &Compared::probability);
  std::cout << "Most probable: " << io::printable(best.name) << " (" << percent(best.probability)
            << ").";
  if (!best.fits) std::cout << " Its model does not explain the data: least wrong, not right.";
  std::cout << "\n\n";
  for (const Compared& run : runs) {
    std::cout << "  " << std::left << std::setw(static_cast<int>(widest)) << io::printable(run.name)
              << "  P = " << percent(run.probability, run.probability_error)
              << "  ln Z = " << with_error(run.log_evidence, run.error);
    if (!run.model.empty()) std::cout << "  (most of it: " << io::printable(run.model) << ')';
    if (!run.fits) std::cout << "  does not fit";
    if (!run.converged) std::cout << "  NOT CONVERGED";
    std::cout << '\n';
  }
  std::cout << "  (a priori";
  for (std::size_t i = 0; i < runs.size(); ++i)
    std::cout << (i == 0 ? " " : ", ") << percent(runs[i].prior);
  std::cout << "; --prior says otherwise)\n";
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
    throw Failure(Exit::usage, "compare: give the folders of two runs at least");
  if (!options.prior.empty() && options.prior.size() != options.folders.size())
    throw Failure(Exit::usage, "--prior: " + std::to_string(options.prior.size()) +
                                   " numbers: must be one a folder, " +
                                   std::to_string(options.folders.size()));
  std::vector<Compared> runs;
  for (const auto& folder : options.folders) runs.push_back(read_run(folder));
  for (const Compared& run : runs) {
    if (run.command != runs[0].command)
      refuse(run.name, "a run of " + run.command + ", beside one of " + runs[0].command + ", " +
                           io::printable(runs[0].name));
    if (run.measured != runs[0].measured)
      refuse(run.name, "is of other data than " + io::printable(runs[0].name) +
                           ": evidences compare what explains the same numbers");
  }
  const double sum = std::accumulate(options.prior.begin(), options.prior.end(), 0.0);
  for (std::size_t i = 0; i < runs.size(); ++i)
    runs[i].prior =
        options.prior.empty() ? 1.0 / static_cast<double>(runs.size()) : options.prior[i] / sum;
  weigh(runs);
  if (options.json) return print_json(runs);
  print(runs);
}

}  // namespace wheeltap::apps
