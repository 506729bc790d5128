#include "apps/cases/damage_case.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "apps/cases/beam_parameters.hpp"
#include "apps/cases/damage_data.hpp"
#include "apps/cases/damage_parts.hpp"
#include "apps/cases/emulator_case.hpp"
#include "apps/cases/modal_data_case.hpp"
#include "apps/cases/states_case.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "apps/cases/syntax/case_remedies.hpp"
#include "apps/structure_words.hpp"
#include "base/constants.hpp"
#include "emulator/gaussian_process.hpp"
#include "fem/sections/section.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "identification/structural/structure_plausibility.hpp"
#include "inference/model/poisson_weights.hpp"
#include "io/netcdf/netcdf_name.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::string damage_number(double x) {
  if (std::isinf(x)) return x < 0.0 ? "minus infinity" : "infinity";
  return Json(x).dump();
}

constexpr int kHoldoutRuns = 50;  // default of "holdout"

Pointer damage_key(const char* text) {
  return Pointer(text);
}

bool has_measured(const Json& data) {
  return data.contains("frequencies") || data.contains("file") || data.contains("from") ||
         data.contains("repeats");
}

}  // namespace

inference::Prior bounded_prior(const CaseFile& file, const Pointer& where, double lower,
                               double upper, const std::string& allowed) {
  const inference::Prior prior = parse_prior(file, where);
  if (!(prior.lower() >= lower && prior.upper() <= upper)) {
    file.refuse(where, "reaches from " + damage_number(prior.lower()) + " to " +
                           damage_number(prior.upper()) + ", but " + allowed +
                           kept_within(file, where, lower, upper));
  }
  return prior;
}

std::vector<double> parse_count_prior(const CaseFile& file, const Pointer& where, int min,
                                      int max) {
  const auto n = static_cast<std::size_t>(max - min + 1);
  std::vector<double> weights(n, 1.0);
  const Json& count = file.json.at(where);
  if (count.contains("prior") && count["prior"].is_object()) {
    weights = inference::poisson_weights(count["prior"]["poisson"].get<double>(), min, max);
  } else if (count.contains("prior") && count["prior"].is_array()) {
    weights = count["prior"].get<std::vector<double>>();
    if (weights.size() != n) {
      file.refuse(where / "prior", "must have " + std::to_string(n) + " weights, for " +
                                       std::to_string(min) + " to " + std::to_string(max));
    }
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0.0 && std::isfinite(sum))) {
    file.refuse(where / "prior", "at least one weight must be > 0");
  }
  for (double& w : weights) w /= sum;
  return weights;
}

Simulation parse_simulation(const CaseFile& file, const Json& truth, Simulation simulation) {
  const Json data = file.json.value("data", Json::object());
  if (data.contains("cov") && data["cov"].is_number()) simulation.cv = data["cov"].get<double>();
  if (data.contains("modes") && data["modes"].is_number())
    simulation.modes = data["modes"].get<int>();
  simulation.seed = data.value("seed", simulation.seed);
  if (data.contains("shape_sd") && data["shape_sd"].is_number())
    simulation.shape_sd = data["shape_sd"].get<double>();
  if (truth.is_object()) {
    simulation.modes = truth.value("modes", simulation.modes);
    simulation.cv = truth.value("cov", simulation.cv);
    simulation.seed = truth.value("seed", simulation.seed);
    simulation.shape_sd = truth.value("shape_sd", simulation.shape_sd);
  }
  return simulation;
}

namespace {

void parse_damage_truth(const CaseFile& file, const Pointer& block, double length, DefectKind& kind,
                        DamageCase& out) {
  const Json& b = file.json.at(block);
  if (!b.contains("truth")) return;
  const Json& t = b["truth"];
  const Json& list = t.is_array() ? t : t.at("defects");
  const Pointer where = t.is_array() ? block / "truth" : block / "truth" / "defects";
  out.simulation = parse_simulation(file, t, out.simulation.value_or(Simulation{}));
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Json& d = list[i];
    const std::string severity = kind.severity_name();
    for (const DefectType* type : defect_types()) {
      const std::string other(type->severity);
      if (other != severity && d.contains(other)) {
        file.refuse(where / i / other,
                    "a " + kind.name + " has a " + severity + ", not a " + other);
      }
    }
    if (!kind.type->may_be_known && !d.contains(severity)) {
      file.refuse(where / i / severity, "is missing: must be a number in [0, 1)");
    }
    DefectKind::True truth{.location = d.at("location").get<double>(), .severity = kInfinity};
    if (truth.location > length) {
      file.refuse(where / i / "location",
                  "is outside the beam, which is " + damage_number(length) + " m long");
    }
    if (d.contains(severity) && d[severity].is_number()) truth.severity = d[severity].get<double>();
    truth.extent = true_extent(file, where / i, kind);
    kind.truth.push_back(truth);
  }
  std::ranges::sort(kind.truth, {}, &DefectKind::True::location);
}

