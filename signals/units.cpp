#include "signals/units.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace wheeltap::signals {
namespace {

// The foot, the pound and standard gravity are exact by definition (NIST Special Publication 811,
// 2008, appendix B): 1 in = 0.0254 m, 1 lb = 0.453 592 37 kg, g = 9.806 65 m/s².
constexpr double kInch = 0.0254;
constexpr double kFoot = 0.3048;
constexpr double kGravity = 9.80665;
constexpr double kPoundForce = 0.45359237 * kGravity;

constexpr Unit kUnits[] = {
    {"s", Dimension::time, 1.0},
    {"ms", Dimension::time, 1e-3},
    {"us", Dimension::time, 1e-6},
    {"ns", Dimension::time, 1e-9},
    {"min", Dimension::time, 60.0},
    {"h", Dimension::time, 3600.0},
    {"d", Dimension::time, 86400.0},
    {"N", Dimension::force, 1.0},
    {"kN", Dimension::force, 1e3},
    {"MN", Dimension::force, 1e6},
    {"mN", Dimension::force, 1e-3},
    {"uN", Dimension::force, 1e-6},
    {"kgf", Dimension::force, kGravity},
    {"lbf", Dimension::force, kPoundForce},
    {"kip", Dimension::force, 1e3 * kPoundForce},
    {"m", Dimension::length, 1.0},
    {"cm", Dimension::length, 1e-2},
    {"mm", Dimension::length, 1e-3},
    {"um", Dimension::length, 1e-6},
    {"nm", Dimension::length, 1e-9},
    {"km", Dimension::length, 1e3},
    {"in", Dimension::length, kInch},
    {"ft", Dimension::length, kFoot},
    {"m/s", Dimension::velocity, 1.0},
    {"cm/s", Dimension::velocity, 1e-2},
    {"mm/s", Dimension::velocity, 1e-3},
    {"um/s", Dimension::velocity, 1e-6},
    {"km/h", Dimension::velocity, 1.0 / 3.6},
    {"in/s", Dimension::velocity, kInch},
    {"ft/s", Dimension::velocity, kFoot},
    {"m/s^2", Dimension::acceleration, 1.0},
    {"cm/s^2", Dimension::acceleration, 1e-2},
    {"mm/s^2", Dimension::acceleration, 1e-3},
    {"um/s^2", Dimension::acceleration, 1e-6},
    {"in/s^2", Dimension::acceleration, kInch},
    {"ft/s^2", Dimension::acceleration, kFoot},
    {"g", Dimension::acceleration, kGravity},
    {"mg", Dimension::acceleration, 1e-3 * kGravity},
    {"Gal", Dimension::acceleration, 1e-2},
    {"Hz", Dimension::frequency, 1.0},
    {"kHz", Dimension::frequency, 1e3},
    {"mHz", Dimension::frequency, 1e-3},
    {"MHz", Dimension::frequency, 1e6},
    {"rad/s", Dimension::frequency, 0.5 / std::numbers::pi},
    {"rpm", Dimension::frequency, 1.0 / 60.0},
    {"1/s", Dimension::frequency, 1.0},
    {"1/min", Dimension::frequency, 1.0 / 60.0},
};

/// Alternative spellings of whole units.
constexpr std::pair<std::string_view, std::string_view> kSynonyms[] = {
    {"S", "s"},
    {"sec", "s"},
    {"secs", "s"},
    {"second", "s"},
    {"seconds", "s"},
    {"msec", "ms"},
    {"usec", "us"},
    {"milliseconds", "ms"},
    {"minutes", "min"},
    {"hours", "h"},
    {"hr", "h"},
    {"days", "d"},
    {"microseconds", "us"},
    {"inch", "in"},
    {"gal", "Gal"},
    {"millis", "ms"},
    {"millisecond", "ms"},
    {"nanoseconds", "ns"},
    {"nsec", "ns"},
    {"micros", "us"},
    {"nanos", "ns"},
    {"minute", "min"},
    {"hour", "h"},
    {"newton", "N"},
    {"newtons", "N"},
    {"metre", "m"},
    {"meter", "m"},
    {"meters", "m"},
    {"metres", "m"},
    {"g's", "g"},
    {"gn", "g"},
    {"g_n", "g"},
    {"G", "g"},
    {"hertz", "Hz"},
    {"hz", "Hz"},
    {"HZ", "Hz"},
    {"khz", "kHz"},
    {"kn", "kN"},
    {"KN", "kN"},
    {"RPM", "rpm"},
    {"Inch", "in"},
    {"lbs", "lbf"},
    {"milli-g", "mg"},

    {"kips", "kip"},
};

void replace(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// Converts all equivalent spellings of a unit to one spelling.
std::string canonical(std::string_view text) {
  std::string out(text);
  for (const std::string_view micro : {"\xC2\xB5", "\xCE\xBC"}) replace(out, micro, "u");  // µ, μ
  replace(out, "\xC2\xB2", "^2");                                                          // ²
  replace(out, "\xE2\x81\xBB\xC2\xB9", "^-1");                                             // ⁻¹
  replace(out, "\xE2\x81\xBB^2", "^-2");                                                   // ⁻²
  replace(out, "\xC2\xB7", " ");                                                           // ·
  replace(out, "**", "^");
  for (const auto& [power, quotient] : {std::pair{"^-2", "/s^2"}, std::pair{"^-1", "/s"}}) {
    if (!out.ends_with(std::string("s") + power)) continue;
    out.resize(out.size() - 4);
    out.resize(out.find_last_not_of(" .*") + 1);
    out += quotient;
  }
  std::erase(out, ' ');
  for (const std::string_view second : {"/sec^2", "/sec2", "/sec/sec"})
    replace(out, second, "/s^2");
  if (out.ends_with("/sec")) out.resize(out.size() - 2);
  replace(out, "/s/s", "/s^2");
  if (out.ends_with("/s2")) out.replace(out.size() - 3, 3, "/s^2");
  std::string small = out;
  for (char& c : small)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const auto& [other, name] : kSynonyms)
    if (out == other || (other.size() > 2 && small == other)) return std::string(name);
  return out;
}

}  // namespace

