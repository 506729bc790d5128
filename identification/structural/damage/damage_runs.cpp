#include "identification/structural/damage/damage_runs.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "emulator/grid_refinement.hpp"
#include "emulator/runs_csv.hpp"
#include "identification/emulation/frequency_tables.hpp"
#include "identification/emulation/interpolants.hpp"
#include "signals/units.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using emulator::Design;
using emulator::Factor;
using emulator::InterpolantType;
using emulator::RowMatrix;
using emulator::Table;

constexpr double kMostRuns = 1e7;

std::string run_number(double x) {
  return base::significant(x, 6);
}

std::vector<fem::Damage> damages_of(std::span<const double> point) {
  std::vector<fem::Damage> damages;
  for (std::size_t i = 0; i + 1 < point.size(); i += 2) damages.push_back({point[i], point[i + 1]});
  return damages;
}

std::vector<Factor> factors(int count, const std::function<std::vector<double>(int i)>& locations,
                            const std::vector<double>& reductions, bool compliance) {
  std::vector<Factor> list;
  for (int i = 0; i < count; ++i) {
    const std::string n = std::to_string(i + 1);
    list.push_back({.name = "location_" + n, .unit = "m", .levels = locations(i)});
    list.push_back({.name = "reduction_" + n,
                    .unit = "",
                    .levels = reductions,
                    .scale = compliance ? emulator::Scale::compliance : emulator::Scale::linear});
  }
  return list;
}

// Sorts the damages of each run by location, moves them to midpoints and removes duplicates.
Design tidied(Design design, const fem::Beam& beam) {
  std::set<std::vector<double>> points;
  Index kept = 0;
  for (Index i = 0; i < design.runs(); ++i) {
    std::vector<double> point;
    for (const fem::Damage& d : sorted_damages(design.point(i))) {
      point.push_back(beam.element_midpoint(beam.element_at(d.location)));
      point.push_back(d.reduction);
    }
    if (!points.insert(point).second) continue;
    std::ranges::copy(point, design.points.row(kept++).begin());
  }
  design.points.conservativeResize(kept, Eigen::NoChange);
  return design;
}

// The user's runs, as a grid if they form one.
Table own_runs(const fem::Beam& beam, const EmulatorSpec& spec, int count) {
  const auto& file = spec.csv[static_cast<std::size_t>(count - 1)];
  std::vector<Factor> columns;
  for (int i = 1; i <= count; ++i) {
    const std::string n = "[" + std::to_string(i) + "]";
    columns.push_back({.name = "location" + n, .unit = "m", .levels = {}});
    columns.push_back(
        {.name = "reduction" + n,
         .unit = "",
         .levels = {},
         .scale = spec.compliance ? emulator::Scale::compliance : emulator::Scale::linear});
  }
  using signals::Dimension;
  const auto in_hz = [](const io::Column& column) -> std::optional<double> {
    const auto found = signals::conversion_of(signals::unit_of(column), Dimension::frequency);
    if (found.basis == signals::Conversion::Basis::foreign) return std::nullopt;
    return found.factor;
  };
  Table table = emulator::read_runs_csv(file, columns,
                                        {.name = "frequency",
                                         .factor = in_hz,
                                         .unit = "Hz",
                                         .units = signals::known_units(Dimension::frequency)});
  const auto refuse = [&](const std::string& what) {
    throw io::FileError(io::FileError::Kind::corrupt, file, what);
  };
  for (const Factor& f : table.factors) {
    const bool location = f.unit == "m";
    if (f.low() < 0.0 || f.high() > (location ? beam.length : 1.0) ||
        (!location && f.high() >= 1.0)) {
      refuse("column \"" + f.name + "\" ranges from " + run_number(f.low()) + " to " +
             run_number(f.high()) + ", but " +
             (location ? "the beam is " + run_number(beam.length) + " m long"
                       : "a reduction lies in [0, 1)"));
    }
  }
  const auto names = factors(
      count, [](int) { return std::vector<double>(); }, {}, false);
  const auto rename = [&](Table& t) {
    for (std::size_t j = 0; j < names.size(); ++j) t.factors[j].name = names[j].name;
  };
  if (spec.interpolant->runs == InterpolantType::Runs::grid) {
    auto grid = emulator::as_grid(table);
    if (!grid) {
      refuse(
          "the runs are not a full grid, which " + interpolant_names(InterpolantType::Runs::grid) +
          " need: use \"interpolation\": " + interpolant_names(InterpolantType::Runs::scattered));
    }
    rename(*grid);
    return std::move(*grid);
  }
  Design all{.factors = table.factors, .points = table.points};
  const Design tidy = tidied(all, beam);
  if (tidy.runs() != all.runs()) {
    refuse("two runs have the same damages (in the elements of the case's beam)");
  }
  table.points = tidy.points;
  // Sorting by location permutes columns: all locations have one range, all reductions another.
  for (std::size_t kind = 0; kind < 2; ++kind) {
    double low = table.points.col(static_cast<Index>(kind)).minCoeff();
    double high = table.points.col(static_cast<Index>(kind)).maxCoeff();
    for (std::size_t j = kind; j < table.factors.size(); j += 2) {
      low = std::min(low, table.points.col(static_cast<Index>(j)).minCoeff());
      high = std::max(high, table.points.col(static_cast<Index>(j)).maxCoeff());
    }
    for (std::size_t j = kind; j < table.factors.size(); j += 2)
      table.factors[j].levels = {low, high};
  }
  rename(table);
  return table;
}