DefectKind parse_kind(const CaseFile& file, const Pointer& where, double length, DamageCase& out) {
  const Json& b = file.json.at(where);
  const auto type_name = b.value("kind", std::string(defect_types()[0]->name));
  const DefectType* type = find_defect_type(type_name);
  if (type == nullptr || !type->is_for_beams()) {
    std::string known;
    for (const DefectType* t : defect_types())
      if (t->is_for_beams()) known += (known.empty() ? "\"" : ", \"") + std::string(t->name) + "\"";
    file.refuse(where / "kind", "unknown kind of defect; there are " + known);
  }
  const std::string severity(type->severity);
  const int min = b["count"].value("min", 0);
  const int max = b["count"].at("max").get<int>();
  if (min > max) {
    file.refuse(where / "count" / "min", "must not exceed max, which is " + std::to_string(max));
  }
  for (const DefectType* other : defect_types()) {
    const std::string key(other->severity);
    if (key == severity || !b.contains(key)) continue;
    if (other->may_be_known) {
      file.refuse(where / key,
                  "is allowed with \"kind\": \"" + std::string(other->name) + "\" only");
    }
    file.refuse(where / key, "a " + type_name + " has a " + severity + ", not a " + key);
  }
  if (!type->may_be_rotational && b.contains("fix")) {
    file.refuse(where / "fix", "is allowed with \"kind\": \"support\" only");
  }
  DefectKind kind{
      .type = type,
      .name = b.value("name", std::string(type->noun)),
      .plural = {},
      .min_count = min,
      .max_count = max,
      .weights = parse_count_prior(file, where / "count", min, max),
      .location =
          bounded_prior(file, where / "location", 0.0, length,
                        "locations lie on the beam, in [0, " + damage_number(length) + "] m"),
      .severity = DefectKind::Rigid{},
      .rotation = type->may_be_rotational && b.contains("fix") && b["fix"][0] == "rotation",
      .truth = {}};
  kind.plural = b.value("plural", b.contains("name") ? kind.name + "s" : type->noun_plural());
  kind.line = SiteLine::of_beam(out.beam);
  if (b.contains("extent") && type_name != "reduction") {
    file.refuse(where / "extent", "is allowed with \"kind\": \"reduction\" only");
  }
  parse_extent(file, where, length, kind);
  if (type_name == "crack") {
    kind.crack_law = parse_crack_law(file, where);
    if (!(out.beam_depth > 0.0)) {
      file.refuse(where / "kind",
                  "a crack needs the depth of the section: give the section a \"shape\" with "
                  "dimensions");
    }
  } else if (b.contains("law")) {
    file.refuse(where / "law", "is allowed with \"kind\": \"crack\" only");
  }
  if (const auto why = io::netcdf_name_error(kind.name)) {
    file.refuse(where / "name", "a name " + *why);
  }
  if (!type->may_be_known && !b.contains(severity)) {
    file.refuse(where / severity, "is missing: must be a prior on [0, 1)");
  }
  if (b.contains(severity) && b[severity].is_number()) {
    kind.severity = b[severity].get<double>();
  } else if (b.contains(severity) && b[severity].is_object()) {
    kind.severity = bounded_prior(file, where / severity, type->lower, type->upper,
                                  std::string(type->bounds_words).c_str());
  }
  parse_damage_truth(file, where, length, kind, out);
  return kind;
}

}  // namespace

