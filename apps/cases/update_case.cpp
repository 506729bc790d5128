#include "apps/cases/update_case.hpp"

#include <algorithm>

#include "apps/cases/modal_data_case.hpp"
#include "apps/cases/states_case.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/updating/update_problem.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

const Pointer kUpdateData("/data"), kUpdateTruth("/truth");

/// "cv" is an alias of "cov" in a case.
void accept_update_cv(CaseFile& file) {
  std::vector<Pointer> places = {kUpdateData, kUpdateTruth, kUpdateData / "discrepancy"};
  if (file.json.contains(kUpdateData / "states") && file.json.at(kUpdateData / "states").is_array())
    for (std::size_t i = 0; i < file.json.at(kUpdateData / "states").size(); ++i)
      places.push_back(kUpdateData / "states" / i);
  for (const Pointer& at : places) {
    if (!file.json.is_object() || !file.json.contains(at) || !file.json.at(at).is_object())
      continue;
    Json& block = file.json.at(at);
    if (!block.contains("cv")) continue;
    if (block.contains("cov"))
      file.refuse(at / "cv", "is an alias of \"cov\": give only one of the two keys");
    block["cov"] = block["cv"];
    block.erase("cv");
  }
}

void parse_update_truth(const CaseFile& f, UpdateCase& out) {
  const Json& truth = f.json.at(kUpdateTruth);
  ModalSimulation simulation{.parameters = {},
                             .modes = truth.value("modes", 5),
                             .cov = truth.value("cov", 0.0),
                             .shape_sd = truth.value("shape_sd", 0.0),
                             .seed = truth.value("seed", std::uint64_t{1})};
  const Json& values = truth.at("parameters");
  for (const auto& parameter : out.structure->parameters) {
    if (!values.contains(parameter.name))
      f.refuse(kUpdateTruth / "parameters" / parameter.name,
               "is missing: the truth needs a value of every parameter");
    simulation.parameters.push_back(values[parameter.name].get<double>());
  }
  for (const auto& [name, ignored] : values.items())
    if (std::ranges::find(out.structure->parameters, name, &inference::Parameter::name) ==
        out.structure->parameters.end())
      f.refuse(kUpdateTruth / "parameters" / name, "no parameter has this name");
  if (simulation.shape_sd > 0.0 && out.data.sensors.empty())
    f.refuse(kUpdateTruth / "shape_sd", "needs \"sensors\" in data");
  out.simulation = std::move(simulation);
}

/// Parses the truth, and the uncertainty of the simulated modes if the data do not give it.
void take_truth(const CaseFile& f, UpdateCase& out, std::uint64_t seed) {
  const Json data = f.json.value("data", Json::object());
  const ModalSimulation& truth = *out.simulation;
  for (const char* key : {"sd", "covariance", "shape_covariance"})
    if (data.contains(key))
      f.refuse(kUpdateData / key,
               "is allowed with measured modes only; use \"cov\" and \"shape_sd\" of the truth");
  if (data.contains("shape_sd") && data["shape_sd"].is_array())
    f.refuse(kUpdateData / "shape_sd", "must be one number, or a prior, for simulated modes");
  const double stated =
      data.contains("cov") && data["cov"].is_number() ? data["cov"].get<double>() : truth.cov;
  if (!(stated > 0.0) && !out.data.cov_prior)
    f.refuse(kUpdateTruth / "cov",
             "is missing: give the uncertainty of the frequencies, here or in data");
  out.data.covariance.resize(0, 0);
  out.data.shapes.resize(0, 0);
  out.data.shape_covariances.clear();
  try {
    simulate(out, seed);
  } catch (const fem::InvalidStructure& error) {
    refuse_structure(f, out.structure->nominal, error);
  } catch (const std::invalid_argument& error) {
    f.refuse(kUpdateTruth, error.what());
  }
  const Eigen::Index n = out.data.modes();
  out.data.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sd = stated * out.data.frequencies_hz[static_cast<std::size_t>(i)];
    out.data.covariance(i, i) = sd * sd;
  }
  if (out.data.cov_prior) out.data.covariance.resize(0, 0);
  const auto sensors = static_cast<Eigen::Index>(out.data.sensors.size());
  if (truth.shape_sd > 0.0) {
    const double sd = out.data.shape_sd_prior     ? 1.0
                      : data.contains("shape_sd") ? data["shape_sd"].get<double>()
                                                  : truth.shape_sd;
    out.data.shape_covariances.assign(static_cast<std::size_t>(n),
                                      sd * sd * Eigen::MatrixXd::Identity(sensors, sensors));
  }
}

void check_modes(const CaseFile& f, UpdateCase& out) {
  try {
    const fem::Discretisation d = discretise(out.structure->nominal);
    const auto most = static_cast<int>(fem::mode_count(d) - d.rigid_motions.cols());
    const auto refuse = [&](const Pointer& at, int modes) {
      f.refuse(at, std::to_string(modes) + " modes: must be at most " + std::to_string(most) +
                       ", the number of elastic modes of the structure");
    };
    // With "doubt", some modes may be spurious.
    if (out.data.least_modes() > most && out.data.doubt == 0.0)
      refuse(kUpdateData, out.data.least_modes());
    if (out.data.modes() + out.data.predict > most && out.data.predict > 0)
      refuse(kUpdateData / "predict", out.data.modes() + out.data.predict);
    if (out.simulation && out.simulation->modes > most) {
      if (f.json.at(kUpdateTruth).contains("modes"))
        refuse(kUpdateTruth / "modes", out.simulation->modes);
      out.simulation->modes = most;
    }
  } catch (const fem::InvalidStructure& error) {
    refuse_structure(f, out.structure->nominal, error);
  }
}