// The requested modes of the user's runs.
Table own_table(const fem::Beam& beam, const EmulatorSpec& spec, int modes, int count) {
  if (static_cast<std::size_t>(count) > spec.csv.size()) {
    throw std::invalid_argument("\"runs_csv\" has no runs with " + std::to_string(count) +
                                " damages, which the case allows");
  }
  Table table = own_runs(beam, spec, count);
  if (table.values.cols() < modes) {
    throw std::invalid_argument(spec.csv[static_cast<std::size_t>(count - 1)].string() + " holds " +
                                std::to_string(table.values.cols()) + " modes, but the data have " +
                                std::to_string(modes));
  }
  table.values = RowMatrix(table.values.leftCols(modes));
  return table;
}

// The values at the points of a design, taken from previous runs.
RowMatrix values_from(const Table& runs, const Design& design, int modes, int count) {
  if (runs.values.cols() != modes) {
    throw std::invalid_argument("the parts of the table have " +
                                std::to_string(runs.values.cols()) + " modes, but the case needs " +
                                std::to_string(modes));
  }
  const Design made = runs.design();
  std::map<std::vector<double>, Index> rows;
  for (Index i = 0; i < made.runs(); ++i) {
    if (!runs.values.row(i).hasNaN()) {
      rows.emplace(std::vector<double>(made.points.row(i).begin(), made.points.row(i).end()), i);
    }
  }
  RowMatrix values(design.runs(), modes);
  Index missing = 0;
  for (Index i = 0; i < design.runs(); ++i) {
    const auto found =
        rows.find(std::vector<double>(design.points.row(i).begin(), design.points.row(i).end()));
    if (found == rows.end()) {
      ++missing;
    } else {
      values.row(i) = runs.values.row(found->second);
    }
  }
  if (missing > 0) {
    throw std::invalid_argument("the parts of the table lack " + std::to_string(missing) +
                                " of the " + std::to_string(design.runs()) + " runs for " +
                                std::to_string(count) + (count == 1 ? " damage" : " damages") +
                                ": a part is missing, or belongs to another case");
  }
  return values;
}

emulator::ExperimentOptions experiment_options(const fem::Beam& beam, int count,
                                               const RunOptions& options) {
  emulator::ExperimentOptions experiment{.threads = options.threads};
  if (!options.journal_stem.empty()) {
    experiment.journal = options.journal_stem.string() + "." + table_name(count);
    experiment.identity = beam_fingerprint(beam);
  }
  if (options.progress) {
    experiment.progress = [&options, count](Index done, Index total) {
      options.progress(count, done, total);
    };
  }
  return experiment;
}

