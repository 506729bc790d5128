#include "identification/frequency_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/number.hpp"
#include "emulator/grid_refinement.hpp"
#include "emulator/runs_csv.hpp"
#include "io/fingerprint.hpp"
#include "io/json_number.hpp"

namespace wheeltap::identification {
namespace {

using emulator::Design;
using emulator::Factor;
using emulator::RowMatrix;
using emulator::Table;
using Rule = EmulatorSpec::Rule;
using Eigen::Index;

constexpr double kMostRuns = 1e7;
constexpr double kLeastSeverity = 1e-3;  // keeps variances of vanishing damages above rounding
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string group(int count) {
  return "count_" + std::to_string(count);
}

std::string number(double x) {
  return base::significant(x, 6);
}

// Σ r / (1 - r): the compliance that damages add, in units of an element's own.
double severity(std::span<const fem::Damage> damages) {
  double sum = kLeastSeverity;
  for (const fem::Damage& d : damages) sum += d.reduction / (1.0 - d.reduction);
  return sum;
}

std::vector<fem::Damage> damages_of(std::span<const double> point) {
  std::vector<fem::Damage> damages;
  for (std::size_t i = 0; i + 1 < point.size(); i += 2) damages.push_back({point[i], point[i + 1]});
  return damages;
}

std::vector<fem::Damage> sorted_damages(std::span<const double> point) {
  auto damages = damages_of(point);
  std::ranges::sort(damages, {}, &fem::Damage::location);
  return damages;
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

// The elements that a prior gives room to: an end within rounding of a node gives none.
std::pair<int, int> elements_of(const inference::Prior& location, const fem::Beam& beam) {
  const double low = location.lower();
  const double high = std::max(low, location.upper() - 1e-6 * beam.element_length());
  return {beam.element_at(low), beam.element_at(high)};
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

// Runs with damages in order of location, at midpoints, none twice.
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

Design design_of(const fem::Beam& beam, const EmulatorSpec& spec, const DefectKind& kind,
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
          "a table for " + std::to_string(count) + " damages would need " + number(runs) +
          " runs, more than 10 million: use \"expansion\": \"anova\", fewer sites or multipliers, "
          "a smaller count, or \"fe\"");
    }
    return emulator::full_factorial(std::move(box));
  }
  const auto [first, last] = elements_of(kind.location, beam);
  if (first == last) throw std::invalid_argument("the location prior leaves one element only");
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
  if (spec.rule == Rule::delaunay) design = emulator::with_corners(std::move(design));
  return tidied(std::move(design), beam);
}

// The user's own runs, as a grid where they are one.
Table table_of_csv(const fem::Beam& beam, const EmulatorSpec& spec, int count) {
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
  Table table = emulator::read_runs_csv(file, columns, "frequency");
  const auto refuse = [&](const std::string& what) {
    throw io::FileError(io::FileError::Kind::corrupt, file, what);
  };
  for (const Factor& f : table.factors) {
    const bool location = f.unit == "m";
    if (f.low() < 0.0 || f.high() > (location ? beam.length : 1.0) ||
        (!location && f.high() >= 1.0)) {
      refuse("column \"" + f.name + "\" reaches from " + number(f.low()) + " to " +
             number(f.high()) + ", but " +
             (location ? "the beam is " + number(beam.length) + " m long"
                       : "a reduction lies in [0, 1)"));
    }
  }
  table.response_unit = "Hz";
  const auto names = factors(
      count, [](int) { return std::vector<double>(); }, {}, false);
  const auto rename = [&](Table& t) {
    for (std::size_t j = 0; j < names.size(); ++j) t.factors[j].name = names[j].name;
  };
  const bool scattered_rule = spec.rule == Rule::gaussian_process || spec.rule == Rule::delaunay;
  if (!scattered_rule) {
    auto grid = emulator::as_grid(table);
    if (!grid) {
      refuse(
          "the runs are no full grid, which \"multilinear\" and the cubic interpolations need: "
          "use \"interpolation\": \"gaussian-process\" or \"delaunay\"");
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
  // Sorting by location mixes the columns: every location may have all of them, reductions alike.
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

// The values at a design's points, from runs made before.
RowMatrix values_from(const Table& runs, const Design& design, int modes, int count) {
  if (runs.values.cols() != modes) {
    throw std::invalid_argument("the parts have " + std::to_string(runs.values.cols()) +
                                " modes, the case asks for " + std::to_string(modes));
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
    throw std::invalid_argument("the parts lack " + std::to_string(missing) + " of the " +
                                std::to_string(design.runs()) + " runs for " +
                                std::to_string(count) + (count == 1 ? " damage" : " damages") +
                                ": they are not all there, or belong to another case");
  }
  return values;
}

emulator::ExperimentOptions experiment_options(const fem::Beam& beam, int count,
                                               const FrequencyEmulator::TrainOptions& options) {
  emulator::ExperimentOptions experiment{.threads = options.threads};
  if (!options.journal_stem.empty()) {
    experiment.journal = options.journal_stem.string() + "." + group(count);
    experiment.identity = beam_fingerprint(beam);
  }
  if (options.progress) {
    experiment.progress = [&options, count](Index done, Index total) {
      options.progress(count, done, total);
    };
  }
  return experiment;
}

int table_count(const EmulatorSpec& spec, int max_count) {
  return spec.anova ? std::min(max_count, 2) : max_count;
}

// Whether each list of sites is its own mirror image: the emulator then is symmetric by itself.
bool mirrors_itself(const std::vector<Factor>& box, double length) {
  for (std::size_t i = 0; i < box.size(); i += 2) {
    const auto& levels = box[i].levels;
    for (std::size_t j = 0; j < levels.size(); ++j) {
      if (std::abs(levels[j] + levels[levels.size() - 1 - j] - length) > 1e-9 * length)
        return false;
    }
    if (levels != box[0].levels) return false;
  }
  return true;
}

RowMatrix row(const std::vector<double>& values) {
  RowMatrix out(1, static_cast<Index>(values.size()));
  std::ranges::copy(values, out.data());
  return out;
}

std::vector<double> vector_of(const RowMatrix& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

// An EmulatorError as a matrix, one row a mode.
RowMatrix to_matrix(const EmulatorError& error) {
  RowMatrix m(static_cast<Index>(error.holdout.size()), 8);
  for (Index i = 0; i < m.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto& h = error.holdout[at];
    const auto& s = error.standardised[at];
    m.row(i) << h.rmse, h.max_error, h.spread, h.q2, error.scale[at], s.mean, s.rms, s.beyond_two;
  }
  return m;
}

EmulatorError from_matrix(const RowMatrix& m) {
  EmulatorError error;
  for (Index i = 0; i < m.rows(); ++i) {
    error.holdout.push_back(
        {.rmse = m(i, 0), .max_error = m(i, 1), .spread = m(i, 2), .q2 = m(i, 3)});
    error.scale.push_back(m(i, 4));
    error.standardised.push_back({.mean = m(i, 5), .rms = m(i, 6), .beyond_two = m(i, 7)});
  }
  return error;
}

Rule rule_of(const Table& table) {
  const auto written = table.attributes.find("interpolation");
  return written == table.attributes.end() ? Rule::multilinear : rule_named(written->second);
}

std::string error_name(int count) {
  return "error_" + group(count);
}

}  // namespace

// As JSON has it, keys in alphabetical order: tables made by earlier versions stay valid.
std::string beam_fingerprint(const fem::Beam& beam) {
  const auto number = [](double x) { return io::json_number(x); };
  const auto yes = [](bool flag) { return flag ? "true" : "false"; };
  std::string supports;
  for (const fem::Support& s : beam.supports) {
    supports += (supports.empty() ? "[" : ",[") + number(s.at) + "," + yes(s.deflection) + "," +
                yes(s.rotation) + "," + (s.stiffness ? number(*s.stiffness) : "null") + "]";
  }
  return io::fingerprint(
      "{\"area\":" + number(beam.section.area) + ",\"density\":" + number(beam.material.density) +
      ",\"elements\":" + std::to_string(beam.elements) + ",\"length\":" + number(beam.length) +
      ",\"poisson\":" + number(beam.material.poisson) +
      ",\"second_moment\":" + number(beam.section.second_moment) +
      ",\"shear_coefficient\":" + number(beam.section.shear_coefficient) + ",\"supports\":[" +
      supports + "],\"young\":" + number(beam.material.young) + "}");
}

namespace {

std::vector<emulator::AxisRule> axis_rules(Rule rule, std::size_t factors) {
  std::vector<emulator::AxisRule> rules;
  for (std::size_t i = 0; i < factors; ++i) {
    rules.push_back(rule == Rule::multilinear           ? emulator::AxisRule::linear
                    : i % 2 == 0 && rule == Rule::cubic ? emulator::AxisRule::cubic
                                                        : emulator::AxisRule::monotone_cubic);
  }
  return rules;
}

// The table of the grid that `spec` starts from, with the sites and levels that its accuracy needs.
Table refined(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec, const DefectKind& kind,
              int modes, int count, const FrequencyEmulator::TrainOptions& options,
              long& model_runs) {
  const fem::Beam& beam = reanalysis.beam();
  const auto start = design_of(beam, spec, kind, count).factors;
  emulator::RefinementOptions refinement{.tolerance = {},
                                         .rules = axis_rules(spec.rule, start.size()),
                                         .candidates = {},
                                         .most_runs = 1'000'000,
                                         .seed = options.seed,
                                         .experiment = {.threads = options.threads}};
  const auto rigid = static_cast<std::size_t>(reanalysis.rigid_body_modes());
  for (int mode = 0; mode < modes; ++mode) {
    refinement.tolerance.push_back(
        *spec.accuracy *
        reanalysis.intact_frequencies_hz()[rigid + static_cast<std::size_t>(mode)]);
  }
  std::vector<double> midpoints;
  for (int e = 0; e < beam.elements; ++e) midpoints.push_back(beam.element_midpoint(e));
  for (int i = 0; i < count; ++i) {
    refinement.candidates.push_back(midpoints);
    refinement.candidates.emplace_back();
  }
  auto grid = emulator::refine_grid(start, modes, fe_model(reanalysis), refinement);
  model_runs += grid.model_runs;
  if (!grid.reached) {
    throw std::invalid_argument("an accuracy of " + number(*spec.accuracy) + " with " +
                                std::to_string(count) + (count == 1 ? " damage" : " damages") +
                                " needs more than a million runs, or more sites than there are "
                                "elements: ask for less, or use \"coordinate\": \"compliance\"");
  }
  return {.factors = std::move(grid.factors),
          .points = {},
          .response_name = "frequency",
          .response_unit = "Hz",
          .values = std::move(grid.values),
          .holdout = {},
          .attributes = {},
          .parameters = {}};
}

}  // namespace

void FrequencyEmulator::add(Table table, int threads) {
  modes_ = static_cast<int>(table.values.cols());
  const Rule rule = rule_of(table);
  std::shared_ptr<const Interpolant> made;
  if (rule == Rule::gaussian_process) {
    const auto fitted = table.parameters.find("gaussian_process");
    if (fitted != table.parameters.end()) {
      made = std::make_shared<const Interpolant>(emulator::GaussianProcess(
          table.factors, table.points, table.values, emulator::Kernel::matern52, fitted->second));
    } else {
      made = std::make_shared<const Interpolant>(emulator::GaussianProcess(
          table.factors, table.points, table.values, {.threads = threads}));
      table.parameters["gaussian_process"] =
          std::get<emulator::GaussianProcess>(*made).parameters();
    }
  } else if (rule == Rule::delaunay) {
#ifdef WHEELTAP_WITH_CGAL
    made = std::make_shared<const Interpolant>(
        emulator::DelaunayInterpolant(table.factors, table.points, table.values));
#else
    throw std::invalid_argument(
        "this program was built without Delaunay interpolation (CMake option WHEELTAP_WITH_CGAL)");
#endif
  } else if (rule == Rule::multilinear) {
    made = std::make_shared<const Interpolant>(
        emulator::MultilinearInterpolant(table.factors, table.values));
  } else {
    made = std::make_shared<const Interpolant>(emulator::CubicInterpolant(
        table.factors, table.values, axis_rules(rule, table.factors.size())));
  }
  interpolants_.push_back(std::move(made));
  tables_.push_back(std::move(table));
}

void FrequencyEmulator::add_anova(emulator::Additive additive) {
  additive_ = additive;
  const auto part = [](const std::shared_ptr<const Interpolant>& interpolant) {
    return [interpolant](std::span<const double> x, std::span<double> out) {
      std::visit([&](const auto& f) { f.evaluate(x, out); }, *interpolant);
    };
  };
  anova_ = std::make_shared<const emulator::AnovaEmulator>(
      vector_of(tables_[1].parameters.at("intact")), 2, part(interpolants_[0]),
      part(interpolants_[1]), additive);
}

emulator::TableFile FrequencyEmulator::run_part(const fem::Reanalysis& reanalysis,
                                                const EmulatorSpec& spec, const DefectKind& kind,
                                                int modes, int part, int parts,
                                                const TrainOptions& options) {
  const fem::Beam& beam = reanalysis.beam();
  emulator::TableFile file;
  file.attributes["fingerprint"] = beam_fingerprint(beam);
  file.attributes["part"] = std::to_string(part + 1) + "/" + std::to_string(parts);
  for (int count = 1; count <= table_count(spec, kind.max_count); ++count) {
    const Design whole = design_of(beam, spec, kind, count);
    const Design mine = emulator::shard(whole, part, parts);
    const RowMatrix values = emulator::run_experiment(mine, modes, fe_model(reanalysis),
                                                      experiment_options(beam, count, options));
    Table table{.factors = whole.factors,
                .points = {},
                .response_name = "frequency",
                .response_unit = "Hz",
                .values = values,
                .holdout = {},
                .attributes = {},
                .parameters = {}};
    if (spec.runs == EmulatorSpec::Runs::grid) {
      table.values = RowMatrix::Constant(whole.runs(), modes, kNaN);
      for (Index i = 0; i < mine.runs(); ++i) table.values.row(part + i * parts) = values.row(i);
    } else {
      table.points = mine.points;
    }
    file.tables[group(count)] = std::move(table);
  }
  return file;
}

FrequencyEmulator FrequencyEmulator::train(const fem::Reanalysis& reanalysis,
                                           const EmulatorSpec& spec, const DefectKind& kind,
                                           int modes, const TrainOptions& options) {
  const fem::Beam& beam = reanalysis.beam();
  FrequencyEmulator trained(beam);
  const int max_count = kind.max_count;
  for (int count = 1; count <= table_count(spec, max_count); ++count) {
    Table table;
    if (spec.runs == EmulatorSpec::Runs::csv) {
      if (static_cast<std::size_t>(count) > spec.csv.size()) {
        throw std::invalid_argument("\"runs_csv\" has no runs with " + std::to_string(count) +
                                    " damages, which the case allows");
      }
      table = table_of_csv(beam, spec, count);
      if (table.values.cols() < modes) {
        throw std::invalid_argument(spec.csv[static_cast<std::size_t>(count - 1)].string() +
                                    " holds " + std::to_string(table.values.cols()) +
                                    " modes, the data have " + std::to_string(modes));
      }
      table.values = RowMatrix(table.values.leftCols(modes));
    } else if (spec.accuracy) {
      table = refined(reanalysis, spec, kind, modes, count, options, trained.trained_runs_);
    } else {
      const Design design = design_of(beam, spec, kind, count);
      table = {.factors = design.factors,
               .points = {},
               .response_name = "frequency",
               .response_unit = "Hz",
               .values = {},
               .holdout = {},
               .attributes = {},
               .parameters = {}};
      if (spec.runs != EmulatorSpec::Runs::grid) table.points = design.points;
      if (options.runs != nullptr) {
        const auto found = options.runs->tables.find(group(count));
        if (found == options.runs->tables.end()) {
          throw std::invalid_argument("the parts hold no runs with " + std::to_string(count) +
                                      " damages");
        }
        table.values = values_from(found->second, design, modes, count);
      } else {
        trained.trained_runs_ += design.runs();
        table.values = emulator::run_experiment(design, modes, fe_model(reanalysis),
                                                experiment_options(beam, count, options));
      }
    }
    table.attributes["interpolation"] = rule_name(spec.rule);
    trained.symmetrised_ =
        spec.symmetrise && !(table.is_grid() && mirrors_itself(table.factors, beam.length));
    table.attributes["symmetrised"] = trained.symmetrised_ ? "true" : "false";
    if (count == 2 && spec.anova) {
      table.attributes["anova"] = emulator::name(*spec.anova);
      const auto intact = reanalysis.intact_frequencies_hz();
      const auto rigid = static_cast<std::size_t>(reanalysis.rigid_body_modes());
      table.parameters["intact"] =
          row({intact.begin() + static_cast<std::ptrdiff_t>(rigid),
               intact.begin() + static_cast<std::ptrdiff_t>(rigid) + modes});
    }
    trained.add(std::move(table), options.threads);
  }
  if (spec.anova && max_count > 2) trained.add_anova(*spec.anova);
  if (const auto outside = trained.reaches_outside(kind);
      outside && !trained.tables_[0].is_grid()) {
    throw std::invalid_argument(outside->message);
  }
  for (int count = 1; count <= max_count; ++count) {
    trained.measure(reanalysis, count, spec.holdout, options);
  }
  return trained;
}

void FrequencyEmulator::measure(const fem::Reanalysis& reanalysis, int count, Index runs,
                                const TrainOptions& options) {
  const auto width = static_cast<std::size_t>(2 * count);
  std::vector<Factor> box;
  for (std::size_t i = 0; i < width; ++i) {
    box.push_back(factor(count, i));
    box.back().name = "factor_" + std::to_string(i);
  }
  Design fresh = emulator::random_design(box, runs, options.seed);
  Index kept = 0;
  for (Index i = 0; i < fresh.runs(); ++i) {
    if (contains(sorted_damages(fresh.point(i)))) fresh.points.row(kept++) = fresh.points.row(i);
  }
  if (kept < 2) {
    throw std::invalid_argument("the runs leave no room for fresh ones between them");
  }
  fresh.points.conservativeResize(kept, Eigen::NoChange);
  const RowMatrix truth =
      emulator::run_experiment(fresh, modes_, fe_model(reanalysis), {.threads = options.threads});
  fresh_runs_ += kept;
  errors_.resize(std::max(errors_.size(), static_cast<std::size_t>(count)));
  EmulatorError& error = errors_[static_cast<std::size_t>(count - 1)];
  const auto modes = static_cast<std::size_t>(modes_);
  error.scale.assign(modes, 1.0);
  RowMatrix predicted(kept, modes_), variance(kept, modes_);
  for (Index i = 0; i < kept; ++i) {
    evaluate(sorted_damages(fresh.point(i)), {predicted.row(i).data(), modes},
             {variance.row(i).data(), modes});
  }
  // A sum that is no frequency: the FE solution takes its place wherever it is used.
  predicted = predicted.array().isNaN().select(truth, predicted);
  error.holdout = emulator::holdout_error(truth, predicted);
  const bool own_variance =
      count <= tables() && std::holds_alternative<emulator::GaussianProcess>(
                               *interpolants_[static_cast<std::size_t>(count - 1)]);
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const auto at = static_cast<Index>(mode);
    const double ratio =
        ((truth.col(at) - predicted.col(at)).array().square() / variance.col(at).array()).mean();
    error.scale[mode] = own_variance ? std::max(1.0, ratio) : ratio;
    variance.col(at) *= error.scale[mode];
  }
  error.standardised = emulator::standardised_residuals(truth, predicted, variance);
  Table& home = tables_[static_cast<std::size_t>(std::min(count, tables()) - 1)];
  if (own_variance) {
    const auto& process =
        std::get<emulator::GaussianProcess>(*interpolants_[static_cast<std::size_t>(count - 1)]);
    const RowMatrix residual = process.leave_one_out().mean - home.values;
    for (Index mode = 0; mode < modes_; ++mode) {
      error.leave_one_out.push_back(std::sqrt(residual.col(mode).array().square().mean()));
    }
    home.parameters["leave_one_out"] = row(error.leave_one_out);
  }
  home.parameters[error_name(count)] = to_matrix(error);
  if (count <= tables()) home.holdout = error.holdout;
}

FrequencyEmulator FrequencyEmulator::load(const std::filesystem::path& path, const fem::Beam& beam,
                                          int max_count, int modes) {
  auto file = emulator::read_table_file(
      path, {.expected_fingerprint = beam_fingerprint(beam), .allow_incomplete = true});
  if (const auto part = file.attributes.find("part"); part != file.attributes.end()) {
    throw io::FileError(
        io::FileError::Kind::corrupt, path,
        "holds part " + part->second + " of a table: join the parts with wheeltap table --merge");
  }
  FrequencyEmulator loaded(beam);
  for (int count = 1; count <= max_count; ++count) {
    const auto found = file.tables.find(group(count));
    if (found == file.tables.end()) break;
    Table& table = found->second;
    if (table.missing_runs() > 0) {
      throw io::FileError(io::FileError::Kind::corrupt, path,
                          "lacks " + std::to_string(table.missing_runs()) + " runs with " +
                              std::to_string(count) + " damages");
    }
    if (table.values.cols() < modes) {
      throw std::invalid_argument(path.string() + " holds " + std::to_string(table.values.cols()) +
                                  " modes, the data have " + std::to_string(modes));
    }
    if (table.factors.size() != static_cast<std::size_t>(2 * count)) {
      throw io::FileError(io::FileError::Kind::foreign, path,
                          "is no table of damages and frequencies");
    }
    const auto symmetrised = table.attributes.find("symmetrised");
    loaded.symmetrised_ = symmetrised != table.attributes.end() && symmetrised->second == "true";
    EmulatorError error;
    if (const auto e = table.parameters.find(error_name(count)); e != table.parameters.end()) {
      error = from_matrix(e->second);
    } else {
      error.holdout = table.holdout;
    }
    if (const auto l = table.parameters.find("leave_one_out"); l != table.parameters.end()) {
      error.leave_one_out = vector_of(l->second);
    }
    if (error.holdout.empty()) {
      throw io::FileError(io::FileError::Kind::foreign, path,
                          "does not say how wrong its emulator is");
    }
    loaded.errors_.push_back(std::move(error));
    try {
      loaded.add(std::move(table), 1);
    } catch (const std::invalid_argument& fault) {
      throw io::FileError(io::FileError::Kind::corrupt, path, fault.what());
    }
  }
  if (loaded.tables() == 2 && loaded.tables_[1].attributes.contains("anova")) {
    for (int count = 3; count <= max_count; ++count) {
      const auto found = loaded.tables_[1].parameters.find(error_name(count));
      if (found == loaded.tables_[1].parameters.end()) break;
      loaded.errors_.push_back(from_matrix(found->second));
    }
    if (loaded.max_count() > 2) {
      loaded.add_anova(emulator::additive_named(loaded.tables_[1].attributes.at("anova")));
    }
  }
  if (loaded.max_count() < max_count) {
    throw std::invalid_argument(path.string() + " holds tables for up to " +
                                std::to_string(loaded.max_count()) + " damages, the case allows " +
                                std::to_string(max_count));
  }
  return loaded;
}

void FrequencyEmulator::save(const std::filesystem::path& path,
                             std::map<std::string, std::string> attributes) const {
  emulator::TableFile file{.attributes = std::move(attributes), .tables = {}};
  file.attributes["fingerprint"] = beam_fingerprint(beam_);
  for (int count = 1; count <= tables(); ++count) file.tables[group(count)] = table(count);
  emulator::write_table_file(path, file);
}

const Factor& FrequencyEmulator::factor(int count, std::size_t i) const {
  // ANOVA asks both tables for any of the damages; theirs are the same.
  return count <= tables() ? table(count).factors[i] : table(tables()).factors[i % 2];
}

Eigen::Index FrequencyEmulator::runs(int count) const {
  return count <= tables() ? table(count).values.rows()
                           : table(1).values.rows() + table(2).values.rows();
}

std::string FrequencyEmulator::describe(int count) const {
  const Table& t = table(std::min(count, tables()));
  const Rule rule = rule_of(t);
  const std::string in = t.factors[1].scale == emulator::Scale::compliance ? "1/(1-r)" : "r";
  std::string text;
  if (rule == Rule::gaussian_process || rule == Rule::delaunay) {
    text = (rule == Rule::delaunay ? "Delaunay interpolation" : "Gaussian process") +
           std::string(" in ") + in;
  } else {
    text = std::string(rule == Rule::multilinear ? "multilinear"
                       : rule == Rule::cubic     ? "cubic"
                                                 : "monotone cubic") +
           " in " + in + ", " + std::to_string(t.factors[0].levels.size()) + " sites x " +
           std::to_string(t.factors[1].levels.size()) + " levels";
  }
  if (count > tables()) {
    text = "ANOVA in the " + std::string(emulator::name(*additive_)) + ", " + text;
  }
  if (symmetrised_) text += ", mean of both mirror images";
  return text;
}

bool FrequencyEmulator::is_slow() const {
  return std::ranges::any_of(interpolants_, [](const auto& f) {
    return std::holds_alternative<emulator::GaussianProcess>(*f);
  });
}

double FrequencyEmulator::midpoint(double location, const Factor& factor) const {
  // The priors' ends lie in elements whose midpoints may be the box's very ends.
  return std::clamp(beam_.element_midpoint(beam_.element_at(location)), factor.low(),
                    factor.high());
}

bool FrequencyEmulator::contains(std::span<const fem::Damage> damages) const {
#ifdef WHEELTAP_WITH_CGAL
  const int count = static_cast<int>(damages.size());
  const auto inside = [&](int n, std::span<const fem::Damage> some) {
    const auto* f = std::get_if<emulator::DelaunayInterpolant>(
        interpolants_[static_cast<std::size_t>(n - 1)].get());
    if (f == nullptr) return true;
    std::vector<double> x;
    for (std::size_t i = 0; i < some.size(); ++i) {
      x.push_back(midpoint(some[i].location, factor(n, 2 * i)));
      x.push_back(some[i].reduction);
    }
    return f->contains(x);
  };
  if (count <= tables()) return inside(count, damages);
  for (std::size_t i = 0; i < damages.size(); ++i) {
    if (!inside(1, damages.subspan(i, 1))) return false;
    for (std::size_t j = 0; j < i; ++j) {
      if (!inside(2, std::vector<fem::Damage>{damages[j], damages[i]})) return false;
    }
  }
#else
  static_cast<void>(damages);
#endif
  return true;
}

void FrequencyEmulator::call(std::span<const fem::Damage> damages, std::span<double> out,
                             std::span<double> variance) const {
  const int count = static_cast<int>(damages.size());
  thread_local std::vector<double> x;
  x.resize(2 * damages.size());
  for (std::size_t i = 0; i < damages.size(); ++i) {
    x[2 * i] = midpoint(damages[i].location, factor(count, 2 * i));
    x[2 * i + 1] = damages[i].reduction;
  }
  if (count > tables()) {
    anova_->evaluate(x, out);
  } else {
    const Interpolant& f = *interpolants_[static_cast<std::size_t>(count - 1)];
    const auto* process = std::get_if<emulator::GaussianProcess>(&f);
    if (process != nullptr && !variance.empty()) {
      process->evaluate(x, out, variance);
      const auto& scale = error(count).scale;
      for (std::size_t i = 0; i < variance.size(); ++i) variance[i] *= scale[i];
      return;
    }
    std::visit([&](const auto& g) { g.evaluate(x, out); }, f);
  }
  if (variance.empty()) return;
  const EmulatorError& e = error(count);
  if (e.scale.empty()) {
    for (std::size_t i = 0; i < variance.size(); ++i)
      variance[i] = e.holdout[i].rmse * e.holdout[i].rmse;
    return;
  }
  const double s = severity(damages);
  for (std::size_t i = 0; i < variance.size(); ++i) variance[i] = e.scale[i] * s;
}

void FrequencyEmulator::evaluate(std::span<const fem::Damage> damages, std::span<double> out,
                                 std::span<double> variance) const {
  thread_local std::vector<double> all, all_variance, mirrored, mirrored_variance;
  thread_local std::vector<fem::Damage> image;
  const auto modes = static_cast<std::size_t>(modes_);
  const bool direct = out.size() == modes;
  std::span<double> f = out, v = variance;
  if (!direct) {
    all.resize(modes);
    f = all;
    if (!variance.empty()) {
      all_variance.resize(modes);
      v = all_variance;
    }
  }
  call(damages, f, v);
  if (symmetrised_) {
    const int count = static_cast<int>(damages.size());
    image.clear();
    bool inside = true;
    for (std::size_t i = damages.size(); i-- > 0;) {
      image.push_back({beam_.length - damages[i].location, damages[i].reduction});
      const Factor& box = factor(count, 2 * (image.size() - 1));
      const double x = beam_.element_midpoint(beam_.element_at(image.back().location));
      const double slack = 1e-6 * beam_.element_length();
      inside = inside && x >= box.low() - slack && x <= box.high() + slack;
    }
    if (inside && contains(image)) {
      mirrored.resize(modes);
      mirrored_variance.resize(v.size());
      call(image, mirrored, mirrored_variance);
      for (std::size_t i = 0; i < modes; ++i) f[i] = 0.5 * (f[i] + mirrored[i]);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = 0.5 * (v[i] + mirrored_variance[i]);
    }
  }
  if (!direct) {
    std::copy_n(f.begin(), out.size(), out.begin());
    std::copy_n(v.begin(), variance.size(), variance.begin());
  }
}

std::optional<FrequencyEmulator::Outside> FrequencyEmulator::reaches_outside(
    const DefectKind& kind) const {
  const inference::Prior& reduction = *kind.severity_prior();
  const double h = beam_.element_length();
  const auto [first, last] = elements_of(kind.location, beam_);
  for (int count = 1; count <= std::min(kind.max_count, tables()); ++count) {
    const auto& box = table(count).factors;
    for (std::size_t i = 0; i < box.size(); i += 2) {
      const std::string who = count == 1 ? ""
                                         : " (damage " + std::to_string(i / 2 + 1) + " of " +
                                               std::to_string(count) + ")";
      if (beam_.element_midpoint(first) < box[i].low() - 1e-6 * h ||
          beam_.element_midpoint(last) > box[i].high() + 1e-6 * h) {
        return Outside{InvalidInput::Part::location, "location prior " + kind.location.describe() +
                                                         " reaches outside the emulator's box, " +
                                                         number(box[i].low()) + " to " +
                                                         number(box[i].high()) + " m" + who};
      }
      if (reduction.lower() < box[i + 1].low() || reduction.upper() > box[i + 1].high()) {
        return Outside{InvalidInput::Part::severity, "reduction prior " + reduction.describe() +
                                                         " reaches outside the emulator's box, " +
                                                         number(box[i + 1].low()) + " to " +
                                                         number(box[i + 1].high()) + who};
      }
    }
    if (rule_of(table(count)) != Rule::delaunay) continue;
    // The corners of the priors' box, damages in order: where they are inside, all of it is.
    for (unsigned corner = 0; corner < 1U << static_cast<unsigned>(2 * count); ++corner) {
      std::vector<double> point;
      for (int i = 0; i < count; ++i) {
        const auto bit = [&](int n) { return (corner >> static_cast<unsigned>(n) & 1U) != 0; };
        point.push_back(beam_.element_midpoint(bit(2 * i) ? last : first));
        point.push_back(bit(2 * i + 1) ? reduction.upper() : reduction.lower());
      }
      const auto damages = sorted_damages(point);
      if (!contains(damages)) {
        std::string where;
        for (const fem::Damage& d : damages) {
          where += (where.empty() ? "" : ", ") + ("location " + number(d.location)) +
                   " m, reduction " + number(d.reduction);
        }
        return Outside{InvalidInput::Part::location,
                       "the priors reach outside the convex hull of the emulator's runs, at " +
                           where + (count == 1 ? "" : " (two damages)")};
      }
    }
  }
  return {};
}

}  // namespace wheeltap::identification
