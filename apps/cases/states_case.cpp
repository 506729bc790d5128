#include "apps/cases/states_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "apps/cases/modal_data_case.hpp"
#include "apps/cases/structures/state_places.hpp"
#include "apps/nearest.hpp"
#include "base/constants.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

const Pointer kData("/data"), kBaseline("/baseline/data"), kTemperature("/temperature");

using KeyList = std::initializer_list<const char*>;

bool has_any(const Json& block, KeyList keys) {
  return std::ranges::any_of(keys, [&](const char* key) { return block.contains(key); });
}

/// Adds the keys of a block to a state; keys of the state take precedence.
void inherit(Json& state, const Json& block) {
  static constexpr std::array<std::array<const char*, 4>, 3> alternatives = {
      {{"frequencies", "file", "from", "repeats"},
       {"cov", "sd", "covariance", "repeats"},
       {"shape_sd", "shape_covariance", "shape_sd", "shape_sd"}}};
  // Keys that select data from the file that another key names. They do not apply to a state whose
  // frequencies have another source.
  static constexpr std::array<std::array<const char*, 2>, 4> selections = {
      {{"columns", "file"}, {"row", "file"}, {"modes", "from"}, {"model_modes", "from"}}};
  const auto has_other_origin = [&](const char* origin) {
    return std::ranges::any_of(alternatives[0], [&](const char* k) {
      return std::string_view(k) != origin && state.contains(k);
    });
  };
  for (const auto& [key, value] : block.items()) {
    if (key == "states" || state.contains(key)) continue;
    if (state.contains("predict") && (key == "sd" || key == "covariance")) continue;
    const bool has_alternative = std::ranges::any_of(alternatives, [&](const auto& keys) {
      return std::ranges::find(keys, key) != keys.end() &&
             std::ranges::any_of(keys, [&](const char* k) { return state.contains(k); });
    });
    // A modes.json contains the uncertainty of its modes.
    const bool by_file = state.contains("from") && (key == "cov" || key == "shape_sd");
    const bool is_useless = std::ranges::any_of(selections, [&](const auto& selection) {
      return key == selection[0] && has_other_origin(selection[1]);
    });
    if (!has_alternative && !by_file && !is_useless) state[key] = value;
  }
}

/// Parser of known masses added in a state.
class MassParser {
 public:
  MassParser(const CaseFile& file, const AnyStructure& structure)
      : file_(file), structure_(structure) {
    if (const auto* members = std::get_if<fem::Structure>(&structure)) mesh_.emplace(*members);
  }

  std::vector<fem::StructureChange::Mass> parse(const Pointer& list) const {
    std::vector<fem::StructureChange::Mass> out;
    for (std::size_t i = 0; i < file_.json.at(list).size(); ++i) {
      const Pointer at = list / i;
      const Json& m = file_.json.at(at);
      if (!m.contains("mass"))
        file_.refuse(at / "mass", "is missing: must be the added mass in kg");
      if (m.contains("inertia"))
        file_.refuse(at / "inertia",
                     "is not supported: added masses are point masses without inertia");
      const std::size_t before = out.size();
      for (fem::SparseRow& motion : motions(at))
        if (!motion.empty())
          out.push_back({.motion = std::move(motion), .mass = m.at("mass").get<double>()});
      if (out.size() == before) file_.refuse(at, "does not move: a support fixes it");
    }
    return out;
  }

