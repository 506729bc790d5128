#include "apps/cases/records/modes_as_data.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "identification/modal/real_shape.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

[[noreturn]] void refuse_file(const TakenModes& taken, const Pointer& where,
                              const std::string& message) {
  throw Failure(Exit::bad_input, taken.path.string() + ": " + where.to_string() + ": " + message);
}

std::string in_a_row(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    text += (i == 0 ? "" : i + 1 == numbers.size() ? " and " : ", ") + std::to_string(numbers[i]);
  return text;
}

/// Mode numbers of these rows of `file`.
std::vector<int> numbers_of(const ModesFile& file, const std::vector<int>& rows) {
  std::vector<int> out;
  for (const int row : rows) out.push_back(file.numbers[static_cast<std::size_t>(row)]);
  return out;
}

/// Rows of `file` with the modes listed in "modes", ascending.
std::vector<int> listed_modes(const CaseFile& file, const Pointer& at, const ModesFile& modes) {
  const Json& given = file.json.at(at);
  const std::size_t all = modes.numbers.size();
  std::vector<int> out;
  if (given.is_number()) {
    const auto count = given.get<std::size_t>();
    if (count > all) file.refuse(at, "\"from\" has " + std::to_string(all) + " modes");
    out.resize(count);
    std::iota(out.begin(), out.end(), 0);
    return out;
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    const auto found = std::ranges::find(modes.numbers, given[i].get<int>());
    if (found == modes.numbers.end())
      file.refuse(at / i,
                  "\"from\" does not have this mode: it has modes " + in_a_row(modes.numbers));
    const auto row = static_cast<int>(found - modes.numbers.begin());
    if (std::ranges::find(out, row) != out.end()) file.refuse(at / i, "is listed twice");
    out.push_back(row);
  }
  std::ranges::sort(out);
  return out;
}

