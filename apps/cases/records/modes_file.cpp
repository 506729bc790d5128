#include "apps/cases/records/modes_file.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace wheeltap::apps {
namespace {

using Eigen::Index;

Report list_of(const Eigen::VectorXd& values) {
  Report list = Report::array();
  for (const double x : values) list.push_back(finite(x));
  return list;
}

class Reader {
 public:
  explicit Reader(const CaseFile& file) : file_(file) {}

  /// Parses a vector. If `gaps` is true, null is NaN; otherwise null is an error.
  [[nodiscard]] Eigen::VectorXd vector(const Pointer& where, Index size, bool gaps = false) const {
    const Json& list = at(where);
    if (!list.is_array() || (size >= 0 && static_cast<Index>(list.size()) != size))
      file_.refuse(where, "must be a list" + (size >= 0 ? " of " + std::to_string(size) + " numbers"
                                                        : std::string(" of numbers")));
    Eigen::VectorXd out(static_cast<Index>(list.size()));
    for (std::size_t i = 0; i < list.size(); ++i) {
      const bool gap = gaps && list[i].is_null();
      if (!gap && !list[i].is_number()) file_.refuse(where / i, "must be a number");
      out[static_cast<Index>(i)] =
          gap ? std::numeric_limits<double>::quiet_NaN() : list[i].get<double>();
    }
    return out;
  }

  [[nodiscard]] Eigen::MatrixXd matrix(const Pointer& where, Index rows, Index columns,
                                       bool gaps = false) const {
    const Json& list = at(where);
    if (!list.is_array() || static_cast<Index>(list.size()) != rows)
      file_.refuse(where, "must be a list of " + std::to_string(rows) + " rows");
    Eigen::MatrixXd out(rows, columns);
    for (Index i = 0; i < rows; ++i)
      out.row(i) = vector(where / static_cast<std::size_t>(i), columns, gaps).transpose();
    return out;
  }

  [[nodiscard]] Eigen::MatrixXd covariance(const Pointer& where, Index size) const {
    Eigen::MatrixXd out = matrix(where, size, size);
    if (size == 0) return out;  // a file without modes
    const double largest = out.cwiseAbs().maxCoeff();
    if (!((out - out.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * largest))
      throw Failure(Exit::bad_input,
                    file_.path.string() + ": " + where.to_string() + ": must be symmetric");
    return out;
  }

  [[nodiscard]] const Json& at(const Pointer& where) const {
    if (!file_.json.contains(where))
      throw Failure(Exit::bad_input,
                    file_.path.string() + ": " + where.to_string() + ": is missing");
    return file_.json.at(where);
  }

 private:
  const CaseFile& file_;
};

MeasuredSensor read_sensor(const CaseFile& file, const Pointer& where) {
  const Json& s = file.json.at(where);
  if (!s.is_object()) file.refuse(where, "must be an object");
  MeasuredSensor out;
  for (const auto& [key, text] : {std::pair{"name", &out.name},
                                  {"node", &out.node},
                                  {"direction", &out.direction},
                                  {"unit", &out.unit},
                                  {"quantity", &out.quantity}})
    if (s.contains(key)) *text = text_or_number(s.at(key));
  for (const auto& [key, angle] :
       {std::pair{"azimuth", &out.azimuth}, {"elevation", &out.elevation}}) {
    if (!s.contains(key)) continue;
    if (!s.at(key).is_number()) file.refuse(where / key, "must be a number, in degrees");
    *angle = s.at(key).get<double>();
  }
  out.reference = s.contains("reference") && s.at("reference") == true;
  return out;
}

/// Numbers the modes 1, 2, ….
ModesFile numbered(ModesFile modes) {
  modes.numbers.resize(static_cast<std::size_t>(modes.frequencies_hz.size()));
  std::iota(modes.numbers.begin(), modes.numbers.end(), 1);
  return modes;
}

/// Parses the mode numbers. A file has mode numbers if a user has deleted modes by hand.
std::vector<int> read_numbers(const CaseFile& file, const Pointer& where, Index count) {
  const Json& list = file.json.at(where);
  if (!list.is_array() || static_cast<Index>(list.size()) != count)
    file.refuse(where,
                "must be a list of " + std::to_string(count) + " whole numbers, one per mode");
  std::vector<int> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    constexpr std::uint64_t kMost = 100'000;
    if (!list[i].is_number_unsigned() || list[i].get<std::uint64_t>() < 1 ||
        list[i].get<std::uint64_t>() > kMost || (i > 0 && list[i].get<int>() <= out.back()))
      file.refuse(where / i, "must be a whole number, 1 or more, larger than the previous number");
    out.push_back(list[i].get<int>());
  }
  return out;
}

}  // namespace

ModesFile measured_modes(const signals::ModalResult& result,
                         const std::vector<MeasuredSensor>& sensors) {
  const auto count = static_cast<Index>(result.modes.size());
  ModesFile out{.sensors = sensors,
                .frequencies_hz = Eigen::VectorXd(count),
                .damping = Eigen::VectorXd(count),
                .covariance = result.covariance,
                .shapes = Eigen::MatrixXcd(static_cast<Index>(sensors.size()), count)};
  for (Index m = 0; m < count; ++m) {
    const signals::Mode& mode = result.modes[static_cast<std::size_t>(m)];
    out.frequencies_hz[m] = mode.pole.frequency_hz;
    out.damping[m] = mode.pole.damping;
    out.shapes.col(m) = mode.pole.shape;
    if (out.covariance.size() > 0) out.shape_covariance.push_back(mode.shape_covariance);
    out.doubtful.push_back(!mode.doubts.empty());
  }
  out.blocks = result.covariance_samples();
  return numbered(std::move(out));
}

