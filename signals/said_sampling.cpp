#include <algorithm>
#include <array>
#include <cmath>

#include "io/text/text_number.hpp"
#include "io/text/words.hpp"
#include "signals/record.hpp"
#include "signals/units.hpp"

namespace wheeltap::signals {
namespace {

// Keys in lower case. A key precedes any shorter key with which it begins.
constexpr std::string_view kRates[] = {"sampling rate",
                                       "sampling_rate",
                                       "samplingrate",
                                       "sample rate",
                                       "sample_rate",
                                       "samplerate",
                                       "sampling frequency",
                                       "sampling_frequency",
                                       "samplefrequency",
                                       "sample frequency",
                                       "sample_frequency",
                                       "samplingfrequency",
                                       "sampling freq",
                                       "sample freq",
                                       "scan rate",
                                       "scanrate",
                                       "data rate",
                                       "acquisition rate",
                                       "abtastrate",
                                       "abtastfrequenz",
                                       "messrate",
                                       "samples per second",
                                       "samples/s",
                                       "sampling",
                                       "fs",
                                       "f_s",
                                       "sps"};
constexpr std::string_view kIntervals[] = {"sampling interval",
                                           "sampling_interval",
                                           "samplinginterval",
                                           "sample interval",
                                           "sample_interval",
                                           "sampleinterval",
                                           "sampling period",
                                           "sample period",
                                           "sampling time",
                                           "sample time",
                                           "time interval",
                                           "time step",
                                           "timestep",
                                           "time increment",
                                           "delta t",
                                           "delta_t",
                                           "deltat",
                                           "delta_x",
                                           "x increment",
                                           "xincrement",
                                           "abtastintervall",
                                           "abtastzeit",
                                           "dt"};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// The text after a key: units and marks, a number, a unit.
struct PrintedRate {
  double value = 0.0;
  std::string unit = {};
};

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> out;
  std::string word;
  for (const char c : text) {
    if (std::string_view(" \t=:;,()[]\"'|").find(c) == std::string_view::npos) {
      word += c;
      continue;
    }
    if (!word.empty()) out.push_back(std::move(word));
    word.clear();
  }
  if (!word.empty()) out.push_back(std::move(word));
  return out;
}

bool counts_samples(std::string_view unit) {
  constexpr std::string_view kKnown[] = {"S/s", "Sa/s", "samples/s", "samples/sec", "sps", "SPS"};
  return std::ranges::find(kKnown, unit) != std::end(kKnown);
}

std::optional<Unit> unit_of_word(std::string_view word) {
  if (counts_samples(word)) return find_unit("Hz");
  if (word.starts_with('k') && counts_samples(word.substr(1))) return find_unit("kHz");
  const std::optional<Unit> unit = find_unit(word);
  if (!unit || (unit->dimension != Dimension::time && unit->dimension != Dimension::frequency))
    return std::nullopt;
  return unit;
}

/// True if the text continues a number with a separated group of three digits: " 200", "'200".
bool continues_number(std::string_view text) {
  for (const std::string_view separator : {" ", "'", "\u00A0", "\u202F"}) {
    if (!text.starts_with(separator)) continue;
    text.remove_prefix(separator.size());
    const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
    return digits == 3;
  }
  return false;
}

std::optional<PrintedRate> rate_after(std::string_view rest, char decimal) {
  const std::size_t at = rest.find_first_of("0123456789");
  constexpr std::size_t kFarthest = 30;
  if (at == std::string_view::npos || at > kFarthest) return std::nullopt;
  PrintedRate out;
  for (const std::string& word : words(rest.substr(0, at))) {
    if (word == "." || word == "of" || word == "is" || word == "in") continue;
    if (!unit_of_word(word)) return std::nullopt;
    out.unit = word;
  }
  if (at == 0) return std::nullopt;  // "fs1"
  std::string_view number = rest.substr(at);
  std::size_t end = std::min(number.find_first_not_of("0123456789.,eE+-"), number.size());
  // Excludes the first letter of the unit and a separating comma.
  while (end > 0 && (number[end - 1] < '0' || number[end - 1] > '9')) --end;
  const std::string_view digits = number.substr(0, end);
  std::optional<double> value = io::parse_number(digits);
  if (!value && decimal == ',') value = io::parse_number(digits, ',');
  if (!value || !(*value > 0.0) || !std::isfinite(*value)) return std::nullopt;
  out.value = *value;
  std::string_view rest_of_line = number.substr(end);
  // "1/256 s"
  if (rest_of_line.starts_with('/') && rest_of_line.size() > 1 && io::is_digit(rest_of_line[1])) {
    const std::size_t length =
        std::min(rest_of_line.find_first_not_of("0123456789.", 1), rest_of_line.size()) - 1;
    const std::optional<double> by = io::parse_number(rest_of_line.substr(1, length));
    if (!by || !(*by > 0.0)) return std::nullopt;
    out.value /= *by;
    rest_of_line.remove_prefix(1 + length);
  }
  const std::vector<std::string> after = words(rest_of_line);
  if (after.empty()) return out;
  // "51 200 Hz", "51'200 Hz", "12/03/2024", "1 of 3", "50 g": the number is not the rate.
  if (continues_number(rest_of_line) || rest_of_line.starts_with('/') || after.front() == "of")
    return std::nullopt;
  if (unit_of_word(after.front()))
    out.unit = after.front();
  else if (find_unit(after.front()))
    return std::nullopt;
  return out;
}

std::optional<double> rate_in(std::string_view text, char decimal) {
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const auto after = [&](std::string_view key) -> std::optional<PrintedRate> {
    for (std::size_t at = 0; (at = low.find(key, at)) != std::string::npos; at += key.size()) {
      const std::size_t end = at + key.size();
      if ((at > 0 && is_letter(low[at - 1])) || (end < low.size() && is_letter(low[end]))) continue;
      return rate_after(text.substr(end), decimal);
    }
    return std::nullopt;
  };
  for (const bool interval : {false, true})
    for (const std::string_view key :
         interval ? std::span<const std::string_view>(kIntervals) : std::span(kRates)) {
      const std::optional<PrintedRate> printed = after(key);
      if (!printed) continue;
      const std::optional<Unit> unit = unit_of_word(printed->unit);
      const double value = printed->value * (unit ? unit->si : 1.0);
      const bool is_time = unit ? unit->dimension == Dimension::time : interval;
      return is_time ? 1.0 / value : value;
    }
  return std::nullopt;
}

}  // namespace

std::optional<Sampling> sampling_from_header(const Record& record) {
  if (!record.layout) return std::nullopt;
  std::optional<Sampling> out;
  for (const io::HeadLine& line : record.layout->above) {
    const std::optional<double> rate =
        rate_in(line.text, record.layout->used.decimal.value_or('.'));
    if (!rate) continue;
    if (out && std::abs(*rate / out->rate_hz - 1.0) > 1e-3) return std::nullopt;
    if (!out)
      out = Sampling{.rate_hz = *rate, .basis = Sampling::Basis::header, .line = line.number};
  }
  return out;
}

}  // namespace wheeltap::signals
