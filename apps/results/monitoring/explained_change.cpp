#include "apps/results/monitoring/explained_change.hpp"

#include <algorithm>
#include <cmath>

#include "apps/words.hpp"
#include "base/index.hpp"
#include "base/number.hpp"

namespace wheeltap::apps {
namespace {

using identification::DefectKind;
using identification::monitoring::CentralInterval;
using identification::monitoring::ChangeExplanation;
using identification::monitoring::ExplainedDefect;
using identification::monitoring::Monitor;

Report central_json(const CentralInterval& interval) {
  return {
      {"q5", finite(interval.q5)}, {"q50", finite(interval.q50)}, {"q95", finite(interval.q95)}};
}

Report defect_json(const DefectKind& kind, bool is_mass, const ExplainedDefect& found) {
  Report places = Report::array();
  for (const auto& place : found.places) {
    const auto& stretch = kind.line.stretches()[index(place.stretch)];
    Report one = {{"name", stretch.name}, {"probability", place.probability}};
    if (stretch.size > 0.0) one["at"] = central_json(place.at);
    places.push_back(std::move(one));
  }
  Report out = {{"name", kind.name},
                {"is_damage", !is_mass},
                {"probability", found.probability},
                {"site", kind.line.is_beam() ? std::string("beam") : kind.site_name()},
                {"location", central_json(found.location)},
                {"places", places},
                {"by_element", found.by_cell}};
  if (kind.severity_prior() != nullptr) {
    out["severity_name"] = kind.severity_name();
    out["severity_unit"] = kind.severity_unit();
    out["severity"] = central_json(found.severity);
  }
  return out;
}

Report explanation_json(const MonitorCaseFile& parsed, const ChangeExplanation& found) {
  Report defects = Report::array(), sensors = Report::array();
  const auto& kinds = parsed.structure->parsed.damage.kinds;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    defects.push_back(defect_json(kinds[k], parsed.structure->causes.is_mass[k], found.defects[k]));
  const auto add = [&](const std::vector<std::string>& names, const std::vector<double>& list) {
    for (std::size_t i = 0; i < list.size(); ++i)
      sensors.push_back({{"name", names[i]}, {"probability", list[i]}});
  };
  add(parsed.series.feature_names, found.feature_faults);
  add(parsed.series.covariate_names, found.covariate_faults);
  return {{"probability_damage", found.damage},
          {"probability_added_mass", found.mass},
          {"probability_sensor_fault", found.sensor},
          {"probability_other", found.other},
          {"sds_from_damage", finite(found.distance_to_damage)},
          {"defects", defects},
          {"sensor_faults", sensors}};
}

std::string rounded_text(double x) {
  return significant(x, 3);
}

std::string between(const Report& interval, const std::string& unit) {
  const auto at = [&](const char* key) { return rounded_text(interval.at(key).get<double>()); };
  return at("q50") + (unit.empty() ? "" : " " + unit) + " (90 % interval " + at("q5") + " to " +
         at("q95") + (unit.empty() ? ")" : " " + unit + ")");
}

/// Sentence on location and severity of a kind of defect, if it is the cause.
std::string defect_in_words(const Report& defect) {
  const Report& places = defect.at("places");
  if (places.empty()) return "";
  std::string out = "If the cause is " + defect.at("name").get<std::string>() + ": ";
  const Report& first = places.front();
  const bool beam = defect.at("site") == "beam";
  if (!beam)
    out += "in " + defect.at("site").get<std::string>() + " " +
           first.at("name").get<std::string>() + " with probability " +
           percent(first.at("probability").get<double>());
  if (first.contains("at")) out += (beam ? "at " : ", at ") + between(first.at("at"), "m");
  if (defect.contains("severity"))
    out += "; " + defect.at("severity_name").get<std::string>() + " " +
           between(defect.at("severity"), defect.at("severity_unit").get<std::string>());
  return out + ".";
}

}  // namespace

std::vector<ChangeExplanation> explanations(const MonitorCaseFile& parsed, const Monitor& monitor,
                                            int threads) {
  std::vector<ChangeExplanation> out;
  if (!parsed.structure || monitor.alarms().empty()) return out;
  const auto& damage = parsed.structure->parsed.damage;
  const auto paths =
      identification::monitoring::defect_paths(damage, parsed.structure->modes, threads);
  auto options = parsed.structure->causes;
  const auto& baseline = monitor.baseline();
  options.residual_sd = baseline.residual_sd;
  options.covariate_sd = Eigen::VectorXd::Zero(parsed.series.covariate_count());
  for (int i = 0; i < baseline.scaling.count(); ++i)
    options.covariate_sd[baseline.scaling.used()[index(i)]] = baseline.scaling.sd(i);
  for (const auto& alarm : monitor.alarms())
    out.push_back(
        explain_change(alarm.likelihood, alarm.covariate_slopes, damage.kinds, paths, options));
  return out;
}

void add_explanations(const MonitorCaseFile& parsed,
                      const std::vector<ChangeExplanation>& explained, Report& summary) {
  if (!parsed.structure) return;
  Report& monitor = summary["monitor"];
  for (std::size_t i = 0; i < explained.size(); ++i)
    monitor["alarms"][i]["explanation"] = explanation_json(parsed, explained[i]);
  if (explained.empty()) {
    monitor["probability_damage"] = monitor["probability_other"] = nullptr;
    return;
  }
  // Probability of at least one change caused by damage, and of at least one with another cause.
  double no_damage = 1.0, no_other = 1.0;
  for (std::size_t i = 0; i < explained.size(); ++i) {
    const double changed = monitor["alarms"][i]["probability_changed"].get<double>();
    no_damage *= 1.0 - changed * explained[i].damage;
    no_other *= 1.0 - changed * (1.0 - explained[i].damage);
  }
  monitor["probability_damage"] = 1.0 - no_damage;
  monitor["probability_other"] = 1.0 - no_other;
  // The first kind of defect that is damage, as in damage runs.
  const auto& is_mass = parsed.structure->causes.is_mass;
  const auto k = static_cast<std::size_t>(std::ranges::find(is_mass, false) - is_mass.begin());
  const ChangeExplanation& last = explained.back();
  std::vector<double> overall(last.defects[k].by_cell.size(), 0.0);
  for (std::size_t i = 0; i < explained.size(); ++i) {
    const double changed = monitor["alarms"][i]["probability_changed"].get<double>();
    for (std::size_t cell = 0; cell < overall.size(); ++cell)
      overall[cell] =
          1.0 - (1.0 - overall[cell]) * (1.0 - changed * explained[i].defects[k].probability *
                                                   explained[i].defects[k].by_cell[cell]);
  }
  summary["damage"] = {{"inclusion_by_element",
                        {{"overall", overall}, {"given_count", {{"1", last.defects[k].by_cell}}}}}};
}

std::vector<std::string> explanation_in_words(const Report& alarm) {
  if (!alarm.contains("explanation")) return {};
  const Report& e = alarm.at("explanation");
  const auto share = [&](const char* key) { return percent(e.at(key).get<double>()); };
  std::vector<std::string> out = {
      "Cause: damage " + share("probability_damage") + ", an added mass " +
      share("probability_added_mass") + ", a sensor fault " + share("probability_sensor_fault") +
      ", none of these " + share("probability_other") + ". The shift differs by " +
      rounded_text(e.at("sds_from_damage").is_null() ? NAN
                                                     : e.at("sds_from_damage").get<double>()) +
      " of its standard deviations from the nearest shift that damage can cause."};
  for (const Report& defect : e.at("defects"))
    if (defect.at("probability").get<double>() >= 0.05)
      if (const std::string text = defect_in_words(defect); !text.empty()) out.push_back(text);
  std::string sensors;
  for (const Report& sensor : e.at("sensor_faults"))
    if (sensor.at("probability").get<double>() >= 0.05)
      sensors += (sensors.empty() ? "" : ", ") + sensor.at("name").get<std::string>() + " " +
                 percent(sensor.at("probability").get<double>());
  if (!sensors.empty()) out.push_back("Faulty sensor: " + sensors + ".");
  return out;
}

}  // namespace wheeltap::apps
