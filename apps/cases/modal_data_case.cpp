#include "apps/cases/modal_data_case.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "apps/cases/damage_parts.hpp"
#include "apps/cases/records/csv_frequencies.hpp"
#include "apps/cases/records/modes_as_data.hpp"
#include "apps/cases/records/repeats_case.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "apps/cases/syntax/case_remedies.hpp"
#include "apps/nearest.hpp"
#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::string count_of(std::size_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

class ModalDataParser {
 public:
  ModalDataParser(const CaseFile& file, const Pointer& where, const AnyStructure& structure,
                  const SimulatedModes* simulated = nullptr)
      : file_(file),
        where_(where),
        json_(file.json.at(where)),
        structure_(structure),
        simulated_(simulated) {
    try {
      if (const auto* members = std::get_if<fem::Structure>(&structure)) mesh_.emplace(*members);
      names_ = (mesh_ ? mesh_->discretisation() : discretise(structure)).names;
    } catch (const fem::InvalidStructure& error) {
      refuse_structure(file, structure, error);
    }
  }

  ModalData parse() {
    if (has("repeats")) {
      take_repeats();
      parse_sensors();
      parse_shapes();
      parse_shape_scatter();
    } else if (has("from")) {
      take_from();
    } else {
      if (has("modes") && json_.at("modes").is_array())
        file_.refuse(where_ / "modes", "a list of modes is allowed with \"from\" only");
      if (has("model_modes")) file_.refuse(where_ / "model_modes", "is allowed with \"from\" only");
      parse_frequencies();
      parse_sensors();
      parse_shapes();
      parse_frequency_scatter();
      parse_shape_scatter();
    }
    if (has("discrepancy")) {
      out_.discrepancy = scatter("cov");
      out_.shape_discrepancy = scatter("shape");
      out_.mixing = scatter("mixing");
      out_.stiffness_discrepancy = scatter("stiffness");
      if (!out_.mixing.none() && out_.discrepancy.none())
        file_.refuse(where_ / "discrepancy" / "mixing", "is relative to \"cov\", which is missing");
      if (!out_.mixing.none() && !out_.stiffness_discrepancy.none())
        file_.refuse(where_ / "discrepancy" / "mixing",
                     "is not allowed with \"stiffness\", whose errors already mix the modes");
    }
    if (has("doubt")) out_.doubt = json_.at("doubt").get<double>();
    if (has("predict")) {
      const Json& predict = json_.at("predict");
      if (predict.is_array()) out_.held_out_hz = numbers(predict);
      out_.predict = predict.is_array() ? static_cast<int>(predict.size()) : predict.get<int>();
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
  static std::vector<double> numbers(const Json& list) {
    std::vector<double> out;
    for (const Json& x : list) out.push_back(x.is_null() ? kNaN : x.get<double>());
    return out;
  }

  // ---- modes.json as data

  void take_from() {
    const TakenModes taken = take_modes(file_, where_);
    std::vector<Index> channels;
    const std::size_t all = taken.file.sensors.size();
    if (has("sensors")) {
      const Json& list = json_.at("sensors");
      if (list.size() != all)
        file_.refuse(where_ / "sensors", "must have one sensor for each of the " +
                                             count_of(all, "channel") +
                                             " of \"from\" (null "
                                             "omits a channel), has " +
                                             std::to_string(list.size()));
      for (std::size_t i = 0; i < all; ++i) {
        if (list[i].is_null()) continue;
        const Pointer at = where_ / "sensors" / i;
        out_.sensors.push_back(sensor(at));
        if (out_.sensors.back().motion.empty())
          file_.refuse(at, "does not move: a support fixes it");
        channels.push_back(static_cast<Index>(i));
      }
    } else {
      if (file_.json.contains("beam"))
        file_.refuse(where_ / "sensors",
                     "is missing: state the position on the beam of each of the " +
                         count_of(all, "channel") + " of \"from\", [{\"at\": x}, ...]");
      const CaseFile beside = taken.sensors_as_case();
      const ModalDataParser places(beside, Pointer(), structure_);
      for (std::size_t i = 0; i < all; ++i) {
        out_.sensors.push_back(places.measured(i, taken.file.sensors[i]));
        channels.push_back(static_cast<Index>(i));
      }
    }
    fill(taken, channels, out_);
  }

  // The sensor of a channel of a modes.json: a node with a signed direction or with angles.
  Sensor measured(std::size_t i, const MeasuredSensor& s) const {
    const Pointer at = Pointer("/sensors") / i;
    if (s.node.empty())
      file_.refuse(at / "node", "is missing: state its position in \"sensors\" of the case");
    if (!s.azimuth && !s.elevation) {
      const bool numbered_mass = std::holds_alternative<fem::LumpedChain>(structure_) &&
                                 s.node.find_first_not_of("0123456789") == std::string::npos;
      Sensor out = numbered_mass ? numbered(at / "node", "mass", "masses") : sensor(at);
      if (numbered_mass && s.direction.starts_with('-')) turn_round(out);
      if (out.motion.empty()) file_.refuse(at, "does not move: a support fixes it");
      return out;
    }
    constexpr double kDegree = std::numbers::pi / 180.0;
    const double a = kDegree * s.azimuth.value_or(0.0), e = kDegree * s.elevation.value_or(0.0);
    const double along[] = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
    static const char* const names[] = {"x", "y", "z"};
    std::map<int, double> sum;
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::abs(along[k]) < 1e-9) continue;
      if (mesh_ && k == 2 && mesh_->structure().dimension == 2) {
        if (std::abs(along[k]) > 0.02)
          file_.refuse(at, "points out of the plane of this structure");
        continue;
      }
      CaseFile one = file_;
      one.json.at(at)["direction"] = names[k];
      const ModalDataParser part(one, where_, structure_);
      const Sensor found = part.sensor(at);
      for (std::size_t d = 0; d < found.motion.dofs.size(); ++d)
        sum[found.motion.dofs[d]] += along[k] * found.motion.coefficients[d];
    }
    Sensor out{.name = s.node + ", azimuth " + Json(s.azimuth.value_or(0.0)).dump() +
                       ", elevation " + Json(s.elevation.value_or(0.0)).dump(),
               .motion = {}};
    for (const auto& [dof, coefficient] : sum) {
      out.motion.dofs.push_back(dof);
      out.motion.coefficients.push_back(coefficient);
    }
    if (out.motion.empty()) file_.refuse(at, "does not move: a support fixes it");
    return out;
  }