/// Parses "model_modes": for each measured mode that is used, the number of the model's mode.
std::vector<int> model_modes(const CaseFile& file, const Pointer& at, std::size_t taken) {
  const Json& given = file.json.at(at);
  if (given.size() != taken)
    file.refuse(at, "must have one number for each of the " + std::to_string(taken) +
                        " modes used, has " + std::to_string(given.size()));
  std::vector<int> out;
  for (std::size_t i = 0; i < taken; ++i) {
    const int number = given[i].get<int>();
    if (!out.empty() && number <= out.back())
      file.refuse(at / i, "must increase: modes are in the order of their frequencies");
    out.push_back(number);
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
    if (data.contains(key))
      file.refuse(where / key, "is not allowed with \"from\": modes.json contains this value");
  TakenModes out{.name = data.at("from").get<std::string>()};
  io::finish_commit(file.place_of(out.name).parent_path());
  out.path = file.resolve(out.name);
  if (std::error_code ignored; !std::filesystem::exists(out.path, ignored))
    throw Failure(
        Exit::no_input,
        io::printable(file.path.string() + ": " + (where / "from").to_string() + ": " +
                      out.path.string() +
                      ": no such file: write it with wheeltap modal, or correct the path"));
  out.file = read_modes_file(out.path);
  const auto all = static_cast<int>(out.file.frequencies_hz.size());
  if (all == 0) refuse_file(out, Pointer("/frequencies_hz"), "has no modes");
  if (out.file.covariance.size() == 0)
    refuse_file(out, Pointer("/covariance"),
                "is null: the identification method gave no uncertainty, but the data of a case "
                "need an uncertainty. Identify the modes with \"ssi-cov\", or give frequencies and "
                "their uncertainty in the case");
  for (Index i = 0; i < all; ++i)
    if (!(out.file.frequencies_hz[i] > 0.0))
      refuse_file(out, Pointer("/frequencies_hz") / static_cast<std::size_t>(i),
                  "must be positive, in Hz");
  if (data.contains("modes")) {
    out.modes = listed_modes(file, where / "modes", out.file);
  } else {
    for (int i = 0; i < all; ++i)
      (out.file.doubtful[static_cast<std::size_t>(i)] ? out.doubtful : out.modes).push_back(i);
    if (out.modes.empty())
      file.refuse(
          where / "from",
          "all modes of this file are doubtful: list the modes to use, \"modes\": [1, ...]");
  }
  out.numbers = data.contains("model_modes")
                    ? model_modes(file, where / "model_modes", out.modes.size())
                    : numbers_of(out.file, out.modes);
  for (int& number : out.numbers) --number;
  return out;
}

void fill(const TakenModes& taken, const std::vector<Index>& channels, ModalData& out) {
  const ModesFile& file = taken.file;
  const auto n = static_cast<Index>(taken.modes.size());
  const Index rows = taken.numbers.back() + 1;
  out.frequencies_hz.assign(static_cast<std::size_t>(rows), kNaN);
  for (std::size_t i = 0; i < taken.modes.size(); ++i)
    out.frequencies_hz[static_cast<std::size_t>(taken.numbers[i])] =
        file.frequencies_hz[taken.modes[i]];
  MatrixXd covariance = file.covariance(taken.modes, taken.modes);
  const double factor = estimated_covariance_factor(static_cast<int>(n), file.blocks);
  bool correlated = factor > 0.0;
  if (correlated)
    covariance *= factor;
  else
    covariance = MatrixXd(covariance.diagonal().asDiagonal());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(covariance, Eigen::EigenvaluesOnly);
  if (!(solver.eigenvalues()[0] > 1e-14 * covariance.diagonal().cwiseAbs().maxCoeff()))
    refuse_file(taken, Pointer("/covariance"), "must be positive definite");
  out.covariance = MatrixXd::Zero(rows, rows);
  out.covariance(taken.numbers, taken.numbers) = covariance;

  const auto sensors = static_cast<Index>(channels.size());
  if (sensors >= 2) {
    const auto size = static_cast<Index>(file.sensors.size());
    out.shapes = MatrixXd::Constant(rows, sensors, kNaN);
    out.shape_covariances.assign(static_cast<std::size_t>(rows),
                                 MatrixXd::Identity(sensors, sensors));
    for (std::size_t i = 0; i < taken.modes.size(); ++i) {
      const auto mode = static_cast<std::size_t>(taken.modes[i]);
      const int row = taken.numbers[i];
      // A shape of merged set-ups lacks the sensors of a set-up that did not identify the mode.
      std::vector<Index> told, entries, imaginary;
      for (Index s = 0; s < sensors; ++s) {
        const Index channel = channels[static_cast<std::size_t>(s)];
        if (!std::isfinite(file.shapes(channel, static_cast<Index>(mode)).real())) continue;
        told.push_back(s);
        entries.push_back(channel);
        imaginary.push_back(size + channel);
      }
      if (told.size() < 2) continue;
      std::vector<Index> both = entries;  // real parts, then imaginary parts
      both.insert(both.end(), imaginary.begin(), imaginary.end());
      try {
        const RealShape shape = real_shape(file.shapes.col(static_cast<Index>(mode))(entries),
                                           file.shape_covariance[mode](both, both), file.blocks);
        out.shapes.row(row)(told) = shape.values.transpose();
        out.shape_covariances[static_cast<std::size_t>(row)](told, told) = shape.covariance;
        correlated = correlated && shape.correlated;
      } catch (const std::invalid_argument& error) {
        refuse_file(taken, Pointer("/shape_covariance") / mode, error.what());
      }
    }
  } else {
    out.sensors.clear();
  }
  const std::vector<int> measured = numbers_of(file, taken.modes);
  out.origin = "from " + taken.name + ": " + std::to_string(n) + " of " +
               std::to_string(file.frequencies_hz.size()) + " modes";
  if (!taken.doubtful.empty())
    out.origin += " (without the doubtful " + in_a_row(numbers_of(file, taken.doubtful)) + ")";
  std::vector<int> structural = taken.numbers;
  for (int& number : structural) ++number;
  if (sensors >= 2) {
    out.origin += ", with shapes at " + std::to_string(sensors) +
                  " sensors, matched to the model's modes by frequency and shape";
  } else {
    out.origin += ", without shapes: ";
    if (measured == structural)
      out.origin += std::string(n == 1 ? "mode " : "modes ") + in_a_row(structural) +
                    (n == 1 ? " keeps its number" : " keep their numbers");
    else
      out.origin += std::string(n == 1 ? "mode " : "modes ") + in_a_row(measured) +
                    (n == 1 ? " is the model's mode " : " are the model's modes ") +
                    in_a_row(structural);
  }
  if (!correlated)
    out.origin +=
        ", with standard deviations but without correlations (too few blocks for correlations)";
  out.origin += "; damping is not used";
}

}  // namespace wheeltap::apps