void DamageCaseFile::refuse(const InvalidInput& error) const {
  using Part = InvalidInput::Part;
  const auto kind = static_cast<std::size_t>(error.index());
  switch (error.part()) {
    case Part::beam:
      file.refuse(damage.structure ? damage_key("/structure") : damage_key("/beam"), error.what());
    case Part::truth:
      file.refuse(damage_key("/damage/truth"), error.what());
    case Part::emulator:
      file.refuse(damage_key("/predictor"), error.what());
    case Part::location: {
      if (damage.structure) file.refuse(kinds[kind] / "on", error.what());
      const Pointer place = kinds[kind] / "location";
      file.refuse(place,
                  error.what() + kept_within(file, place, 0.0, damage.kinds[kind].line.length()));
    }
    case Part::severity: {
      const identification::DefectType& type = *damage.kinds[kind].type;
      const Pointer place = kinds[kind] / damage.kinds[kind].severity_name();
      file.refuse(place, error.what() + kept_within(file, place, type.lower, type.upper));
    }
    default:
      file.refuse(damage_key("/data"), error.what());
  }
}

namespace {

// "cv" is an alias of "cov" in a case.
void accept_cv(CaseFile& file) {
  std::vector<Pointer> places = {damage_key("/data"), damage_key("/data/discrepancy"),
                                 damage_key("/damage/truth"), damage_key("/baseline/data"),
                                 damage_key("/baseline/data/discrepancy")};
  for (const Pointer& block : {damage_key("/data"), damage_key("/baseline/data")})
    if (file.json.contains(block / "states") && file.json.at(block / "states").is_array())
      for (std::size_t i = 0; i < file.json.at(block / "states").size(); ++i)
        places.push_back(block / "states" / i);
  if (file.json.contains("damage") && file.json["damage"].is_array()) {
    for (std::size_t i = 0; i < file.json["damage"].size(); ++i)
      places.push_back(damage_key("/damage") / i / "truth");
  }
  for (const Pointer& where : places) {
    if (!file.json.contains(where) || !file.json[where].is_object()) continue;
    Json& object = file.json[where];
    if (!object.contains("cv")) continue;
    if (object.contains("cov")) {
      file.refuse(where / "cv", "is an alias of \"cov\": give only one of the two keys");
    }
    object["cov"] = object["cv"];
    object.erase("cv");
  }
}

}  // namespace

namespace {

void check_beam_modes(const CaseFile& f, DamageCase& out) {
  const int free = free_degrees_of_freedom(out.beam);
  if (free < 1)
    f.refuse(damage_key("/beam/supports"), "fix all degrees of freedom: the beam cannot vibrate");
  out.rigid_body_modes = rigid_body_modes(out.beam);
  int most_supports = 0;
  for (const DefectKind& kind : out.kinds) {
    if (kind.type->may_be_known) {
      most_supports += std::max(kind.max_count, static_cast<int>(kind.truth.size()));
    }
  }
  const int most_modes = free - std::max(out.rigid_body_modes, most_supports);
  if (!out.states() && out.modes() > most_modes) {
    f.refuse(out.data.modes() > 0 ? damage_key("/data") : damage_key("/data/modes"),
             std::to_string(out.modes()) + " modes: must be at most " + std::to_string(most_modes) +
                 ", the number of elastic modes of " + std::to_string(out.beam.elements) +
                 " elements; refine beam.elements");
  }
}

void check_damage_modes(const CaseFile& f, DamageCase& out) {
  if (out.structure) {
    check_structure_modes(f, out);
  } else {
    check_beam_modes(f, out);
  }
}

std::vector<std::string> notes_of(const Json& json) {
  if (!json.contains("notes")) return {};
  if (json["notes"].is_string()) return {json["notes"].get<std::string>()};
  return json["notes"].get<std::vector<std::string>>();
}

/// Parses the structure or the beam. Returns the model of the states, and whether it is a beam with
/// equal elements.
std::pair<std::shared_ptr<const StructureModel>, bool> take_structure(const CaseFile& f,
                                                                      bool structure,
                                                                      DamageCase& out) {
  if (structure) {
    out.structure = std::make_shared<const StructureModel>(parse_structure(with_known(f)));
    return {out.structure, false};
  }
  ParametricBeam beam = parse_parametric_beam(with_known(f));
  out.beam = beam.beam;
  out.beam_depth = beam.depth;
  return {beam.model, beam.uniform};
}

void check_kinds(const CaseFile& f, const DamageCaseFile& parsed) {
  // The limit is necessary because posterior modes are searched in each model separately before
  // sampling.
  constexpr double kMostModels = 5000;
  const std::vector<DefectKind>& kinds = parsed.damage.kinds;
  double models = 1.0;
  for (const DefectKind& kind : kinds) models *= kind.max_count - kind.min_count + 1.0;
  if (models > kMostModels) {
    f.refuse(damage_key("/damage"), "would be " + damage_number(models) +
                                        " models, one per combination of counts: must be at most " +
                                        damage_number(kMostModels) + "; lower the largest counts");
  }
  for (std::size_t i = 1; i < kinds.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (kinds[i].name == kinds[j].name) {
        f.refuse(parsed.kinds[i], "two kinds have the name \"" + kinds[i].name +
                                      "\"; give one of the two kinds another \"name\"");
      }
    }
  }
}