  static void turn_round(Sensor& sensor) {
    for (double& c : sensor.motion.coefficients) c = -c;
  }

  // ---- frequencies

  void take_repeats() {
    const auto tests =
        std::make_shared<const RepeatedTests>(parse_repeats(file_, where_, shape_rows().empty()));
    const Json& repeats = json_.at("repeats");
    out_.frequencies_hz = tests->frequencies_hz;
    out_.covariance = tests->covariance_hz2;
    out_.origin =
        in_words(*tests, repeats.is_object() ? "from " + repeats.at("file").get<std::string>()
                                             : "given in the case");
    out_.repeats = tests;
  }

  void parse_frequencies() {
    if (has("frequencies") && has("file"))
      file_.refuse(where_ / "file", "data have either \"frequencies\" or a \"file\", not both");
    for (const char* key : {"columns", "row"})
      if (has(key) && !has("file")) file_.refuse(where_ / key, "is allowed with \"file\" only");
    out_.origin = "given in the case";
    if (has("frequencies")) out_.frequencies_hz = numbers(json_.at("frequencies"));
    if (has("file")) {
      FrequencyCells cells;
      if (has("row")) cells.row = json_["row"].get<int>();
      for (const Json& c : json_.value("columns", Json::array()))
        cells.columns.push_back(text_or_number(c));
      FrequencyTable table =
          read_frequency_csv(file_.resolve(json_["file"].get<std::string>()), cells);
      out_.frequencies_hz = std::move(table.frequencies_hz);
      from_file_ = std::move(table.sd_hz);
      out_.origin = "from " + json_["file"].get<std::string>();
    }
    if (simulated_ != nullptr) out_.frequencies_hz = simulated_->frequencies_hz;
    if (!shape_rows().empty()) return;
    double before = 0.0;
    for (std::size_t i = 0; i < out_.frequencies_hz.size(); ++i) {
      const double f = out_.frequencies_hz[i];
      if (std::isnan(f)) continue;
      if (f < before)
        file_.refuse(has("file") ? where_ / "file" : where_ / "frequencies" / i,
                     simulated_value(f) +
                         "without shapes, frequencies must increase, beginning with the lowest "
                         "elastic mode; write null for a mode not measured" +
                         increasing(out_.frequencies_hz));
      before = f;
    }
  }

