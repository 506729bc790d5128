#include "apps/modes_as_data.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

#include "identification/real_shape.hpp"
#include "io/atomic_file.hpp"

namespace wheeltap::apps {

using namespace identification;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

[[noreturn]] void refuse_file(const TakenModes& taken, const Pointer& where,
                              const std::string& message) {
  throw Failure(Exit::bad_input, taken.path.string() + ": " + where.to_string() + ": " + message);
}

std::string numbers_in_words(const std::vector<int>& modes) {
  std::string text;
  for (std::size_t i = 0; i < modes.size(); ++i)
    text += (i == 0 ? "" : i + 1 == modes.size() ? " and " : ", ") + std::to_string(modes[i] + 1);
  return text;
}

std::vector<int> listed_modes(const CaseFile& file, const Pointer& at, int all) {
  const Json& given = file.json.at(at);
  std::vector<int> out;
  if (given.is_number()) {
    const int count = given;
    if (count > all) file.refuse(at, "\"from\" has " + std::to_string(all) + " modes");
    out.resize(static_cast<std::size_t>(count));
    std::iota(out.begin(), out.end(), 0);
    return out;
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    const int mode = given[i];
    if (mode > all) file.refuse(at / i, "\"from\" has " + std::to_string(all) + " modes, from 1");
    if (std::ranges::find(out, mode - 1) != out.end()) file.refuse(at / i, "stands twice");
    out.push_back(mode - 1);
  }
  return out;
}

}  // namespace

CaseFile TakenModes::sensors_as_case() const {
  Json list = Json::array();
  for (const MeasuredSensor& s : file.sensors) {
    Json one = {{"node", s.node}};
    if (!s.direction.empty()) one["direction"] = s.direction;
    list.push_back(std::move(one));
  }
  return {.path = path, .json = {{"sensors", list}}};
}

TakenModes take_modes(const CaseFile& file, const Pointer& where) {
  const Json& data = file.json.at(where);
  for (const char* key : {"frequencies", "file", "columns", "row", "cov", "sd", "covariance",
                          "shapes", "shape_sd", "shape_covariance", "seed"})
    if (data.contains(key)) file.refuse(where / key, "does not go with \"from\", which says it");
  TakenModes out{.name = data.at("from")};
  io::finish_commit(file.place_of(out.name).parent_path());
  out.path = file.resolve(out.name);
  out.file = read_modes_file(out.path);
  const auto all = static_cast<int>(out.file.frequencies_hz.size());
  if (all == 0) refuse_file(out, Pointer("/frequencies_hz"), "holds no mode");
  if (out.file.covariance.size() == 0)
    refuse_file(out, Pointer("/covariance"),
                "is null: the method that found these modes says nothing of their scatter, and "
                "without it they are not data: identify them with \"ssi-cov\", or give "
                "frequencies and how exact they are in the case");
  for (Index i = 0; i < all; ++i)
    if (!(out.file.frequencies_hz[i] > 0.0))
      refuse_file(out, Pointer("/frequencies_hz") / static_cast<std::size_t>(i),
                  "must be positive, in Hz");
  if (data.contains("modes")) {
    out.modes = listed_modes(file, where / "modes", all);
    return out;
  }
  for (int i = 0; i < all; ++i)
    (out.file.doubtful[static_cast<std::size_t>(i)] ? out.doubtful : out.modes).push_back(i);
  if (out.modes.empty())
    file.refuse(where / "from",
                "all of its modes are doubtful: name those to be used, \"modes\": [1, ...]");
  return out;
}

void fill(const TakenModes& taken, const std::vector<Index>& channels, ModalData& out) {
  const MeasuredModes& file = taken.file;
  const auto n = static_cast<Index>(taken.modes.size());
  for (const int mode : taken.modes) out.frequencies_hz.push_back(file.frequencies_hz[mode]);
  out.covariance = file.covariance(taken.modes, taken.modes);
  const double factor = estimated_covariance_factor(static_cast<int>(n), file.blocks);
  bool correlated = factor > 0.0;
  if (correlated)
    out.covariance *= factor;
  else
    out.covariance = MatrixXd(out.covariance.diagonal().asDiagonal());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(out.covariance, Eigen::EigenvaluesOnly);
  if (!(solver.eigenvalues()[0] > 1e-14 * out.covariance.diagonal().cwiseAbs().maxCoeff()))
    refuse_file(taken, Pointer("/covariance"), "must be positive definite");

  const auto sensors = static_cast<Index>(channels.size());
  if (sensors >= 2) {
    const auto size = static_cast<Index>(file.sensors.size());
    out.shapes = MatrixXd::Constant(n, sensors, std::numeric_limits<double>::quiet_NaN());
    for (Index i = 0; i < n; ++i) {
      const auto mode = static_cast<std::size_t>(taken.modes[static_cast<std::size_t>(i)]);
      // Set-ups that were merged leave gaps where one of them lacks the mode.
      std::vector<Index> told, entries, imaginary;
      for (Index s = 0; s < sensors; ++s) {
        const Index channel = channels[static_cast<std::size_t>(s)];
        if (!std::isfinite(file.shapes(channel, static_cast<Index>(mode)).real())) continue;
        told.push_back(s);
        entries.push_back(channel);
        imaginary.push_back(size + channel);
      }
      out.shape_covariances.emplace_back(MatrixXd::Identity(sensors, sensors));
      if (told.size() < 2) continue;
      std::vector<Index> both = entries;  // real parts, then imaginary parts
      both.insert(both.end(), imaginary.begin(), imaginary.end());
      try {
        const RealShape shape = real_shape(file.shapes.col(static_cast<Index>(mode))(entries),
                                           file.shape_covariance[mode](both, both), file.blocks);
        out.shapes.row(i)(told) = shape.values.transpose();
        out.shape_covariances.back()(told, told) = shape.covariance;
        correlated = correlated && shape.correlated;
      } catch (const std::invalid_argument& error) {
        refuse_file(taken, Pointer("/shape_covariance") / mode, error.what());
      }
    }
  } else {
    out.sensors.clear();
  }
  out.origin = "from " + taken.name + ": " + std::to_string(n) + " of " +
               std::to_string(file.frequencies_hz.size()) + " modes";
  if (!taken.doubtful.empty())
    out.origin += " (without the doubtful " + numbers_in_words(taken.doubtful) + ")";
  out.origin += sensors >= 2 ? ", with shapes at " + std::to_string(sensors) + " sensors"
                             : std::string(", without shapes");
  if (!correlated)
    out.origin += ", of scatters without their correlations (too few blocks for these)";
  out.origin += "; damping is not used";
}

}  // namespace wheeltap::apps