Table frequency_table(std::vector<Factor> factors, RowMatrix points, RowMatrix values) {
  return {.factors = std::move(factors),
          .points = std::move(points),
          .response_name = "frequency",
          .response_unit = "Hz",
          .values = std::move(values),
          .holdout = {},
          .attributes = {},
          .parameters = {}};
}

// The table on the grid of `spec`, with sites and levels added until it has the required accuracy.
Table refined(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec, const DefectKind& kind,
              int modes, int count, const RunOptions& options, long& made) {
  const fem::Beam& beam = reanalysis.beam();
  const auto start = damage_design(beam, spec, kind, count).factors;
  emulator::RefinementOptions refinement{.tolerance = {},
                                         .interpolant = spec.interpolant,
                                         .waves = waves(count),
                                         .candidates = {},
                                         .most_runs = 1'000'000,
                                         .seed = options.seed,
                                         .experiment = {.threads = options.threads}};
  std::vector<double> intact(static_cast<std::size_t>(modes));
  model_of(reanalysis, options)()({}, intact);
  for (const double frequency : intact) refinement.tolerance.push_back(*spec.accuracy * frequency);
  std::vector<double> midpoints;
  for (int e = 0; e < beam.elements; ++e) midpoints.push_back(beam.element_midpoint(e));
  for (int i = 0; i < count; ++i) {
    refinement.candidates.push_back(midpoints);
    refinement.candidates.emplace_back();
  }
  auto grid = emulator::refine_grid(start, modes, model_of(reanalysis, options), refinement);
  made += grid.model_runs;
  if (!grid.reached) {
    throw std::invalid_argument(
        "an accuracy of " + run_number(*spec.accuracy) + " with " + std::to_string(count) +
        (count == 1 ? " damage" : " damages") +
        " needs more than a million runs, or more sites than there are "
        "elements: choose a lower accuracy, or use \"coordinate\": \"compliance\"");
  }
  return frequency_table(std::move(grid.factors), {}, std::move(grid.values));
}

}  // namespace

std::vector<fem::Damage> sorted_damages(std::span<const double> point) {
  auto damages = damages_of(point);
  std::ranges::sort(damages, {}, &fem::Damage::location);
  return damages;
}

std::vector<bool> waves(int count) {
  std::vector<bool> list;
  for (int i = 0; i < count; ++i) list.insert(list.end(), {true, false});
  return list;
}

emulator::ModelFactory fe_model(const fem::Reanalysis& reanalysis) {
  return [&reanalysis] {
    auto workspace = std::make_shared<fem::Reanalysis::Workspace>(reanalysis.make_workspace());
    const auto rigid = static_cast<std::size_t>(reanalysis.rigid_body_modes());
    return [&reanalysis, workspace, rigid](std::span<const double> point, std::span<double> out) {
      std::vector<double> all(out.size() + rigid);
      reanalysis.frequencies_hz(damages_of(point), {}, *workspace, all);
      std::copy(all.begin() + static_cast<std::ptrdiff_t>(rigid), all.end(), out.begin());
    };
  };
}

emulator::ModelFactory outside_model(OutsideModel& model, int max_count) {
  const auto width = 2 * static_cast<std::size_t>(max_count);
  return [&model, width] {
    return [&model, width](std::span<const double> point, std::span<double> out) {
      std::vector<double> sent;
      for (const fem::Damage& d : sorted_damages(point)) {
        sent.push_back(d.location);
        sent.push_back(d.reduction);
      }
      sent.resize(width, 0.0);
      model.evaluate(sent, out);
    };
  };
}

emulator::ModelFactory model_of(const fem::Reanalysis& reanalysis, const RunOptions& options) {
  return options.model ? options.model : fe_model(reanalysis);
}

// Excludes an element that overlaps the prior only by rounding errors.
std::pair<int, int> elements_of(const inference::Prior& location, const fem::Beam& beam) {
  const double low = location.lower();
  const double high = std::max(low, location.upper() - 1e-6 * beam.element_length());
  return {beam.element_at(low), beam.element_at(high)};
}

