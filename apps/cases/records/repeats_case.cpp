#include "apps/cases/records/repeats_case.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/records/csv_frequencies.hpp"
#include "apps/words.hpp"
#include "base/constants.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using Rows = std::vector<std::vector<double>>;

void refuse_other_keys(const CaseFile& file, const Pointer& where) {
  const Json& data = file.json.at(where);
  for (const char* key : {"cov", "sd", "covariance"})
    if (data.contains(key))
      file.refuse(where / key,
                  "is not allowed with \"repeats\": the scatter is inferred from the tests; state "
                  "errors common to all tests as \"discrepancy\"");
  for (const char* key :
       {"frequencies", "file", "columns", "row", "from", "modes", "model_modes", "seed"})
    if (data.contains(key))
      file.refuse(where / key,
                  "is not allowed with \"repeats\", which give the frequencies; leave out one of "
                  "the two keys");
}

Rows read_rows(const CaseFile& file, const Pointer& at) {
  const Json& repeats = file.json.at(at);
  if (repeats.is_object()) {
    std::vector<std::string> columns;
    for (const Json& c : repeats.value("columns", Json::array()))
      columns.push_back(text_or_number(c));
    return read_repeats_csv(file.resolve(repeats.at("file").get<std::string>()), columns);
  }
  Rows rows;
  for (std::size_t t = 0; t < repeats.size(); ++t) {
    rows.emplace_back();
    for (const Json& f : repeats[t]) rows.back().push_back(f.is_null() ? kNaN : f.get<double>());
    if (rows[t].size() != rows[0].size())
      file.refuse(at / t, "has " + std::to_string(rows[t].size()) +
                              " frequencies, the first test " + std::to_string(rows[0].size()) +
                              ": write one value per mode in each test, null if the test did not "
                              "identify the mode");
  }
  return rows;
}

std::string range_of(const std::vector<double>& values) {
  double low = kInfinity, high = 0.0;
  for (const double x : values) {
    if (std::isnan(x)) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  const std::string from = significant(100.0 * low, 2), to = significant(100.0 * high, 2);
  return from == to ? from + " %" : from + " to " + to + " %";
}

}  // namespace

RepeatedTests parse_repeats(const CaseFile& file, const Pointer& where, bool ascending) {
  refuse_other_keys(file, where);
  const Pointer at = where / "repeats";
  const Json& json = file.json.at(at);
  const Pointer place = json.is_object() ? at / "file" : at;
  // The message about a rejected list states only the location of the list, not its content.
  const auto refuse = [&](const std::string& message) {
    if (json.is_object()) file.refuse(place, message);
    throw Failure(Exit::bad_input, file.path.string() + ": " + at.to_string() + ": " + message);
  };
  const Rows rows = read_rows(file, at);
  Eigen::MatrixXd frequencies(static_cast<Eigen::Index>(rows.size()),
                              static_cast<Eigen::Index>(rows[0].size()));
  for (Eigen::Index t = 0; t < frequencies.rows(); ++t)
    for (Eigen::Index j = 0; j < frequencies.cols(); ++j)
      frequencies(t, j) = rows[static_cast<std::size_t>(t)][static_cast<std::size_t>(j)];
  RepeatedTests out;
  try {
    out = infer_repeated_tests(frequencies);
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
  double before = 0.0;
  for (std::size_t i = 0; i < out.frequencies_hz.size() && ascending; ++i) {
    const double f = out.frequencies_hz[i];
    if (std::isnan(f)) continue;
    if (f < before)
      refuse("the mean frequencies must increase, beginning with the lowest elastic mode: mode " +
             std::to_string(i + 1) + " has a mean of " + significant(f, 6) +
             " Hz, the mode before it " + significant(before, 6) +
             " Hz; order the columns by frequency");
    before = f;
  }
  return out;
}

std::string in_words(const RepeatedTests& tests, const std::string& origin) {
  std::string out = std::to_string(tests.tests) + " repeated tests " + origin +
                    "; scatter between tests " + range_of(tests.scatter);
  if (!tests.outliers.empty()) {
    constexpr std::size_t kMostListed = 8;
    std::vector<std::string> numbers;
    for (const int t : tests.outliers) numbers.push_back(std::to_string(t + 1));
    const std::size_t all = numbers.size();
    if (all > kMostListed) numbers.resize(kMostListed);
    out += all == 1 ? "; probable outlier: test " : "; probable outliers: tests ";
    out += all > kMostListed
               ? listed(numbers) + " and " + std::to_string(all - kMostListed) + " more"
               : in_words(numbers);
  }
  double independent = kInfinity;
  for (std::size_t j = 0; j < tests.inflation.size(); ++j)
    if (tests.inflation[j] > 1.0)
      independent = std::min(independent, tests.identified[j] / tests.inflation[j]);
  if (std::isfinite(independent))
    out += "; consecutive tests are correlated: the error of the mean is that of about " +
           significant(independent, 2) + " independent tests (worst mode)";
  return out;
}

}  // namespace wheeltap::apps