ModesFile measured_modes(const signals::MergedModes& merged,
                         const std::vector<MeasuredSensor>& sensors) {
  const auto count = static_cast<Index>(merged.modes.size());
  ModesFile out{.sensors = sensors,
                .frequencies_hz = Eigen::VectorXd(count),
                .damping = Eigen::VectorXd(count),
                .covariance = merged.covariance,
                .shapes = Eigen::MatrixXcd(static_cast<Index>(sensors.size()), count)};
  for (Index m = 0; m < count; ++m) {
    const signals::MergedMode& mode = merged.modes[static_cast<std::size_t>(m)];
    out.frequencies_hz[m] = mode.frequency_hz;
    out.damping[m] = mode.damping;
    out.shapes.col(m) = mode.shape;
    out.shape_covariance.push_back(mode.shape_covariance);
    out.doubtful.push_back(!mode.doubts.empty());
  }
  out.blocks = merged.covariance_samples;
  return numbered(std::move(out));
}

Report modes_json(const ModesFile& modes) {
  Report sensors = Report::array();
  for (const MeasuredSensor& s : modes.sensors) {
    Report one = {{"name", s.name}};
    if (!s.node.empty()) one["node"] = s.node;
    if (!s.direction.empty()) one["direction"] = s.direction;
    if (s.azimuth) one["azimuth"] = *s.azimuth;
    if (s.elevation) one["elevation"] = *s.elevation;
    if (s.reference) one["reference"] = true;
    if (!s.unit.empty()) one["unit"] = s.unit;
    if (!s.quantity.empty()) one["quantity"] = s.quantity;
    sensors.push_back(std::move(one));
  }
  Report shapes = Report::array();
  for (const Eigen::MatrixXd& c : modes.shape_covariance) shapes.push_back(rows_of(c));
  const bool scatter = modes.covariance.size() > 0 || modes.frequencies_hz.size() == 0;
  if (modes.numbers.empty() && modes.frequencies_hz.size() > 0) return modes_json(numbered(modes));
  return {{"title", modes.title},
          {"numbers", modes.numbers},
          {"frequencies_hz", list_of(modes.frequencies_hz)},
          {"damping", list_of(modes.damping)},
          {"covariance", scatter ? rows_of(modes.covariance) : Report()},
          {"sensors", sensors},
          {"quantity", modes.quantity.empty() ? Report() : Report(modes.quantity)},
          {"shapes",
           {{"real", rows_of(modes.shapes.real().transpose())},
            {"imaginary", rows_of(modes.shapes.imag().transpose())}}},
          {"shape_covariance", scatter ? shapes : Report()},
          {"doubtful", modes.doubtful},
          {"blocks", modes.blocks}};
}

ModesFile read_modes_file(const std::filesystem::path& path) {
  const CaseFile file = read_case(path);
  const Reader read(file);
  ModesFile out{.title = file.json.value("title", "")};
  if (file.json.contains("quantity") && file.json["quantity"].is_string())
    out.quantity = file.json["quantity"].get<std::string>();
  out.frequencies_hz = read.vector(Pointer("/frequencies_hz"), -1);
  const Index count = out.frequencies_hz.size();
  out = numbered(std::move(out));
  const Pointer numbers("/numbers");
  if (file.json.contains(numbers)) out.numbers = read_numbers(file, numbers, count);
  out.damping = read.vector(Pointer("/damping"), count, true);
  const bool scatter = !read.at(Pointer("/covariance")).is_null();
  if (scatter) out.covariance = read.covariance(Pointer("/covariance"), 2 * count);
  const Json& sensors = read.at(Pointer("/sensors"));
  if (!sensors.is_array()) file.refuse(Pointer("/sensors"), "must be a list");
  for (std::size_t i = 0; i < sensors.size(); ++i)
    out.sensors.push_back(read_sensor(file, Pointer("/sensors") / i));
  const auto size = static_cast<Index>(sensors.size());
  out.shapes.resize(size, count);
  out.shapes.real() = read.matrix(Pointer("/shapes/real"), count, size, true).transpose();
  out.shapes.imag() = read.matrix(Pointer("/shapes/imaginary"), count, size, true).transpose();
  const Json& covariances = read.at(Pointer("/shape_covariance"));
  if (!scatter && !covariances.is_null())
    file.refuse(Pointer("/shape_covariance"), "must be null if the covariance is null");
  if (scatter && (!covariances.is_array() || static_cast<Index>(covariances.size()) != count))
    file.refuse(Pointer("/shape_covariance"), "must be a list of one matrix per mode");
  for (std::size_t m = 0; scatter && m < covariances.size(); ++m)
    out.shape_covariance.push_back(read.covariance(Pointer("/shape_covariance") / m, 2 * size));
  out.doubtful.assign(static_cast<std::size_t>(count), false);
  const Json doubtful = file.json.value("doubtful", Json::array());
  for (std::size_t m = 0; m < std::min(doubtful.size(), out.doubtful.size()); ++m)
    out.doubtful[m] = doubtful[m] == true;
  if (file.json.contains("blocks")) {
    const Json& blocks = file.json["blocks"];
    if (!blocks.is_number_unsigned() || blocks.get<std::uint64_t>() > 1'000'000)
      file.refuse(Pointer("/blocks"), "must be a whole number, 0 for exact covariances");
    out.blocks = blocks.get<int>();
  }
  return out;
}

}  // namespace wheeltap::apps