Design damage_design(const fem::Beam& beam, const EmulatorSpec& spec, const DefectKind& kind,
                     int count) {
  if (spec.runs == EmulatorSpec::Runs::grid) {
    const auto sites = [&](int i) {
      std::vector<double> levels;
      const auto n = std::min(static_cast<std::size_t>(i), spec.sites.size() - 1);
      for (const int site : spec.sites[n]) levels.push_back(beam.element_midpoint(site));
      return levels;
    };
    auto box = factors(count, sites, spec.reductions, spec.compliance);
    double runs = 1.0;
    for (const Factor& factor : box) runs *= static_cast<double>(factor.levels.size());
    if (runs > kMostRuns) {
      throw std::invalid_argument(
          "a table for " + std::to_string(count) + " damages would need " + run_number(runs) +
          " runs, more than 10 million: use \"expansion\": \"anova\", fewer sites or multipliers, "
          "a smaller count, or \"predictor\": \"fe\"");
    }
    return emulator::full_factorial(std::move(box));
  }
  const auto [first, last] = elements_of(kind.location, beam);
  if (first == last)
    throw std::invalid_argument(
        "the location prior covers one element only: choose a wider prior, or \"fe\"");
  std::vector<double> reductions = {kind.severity_prior()->lower(), kind.severity_prior()->upper()};
  if (!spec.reductions.empty()) reductions = {spec.reductions.front(), spec.reductions.back()};
  const std::vector<double> ends = {beam.element_midpoint(first), beam.element_midpoint(last)};
  auto box = factors(
      count, [&](int) { return ends; }, reductions, spec.compliance);
  const auto runs =
      spec.design_runs[std::min(static_cast<std::size_t>(count), spec.design_runs.size()) - 1];
  Design design = spec.runs == EmulatorSpec::Runs::sobol
                      ? emulator::sobol(std::move(box), runs, spec.design_seed)
                      : emulator::latin_hypercube(std::move(box), runs, spec.design_seed);
  if (spec.interpolant->within_hull) design = emulator::with_corners(std::move(design));
  return tidied(std::move(design), beam);
}

Table run_table(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec, const DefectKind& kind,
                int modes, int count, const RunOptions& options, long& made) {
  const fem::Beam& beam = reanalysis.beam();
  if (spec.runs == EmulatorSpec::Runs::csv) return own_table(beam, spec, modes, count);
  if (spec.accuracy) return refined(reanalysis, spec, kind, modes, count, options, made);
  const Design design = damage_design(beam, spec, kind, count);
  Table table = frequency_table(design.factors, {}, {});
  if (spec.runs != EmulatorSpec::Runs::grid) table.points = design.points;
  if (options.runs != nullptr) {
    const auto found = options.runs->tables.find(table_name(count));
    if (found == options.runs->tables.end()) {
      throw std::invalid_argument("the parts of the table have no runs with " +
                                  std::to_string(count) + " damages");
    }
    table.values = values_from(found->second, design, modes, count);
  } else {
    made += design.runs();
    table.values = emulator::run_experiment(design, modes, model_of(reanalysis, options),
                                            experiment_options(beam, count, options));
  }
  return table;
}

emulator::TableFile run_part(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                             const DefectKind& kind, int modes, int part, int parts,
                             const RunOptions& options) {
  const fem::Beam& beam = reanalysis.beam();
  emulator::TableFile file;
  file.attributes["fingerprint"] = beam_fingerprint(beam);
  file.attributes["part"] = std::to_string(part + 1) + "/" + std::to_string(parts);
  for (int count = 1; count <= spec.tables(kind.max_count); ++count) {
    const Design whole = damage_design(beam, spec, kind, count);
    const Design mine = emulator::shard(whole, part, parts);
    const RowMatrix values = emulator::run_experiment(mine, modes, model_of(reanalysis, options),
                                                      experiment_options(beam, count, options));
    Table table = frequency_table(whole.factors, {}, values);
    if (spec.runs == EmulatorSpec::Runs::grid) {
      table.values = RowMatrix::Constant(whole.runs(), modes, kNaN);
      for (Index i = 0; i < mine.runs(); ++i) table.values.row(part + i * parts) = values.row(i);
    } else {
      table.points = mine.points;
    }
    file.tables[table_name(count)] = std::move(table);
  }
  return file;
}

}  // namespace wheeltap::identification
