#include "apps/cases/damage_data.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "apps/cases/damage_parts.hpp"
#include "apps/cases/modal_data_case.hpp"
#include "apps/cases/records/csv_frequencies.hpp"
#include "apps/cases/syntax/case_remedies.hpp"
#include "base/constants.hpp"
#include "base/number.hpp"
#include "identification/structural/damage/baseline.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

Pointer data_key(const char* place) {
  return Pointer(place);
}
std::string data_number(double x) {
  return Json(x).dump();
}

FrequencyData parse_data(const CaseFile& file, const Pointer& where) {
  const Json& d = file.json.at(where);
  FrequencyData data;
  if (d.contains("modes") && d["modes"].is_array())
    file.refuse(where / "modes", "a list of modes is allowed with \"from\" only");
  if (d.contains("model_modes"))
    file.refuse(where / "model_modes", "is allowed with \"from\" only");
  if (d.contains("frequencies") && d.contains("file")) {
    file.refuse(where / "file", "data have either \"frequencies\" or a \"file\", not both");
  }
  if (d.contains("cov") && d.contains("sd")) {
    file.refuse(where / "sd", "noise is either \"cov\" or \"sd\", not both");
  }
  for (const char* key : {"columns", "row"}) {
    if (d.contains(key) && !d.contains("file"))
      file.refuse(where / key, "is allowed with \"file\" only");
  }
  if (d.contains("row") && !d.contains("columns")) {
    file.refuse(where / "row", "is allowed with \"columns\" only");
  }
  if (d.contains("frequencies")) {
    for (const Json& f : d["frequencies"]) {
      data.frequencies_hz.push_back(f.is_null() ? kNaN : f.get<double>());
    }
    data.origin = "given in the case";
  } else if (d.contains("file")) {
    FrequencyCells cells;
    if (d.contains("row")) cells.row = d["row"].get<int>();
    for (const Json& c : d.value("columns", Json::array())) {
      cells.columns.push_back(c.is_string() ? c.get<std::string>() : c.dump());
    }
    FrequencyTable table = read_frequency_csv(file.resolve(d["file"].get<std::string>()), cells);
    data.frequencies_hz = std::move(table.frequencies_hz);
    if (!d.contains("cov") && !d.contains("sd")) data.sd_hz = std::move(table.sd_hz);
    data.origin = "from " + d["file"].get<std::string>() +
                  (d.contains("columns") ? ", row " + std::to_string(cells.row.value_or(1)) : "");
  }
  if (!data.frequencies_hz.empty() && data.measured() == 0) {
    file.refuse(where, "no frequency is given");
  }
  double previous = 0.0;
  for (std::size_t i = 0; i < data.frequencies_hz.size(); ++i) {
    const double f = data.frequencies_hz[i];
    if (std::isnan(f)) continue;
    if (f < previous) {
      file.refuse(d.contains("frequencies") ? where / "frequencies" / i : where / "file",
                  "frequencies must increase; mode " + std::to_string(i + 1) + " at " +
                      data_number(f) + " Hz is below the previous frequency" +
                      increasing(data.frequencies_hz));
    }
    previous = f;
  }
  if (d.contains("cov")) {
    if (d["cov"].is_number()) {
      data.cv = d["cov"].get<double>();
      for (const double f : data.frequencies_hz) data.sd_hz.push_back(*data.cv * f);
    } else {
      data.cv_prior =
          bounded_prior(file, where / "cov", 0.0, kInfinity, "a coefficient of variation is > 0");
    }
  }
  if (d.contains("discrepancy")) {
    if (d["discrepancy"].contains("shape"))
      file.refuse(where / "discrepancy" / "shape", "is allowed with \"shapes\" only");
    if (d["discrepancy"].contains("mixing"))
      file.refuse(where / "discrepancy" / "mixing",
                  "is allowed with \"shapes\" or a baseline only");
    if (!d["discrepancy"].contains("cov"))
      file.refuse(where / "discrepancy" / "cov", "is missing: a coefficient of variation");
    data.discrepancy_cv = d["discrepancy"]["cov"].get<double>();
  }
  if (d.contains("sd")) {
    const Json& sd = d["sd"];
    if (!data.frequencies_hz.empty() && sd.size() != data.frequencies_hz.size()) {
      file.refuse(where / "sd", "must have one value per mode: " + std::to_string(data.modes()) +
                                    ", has " + std::to_string(sd.size()));
    }
    for (const Json& s : sd) data.sd_hz.push_back(s.is_null() ? kNaN : s.get<double>());
  }
  for (std::size_t i = 0; i < data.frequencies_hz.size(); ++i) {
    if (!data.sd_hz.empty() && std::isnan(data.sd_hz[i]) && !std::isnan(data.frequencies_hz[i])) {
      file.refuse(where,
                  "mode " + std::to_string(i + 1) + " has a frequency but no standard deviation");
    }
  }
  return data;
}

