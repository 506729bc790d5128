#include "apps/results/sid_posterior_file.hpp"

#include <algorithm>
#include <cmath>

#include "apps/results/posterior_file.hpp"
#include "base/random.hpp"
#include "identification/findings/marginal.hpp"
#include "identification/sid/findings/link_paths.hpp"
#include "identification/sid/sid_fit.hpp"
#include "identification/sid/sid_units.hpp"
#include "io/netcdf/netcdf_name.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// The name of a channel without its unit, changed if it is one of the `others`.
std::string variable_name(const SidChannel& channel, const std::vector<std::string>& others) {
  std::string name = io::netcdf_name(channel.column.substr(0, channel.column.find(" [")));
  if (name.find_first_not_of("0123456789") == std::string::npos) name = "column_" + name;
  // Names that the groups already use.
  static const std::vector<std::string> kTaken = {"time", "sample",     "chain",
                                                  "draw", "draw_index", "quantile"};
  const auto taken = [&](const std::string& one) {
    return std::ranges::count(others, one) > 0 || std::ranges::count(kTaken, one) > 0;
  };
  const std::string stem = name;
  for (std::size_t n = others.size() + 1; taken(name); ++n) name = stem + "_" + std::to_string(n);
  return name;
}

std::vector<std::string> variable_names(const SidCase& sid_case) {
  std::vector<std::string> names;
  for (const SidChannel* channel : sid_case.responses()) {
    names.push_back(variable_name(*channel, names));
  }
  return names;
}

/// Writes the excitation in SI units at the samples of the likelihood, in ArviZ's group for
/// constant data.
void write_excitation(const io::NetcdfWriter& file, const SidCase& sid_case, std::size_t samples,
                      std::span<const double> theta) {
  const int group = file.group("constant_data");
  const int sample = file.dimension(group, "sample", samples, sid_case.begin);
  std::vector<std::string> names;
  for (const SidChannel& channel : sid_case.channels) {
    if (!channel.is_excitation()) continue;
    const auto stride = static_cast<std::size_t>(sid_case.stride);
    const double scale = channel.signal.scale.at(theta), offset = channel.signal.offset.at(theta);
    std::vector<double> values;
    for (std::size_t n = 0; n < samples; ++n) {
      const std::size_t at = (static_cast<std::size_t>(sid_case.lead_in) + n) * stride;
      values.push_back(scale * channel.signal.samples[at] + offset);
    }
    names.push_back(variable_name(channel, names));
    const int id = file.put(group, names.back(), {sample}, values);
    const bool force = channel.role == SidChannel::Role::force;
    const bool displacement = channel.role == SidChannel::Role::base_displacement;
    file.text(group, id, "units", channel.used_unit());
    file.text(group, id, "role",
              force          ? "force on mass " + std::to_string(channel.mass)
              : displacement ? "base displacement"
                             : "base acceleration");
  }
}

std::vector<float> single(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

/// Writes the predictions of `predictive` without noise. Writes nothing if there are no draws.
void write_noise_free(const io::NetcdfWriter& file, const SidProblem& problem,
                      const inference::Posterior& posterior, const SidPredictive& predictive,
                      const std::vector<std::string>& names) {
  const std::vector<NoiseFree> found = noise_free(problem, posterior, predictive);
  if (found.empty()) return;
  const int group = file.group("noise_free");
  const int quantile = file.dimension(group, "quantile", 3, 0);
  const int sample = file.dimension(group, "sample", found[0].q50.size(), problem.sid_case.begin);
  const auto responses = problem.sid_case.responses();
  for (std::size_t c = 0; c < found.size(); ++c) {
    std::vector<float> values = single(found[c].q2_5);
    for (const auto* more : {&found[c].q50, &found[c].q97_5}) {
      values.insert(values.end(), more->begin(), more->end());
    }
    const int id = file.put(group, names[c], {quantile, sample}, values);
    file.text(group, id, "units", responses[c]->used_unit());
    file.text(group, id, "quantiles", "0.025, 0.5, 0.975");
  }
}

/// Writes the motion of the links at a model's draw of highest density, if this motion is known.
void write_link_paths(const io::NetcdfWriter& file, const SidProblem& problem,
                      const inference::Posterior& posterior, int model) {
  const auto draw = best_draw(problem, posterior, model);
  if (draw.empty()) return;
  const std::vector<LinkPath> paths = link_paths(problem, model, problem.theta(model, draw));
  if (paths.empty()) return;
  const int group = file.group("link_paths");
  file.text(group, NC_GLOBAL, "model",
            problem.sid_case.models[static_cast<std::size_t>(model)].name);
  const int sample =
      file.dimension(group, "sample", paths[0].extension.size(), problem.sid_case.begin);
  const auto system = unit_system(problem.sid_case);
  for (const LinkPath& path : paths) {
    const std::string ends = std::to_string(path.a) + "_" + std::to_string(path.b);
    const auto put = [&](const char* name, const std::vector<double>& values, const char* si) {
      if (values.empty()) return;
      const int id = file.put(group, name + ends, {sample}, single(values));
      if (system) file.text(group, id, "units", system->in_place_of(si));
      if (path.differentiated) file.text(group, id, "differentiated", "yes");
    };
    put("extension_", path.extension, "m");
    put("rate_", path.rate, "m/s");
    put("tension_", path.tension, "N");
    put("measured_tension_", path.measured, "N");
    put("measured_extension_", path.measured_extension, "m");
  }
}

}  // namespace