 private:
  std::vector<fem::SparseRow> motions(const Pointer& at) const {
    const Json& m = file_.json.at(at);
    if (file_.json.contains("beam")) return on_beam(at);
    if (!m.contains("node"))
      file_.refuse(at / "node", "is missing: must be the location of the added mass");
    const std::string name = text_or_number(m.at("node"));
    if (mesh_) {
      const auto& nodes = mesh_->structure().nodes;
      const auto found = std::ranges::find(nodes, name, &fem::Node::name);
      if (found == nodes.end()) {
        std::vector<std::string> names;
        for (const fem::Node& node : nodes) names.push_back(node.name);
        refuse_name(at, name, names);
      }
      std::vector<fem::SparseRow> out;
      for (const auto d : {fem::Direction::x, fem::Direction::y, fem::Direction::z})
        if (d != fem::Direction::z || mesh_->structure().dimension == 3)
          out.push_back(mesh_->motion(static_cast<int>(found - nodes.begin()), d));
      return out;
    }
    const auto dofs = discretise(structure_).names;
    std::vector<fem::SparseRow> out;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      names.push_back(dofs[i].place);
      const bool turns = dofs[i].direction.starts_with('r');
      if ((dofs[i].place == name || dofs[i].place == "mass " + name) && !turns)
        out.push_back({.dofs = {static_cast<int>(i)}, .coefficients = {1.0}});
    }
    if (out.empty()) refuse_name(at, name, names);
    return out;
  }

  std::vector<fem::SparseRow> on_beam(const Pointer& at) const {
    const Json& m = file_.json.at(at);
    if (!m.contains("at")) file_.refuse(at / "at", "is missing: metres from the left end");
    double left = m.at("at").get<double>();
    int member = 0;
    const auto members = static_cast<int>(mesh_->structure().members.size());
    while (member + 1 < members && left >= mesh_->member_length(member))
      left -= mesh_->member_length(member++);
    if (left > mesh_->member_length(member) * (1.0 + 1e-9))
      file_.refuse(at / "at", "is outside the beam");
    return {mesh_->motion(member, std::min(left, mesh_->member_length(member)), fem::Direction::y)};
  }

  [[noreturn]] void refuse_name(const Pointer& at, const std::string& name,
                                const std::vector<std::string>& names) const {
    file_.refuse(at / "node", "no location has this name" + did_you_mean(name, names));
  }

  const CaseFile& file_;
  const AnyStructure& structure_;
  std::optional<fem::Mesh> mesh_;
};

/// Checks that two states have the same unknown noise parameters and model errors.
void check_scatters(const CaseFile& file, const Pointer& where, const ModalData& first,
                    const ModalData& data) {
  const auto same = [](const std::optional<inference::Prior>& a,
                       const std::optional<inference::Prior>& b) {
    return a.has_value() == b.has_value() && (!a || a->describe() == b->describe());
  };
  if (!same(first.cov_prior, data.cov_prior))
    file.refuse(where / "cov",
                "must have the same prior in every state, or be known in every state");
  if (first.has_shapes() && data.has_shapes() && !same(first.shape_sd_prior, data.shape_sd_prior))
    file.refuse(where / "shape_sd",
                "must have the same prior in every state, or be known in every state");
  const auto one = [&](const Scatter& a, const Scatter& b, const char* key) {
    if (a.none() || b.none()) return;
    if (!same(a.prior, b.prior) || a.value != b.value)
      file.refuse(
          where / "discrepancy" / key,
          "must be the same in every state: it is an error of the model, not of a measurement");
  };
  one(first.discrepancy, data.discrepancy, "cov");
  one(first.shape_discrepancy, data.shape_discrepancy, "shape");
  one(first.mixing, data.mixing, "mixing");
  one(first.stiffness_discrepancy, data.stiffness_discrepancy, "stiffness");
}

/// True if a member has an axial force, given or unknown. Its geometric stiffness does not change
/// with the temperature, unlike all other stiffnesses.
bool has_axial_force(const CaseFile& file, const StructureModel& model) {
  const auto* members = std::get_if<fem::Structure>(&model.nominal);
  if (members == nullptr) return false;
  const auto is_loaded = [](const fem::Member& m) { return m.axial_force != 0.0; };
  const Pointer list("/structure/members");
  return std::ranges::any_of(members->members, is_loaded) ||
         (file.json.contains(list) && std::ranges::any_of(file.json.at(list), [](const Json& m) {
            return m.contains("axial_force") && m.at("axial_force").is_string();
          }));
}

