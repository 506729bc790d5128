#include "apps/cases/simulation.hpp"

#include "apps/cases/damage_case.hpp"
#include "apps/cases/sid_case.hpp"
#include "apps/cases/update_case.hpp"
#include "apps/structure_words.hpp"
#include "identification/sid/sid_simulation.hpp"
#include "identification/structural/structure_plausibility.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

Json json_rows(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (const auto& row : matrix.rowwise())
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

}  // namespace

SimulatedCase simulated_update(CaseFile file, std::optional<std::uint64_t> seed) {
  const UpdateCaseFile parsed = parse_update_case(std::move(file), UpdateNeeds::truth, seed);
  warn_of(implausible(parsed.update));
  const ModalData& data = parsed.update.data;
  Json json = parsed.file.json;
  Json& out = json["data"];
  if (!out.is_object()) out = Json::object();
  for (const char* key : {"file", "columns", "row", "repeats", "from", "modes", "model_modes"})
    out.erase(key);
  out["frequencies"] = data.frequencies_hz;
  const Json& truth = json["truth"];
  if (!out.contains("cov")) out["cov"] = truth.at("cov");
  if (data.has_shapes()) {
    out["shapes"] = json_rows(data.shapes);
    if (!out.contains("shape_sd")) out["shape_sd"] = truth.at("shape_sd");
  } else {
    out.erase("shapes");
  }
  json.erase("truth");
  return {.json = std::move(json), .modes = data.modes(), .origin = data.origin};
}

Json with_simulated(const DamageCaseFile& parsed, const FrequencyData& data, std::uint64_t seed) {
  const DamageCase& damage_case = parsed.damage;
  Json json = parsed.file.json;
  if (!json["data"].is_object()) json["data"] = Json::object();  // the truth defines all data
  for (const char* key :
       {"file", "columns", "row", "repeats", "from", "modes", "model_modes", "seed"})
    json["data"].erase(key);
  json["data"]["frequencies"] = data.frequencies_hz;
  const auto says = [&](const char* key) { return json["data"].contains(key); };
  if (!says("cov") && !says("sd") && !says("covariance"))
    json["data"]["cov"] = damage_case.simulation->cv;
  if (damage_case.modal() && !damage_case.modal()->sensors.empty()) {
    json["data"]["shapes"] = json_rows(
        explained(parsed, [&] { return simulated_shapes(damage_case, data.modes(), seed); }));
    if (!json["data"].contains("shape_sd"))
      json["data"]["shape_sd"] = damage_case.simulation->shape_sd;
  }
  return json;
}

SimulatedCase simulated_damage(CaseFile file, std::optional<std::uint64_t> seed) {
  const DamageCaseFile parsed = parse_damage_case(std::move(file), Needs::structure);
  const auto& simulation = parsed.damage.simulation;
  const std::uint64_t used = seed.value_or(simulation ? simulation->seed : 1);
  warn_of(parsed.damage.structure ? implausible(parsed.damage.structure->nominal)
                                  : implausible(parsed.damage.beam));
  const FrequencyData data = explained(parsed, [&] { return simulate(parsed.damage, used); });
  return {.json = with_simulated(parsed, data, used), .modes = data.modes(), .origin = data.origin};
}

SimulatedRecord simulated_record(CaseFile file, std::optional<std::uint64_t> seed) {
  const SidCaseFile parsed = parse_sid_case(std::move(file), SidNeeds::truth);
  const SidCase& sid_case = parsed.sid;
  const std::uint64_t used = seed.value_or(sid_case.truth ? sid_case.truth->seed : 1);
  return {.record = explained(parsed, [&] { return simulate_record(sid_case, used); }),
          .title = sid_case.title,
          .seed = used};
}

}  // namespace wheeltap::apps