std::string_view name(Dimension dimension) {
  constexpr std::array<std::string_view, 6> kNames{"a time",     "a force",         "a length",
                                                   "a velocity", "an acceleration", "a frequency"};
  return kNames.at(static_cast<std::size_t>(dimension));
}

std::string_view si_unit(Dimension dimension) {
  constexpr std::array<std::string_view, 6> kUnitNames{"s", "N", "m", "m/s", "m/s^2", "Hz"};
  return kUnitNames.at(static_cast<std::size_t>(dimension));
}

std::optional<Unit> find_unit(std::string_view text) {
  const std::string wanted = canonical(text);
  const auto found = std::ranges::find(kUnits, wanted, &Unit::name);
  if (found == std::end(kUnits)) return std::nullopt;
  return *found;
}

int derivative_order(Dimension dimension) {
  return dimension == Dimension::acceleration ? 2 : dimension == Dimension::velocity ? 1 : 0;
}

std::string known_units(Dimension dimension) {
  std::string list;
  for (const Unit& unit : kUnits) {
    if (unit.dimension != dimension) continue;
    list += (list.empty() ? "" : ", ") + std::string(unit.name);
  }
  return list;
}

Conversion conversion_of(std::string_view unit, std::optional<Dimension> wanted) {
  Conversion out{.unit = std::string(unit), .dimension = wanted};
  // Numbers without a unit, or with the unit "1" or "-", are not converted.
  if (unit.empty() || unit == "-" || unit == "1") {
    if (unit == "-") out.unit.clear();
    return out;
  }
  const std::optional<Unit> known = find_unit(unit);
  if (!known || (wanted && known->dimension != *wanted)) {
    out.basis = Conversion::Basis::foreign;
    return out;
  }
  out.basis = Conversion::Basis::unit;
  out.factor = known->si;
  out.dimension = known->dimension;
  return out;
}