void take_kinds(const CaseFile& f, bool structure, DamageCaseFile& parsed) {
  DamageCase& out = parsed.damage;
  const Json damage = f.json.value("damage", Json::array());
  if (structure) {
    parse_structure_kinds(f, out, parsed.kinds);
  } else if (damage.is_array()) {
    for (std::size_t i = 0; i < damage.size(); ++i) {
      parsed.kinds.push_back(damage_key("/damage") / i);
      out.kinds.push_back(parse_kind(f, parsed.kinds.back(), out.beam.length, out));
    }
  } else {
    parsed.kinds.push_back(damage_key("/damage"));
    out.kinds.push_back(parse_kind(f, parsed.kinds.back(), out.beam.length, out));
  }
  check_kinds(f, parsed);
}

/// Parses an external model or an emulator.
void take_predictor(const CaseFile& f, DamageCaseFile& parsed) {
  DamageCase& out = parsed.damage;
  if (!has_outside_model(f)) {
    if (f.json.contains("predictor") && f.json["predictor"].is_object())
      out.emulator = parse_emulator(f, damage_key("/predictor"), out);
    return;
  }
  for (const DefectKind& kind : out.kinds)
    if (kind.severity_prior() == nullptr)
      f.refuse(damage_key("/predictor"),
               "a " + kind.name +
                   " has a known severity: an external model needs a prior on the severity");
  parsed.outside = parse_outside(f, outside_inputs(out));
  if (!f.json["predictor"].contains("emulator")) return;
  const Pointer front("/predictor/emulator");
  if (f.json.at(front).contains("table"))
    f.refuse(front / "table",
             "a table contains runs of Wheeltap's beam model, not of this external model");
  out.emulator = parse_emulator(f, front, out);
  if (f.json.at(front).value("symmetrise", false))
    f.refuse(front / "symmetrise",
             "is not allowed: Wheeltap does not know whether this model is symmetric");
  out.emulator->symmetrise = false;
  if (!f.json.at(front).contains("holdout")) out.emulator->holdout = kHoldoutRuns;
}

/// Simulates modes of the case's truth, for cases with states; /data may lack modes.
SimulatedModes simulated_modes(const CaseFile& f, DamageCaseFile& parsed) {
  DamageCase& out = parsed.damage;
  take_data(f, out);
  check_damage_modes(f, out);
  warn_of(out.structure ? implausible(out.structure->nominal) : implausible(out.beam));
  const Simulation& simulation = *out.simulation;
  out.data = explained(parsed, [&] { return simulate(out, simulation.seed); });
  SimulatedModes made{.frequencies_hz = out.data.frequencies_hz,
                      .shapes = {},
                      .cov = simulation.cv,
                      .shape_sd = simulation.shape_sd};
  const bool shapes = out.modal() && !out.modal()->sensors.empty();
  if (shapes)
    made.shapes =
        explained(parsed, [&] { return simulated_shapes(out, out.data.modes(), simulation.seed); });
  const Json& data = f.json.at("data");
  const auto require_positive = [&](const Pointer& where, double value, const char* what) {
    if (!(value > 0.0)) f.refuse(where, Json(value).dump() + ": must be > 0" + what);
  };
  if (!data.contains("cov") && !data.contains("sd") && !data.contains("covariance"))
    require_positive(damage_key("/data/cov"), made.cov, " (0.01 is 1 % of each frequency)");
  for (std::size_t i = 0; i < made.frequencies_hz.size(); ++i)
    require_positive(damage_key("/data/frequencies") / i, made.frequencies_hz[i],
                     " (Hz, or null for a mode not measured)");
  if (shapes && !data.contains("shape_sd"))
    require_positive(damage_key("/data/shape_sd"), made.shape_sd, "");
  return made;
}

