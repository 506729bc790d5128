#include "apps/cases/sid_truth.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/sid_record.hpp"
#include "apps/nearest.hpp"
#include "base/constants.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using Role = SidChannel::Role;

constexpr int kPointsPerSample = 8;  // grid points per sample of a band-limited excitation

Role role_of(const Json& excitation) {
  return !excitation.contains("base")                         ? Role::force
         : excitation.value("quantity", "") == "displacement" ? Role::base_displacement
                                                              : Role::base_acceleration;
}

// True for a coefficient that belongs to a term of the discovery.
bool belongs_to_a_term(const SidCase& sid_case, int parameter) {
  if (!sid_case.discovery) return false;
  return std::ranges::any_of(sid_case.discovery->terms, [&](const SidTerm& term) {
    return std::ranges::any_of(term.by_default, [&](std::size_t c) {
      return term.law.coefficients[c].parameter == parameter;
    });
  });
}

void add_true_excitations(SidCaseFile& parsed) {
  const CaseFile& file = parsed.file;
  SidCase& out = parsed.sid;
  const Json& list = file.json["truth"]["excitation"];
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Pointer where = Pointer("/truth/excitation") / i;
    const bool base = list[i].contains("base");
    if (base == list[i].contains("mass")) {
      file.refuse(where, "must have either a \"mass\" or \"base\": true");
    }
    if (list[i].contains("quantity") && !base) {
      file.refuse(where / "quantity", "is allowed with \"base\": true only");
    }
    const Role role = role_of(list[i]);
    const int mass = list[i].value("mass", 0);
    const int masses = out.models[static_cast<std::size_t>(out.truth->model)].chain.size();
    if (mass > masses) {
      file.refuse(where / "mass",
                  "unknown mass; the true model has masses 1 to " + std::to_string(masses));
    }
    if (std::ranges::any_of(
            out.channels, [&](const SidChannel& c) { return c.role == role && c.mass == mass; })) {
      continue;
    }
    out.channels.push_back({.column = role == Role::force ? "force " + std::to_string(mass) + " [N]"
                                      : role == Role::base_displacement
                                          ? "base displacement [m]"
                                          : "base acceleration [m/s^2]",
                            .role = role,
                            .mass = mass});
    parsed.channels.push_back(where);
  }
}

std::vector<double> read_excitation(const SidCaseFile& parsed, const Json& e,
                                    const Pointer& where) {
  const std::string name = text_or_number(e["column"]);
  const signals::Record record = read_record(parsed.file, where / "file", {name});
  try {
    const int column = record.find(name);
    std::vector<double> x = signals::window(record, column, 0, parsed.sid.truth->samples);
    SidChannel channel{.column = name, .role = role_of(e)};
    channel.take_unit(signals::unit_of(record.columns[static_cast<std::size_t>(column)]));
    for (double& sample : x) sample *= e.value("scale", channel.signal.scale.value);
    return x;
  } catch (const io::FileError& error) {
    parsed.file.refuse(where, error.what());
  }
}

}  // namespace

bool truth_moves_base(const Json& json) {
  if (json["record"].contains("file") || !json.contains("truth")) return false;
  return std::ranges::any_of(json["truth"]["excitation"],
                             [](const Json& e) { return e.contains("base"); });
}

bool truth_displaces_base(const Json& json) {
  return truth_moves_base(json) &&
         std::ranges::any_of(json["truth"]["excitation"],
                             [](const Json& e) { return role_of(e) == Role::base_displacement; });
}

