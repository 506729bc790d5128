#include "apps/results/posterior_file.hpp"

#include <cmath>
#include <set>

#include "identification/structural/damage/findings/damage_modes.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {

using namespace identification;

void write_sample_stats(const io::NetcdfWriter& file, const inference::Posterior& posterior,
                        const DrawColumn& k) {
  using inference::Chain;
  const int group = file.group("sample_stats");
  const int chain = file.dimension(group, "chain", posterior.chains.size(), 0);
  const int draw = file.dimension(group, "draw", posterior.chains[0].size(), 0);
  const auto put = [&](auto number, const char* name, const auto& value,
                       nc_type type = io::kNetcdfType<decltype(number)>) {
    return file.put_rows<decltype(number)>(
        group, name, {chain, draw},
        [&](std::size_t c, auto& row) {
          const Chain& from = posterior.chains[c];
          row.reserve(from.size());
          for (std::size_t i = 0; i < from.size(); ++i) row.push_back(value(from, i));
          from.let_go();
        },
        type);
  };
  put(0.0, "lp",
      [](const Chain& c, std::size_t i) { return c.log_prior[i] + c.log_likelihood[i]; });
  put(0.0, "log_likelihood", [](const Chain& c, std::size_t i) { return c.log_likelihood[i]; });
  put(0, "k", [&](const Chain& c, std::size_t i) { return static_cast<int>(k.value(c, i, 0)); });
  const int move = put(
      0, "move", [](const Chain& c, std::size_t i) { return static_cast<int>(c.move[i]); },
      NC_SHORT);
  std::string names;
  for (const auto& m : posterior.moves) names += (names.empty() ? "" : ";") + m.name;
  file.text(group, move, "names", names);
  if (!posterior.log_weight.empty()) {
    const std::vector<double> of_model = model_weights(posterior);
    const int weight = put(0.0, "weight", [&](const Chain& c, std::size_t i) {
      return of_model[static_cast<std::size_t>(c.model[i])];
    });
    file.text(
        group, weight, "description",
        "weight of a draw in averages over models (sampled with equal probability); mean weight 1");
  }
  put(
      0, "accepted", [](const Chain& c, std::size_t i) { return static_cast<int>(c.accepted[i]); },
      NC_BYTE);
}

namespace {

// The variable of a parameter that all models have: named like the parameter, unless this name is
// in use.
std::string common_variable(const std::string& name) {
  static const std::set<std::string> taken = {
      "model", "k",    "chain",        "draw",  "slot", "location", "reduction", "member",
      "node",  "link", "substructure", "depth", "mass", "mode",     "stiffness", "extent"};
  const bool free = !taken.contains(name) && !name.starts_with("k_");
  return variable_of(free ? name : "parameter_" + name);
}

}  // namespace

std::string damage_variable(const DamageCase& damage_case, const Unknown& unknown) {
  if (unknown.kind < 0) return common_variable(unknown.name);
  const bool several = damage_case.kinds.size() > 1;
  return (several && unknown.kind >= 0
              ? damage_case.kinds[static_cast<std::size_t>(unknown.kind)].name + "_"
              : "") +
         unknown.name;
}