std::string unit_of(const io::Column& column) {
  if (column.unit == "-") return {};
  if (!column.unit.empty()) return column.unit;
  const std::string_view name = column.name;
  if (find_unit(name)) return {};
  const auto without_brackets = [](std::string_view unit) {
    for (const std::string_view brackets : {"()", "[]", "{}", "<>"})
      if (unit.size() > 2 && unit.front() == brackets[0] && unit.back() == brackets[1])
        return unit.substr(1, unit.size() - 2);
    return unit;
  };
  for (const std::string_view before : {" / ", ", ", " in ", " - ", ": "}) {
    const std::size_t at = name.rfind(before);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view unit = without_brackets(name.substr(at + before.size()));
    if (find_unit(unit)) return std::string(unit);
  }
  // Unit in brackets: "a{g}", "a <g>".
  for (const std::string_view brackets : {"{}", "<>"}) {
    const std::size_t open = name.rfind(brackets[0]);
    if (open == std::string_view::npos || open == 0 || name.back() != brackets[1]) continue;
    const std::string_view unit = without_brackets(name.substr(open));
    if (find_unit(unit)) return std::string(unit);
  }
  // A quotient as the last word: "a m/s^2".
  const std::size_t blank = name.rfind(' ');
  if (blank == std::string_view::npos || blank == 0) return {};
  const std::string_view word = name.substr(blank + 1);
  const bool quotient = word.find('/') != std::string_view::npos;
  return quotient && find_unit(word) ? std::string(word) : std::string();
}

std::string possible_unit_of(const io::Column& column) {
  if (!unit_of(column).empty() || column.unit == "-") return {};
  const std::string_view name = column.name;
  // Endings as in "acc_m_s2", "acc_mps2".
  static constexpr std::pair<std::string_view, std::string_view> kEndings[] = {
      {"m_s2", "m/s^2"}, {"m_s^2", "m/s^2"}, {"mps2", "m/s^2"},   {"m_per_s2", "m/s^2"},
      {"ms2", "m/s^2"},  {"mm_s", "mm/s"},   {"mm_s2", "mm/s^2"}, {"cm_s2", "cm/s^2"},
      {"m_s", "m/s"},    {"mps", "m/s"},     {"mmps", "mm/s"},    {"in_s", "in/s"},
      {"ms-2", "m/s^2"}};
  std::string_view best;
  std::size_t length = 0;
  for (const auto& [ending, unit] : kEndings)
    for (const std::string_view mark : {"_", " ", "."}) {
      const std::string whole = std::string(mark) + std::string(ending);
      if (name.size() > whole.size() && name.ends_with(whole) && whole.size() > length) {
        best = unit;
        length = whole.size();
      }
    }
  if (!best.empty()) return std::string(best);
  // "F/N" may be a quantity and its unit (DIN 461), but also a path.
  const std::size_t mark = name.find_last_of("_ ./");
  if (mark == std::string_view::npos || mark == 0) return {};
  const std::string_view last = name.substr(mark + 1);
  const std::optional<Unit> unit = find_unit(last);
  if (!unit || find_unit(name) || unit->dimension == Dimension::time ||
      unit->dimension == Dimension::frequency)
    return {};
  return std::string(last);
}

std::string time_unit_of(const io::Column& column) {
  if (std::string unit = unit_of(column); !unit.empty()) return unit;
  // The last word of the name; it may begin with a capital letter.
  const std::string_view name = column.name;
  const auto is_time = [](std::string_view word) {
    const std::optional<Unit> unit = find_unit(word);
    return unit && unit->dimension == Dimension::time;
  };
  const std::size_t mark = name.find_last_of("_ .-:/");
  const std::string_view last = mark == std::string_view::npos ? name : name.substr(mark + 1);
  if (mark != std::string_view::npos && is_time(last)) return std::string(last);
  if (mark == std::string_view::npos && last.size() > 1 && is_time(last)) return std::string(last);
  // Names without a separator: "timems", "TimeMS", "tms", "epochus".
  std::string low(last);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const std::string_view unit : {"millis", "micros", "nanos", "msec", "usec", "nsec", "ms",
                                      "us", "\xC2\xB5s", "\xCE\xBCs", "ns"}) {
    if (!low.ends_with(unit)) continue;
    const std::string_view rest = std::string_view(low).substr(0, low.size() - unit.size());
    for (const std::string_view before :
         {"time", "timestamp", "t", "elapsed", "epoch", "zeit", "elapsedtime", "temps", "unixtime"})
      if (rest == before) return std::string(unit);
  }
  std::size_t capital = last.size();
  while (capital > 1 && last[capital - 1] >= 'a' && last[capital - 1] <= 'z') --capital;
  if (capital < 2 || capital == last.size()) return {};
  std::string word(last.substr(capital - 1));
  if (word.front() < 'A' || word.front() > 'Z') return {};
  word.front() = static_cast<char>(word.front() - 'A' + 'a');
  return word.size() > 1 && is_time(word) ? word : std::string();
}

}  // namespace wheeltap::signals
