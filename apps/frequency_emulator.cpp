#include "apps/frequency_emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/summary.hpp"

namespace wheeltap::apps {
namespace {

using emulator::Factor;

constexpr double kMostRuns = 1e7;

std::string group(int count) {
  return "count_" + std::to_string(count);
}

std::string number(double x) {
  return significant(x, 6);
}

std::vector<Factor> factors(const fem::Beam& beam, const EmulatorSpec& spec, int count) {
  std::vector<Factor> list;
  for (int i = 0; i < count; ++i) {
    const auto& sites = spec.sites[std::min(static_cast<std::size_t>(i), spec.sites.size() - 1)];
    Factor location{.name = "location_" + std::to_string(i + 1), .unit = "m", .levels = {}};
    for (const int site : sites) location.levels.push_back(beam.element_midpoint(site));
    Factor reduction{
        .name = "reduction_" + std::to_string(i + 1),
        .unit = "",
        .levels = spec.reductions,
        .scale = spec.compliance ? emulator::Scale::compliance : emulator::Scale::linear};
    list.push_back(std::move(location));
    list.push_back(std::move(reduction));
  }
  return list;
}

// Damages in the order of the tables' factors: by location.
template <class Point>
std::vector<fem::Damage> damages_of(const Point& point) {
  std::vector<fem::Damage> damages;
  for (std::size_t i = 0; i + 1 < point.size(); i += 2) damages.push_back({point[i], point[i + 1]});
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

}  // namespace

std::string beam_fingerprint(const fem::Beam& beam) {
  Json supports = Json::array();
  for (const fem::Support& s : beam.supports) {
    supports.push_back({s.at, s.deflection, s.rotation, s.stiffness ? Json(*s.stiffness) : Json()});
  }
  const Json identity = {{"length", beam.length},
                         {"elements", beam.elements},
                         {"supports", supports},
                         {"young", beam.material.young},
                         {"poisson", beam.material.poisson},
                         {"density", beam.material.density},
                         {"area", beam.section.area},
                         {"second_moment", beam.section.second_moment},
                         {"shear_coefficient", beam.section.shear_coefficient}};
  return emulator::fingerprint(identity.dump());
}

void FrequencyEmulator::add(emulator::Table table) {
  modes_ = static_cast<int>(table.values.cols());
  const auto rule = table.attributes.find("interpolation");
  if (rule != table.attributes.end() && rule->second == "cubic") {
    std::vector<emulator::AxisRule> rules;
    for (std::size_t i = 0; i < table.factors.size(); ++i) {
      rules.push_back(i % 2 == 0 ? emulator::AxisRule::cubic : emulator::AxisRule::monotone_cubic);
    }
    interpolants_.emplace_back(emulator::CubicInterpolant(table.factors, table.values, rules));
  } else {
    interpolants_.emplace_back(emulator::MultilinearInterpolant(table.factors, table.values));
  }
  tables_.push_back(std::move(table));
}

FrequencyEmulator FrequencyEmulator::train(const fem::Reanalysis& reanalysis,
                                           const EmulatorSpec& spec, int max_count, int modes,
                                           const TrainOptions& options) {
  FrequencyEmulator trained(reanalysis.beam());
  const auto model = fe_model(reanalysis);
  for (int count = 1; count <= max_count; ++count) {
    const auto box = factors(reanalysis.beam(), spec, count);
    double runs = 1.0;
    for (const Factor& factor : box) runs *= static_cast<double>(factor.levels.size());
    if (runs > kMostRuns) {
      throw std::invalid_argument("a table for " + std::to_string(count) + " damages would need " +
                                  number(runs) +
                                  " runs, more than 10 million: use fewer sites or multipliers, a "
                                  "smaller count, or \"fe\"");
    }
    emulator::ExperimentOptions experiment{.threads = options.threads};
    if (!options.journal_stem.empty()) {
      experiment.journal = options.journal_stem.string() + "." + group(count);
      experiment.identity = beam_fingerprint(reanalysis.beam());
    }
    if (options.progress) {
      experiment.progress = [&, count](Eigen::Index done, Eigen::Index total) {
        options.progress(count, done, total);
      };
    }
    emulator::Table table{
        .factors = box,
        .points = {},
        .response_name = "frequency",
        .response_unit = "Hz",
        .values = emulator::run_experiment(emulator::full_factorial(box), modes, model, experiment),
        .holdout = {},
        .attributes = {{"interpolation", spec.cubic ? "cubic" : "multilinear"}},
        .parameters = {}};
    trained.add(std::move(table));
    const auto predict = [&](std::span<const double> point, std::span<double> out) {
      auto damages = damages_of(point);
      std::ranges::sort(damages, {}, &fem::Damage::location);
      trained.evaluate(damages, out);
    };
    trained.tables_.back().holdout = emulator::validate(
        box, modes, model, predict,
        {.runs = spec.holdout, .seed = options.seed, .experiment = {.threads = options.threads}});
  }
  return trained;
}

FrequencyEmulator FrequencyEmulator::load(const std::filesystem::path& path, const fem::Beam& beam,
                                          int max_count, int modes) {
  auto file = emulator::read_table_file(path, {.expected_fingerprint = beam_fingerprint(beam)});
  FrequencyEmulator loaded(beam);
  for (int count = 1; count <= max_count; ++count) {
    const auto found = file.tables.find(group(count));
    if (found == file.tables.end()) {
      throw std::invalid_argument(path.string() + " holds tables for up to " +
                                  std::to_string(count - 1) + " damages, the case allows " +
                                  std::to_string(max_count));
    }
    if (found->second.values.cols() < modes) {
      throw std::invalid_argument(path.string() + " holds " +
                                  std::to_string(found->second.values.cols()) +
                                  " modes, the data have " + std::to_string(modes));
    }
    loaded.add(std::move(found->second));
  }
  return loaded;
}

void FrequencyEmulator::save(const std::filesystem::path& path,
                             std::map<std::string, std::string> attributes) const {
  emulator::TableFile file{.attributes = std::move(attributes), .tables = {}};
  file.attributes["fingerprint"] = beam_fingerprint(beam_);
  for (int count = 1; count <= max_count(); ++count) file.tables[group(count)] = table(count);
  emulator::write_table_file(path, file);
}

double FrequencyEmulator::midpoint(double location, const Factor& factor) const {
  // The priors' ends lie in elements whose midpoints may be the box's very ends.
  return std::clamp(beam_.element_midpoint(beam_.element_at(location)), factor.low(),
                    factor.high());
}

void FrequencyEmulator::evaluate(std::span<const fem::Damage> damages,
                                 std::span<double> out) const {
  const std::size_t count = damages.size();
  const auto& box = tables_[count - 1].factors;
  std::array<double, emulator::MultilinearInterpolant::kMostFactors> x{};
  std::vector<double> all;
  std::span<double> target = out;
  if (static_cast<int>(out.size()) < modes_) {
    all.resize(static_cast<std::size_t>(modes_));
    target = all;
  }
  for (std::size_t i = 0; i < count; ++i) {
    x[2 * i] = midpoint(damages[i].location, box[2 * i]);
    x[2 * i + 1] = damages[i].reduction;
  }
  std::visit(
      [&](const auto& f) {
        f.evaluate({x.data(), 2 * count}, target);
      },
      interpolants_[count - 1]);
  if (!all.empty()) std::copy_n(all.begin(), out.size(), out.begin());
}

std::optional<FrequencyEmulator::Outside> FrequencyEmulator::reaches_outside(
    const DefectKind& kind) const {
  const inference::Prior& reduction = *kind.severity_prior();
  const double h = beam_.element_length();
  for (int count = 1; count <= kind.max_count; ++count) {
    const auto& box = table(count).factors;
    for (std::size_t i = 0; i < box.size(); i += 2) {
      const std::string who = count == 1 ? ""
                                         : " (damage " + std::to_string(i / 2 + 1) + " of " +
                                               std::to_string(count) + ")";
      // Elements that the prior gives room to: an end within rounding of a node gives none.
      const int first = beam_.element_at(kind.location.lower());
      const int last =
          beam_.element_at(std::max(kind.location.lower(), kind.location.upper() - 1e-6 * h));
      if (beam_.element_midpoint(first) < box[i].low() - 1e-6 * h ||
          beam_.element_midpoint(last) > box[i].high() + 1e-6 * h) {
        return Outside{"location", "location prior " + kind.location.describe() +
                                       " reaches outside the emulator's box, " +
                                       number(box[i].low()) + " to " + number(box[i].high()) +
                                       " m" + who};
      }
      if (reduction.lower() < box[i + 1].low() || reduction.upper() > box[i + 1].high()) {
        return Outside{"reduction", "reduction prior " + reduction.describe() +
                                        " reaches outside the emulator's box, " +
                                        number(box[i + 1].low()) + " to " +
                                        number(box[i + 1].high()) + who};
      }
    }
  }
  return {};
}

}  // namespace wheeltap::apps