std::vector<DrawColumn> sid_columns(const SidProblem& problem,
                                    const inference::Posterior& posterior) {
  std::vector<DrawColumn> columns = {model_column(posterior)};
  const auto units = parameter_units(problem.sid_case);
  const auto& parameters = posterior.space->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p)
    columns.push_back(parameter_column(posterior, static_cast<int>(p),
                                       variable_of(parameters[p].name),
                                       units.at(parameters[p].name)));
  return columns;
}

void write_sid_posterior(const io::NetcdfWriter& file, const std::string& run,
                         const SidCaseFile& parsed, const SidProblem& problem,
                         const inference::Posterior& posterior, const SidPredictive& predictive,
                         std::uint64_t seed) {
  const SidCase& sid_case = problem.sid_case;
  const auto& space = *posterior.space;
  const std::size_t chains = posterior.chains.size();
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const auto responses = sid_case.responses();
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  const std::vector<DrawColumn> columns = sid_columns(problem, posterior);

  file.about(WHEELTAP_VERSION, run);
  file.text(file.root(), NC_GLOBAL, "title", sid_case.title);
  file.text(file.root(), NC_GLOBAL, "case", parsed.file.json.dump());
  write_draws(file, posterior, columns);
  write_sample_stats(file, posterior, columns[0]);

  const auto names = variable_names(sid_case);
  const std::size_t each = predictive.draws.size() / chains;
  if (each > 0 && predictive.draws.size() == each * chains) {
    const int group = file.group("posterior_predictive");
    const int chain = file.dimension(group, "chain", chains, 0);
    const int draw = file.dimension(group, "draw", each, 0);
    const int sample = file.dimension(group, "sample", samples, sid_case.begin);
    std::vector<int> index;
    for (const auto& d : predictive.draws) index.push_back(static_cast<int>(d.draw));
    file.put(group, "draw_index", {chain, draw}, index);
    for (std::size_t c = 0; c < responses.size(); ++c) {
      std::vector<float> values;
      values.reserve(predictive.draws.size() * samples);
      for (const auto& d : predictive.draws) {
        const int m = posterior.chains[d.chain].model[d.draw];
        const auto theta =
            problem.theta(m, {posterior.chains[d.chain].theta.data() + d.draw * width, width});
        const std::vector<double> y = observed(problem, c, theta);
        base::Random random(seed, d.chain * responses.size() + c, d.draw,
                            base::Purpose::prediction);
        for (std::size_t n = 0; n < samples; ++n) {
          values.push_back(static_cast<float>(y[n] -
                                              static_cast<double>(d.residuals[c * samples + n]) +
                                              d.noise[c] * random.normal()));
        }
      }
      const int id = file.put(group, names[c], {chain, draw, sample}, values);
      file.text(group, id, "units", responses[c]->used_unit());
    }
  }
  write_noise_free(file, problem, posterior, predictive, names);
  {
    const int group = file.group("observed_data");
    const int sample = file.dimension(group, "sample", samples, sid_case.begin);
    std::vector<double> time;
    for (std::size_t n = 0; n < samples; ++n) {
      time.push_back((sid_case.begin + static_cast<double>(n)) / sid_case.sample_rate_hz);
    }
    file.text(group, file.put(group, "time", {sample}, time), "units", "s");
    int most = 0;
    std::vector<double> visits(static_cast<std::size_t>(space.size()));
    const std::vector<double> weights = model_weights(posterior);
    for (const inference::Chain& chain : posterior.chains)
      for (const int m : chain.model)
        visits[static_cast<std::size_t>(m)] += weights[static_cast<std::size_t>(m)];
    most = static_cast<int>(std::ranges::max_element(visits) - visits.begin());
    const auto theta = posterior_mean(problem, posterior, most);
    for (std::size_t c = 0; c < responses.size(); ++c) {
      const int id = file.put(group, names[c], {sample}, observed(problem, c, theta));
      file.text(group, id, "units", responses[c]->used_unit());
    }
    write_excitation(file, sid_case, samples, theta);
    write_link_paths(file, problem, posterior, most);
  }
}

}  // namespace wheeltap::apps