  void parse_frequency_scatter() {
    int given = 0;
    for (const char* key : {"cov", "sd", "covariance"}) given += has(key);
    if (given > 1) file_.refuse(where_, "give only one of \"cov\", \"sd\" and \"covariance\"");
    const auto n = static_cast<Index>(out_.frequencies_hz.size());
    std::vector<double> sd = from_file_;
    Pointer at = where_ / "cov";
    if (has("cov") && json_["cov"].is_object()) {
      out_.cov_prior =
          bounded_prior(file_, at, 0.0, kInfinity, "a coefficient of variation is > 0");
      return;
    }
    if (has("cov") || (given == 0 && simulated_ != nullptr)) {
      const double cov = has("cov") ? json_["cov"].get<double>() : simulated_->cov;
      sd.clear();
      for (const double f : out_.frequencies_hz) sd.push_back(cov * f);
    }
    if (has("sd")) {
      at = where_ / "sd";
      sd = numbers(json_["sd"]);
    }
    if (has("covariance")) {
      at = where_ / "covariance";
      out_.covariance = square(at, n);
    } else if (!sd.empty()) {
      if (static_cast<Index>(sd.size()) != n)
        file_.refuse(at, "must have one value per mode: " + std::to_string(n) + ", has " +
                             std::to_string(sd.size()));
      out_.covariance = MatrixXd::Zero(n, n);
      for (Index i = 0; i < n; ++i) {
        const double s = sd[static_cast<std::size_t>(i)];
        if (std::isnan(s) && !std::isnan(out_.frequencies_hz[static_cast<std::size_t>(i)]))
          file_.refuse(
              at / static_cast<std::size_t>(i),
              "mode " + std::to_string(i + 1) + " has a frequency but no standard deviation");
        out_.covariance(i, i) = std::isnan(s) ? 0.0 : s * s;
      }
      return;
    } else if (n > 0) {
      file_.refuse(where_ / "cov",
                   "is missing: give the uncertainty of the frequencies, \"cov\", \"sd\" or "
                   "\"covariance\"; for example, write \"cov\": 0.005 for 0.5 % of each frequency");
    }
    if (!has("covariance")) return;
    std::vector<Index> measured;
    for (Index i = 0; i < n; ++i)
      if (!std::isnan(out_.frequencies_hz[static_cast<std::size_t>(i)])) measured.push_back(i);
    require_definite(at, out_.covariance(measured, measured));
  }