/// Temperatures relative to the reference, and the temperature coefficient of the stiffness.
void parse_temperature(const CaseFile& file, const StructureModel& model,
                       const std::vector<Pointer>& where, ObservedStates& out) {
  double sum = 0.0, count = 0.0;
  for (std::size_t s = 0; s < where.size(); ++s) {
    if (!file.json.at(where[s]).contains("temperature")) continue;
    sum += file.json.at(where[s]).at("temperature").get<double>();
    ++count;
  }
  if (count == 0.0) {
    if (file.json.contains(kTemperature))
      file.refuse(kTemperature, "needs states with a \"temperature\"");
    return;
  }
  if (!file.json.contains(kTemperature))
    file.refuse(kTemperature,
                "is missing: {\"stiffness_per_kelvin\": prior}, the relative change of the "
                "stiffness per kelvin, e.g. {\"normal\": [-4e-4, 4e-4]}");
  if (has_axial_force(file, model))
    file.refuse(kTemperature,
                "is not allowed with axial forces: it scales all stiffnesses, and the geometric "
                "stiffness of an axial force does not change with the temperature; use states of "
                "equal temperature without this key");
  out.per_kelvin = parse_prior(file, kTemperature / kPerKelvin);
  const double reference = file.json.at(kTemperature).value("reference", sum / count);
  for (std::size_t s = 0; s < where.size(); ++s) {
    if (!file.json.at(where[s]).contains("temperature"))
      file.refuse(where[s] / "temperature", "is missing: other states have a temperature");
    out.list[s].temperature = file.json.at(where[s]).at("temperature").get<double>() - reference;
  }
}

}  // namespace

bool has_states(const CaseFile& file) {
  if (!file.json.value("parameters", Json::object()).empty()) return true;
  for (const Pointer& where : state_blocks(file)) {
    if (has_any(file.json.at(where), {"states", "masses", "temperature", "known"})) return true;
    // Only the likelihood of states integrates over stiffness errors of members or links.
    const Json discrepancy = file.json.at(where).value("discrepancy", Json());
    if (discrepancy.is_object() && discrepancy.contains("stiffness")) return true;
    // A baseline that contains more than frequencies is also a state.
    if (where == kBaseline &&
        has_any(file.json.at(where),
                {"from", "sensors", "shapes", "covariance", "discrepancy", "repeats"}))
      return true;
  }
  return false;
}

CaseFile with_known(const CaseFile& file) {
  CaseFile out = file;
  std::map<std::string, std::pair<double, double>> range;
  for (const Pointer& block : state_blocks(file))
    for (const Pointer& where : state_places(file, block)) {
      const Json& state = file.json.at(where);
      if (!state.contains("known")) continue;
      for (const auto& [name, value] : state.at("known").items()) {
        const Json& own = file.json.value("parameters", Json::object());
        if (own.contains(name))
          file.refuse(where / "known" / name,
                      "also has a prior in /parameters: a coefficient is either known or unknown");
        const double x = value.get<double>();
        auto [at, first] = range.try_emplace(name, x, x);
        at->second = {std::min(at->second.first, x), std::max(at->second.second, x)};
      }
    }
  for (const auto& [name, ends] : range) {
    const double more =
        ends.first < ends.second ? 0.0 : 1e-9 * std::max(1e-9, std::abs(ends.first));
    out.json["parameters"][name] = {{"uniform", {ends.first - more, ends.second + more}}};
  }
  return out;
}

