#include "apps/cases/emulator_case.hpp"

#include <algorithm>
#include <numeric>

#include "emulator/gaussian_process.hpp"
#include "identification/emulation/interpolants.hpp"
#include "identification/structural/defects/reduction.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::vector<std::vector<int>> parse_sites(const CaseFile& file, const Pointer& where,
                                          int elements) {
  const auto parse_list = [&](const Pointer& list_at) {
    std::vector<int> sites;
    const Json& list = file.json.at(list_at);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const int site = list[i].get<int>();
      if (site > elements) {
        file.refuse(list_at / i, "the beam has " + std::to_string(elements) + " elements");
      }
      if (!sites.empty() && site - 1 <= sites.back()) {
        file.refuse(list_at / i, "sites must increase, without duplicates");
      }
      sites.push_back(site - 1);
    }
    if (sites.size() < 2) file.refuse(list_at, "at least two sites are needed to interpolate");
    return sites;
  };
  const Json& sites = file.json.at(where);
  std::vector<std::vector<int>> lists;
  if (sites.is_string()) {
    if (elements < 2) file.refuse(where, "an emulator needs a beam of at least two elements");
    lists.emplace_back(static_cast<std::size_t>(elements));
    std::iota(lists[0].begin(), lists[0].end(), 0);
  } else if (sites[0].is_array()) {
    for (std::size_t i = 0; i < sites.size(); ++i) lists.push_back(parse_list(where / i));
  } else {
    lists.push_back(parse_list(where));
  }
  return lists;
}

// Parses a space-filling design, or the names of files with the user's own model runs.
void parse_runs(const CaseFile& file, const Pointer& where, EmulatorSpec& spec) {
  const Json& p = file.json.at(where);
  if (p.contains("design")) {
    const Json& d = p["design"];
    spec.runs =
        d["kind"] == "sobol" ? EmulatorSpec::Runs::sobol : EmulatorSpec::Runs::latin_hypercube;
    spec.design_runs = d["runs"].is_array() ? d["runs"].get<std::vector<int>>()
                                            : std::vector<int>{d["runs"].get<int>()};
    spec.design_seed = d.value("seed", std::uint64_t{1});
  }
  if (p.contains("runs_csv")) {
    spec.runs = EmulatorSpec::Runs::csv;
    const Json& names = p["runs_csv"];
    for (const Json& name : names.is_array() ? names : Json::array({names})) {
      spec.csv.push_back(file.resolve(name.get<std::string>()));
    }
  }
}

}  // namespace