  MatrixXd square(const Pointer& at, Index n) const {
    const Json& rows = file_.json.at(at);
    if (static_cast<Index>(rows.size()) != n)
      file_.refuse(at, "must be " + std::to_string(n) + " x " + std::to_string(n) + ", has " +
                           count_of(rows.size(), "row"));
    MatrixXd out(n, n);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (static_cast<Index>(rows[i].size()) != n)
        file_.refuse(at / i, "must have " + count_of(static_cast<std::size_t>(n), "number") +
                                 ", has " + std::to_string(rows[i].size()));
      for (std::size_t j = 0; j < rows[i].size(); ++j)
        out(static_cast<Index>(i), static_cast<Index>(j)) = rows[i][j].get<double>();
    }
    return out;
  }

  void require_definite(const Pointer& at, const MatrixXd& c) const {
    for (Index i = 0; i < c.rows(); ++i)
      for (Index j = 0; j < i; ++j)
        if (std::abs(c(i, j) - c(j, i)) > 1e-8 * c.cwiseAbs().maxCoeff())
          file_.refuse(at / static_cast<std::size_t>(i) / static_cast<std::size_t>(j),
                       "is not symmetric: the transposed entry is " + Json(c(j, i)).dump());
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(c, Eigen::EigenvaluesOnly);
    if (c.rows() > 0 && !(solver.eigenvalues()[0] > 1e-14 * c.diagonal().cwiseAbs().maxCoeff()))
      file_.refuse(at, "is not positive definite: its smallest eigenvalue is " +
                           Json(solver.eigenvalues()[0]).dump());
  }

  // ---- sensors

  void parse_sensors() {
    if (!has("sensors")) return;
    for (std::size_t i = 0; i < json_.at("sensors").size(); ++i) {
      const Pointer at = where_ / "sensors" / i;
      out_.sensors.push_back(sensor(at));
      if (out_.sensors.back().motion.empty()) file_.refuse(at, "does not move: a support fixes it");
    }
  }

  // Parses {"at": x} and a direction: the deflection (default) or the rotation.
  Sensor on_beam(const Pointer& at) const {
    const Json& s = file_.json.at(at);
    for (const char* key : {"node", "member", "mass", "dof"})
      if (s.contains(key))
        file_.refuse(at / key, "is allowed with a structure only; a beam has \"at\"");
    if (!s.contains("at")) file_.refuse(at / "at", "is missing: metres from the left end");
    const std::string along = s.value("direction", "deflection");
    if (along != "deflection" && along != "rotation")
      file_.refuse(at / "direction", "must be \"deflection\" or \"rotation\" on a beam");
    const double x = s.at("at").get<double>();
    double left = x;
    int member = 0;
    while (member + 1 < static_cast<int>(mesh_->structure().members.size()) &&
           left >= mesh_->member_length(member))
      left -= mesh_->member_length(member++);
    if (left > mesh_->member_length(member) * (1.0 + 1e-9))
      file_.refuse(at / "at", "is outside the beam");
    return {Json(x).dump() + " m" + (along == "rotation" ? ", rotation" : ""),
            mesh_->motion(member, std::min(left, mesh_->member_length(member)),
                          along == "rotation" ? fem::Direction::rz : fem::Direction::y)};
  }

  Sensor sensor(const Pointer& at) const {
    if (file_.json.contains("beam")) return on_beam(at);
    const Json& s = file_.json.at(at);
    int places = 0;
    for (const char* key : {"node", "member", "mass", "dof"}) places += s.contains(key);
    if (places != 1)
      file_.refuse(at, "must have one of \"node\", \"member\", \"mass\" and \"dof\"");
    if (s.contains("at") != s.contains("member"))
      file_.refuse(at, "\"member\" and \"at\" must be given together");
    const bool chain = std::holds_alternative<fem::LumpedChain>(structure_);
    const bool matrices = std::holds_alternative<fem::MatrixStructure>(structure_);
    if (s.contains("mass")) {
      if (!chain) file_.refuse(at / "mass", "is allowed with a chain only");
      return numbered(at / "mass", "mass", "masses");
    }
    if (s.contains("dof")) {
      if (!matrices) file_.refuse(at / "dof", "is allowed with \"matrices\" only");
      return numbered(at / "dof", "degree of freedom", "degrees of freedom");
    }
    if (s.contains("member")) {
      if (!mesh_) file_.refuse(at / "member", "this structure has no members");
      return on_member(at, direction(at));
    }
    if (!mesh_) return named(at, chain);
    const int node = find(at / "node", mesh_->structure().nodes, "node");
    const Along along = direction(at);
    Sensor out{s["node"].get<std::string>() + ", " + along.name, mesh_->motion(node, along.which)};
    if (along.backwards) turn_round(out);
    return out;
  }

  Sensor numbered(const Pointer& at, const std::string& one, const std::string& many) const {
    const Json& given = file_.json.at(at);
    const int number =
        given.is_string() ? std::atoi(given.get<std::string>().c_str()) : given.get<int>();
    if (number < 1 || number > static_cast<int>(names_.size()))
      file_.refuse(at,
                   "unknown " + one + ": there are " + std::to_string(names_.size()) + " " + many);
    const fem::DofName& name = names_[static_cast<std::size_t>(number) - 1];
    return {name.place + (name.direction.empty() ? "" : ", " + name.direction),
            {.dofs = {number - 1}, .coefficients = {1.0}}};
  }

  // Finds the degree of freedom with a given location and direction in the table, or "mass 1".
  Sensor named(const Pointer& at, bool chain) const {
    const auto place = file_.json.at(at / "node").get<std::string>();
    std::string along = file_.json.at(at).value("direction", chain ? "x" : "");
    const bool backwards = along.starts_with('-');
    if (backwards) along.erase(0, 1);
    std::vector<std::string> places, there;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i].place == place && names_[i].direction == along)
        return {place + (along.empty() ? ""
                         : backwards   ? ", -" + along
                                       : ", " + along),
                {.dofs = {static_cast<int>(i)}, .coefficients = {backwards ? -1.0 : 1.0}}};
      if (names_[i].place == place) there.push_back(names_[i].direction);
      places.push_back(names_[i].place);
    }
    if (!there.empty())
      file_.refuse(at / "direction", "unknown direction: " + place + " has " + listed(there));
    file_.refuse(at / "node",
                 "no degree of freedom belongs to this node" + did_you_mean(place, places));
  }

  template <class List>
  int find(const Pointer& at, const List& list, const std::string& what) const {
    const auto name = file_.json.at(at).get<std::string>();
    std::vector<std::string> names;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i].name == name) return static_cast<int>(i);
      names.push_back(list[i].name);
    }
    file_.refuse(at, "no " + what + " has this name" + did_you_mean(name, names));
  }

  struct Along {
    std::string name;
    fem::Direction which;
    bool backwards = false;  // "-x"
  };
  Along direction(const Pointer& at) const {
    const bool space = mesh_->structure().dimension == 3;
    const std::string words = std::string("must be a direction: ") +
                              (space ? "x, y, z, rx, ry or rz, in a structure of dimension 3"
                                     : "x, y or rotation, in a structure of dimension 2");
    if (!file_.json.at(at).contains("direction"))
      file_.refuse(at / "direction", "is missing: " + words);
    const auto name = file_.json.at(at / "direction").get<std::string>();
    static const std::vector<std::string> names = {"x", "y", "z", "rx", "ry", "rz"};
    const bool backwards = name.starts_with('-');
    const std::string forwards = name.substr(backwards ? 1 : 0);
    const std::string global = forwards == "rotation" && !space ? "rz" : forwards;
    const auto found = std::ranges::find(names, global);
    if (found == names.end() || (!space && global != "x" && global != "y" && global != "rz"))
      file_.refuse(at / "direction", words);
    return {name, static_cast<fem::Direction>(found - names.begin()), backwards};
  }

  Sensor on_member(const Pointer& at, const Along& along) const {
    const int member = find(at / "member", mesh_->structure().members, "member");
    const double s = file_.json.at(at / "at").get<double>();
    const double length = mesh_->member_length(member);
    if (s > length * (1.0 + 1e-9))
      file_.refuse(at / "at", "is outside the member, which is " + Json(length).dump() + " m long");
    Sensor out{file_.json.at(at / "member").get<std::string>() + " at " + Json(s).dump() + " m, " +
                   along.name,
               mesh_->motion(member, std::min(s, length), along.which)};
    if (along.backwards) turn_round(out);
    return out;
  }

  // ---- shapes

  [[nodiscard]] std::vector<std::vector<double>> shape_rows() const {
    std::vector<std::vector<double>> out;
    if (simulated_ != nullptr) {
      for (const auto& row : simulated_->shapes.rowwise()) out.emplace_back(row.begin(), row.end());
    } else if (has("shapes")) {
      for (const Json& row : json_.at("shapes")) out.push_back(numbers(row));
    }
    return out;
  }

  /// Formats a simulated value as CaseFile::refuse formats the values of a case.
  [[nodiscard]] std::string simulated_value(const Json& value) const {
    return simulated_ == nullptr ? std::string() : value.dump() + ": ";
  }

  void parse_shapes() {
    const std::vector<std::vector<double>> rows = shape_rows();
    if (rows.empty()) {
      for (const char* key : {"shape_covariance"})
        if (has(key)) file_.refuse(where_ / key, "is allowed with \"shapes\" only");
      return;
    }
    if (!has("sensors"))
      file_.refuse(where_ / "sensors", "is missing: \"shapes\" have one number per sensor");
    if (out_.frequencies_hz.empty()) out_.frequencies_hz.assign(rows.size(), kNaN);
    if (rows.size() != out_.frequencies_hz.size())
      file_.refuse(where_ / "shapes",
                   "must have one shape per frequency (null if not measured): " +
                       count_of(out_.frequencies_hz.size(), "frequency").append(", has ") +
                       count_of(rows.size(), "shape"));
    const std::size_t sensors = out_.sensors.size();
    out_.shapes.resize(static_cast<Index>(rows.size()), static_cast<Index>(sensors));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Pointer at = where_ / "shapes" / i;
      if (rows[i].size() != sensors)
        file_.refuse(at, "must have one number per sensor: " + std::to_string(sensors) + ", has " +
                             std::to_string(rows[i].size()));
      const std::vector<double>& values = rows[i];
      std::size_t measured = 0;
      double largest = 0.0;
      for (std::size_t s = 0; s < sensors; ++s) {
        out_.shapes(static_cast<Index>(i), static_cast<Index>(s)) = values[s];
        if (std::isnan(values[s])) continue;
        ++measured;
        largest = std::max(largest, std::abs(values[s]));
      }
      if (measured == 1)
        file_.refuse(at, simulated_value(values) +
                             "has one number only: a mode shape needs at least two numbers, "
                             "because the scale of a mode shape is unknown");
      if (measured > 0 && largest == 0.0) file_.refuse(at, "has only zeros");
      if (measured == 0 && std::isnan(out_.frequencies_hz[i]))
        file_.refuse(at, "mode " + std::to_string(i + 1) + " has neither frequency nor shape");
    }
  }

  void parse_shape_scatter() {
    const auto sensors = static_cast<Index>(out_.sensors.size());
    const auto modes = static_cast<std::size_t>(out_.shapes.rows());
    if (has("shape_sd") && has("shape_covariance"))
      file_.refuse(where_ / "shape_covariance", "give either this key or \"shape_sd\"");
    const Pointer at = where_ / "shape_sd";
    if (has("shape_sd") && json_["shape_sd"].is_object()) {
      out_.shape_sd_prior = bounded_prior(file_, at, 0.0, kInfinity, "an sd is > 0");
      out_.shape_covariances.assign(modes, MatrixXd::Identity(sensors, sensors));
    } else if (has("shape_sd") && json_["shape_sd"].is_array()) {
      if (json_["shape_sd"].size() != modes)
        file_.refuse(at, "must have one row per shape: " + std::to_string(modes) + ", has " +
                             std::to_string(json_["shape_sd"].size()));
      for (std::size_t i = 0; i < modes; ++i) {
        const std::vector<double> sd = numbers(json_["shape_sd"][i]);
        if (static_cast<Index>(sd.size()) != sensors)
          file_.refuse(at / i, "must have one number per sensor: " + std::to_string(sensors) +
                                   ", has " + std::to_string(sd.size()));
        MatrixXd c = MatrixXd::Zero(sensors, sensors);
        for (Index s = 0; s < sensors; ++s) {
          const double one = sd[static_cast<std::size_t>(s)];
          if (std::isnan(one) && !std::isnan(out_.shapes(static_cast<Index>(i), s)))
            file_.refuse(at / i / static_cast<std::size_t>(s),
                         "is missing: this entry was measured");
          c(s, s) = std::isnan(one) ? 0.0 : one * one;
        }
        out_.shape_covariances.push_back(std::move(c));
      }
    } else if (has("shape_sd") || (simulated_ != nullptr && !has("shape_covariance"))) {
      const double sd = has("shape_sd") ? json_["shape_sd"].get<double>() : simulated_->shape_sd;
      out_.shape_covariances.assign(modes, sd * sd * MatrixXd::Identity(sensors, sensors));
    } else if (has("shape_covariance")) {
      const Json& list = json_["shape_covariance"];
      if (list.size() != modes)
        file_.refuse(where_ / "shape_covariance",
                     "must have one matrix per shape: " + std::to_string(modes) + ", has " +
                         std::to_string(list.size()));
      for (std::size_t i = 0; i < modes; ++i) {
        const Pointer here = where_ / "shape_covariance" / i;
        out_.shape_covariances.push_back(square(here, sensors));
        std::vector<Index> measured;
        for (Index s = 0; s < sensors; ++s)
          if (!std::isnan(out_.shapes(static_cast<Index>(i), s))) measured.push_back(s);
        require_definite(here, out_.shape_covariances.back()(measured, measured));
      }
    } else if (modes > 0) {
      file_.refuse(at,
                   "is missing: give the uncertainty of the shapes, \"shape_sd\" or "
                   "\"shape_covariance\"");
    }
  }

  Scatter scatter(const char* key) const {
    const Json& d = json_.at("discrepancy");
    if (!d.contains(key)) return {};
    if (d[key].is_number()) return {.value = d[key].get<double>()};
    return {.value = 0.0,
            .prior = bounded_prior(file_, where_ / "discrepancy" / key, 0.0, kInfinity,
                                   "a discrepancy is > 0")};
  }

  const CaseFile& file_;
  Pointer where_;
  const Json& json_;
  const AnyStructure& structure_;
  const SimulatedModes* simulated_;
  std::optional<fem::Mesh> mesh_;
  std::vector<fem::DofName> names_;
  std::vector<double> from_file_;
  ModalData out_;
};

}  // namespace

void require_shapes_to_doubt(const CaseFile& file, const Pointer& where, bool shapes) {
  if (file.json.at(where).contains("doubt") && !shapes)
    file.refuse(where / "doubt",
                "needs mode shapes: without shapes, the i-th frequency belongs to the i-th mode");
}

ModalData parse_modal_data(const CaseFile& file, const Pointer& where,
                           const AnyStructure& structure, const SimulatedModes* simulated) {
  return ModalDataParser(file, where, structure, simulated).parse();
}

}  // namespace wheeltap::apps