ObservedStates parse_states(const CaseFile& given, std::shared_ptr<const StructureModel> model,
                            bool damage, const SimulatedModes* simulated) {
  CaseFile file = given;
  std::vector<Pointer> where;
  std::vector<std::string> names;
  for (const Pointer& block : state_blocks(given)) {
    if (block == kBaseline && !damage) continue;
    const std::vector<Pointer> of_block = state_places(given, block);
    const std::string name = !damage ? "state" : block == kBaseline ? "healthy" : "damaged";
    for (std::size_t i = 0; i < of_block.size(); ++i) {
      Json& state = file.json[of_block[i]];
      if (block != of_block[i]) {
        if (state.contains("states"))
          given.refuse(of_block[i] / "states", "a state cannot contain states");
        inherit(state, given.json.at(block));
      }
      where.push_back(of_block[i]);
      names.push_back(
          state.value("name", of_block.size() == 1 ? name : name + " " + std::to_string(i + 1)));
    }
  }
  ObservedStates out{.model = std::move(model)};
  std::set<std::string> known;
  for (const Pointer& at : where) {
    const Json set = file.json.at(at).value("known", Json::object());
    for (const auto& [name, ignored] : set.items()) known.insert(name);
  }
  const MassParser masses(file, out.model->nominal);
  for (std::size_t s = 0; s < where.size(); ++s) {
    const Json& json = file.json.at(where[s]);
    ObservedState state{
        .name = names[s],
        .damaged = damage && names.size() > 0 && where[s].to_string().starts_with("/data")};
    state.data = parse_modal_data(file, where[s], out.model->nominal,
                                  where[s] == kData ? simulated : nullptr);
    if (!state.data.stiffness_discrepancy.none() &&
        (!damage || std::holds_alternative<fem::MatrixStructure>(out.model->nominal)))
      given.refuse(where[s] / "discrepancy" / "stiffness",
                   std::string("is allowed for damage of members and chains only: ") +
                       (damage ? "this structure has only matrices" : "an update has no damage") +
                       "; give the uncertain stiffnesses priors in /parameters");
    if (const auto* members = std::get_if<fem::Structure>(&out.model->nominal);
        members && !state.data.stiffness_discrepancy.none() &&
        std::ranges::any_of(members->members, [](const fem::Member& m) {
          return m.axial_force != 0.0 || m.foundation > 0.0;
        }))
      given.refuse(where[s] / "discrepancy" / "stiffness",
                   "is not allowed with axial forces and foundations");
    if (state.data.doubt > 0.0)
      file.refuse(where[s] / "doubt",
                  "is allowed with one state only: remove spurious modes from \"modes\"");
    if (state.data.modes() == 0 && state.data.predict > 0 && !damage) {
      // No modes were measured in this state: all its modes are predicted.
      const auto n = static_cast<std::size_t>(state.data.predict);
      state.data.frequencies_hz.assign(n, kNaN);
      state.data.covariance = Eigen::MatrixXd::Zero(state.data.predict, state.data.predict);
      state.data.origin = "to be predicted";
      state.data.predict = 0;
    }
    if (state.data.modes() == 0)
      given.refuse(where[s], "no data: give \"frequencies\", a \"file\" or \"from\"");
    if (state.data.predict > 0)
      given.refuse(
          where[s] / "predict",
          "is allowed only in states without measurements: use it in place of \"frequencies\"");
    for (const double f : state.data.frequencies_hz)
      if (!std::isnan(f) && !(f > 0.0)) given.refuse(where[s], "frequencies must be positive");
    for (const ObservedState& earlier : out.list)
      check_scatters(given, where[s], earlier.data, state.data);
    if (json.contains("masses")) state.masses = masses.parse(where[s] / "masses");
    for (const std::string& name : known) {
      if (!json.value("known", Json::object()).contains(name))
        given.refuse(where[s] / "known" / name,
                     "is missing: every state must give this coefficient a value");
      state.known.push_back(json["known"][name].get<double>());
    }
    out.list.push_back(std::move(state));
  }
  for (std::size_t p = 0; p < out.model->parameters.size(); ++p)
    (known.contains(out.model->parameters[p].name) ? out.known : out.unknown)
        .push_back(static_cast<int>(p));
  parse_temperature(file, *out.model, where, out);
  return out;
}

void take_states(const CaseFile& file, std::shared_ptr<const StructureModel> model, bool uniform,
                 DamageCase& out, const SimulatedModes* simulated) {
  if (out.emulator)
    file.refuse(Pointer("/predictor"),
                "an emulator supports one beam with known coefficients: with unknown coefficients "
                "or states, use \"fe\"");
  ObservedStates states = parse_states(file, std::move(model), true, simulated);
  states.uniform = uniform;
  const bool healthy = std::ranges::any_of(states.list, [](const auto& s) { return !s.damaged; });
  const ModalData all = states.joined();
  if (healthy && states.parameters().empty() && all.discrepancy.none() &&
      all.stiffness_discrepancy.none())
    file.refuse(kBaseline,
                "has no effect: give the uncertain coefficients priors in \"parameters\", or give "
                "a \"discrepancy\", the model error common to all states");
  const ModalData joined = states.joined();
  if (std::ranges::none_of(states.list, &ObservedState::damaged))
    file.refuse(kData, "is missing: must be an object");
  FrequencyData data{.frequencies_hz = joined.frequencies_hz,
                     .sd_hz = {},
                     .cv = {},
                     .cv_prior = joined.cov_prior,
                     .discrepancy_cv = joined.discrepancy.value,
                     .simulated = false,
                     .origin = joined.origin};
  for (Eigen::Index i = 0; i < joined.covariance.rows(); ++i)
    data.sd_hz.push_back(std::isnan(data.frequencies_hz[static_cast<std::size_t>(i)])
                             ? kNaN
                             : std::sqrt(joined.covariance(i, i)));
  out.data = std::move(data);
  out.measured = identification::MeasuredModes(
      std::make_shared<const ObservedStates>(std::move(states)), joined);
}

}  // namespace wheeltap::apps