void parse_truth(SidCaseFile& parsed) {
  const CaseFile& file = parsed.file;
  SidCase& out = parsed.sid;
  if (!file.json.contains("truth")) return;
  const Json& t = file.json["truth"];
  const Pointer where("/truth");
  SidTruth truth{.samples = t["samples"].get<int>(),
                 .sample_rate_hz = t["sample_rate"].get<double>(),
                 .seed = t.value("seed", std::uint64_t{1})};
  const auto found = std::ranges::find(out.models, t["model"].get<std::string>(), &SidModel::name);
  if (found == out.models.end()) {
    std::vector<std::string> names;
    for (const SidModel& model : out.models) names.push_back(model.name);
    file.refuse(where / "model",
                "no model has this name" + did_you_mean(t["model"].get<std::string>(), names));
  }
  truth.model = static_cast<int>(found - out.models.begin());
  truth.theta.assign(out.parameters.size(), kNaN);
  const Json given = t.value("parameters", Json::object());
  for (const auto& [name, value] : given.items()) {
    const auto p = std::ranges::find(out.parameters, name, &inference::Parameter::name);
    if (p == out.parameters.end()) {
      std::vector<std::string> names;
      for (const int used : out.parameters_of(*found))
        names.push_back(out.parameters[static_cast<std::size_t>(used)].name);
      file.refuse(where / "parameters" / name,
                  "no parameter of the true model has this name" + did_you_mean(name, names));
    }
    truth.theta[static_cast<std::size_t>(p - out.parameters.begin())] = value.get<double>();
  }
  for (const int p : out.parameters_of(*found)) {
    const auto at = static_cast<std::size_t>(p);
    const bool noise_only = std::ranges::any_of(
        found->noise, [&](const dynamics::Coefficient& c) { return c.parameter == p; });
    if (std::isnan(truth.theta[at]) && noise_only && t.contains("noise")) continue;
    const bool of_case =
        file.json.value("parameters", Json::object()).contains(out.parameters[at].name);
    if (std::isnan(truth.theta[at]) && (of_case || belongs_to_a_term(out, p))) {
      file.refuse(where / "parameters" / out.parameters[at].name,
                  "is missing: the true model uses it");
    }
  }
  const std::size_t responses = out.responses().size();
  if (t.contains("noise") && t["noise"].is_array()) {
    truth.noise = t["noise"].get<std::vector<double>>();
    if (truth.noise.size() != responses) {
      file.refuse(where / "noise",
                  "must have one value per response channel: " + std::to_string(responses));
    }
  } else if (t.contains("noise")) {
    truth.noise.assign(responses, t["noise"].get<double>());
  } else {
    for (const dynamics::Coefficient& c : found->noise) truth.noise.push_back(c.at(truth.theta));
  }
  for (double& x : truth.theta) {
    if (std::isnan(x)) x = 0.0;  // initial states and autocorrelations have no true value
  }
  out.truth = std::move(truth);
  const Json& record = file.json["record"];
  if (record.value("between_samples", "linear") == "band-limited")
    out.truth->points_a_sample = std::max(kPointsPerSample, record.value("upsample", 1));
  if (!record.contains("file")) add_true_excitations(parsed);
}

void parse_excitations(SidCaseFile& parsed) {
  const CaseFile& file = parsed.file;
  static const std::vector<std::pair<std::string, std::vector<std::string>>> kinds = {
      {"white", {"variance"}},
      {"band-limited", {"low", "high", "variance"}},
      {"sine", {"amplitude", "frequency"}},
      {"multisine", {"low", "high", "rms"}},
      {"file", {"file", "column"}}};
  const Json& list = file.json["truth"]["excitation"];
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Pointer where = Pointer("/truth/excitation") / i;
    const Json& e = list[i];
    const std::string kind = e["kind"].get<std::string>();
    for (const auto& [name, keys] : kinds) {
      if (name != kind) continue;
      for (const auto& key : keys) {
        if (!e.contains(key)) {
          file.refuse(where / key, "is missing: \"" + kind + "\" has " + listed(keys));
        }
      }
    }
    const auto value = [&](const char* key) { return e[key].get<double>(); };
    TrueExcitation one{.role = role_of(e), .mass = e.value("mass", 0), .signal = {}};
    if (kind == "white") {
      one.signal = TrueExcitation::White{value("variance")};
    } else if (kind == "band-limited") {
      one.signal = TrueExcitation::BandLimited{value("low"), value("high"), value("variance")};
    } else if (kind == "sine") {
      one.signal =
          TrueExcitation::Sine{value("amplitude"), value("frequency"), e.value("phase", 0.0)};
    } else if (kind == "multisine") {
      one.signal = signals::Multisine{.period = e.value("period", 1024),
                                      .low_hz = value("low"),
                                      .high_hz = value("high"),
                                      .rms = value("rms"),
                                      .odd_lines_only = e.value("odd", false)};
    } else {
      one.signal = TrueExcitation::Sampled{read_excitation(parsed, e, where)};
    }
    parsed.sid.truth->excitations.push_back(std::move(one));
  }
}

}  // namespace wheeltap::apps