std::vector<DrawColumn> damage_columns(const DamageProblem& problem,
                                       const inference::Posterior& posterior) {
  const DamageCase& damage_case = problem.damage_case;
  const auto& space = *posterior.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const bool several = damage_case.kinds.size() > 1;
  // The number of defects in each draw, of one kind or of all kinds.
  const auto counts = [&](std::string name, int kind) {
    std::vector<int> of_model;
    for (const auto& m : space.models()) {
      int& sum = of_model.emplace_back(0);
      for (std::size_t k = 0; k < damage_case.kinds.size(); ++k)
        if (kind < 0 || static_cast<int>(k) == kind) sum += m.counts[k];
    }
    return DrawColumn{
        .name = std::move(name),
        .value = [of_model = std::move(of_model)](
                     const inference::Chain& chain, std::size_t i,
                     std::size_t) { return of_model[static_cast<std::size_t>(chain.model[i])]; },
        .whole = true};
  };

  std::vector<DrawColumn> columns = {model_column(posterior), counts("k", -1)};
  for (int p = 0; p < problem.common; ++p) {
    columns.push_back(parameter_column(
        posterior, p, common_variable(space.parameters()[static_cast<std::size_t>(p)].name)));
  }
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    if (kind.max_count == 0) continue;
    const auto slots = static_cast<std::size_t>(kind.max_count);
    const std::string prefix = several ? kind.name + "_" : "";
    if (several) columns.push_back(counts("k_" + kind.name, static_cast<int>(k)));
    const auto parameters = static_cast<std::size_t>(kind.parameters());
    // One number per draw and slot; NaN in unused slots.
    const auto add = [&](const std::string& name, const std::string& unit, std::size_t p, auto of) {
      std::vector<std::pair<std::size_t, std::size_t>> places;  // used slots, and their positions
      for (const auto& m : space.models())
        places.emplace_back(m.counts[k], static_cast<std::size_t>(m.offsets[k]) + p);
      columns.push_back({.name = prefix + name,
                         .value =
                             [places = std::move(places), of, width, parameters](
                                 const inference::Chain& c, std::size_t i, std::size_t slot) {
                               const auto [used, at] = places[static_cast<std::size_t>(c.model[i])];
                               return slot < used ? of(c.theta[i * width + at + parameters * slot])
                                                  : std::nan("");
                             },
                         .unit = unit,
                         .slot = prefix + "slot",
                         .slots = slots});
    };
    const auto itself = [](double x) { return x; };
    if (kind.line.is_beam()) {
      add("location", "m", 0, itself);
    } else {
      add(kind.site_name(), "", 0,
          [&kind](double x) { return static_cast<double>(kind.line.spot(x).site); });
      if (kind.type->sites == DefectType::Sites::members)
        add("location", "m", 0, [&kind](double x) { return kind.line.spot(x).s; });
    }
    if (parameters > 1) add(kind.severity_name(), kind.severity_unit(), 1, itself);
  }
  return columns;
}

void write_posterior(const io::NetcdfWriter& file, const std::string& run,
                     const DamageCaseFile& parsed, const DamageProblem& problem,
                     const inference::Posterior& posterior, std::uint64_t seed) {
  const DamageCase& damage_case = problem.damage_case;
  const FrequencyData& data = damage_case.data;
  const std::size_t chains = posterior.chains.size();
  const std::size_t draws = posterior.chains[0].model.size();
  const auto modes = static_cast<std::size_t>(data.modes());
  const std::vector<DrawColumn> columns = damage_columns(problem, posterior);
  file.about(WHEELTAP_VERSION, run);
  file.text(file.root(), NC_GLOBAL, "title", damage_case.title);
  file.text(file.root(), NC_GLOBAL, "case", parsed.file.json.dump());

  write_draws(file, posterior, columns);
  write_sample_stats(file, posterior, columns[1]);
  if (posterior.predictions == data.modes()) {
    const int group = file.group("posterior_predictive");
    const int chain = file.dimension(group, "chain", chains, 0);
    const int draw = file.dimension(group, "draw", draws, 0);
    const int mode = file.dimension(group, "mode", modes, 1);
    const auto next = frequency_replicates(problem, posterior, seed);
    const auto replicate = [&](std::size_t c, std::vector<float>& values) {
      for (std::size_t i = 0; i < draws; ++i)
        for (const double f : next(c, i)) values.push_back(static_cast<float>(f));
    };
    const int id = file.put_rows<float>(group, "frequency", {chain, draw, mode}, replicate);
    file.text(group, id, "units", "Hz");
  }
  {
    const int group = file.group("observed_data");
    const int mode = file.dimension(group, "mode", modes, 1);
    const int id = file.put(group, "frequency", {mode}, data.frequencies_hz);
    file.text(group, id, "units", "Hz");
    if (!data.sd_hz.empty()) file.put(group, "sd", {mode}, data.sd_hz);
  }
}

}  // namespace wheeltap::apps