EmulatorSpec parse_emulator(const CaseFile& file, const Pointer& where, const DamageCase& out) {
  const Json& p = file.json.at(where);
  if (out.kinds.size() != 1 || out.kinds[0].type != &defects::kReduction) {
    file.refuse(where, "an emulator supports one kind of defect, \"reduction\"; use \"fe\" here");
  }
  if (out.kinds[0].extent || out.kinds[0].extent_prior)
    file.refuse(where,
                "an emulator supports stiffness reductions of single elements, not an \"extent\"; "
                "use \"fe\" here");
  if (out.structure)
    file.refuse(where, "an emulator is trained on a beam, not on a structure; use \"fe\" here");
  EmulatorSpec spec;
  spec.emulator_error = p.value("emulator_error", true);
  spec.exact = p.value("exact", false);
  spec.holdout = p.value("holdout", spec.holdout);
  if (p.contains("table")) {
    for (const char* key :
         {"sites", "multipliers", "interpolation", "coordinate", "expansion", "additive", "design",
          "runs_csv", "symmetrise", "holdout", "accuracy"}) {
      if (p.contains(key))
        file.refuse(where / key, "is defined by the table: remove this key, or remove \"table\"");
    }
    spec.table = file.resolve(p["table"].get<std::string>());
    return spec;
  }
  const int sources = (p.contains("sites") ? 1 : 0) + (p.contains("design") ? 1 : 0) +
                      (p.contains("runs_csv") ? 1 : 0);
  if (sources != 1) {
    file.refuse(where,
                "an emulator needs one of \"table\", \"sites\" (with \"multipliers\"), "
                "\"design\" and \"runs_csv\"");
  }
  parse_runs(file, where, spec);
  const bool grid = p.contains("sites");
  const bool own = p.contains("runs_csv");
  if (grid && !p.contains("multipliers")) {
    file.refuse(where / "multipliers", "is missing: \"sites\" need \"multipliers\"");
  }
  if (own && p.contains("multipliers")) {
    file.refuse(where / "multipliers",
                "is not allowed with \"runs_csv\": the file contains the levels");
  }
  if (!grid && !own) spec.interpolant = &emulator::kGaussianProcess;
  if (p.contains("interpolation")) {
    // The schema has rejected unknown names.
    spec.interpolant = find_interpolant_type(p["interpolation"].get<std::string>());
  }
  using Joined = emulator::InterpolantType::Runs;
  if (grid && spec.interpolant->runs != Joined::grid) {
    file.refuse(where / "interpolation",
                "needs model runs that are not on a grid (\"design\", \"runs_csv\"); a grid of "
                "sites allows " +
                    interpolant_names(Joined::grid));
  }
  if (p.contains("design") && spec.interpolant->runs != Joined::scattered) {
    file.refuse(where / "interpolation", "needs a grid of sites; a space-filling design allows " +
                                             interpolant_names(Joined::scattered));
  }
  if (grid) spec.sites = parse_sites(file, where / "sites", out.beam.elements);
  if (p.contains("accuracy")) {
    if (!grid)
      file.refuse(where / "accuracy", "is allowed with \"sites\" and \"multipliers\" only");
    spec.accuracy = p["accuracy"].get<double>();
  }
  if (p.contains("multipliers")) {
    for (const double multiplier : p["multipliers"].get<std::vector<double>>()) {
      spec.reductions.push_back(std::round((1.0 - multiplier) * 1e12) / 1e12);  // exactly 0.6
    }
    std::ranges::sort(spec.reductions);
    if (std::ranges::adjacent_find(spec.reductions) != spec.reductions.end()) {
      file.refuse(where / "multipliers", "a multiplier is listed twice");
    }
  } else if (p.contains("design")) {
    const inference::Prior& prior = *out.kinds[0].severity_prior();
    if (!(prior.upper() <= 0.999 && prior.upper() > prior.lower())) {
      file.refuse(where / "multipliers",
                  "is missing: it is required if the prior of the reduction extends above 0.999");
    }
  }
  spec.compliance = p.value("coordinate", std::string()) == "compliance";
  if (p.value("expansion", std::string("none")) == "anova") {
    spec.anova = emulator::additive_named(p.value("additive", std::string("inverse-square")));
    if (spec.sites.size() > 1) {
      file.refuse(where / "sites",
                  "\"anova\" uses one table for all numbers of damages: give one list of sites");
    }
  } else if (p.contains("additive")) {
    file.refuse(where / "additive", "is allowed with \"expansion\": \"anova\" only");
  }
  const std::size_t most_damages = spec.interpolant->most_factors / 2;
  if (static_cast<std::size_t>(spec.tables(out.kinds[0].max_count)) > most_damages) {
    file.refuse(where / "interpolation", '"' + std::string(spec.interpolant->name) +
                                             "\" supports up to " + std::to_string(most_damages) +
                                             " damages; add \"expansion\": \"anova\" for more");
  }
  const bool symmetric = fem::is_mirror_symmetric(out.beam);
  spec.symmetrise = p.value("symmetrise", symmetric && spec.emulator_error);
  if (spec.symmetrise && !symmetric) {
    file.refuse(where / "symmetrise", "this beam is not symmetric");
  }
  return spec;
}

}  // namespace wheeltap::apps