// The frequencies of measured modes.
FrequencyData frequencies_of(const ModalData& modal, const Json& data) {
  FrequencyData out;
  out.frequencies_hz = modal.frequencies_hz;
  for (Eigen::Index i = 0; i < modal.covariance.rows(); ++i)
    out.sd_hz.push_back(std::isnan(out.frequencies_hz[static_cast<std::size_t>(i)])
                            ? kNaN
                            : std::sqrt(modal.covariance(i, i)));
  if (data.contains("cov") && data["cov"].is_number()) out.cv = data["cov"].get<double>();
  out.cv_prior = modal.cov_prior;
  out.discrepancy_cv = modal.discrepancy.value;
  out.origin = modal.origin;
  return out;
}

}  // namespace

void take_data(const CaseFile& f, DamageCase& out) {
  const Json& data = f.json.at("data");
  const bool shapes = std::ranges::any_of(
      std::initializer_list<const char*>{"sensors", "shapes", "shape_sd", "shape_covariance",
                                         "covariance", "from", "repeats"},
      [&](const char* key) { return data.contains(key); });
  const bool inferred =
      data.contains("discrepancy") && data["discrepancy"].is_object() &&
      std::ranges::any_of(data["discrepancy"], [](const Json& d) { return d.is_object(); });
  if (!shapes && !inferred) {
    out.data = parse_data(f, data_key("/data"));
    return;
  }
  if (out.emulator && data.contains("repeats"))
    f.refuse(data_key("/predictor"),
             "\"repeats\" have errors that are correlated between modes, which an emulator does "
             "not support: use "
             "\"fe\" here");
  if (out.emulator)
    f.refuse(data_key("/predictor"),
             "an emulator predicts frequencies, not shapes: use \"fe\" here");
  AnyStructure solved;
  try {
    out.measured.set_modal(ModalData{});  // if modes are set, the model is solved as a structure
    solved = out.solved_structure();
  } catch (const std::invalid_argument& error) {
    f.refuse(data_key(out.structure ? "/structure" : "/beam"), error.what());
  }
  out.measured.set_modal(parse_modal_data(f, data_key("/data"), solved));
  if (out.modal()->predict > 0)
    f.refuse(data_key("/data/predict"), "is allowed with \"kind\": \"update\" only");
  out.data = frequencies_of(*out.modal(), data);
}

void take_baseline(const CaseFile& f, DamageCase& out) {
  const Pointer where = data_key("/baseline/data");
  for (const auto& [key, ignored] : f.json.at(where).items())
    if (key != "frequencies" && key != "cov" && key != "sd" && key != "file" && key != "columns" &&
        key != "row")
      f.refuse(where / key, "is not supported: a baseline has frequencies and their noise only");
  const FrequencyData baseline = parse_data(f, where);
  if (baseline.frequencies_hz.empty())
    f.refuse(where / "frequencies",
             "is missing: must be the frequencies of the undamaged structure");
  if (baseline.cv_prior) f.refuse(where / "cov", "must be a number");
  if (baseline.sd_hz.empty())
    f.refuse(where / "cov",
             "is missing: give the uncertainty of the frequencies, \"cov\" or \"sd\"; for example, "
             "write \"cov\": 0.005 for 0.5 % of each frequency");
  try {
    compare_with_baseline(out, baseline);
  } catch (const InvalidInput& error) {
    f.refuse(where, error.what());
  }
}

// Simulates shapes of the truth if there are sensors.
void take_true_shapes(const CaseFile& f, DamageCase& out) {
  ModalData modal = *out.modal();
  const Eigen::Index n = out.data.modes();
  modal.frequencies_hz = out.data.frequencies_hz;
  modal.simulated = true;
  modal.origin = out.data.origin;
  if (!modal.cov_prior) {
    modal.covariance = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      modal.covariance(i, i) = std::pow(out.data.sd_hz[static_cast<std::size_t>(i)], 2);
  }
  if (!modal.sensors.empty()) {
    const double sd = out.simulation->shape_sd;
    if (!(sd > 0.0))
      f.refuse(data_key("/data/shape_sd"),
               "is missing: give the standard deviation of the simulated shapes, or leave out "
               "\"sensors\"");
    modal.shapes = simulated_shapes(out, static_cast<int>(n), out.simulation->seed);
    const auto sensors = static_cast<Eigen::Index>(modal.sensors.size());
    const double unit = modal.shape_sd_prior ? 1.0 : sd * sd;
    modal.shape_covariances.assign(static_cast<std::size_t>(n),
                                   unit * Eigen::MatrixXd::Identity(sensors, sensors));
  }
  out.measured.set_modal(std::move(modal));
}

}  // namespace wheeltap::apps