/// Simulates frequencies from the case's truth if the case gives no frequencies.
void simulate_data(const CaseFile& f, DamageCaseFile& parsed) {
  DamageCase& out = parsed.damage;
  if (!out.simulation) {
    f.refuse(
        damage_key("/data"),
        "no data: give \"frequencies\" or a \"file\", or a \"truth\" in damage from which Wheeltap "
        "simulates the frequencies");
  }
  const auto sd = out.data.sd_hz;
  const auto cv = out.data.cv;
  const auto cv_prior = out.data.cv_prior;
  const double discrepancy = out.data.discrepancy_cv;
  out.data = explained(parsed, [&] { return simulate(out, out.simulation->seed); });
  out.data.cv = cv;
  out.data.cv_prior = cv_prior;
  out.data.discrepancy_cv = discrepancy;
  if (!sd.empty() && sd.size() != out.data.frequencies_hz.size()) {
    f.refuse(damage_key("/data/sd"),
             "must have one value per mode: " + std::to_string(out.data.modes()));
  }
  if (!sd.empty()) out.data.sd_hz = sd;
  if (out.modal())
    explained(parsed, [&] {
      take_true_shapes(f, out);
      return true;
    });
  if (cv_prior) out.data.sd_hz.clear();
}

/// Parses the noise of the data, and the baseline if the case has one.
void finish_data(const CaseFile& f, DamageCase& out) {
  if (out.data.sd_hz.empty() && !out.data.cv_prior) {
    f.refuse(damage_key("/data/cov"),
             "is missing: give the uncertainty of the frequencies, \"cov\" or \"sd\"; for example, "
             "write \"cov\": 0.005 for 0.5 % of each frequency");
  }
  if (f.json.contains("baseline")) {
    if (out.data.simulated)
      f.refuse(damage_key("/baseline"),
               "is allowed with measured data only: the model itself simulates the data of this "
               "case, so there is no model error to correct");
    take_baseline(f, out);
  }
  if (f.json.contains("data"))
    require_shapes_to_doubt(f, damage_key("/data"), out.modal() && out.modal()->has_shapes());
}

/// True if the case takes its data from a modes.json that does not exist yet.
bool waits_for_modes(const CaseFile& f) {
  std::error_code ignored;
  return f.json.at("data").contains("from") &&
         !std::filesystem::exists(f.place_of(f.json["data"]["from"].get<std::string>()), ignored);
}

}  // namespace

DamageCaseFile parse_damage_case(CaseFile file, Needs needs) {
  const bool structure = has_structure(file);
  accept_cv(file);
  validate_against_schema(file, structure ? "structure" : "damage");
  if (file.json.at("kind") != "damage") file.refuse(damage_key("/kind"), "must be \"damage\" here");
  DamageCaseFile parsed{.file = std::move(file), .notes = {}, .damage = {}, .kinds = {}};
  DamageCase& out = parsed.damage;
  const CaseFile& f = parsed.file;
  const Json& json = f.json;
  out.title = json.value("title", io::printable(f.path.stem().string()));
  out.balance = json.value("balance", false);
  parsed.notes = notes_of(json);
  const auto [model, uniform] = take_structure(f, structure, out);
  if (needs == Needs::data) {
    if (json.contains("plan") && !json.contains("data"))
      f.refuse(Pointer("/data"),
               "is missing: this case plans a test. Run wheeltap plan, or add the measured modes");
    for (const char* key : {"damage", "data"}) {
      if (!json.contains(key))
        f.refuse(Pointer() / std::string(key), "is missing: must be an object");
    }
  }
  take_kinds(f, structure, parsed);
  take_predictor(f, parsed);
  const bool of_low_rank = std::ranges::all_of(
      out.kinds, [](const DefectKind& kind) { return kind.type->has_low_rank; });
  const bool states = needs == Needs::data && (has_states(f) || !of_low_rank);
  if (states && !has_states(f) && out.simulation && !has_measured(json["data"])) {
    const SimulatedModes made = simulated_modes(f, parsed);
    const std::string origin = out.data.origin;
    take_states(f, model, uniform, out, &made);
    out.data.simulated = true;
    out.data.origin = origin;
  } else if (states) {
    take_states(f, model, uniform, out);
  } else if (json.contains("data") && (needs == Needs::data || !waits_for_modes(f))) {
    take_data(f, out);
  }
  check_damage_modes(f, out);
  if (needs == Needs::structure || states) return parsed;
  if (out.data.frequencies_hz.empty()) simulate_data(f, parsed);
  finish_data(f, out);
  return parsed;
}

}  // namespace wheeltap::apps