/// Parses the parameters of an external model. The structure of such a model is unknown.
StructureModel parse_parameters_alone(const CaseFile& f) {
  // Placeholder structure for the parser of data; it is never solved.
  StructureModel model{
      .nominal = fem::LumpedChain{.masses = {1.0},
                                  .links = {{.name = "", .between = {0, 1}, .stiffness = 1.0}}}};
  for (const auto& [name, ignored] : f.json.at("parameters").items()) {
    model.parameters.push_back({name, parse_prior(f, Pointer("/parameters") / name)});
    model.setters.emplace_back([](AnyStructure&, double) {});
  }
  return model;
}

/// Rejects keys that need a known structure if the predictor is external.
void check_outside(const CaseFile& f, UpdateCaseFile& parsed) {
  for (const char* key : {"sensors", "shapes", "shape_sd", "shape_covariance", "states", "masses",
                          "temperature", "known"})
    if (f.json.contains(kUpdateData / key))
      f.refuse(kUpdateData / key,
               "is not allowed with an external predictor, which predicts frequencies only");
  if (f.json.contains("temperature"))
    f.refuse(Pointer("/temperature"), "is not allowed with an external predictor");
  std::vector<std::string> names;
  for (const auto& parameter : parsed.update.structure->parameters) names.push_back(parameter.name);
  parsed.outside = parse_outside(f, names);
}

// True if the case has data of several states.
bool has_several(const CaseFile& f) {
  if (!f.json.contains(kUpdateData)) return false;
  const Json& data = f.json.at(kUpdateData);
  return std::ranges::any_of(std::vector<std::string>{"states", "masses", "temperature", "known"},
                             [&](const std::string& key) { return data.contains(key); });
}

void take_case_states(const CaseFile& f, UpdateNeeds needs, UpdateCase& out) {
  if (needs == UpdateNeeds::truth)
    f.refuse(kUpdateTruth, "is missing: there is nothing to simulate");
  auto states = parse_states(f, out.structure, false);
  out.data = states.joined();
  out.states = std::make_shared<const ObservedStates>(std::move(states));
}

}  // namespace

Pointer prior_place(const UpdateCase& update_case, const std::string& parameter) {
  const auto& own = update_case.structure->parameters;
  if (std::ranges::find(own, parameter, &inference::Parameter::name) != own.end())
    return Pointer("/parameters") / parameter;
  if (parameter == kPerKelvin) return Pointer("/temperature") / parameter;
  if (parameter == "discrepancy") return kUpdateData / "discrepancy" / "cov";
  if (parameter == "shape_discrepancy") return kUpdateData / "discrepancy" / "shape";
  if (parameter == "mixing") return kUpdateData / "discrepancy" / "mixing";
  return kUpdateData / parameter;
}

UpdateCaseFile parse_update_case(CaseFile file, UpdateNeeds needs,
                                 std::optional<std::uint64_t> seed) {
  accept_update_cv(file);
  validate_against_schema(file, "update");
  UpdateCaseFile parsed{.file = std::move(file), .notes = {}, .update = {}};
  const CaseFile& f = parsed.file;
  const Json& json = f.json;
  UpdateCase& out = parsed.update;
  out.title = json.value("title", io::printable(f.path.stem().string()));
  if (json.contains("notes"))
    parsed.notes = json["notes"].is_string()
                       ? std::vector<std::string>{json["notes"].get<std::string>()}
                       : json["notes"].get<std::vector<std::string>>();
  for (const std::string& name : scatter_names())
    if (json["parameters"].contains(name))
      f.refuse(Pointer("/parameters") / name,
               "is the reserved name of a standard deviation of the data: choose another name");
  const bool outside = has_outside_model(f);
  const bool alone = outside && !json.contains("structure");
  if (!outside && !json.contains("structure"))
    f.refuse(
        Pointer("/structure"),
        "is missing: must be an object, unless an external \"predictor\" replaces the structure");
  if (alone && needs == UpdateNeeds::structure)
    f.refuse(Pointer("/structure"),
             "is missing: this command needs a structure, not only a predictor");
  if (alone && json.contains("truth")) f.refuse(kUpdateTruth, "needs a structure to simulate from");
  out.structure = std::make_shared<const StructureModel>(alone ? parse_parameters_alone(f)
                                                               : parse_structure(with_known(f)));
  if (outside) check_outside(f, parsed);
  if (has_several(f)) {
    if (json.contains("truth"))
      f.refuse(kUpdateTruth, "is not allowed with states: give the measured data of each state");
    take_case_states(f, needs, out);
    return parsed;
  }
  if (json.contains("data")) out.data = parse_modal_data(f, kUpdateData, out.structure->nominal);
  if (json.contains("truth")) parse_update_truth(f, out);
  if (!alone) check_modes(f, out);
  if (needs == UpdateNeeds::structure) return parsed;
  const bool measured = out.data.modes() > 0;
  if (needs == UpdateNeeds::truth && !out.simulation)
    f.refuse(kUpdateTruth, "is missing: there is nothing to simulate");
  if (needs == UpdateNeeds::truth || !measured) {
    if (!out.simulation)
      f.refuse(kUpdateData,
               "no data: give \"frequencies\" (and \"shapes\"), or a \"truth\" from which "
               "Wheeltap simulates the data");
    take_truth(f, out, seed.value_or(out.simulation->seed));
  }
  if (json.contains("data")) require_shapes_to_doubt(f, kUpdateData, out.data.has_shapes());
  return parsed;
}

}  // namespace wheeltap::apps
