#include "apps/written_number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "signals/units.hpp"

namespace wheeltap::apps {
namespace {

struct CaseUnit {
  std::string_view name, si;
  double factor;  ///< SI value = factor · value
};

// Units in cases; signals/units has the units of records. "g" is gram here, because no key of a
// case is an acceleration. Source of the pound-force per square inch: NIST Special Publication 811
// (2008), appendix B.
constexpr double kPsi = 0.45359237 * 9.80665 / (0.0254 * 0.0254);
constexpr CaseUnit kCaseUnits[] = {
    {"%", "", 1e-2},
    {"percent", "", 1e-2},
    {"\xE2\x80\xB0", "", 1e-3},  // per mille
    {"Hz", "Hz", 1.0},
    {"hz", "Hz", 1.0},
    {"kHz", "Hz", 1e3},
    {"kg", "kg", 1.0},
    {"g", "kg", 1e-3},
    {"t", "kg", 1e3},
    {"lb", "kg", 0.45359237},
    {"Pa", "Pa", 1.0},
    {"kPa", "Pa", 1e3},
    {"MPa", "Pa", 1e6},
    {"GPa", "Pa", 1e9},
    {"psi", "Pa", kPsi},
    {"ksi", "Pa", 1e3 * kPsi},
    {"N/m2", "Pa", 1.0},
    {"kN/m2", "Pa", 1e3},
    {"N/mm2", "Pa", 1e6},
    {"kN/mm2", "Pa", 1e9},
    {"kN/cm2", "Pa", 1e7},
    {"kg/m3", "kg/m3", 1.0},
    {"g/cm3", "kg/m3", 1e3},
    {"kg/dm3", "kg/m3", 1e3},
    {"t/m3", "kg/m3", 1e3},
    {"N/m", "N/m", 1.0},
    {"kN/m", "N/m", 1e3},
    {"MN/m", "N/m", 1e6},
    {"N/mm", "N/m", 1e3},
    {"kN/mm", "N/m", 1e6},
    {"Nm/rad", "N m/rad", 1.0},
    {"kNm/rad", "N m/rad", 1e3},
    {"MNm/rad", "N m/rad", 1e6},
    {"Ns/m", "N s/m", 1.0},
    {"kNs/m", "N s/m", 1e3},
    {"m2", "m2", 1.0},
    {"cm2", "m2", 1e-4},
    {"mm2", "m2", 1e-6},
    {"m4", "m4", 1.0},
    {"cm4", "m4", 1e-8},
    {"mm4", "m4", 1e-12},
    {"rad", "rad", 1.0},
    {"deg", "degrees", 1.0},
    {"\xC2\xB0", "degrees", 1.0},
    {"degC", "degrees Celsius", 1.0},
    {"\xC2\xB0"
     "C",
     "degrees Celsius", 1.0},
    {"samples", "", 1.0},
    {"elements", "", 1.0},
};

void substitute(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

std::optional<CaseUnit> find_case_unit(std::string_view text) {
  std::string plain(text);
  for (const auto& [power, digit] :
       {std::pair{"\xC2\xB2", "2"}, std::pair{"\xC2\xB3", "3"}, std::pair{"\xE2\x81\xB4", "4"},
        std::pair{"\xC2\xB7", ""}, std::pair{"^", ""}, std::pair{"*", ""}, std::pair{" ", ""}})
    substitute(plain, power, digit);
  if (const auto found = std::ranges::find(kCaseUnits, plain, &CaseUnit::name);
      found != std::end(kCaseUnits))
    return *found;
  if (const auto unit = signals::find_unit(text))
    return CaseUnit{unit->name, signals::si_unit(unit->dimension), unit->si};
  return {};
}

/// The digits of a number, with a decimal point.
std::string plain_digits(std::string text) {
  std::erase(text, ' ');
  std::erase(text, '\'');
  std::erase(text, '_');
  if (text.starts_with('+')) text.erase(0, 1);
  const std::size_t comma = text.rfind(','), point = text.rfind('.');
  if (comma == std::string::npos) return text;
  if (point == std::string::npos || comma > point) {
    // A single comma is a decimal comma; several commas separate groups of thousands.
    if (std::ranges::count(text, ',') > 1) {
      std::erase(text, ',');
    } else {
      std::erase(text, '.');
      text[text.find(',')] = '.';
    }
  } else {
    std::erase(text, ',');
  }
  return text;
}

}  // namespace

std::optional<WrittenNumber> written_number(std::string_view text) {
  const auto trim = [](std::string_view part) {
    const std::size_t first = part.find_first_not_of(" \t[](");
    if (first == std::string_view::npos) return std::string_view();
    return part.substr(first, part.find_last_not_of(" \t])") - first + 1);
  };
  const std::string_view all = trim(text);
  if (all.size() > 40) return {};
  std::size_t end = all.find_first_not_of("+-0123456789.,_' ");
  // Include an exponent if digits follow the letter e.
  if (end != std::string_view::npos && end > 0 && (all[end] == 'e' || all[end] == 'E')) {
    const std::size_t sign =
        end + 1 +
        ((end + 1 < all.size() && (all[end + 1] == '-' || all[end + 1] == '+')) ? 1U : 0U);
    if (sign < all.size() && all[sign] >= '0' && all[sign] <= '9')
      end = all.find_first_not_of("0123456789", sign);
  }
  const std::string digits = plain_digits(std::string(trim(all.substr(0, end))));
  double value = 0.0;
  const char* last = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), last, value);
  if (digits.empty() || error != std::errc() || stop != last || !std::isfinite(value)) return {};
  const std::string_view name =
      end == std::string_view::npos ? std::string_view() : trim(all.substr(end));
  if (name.empty()) return WrittenNumber{value, ""};
  const auto unit = find_case_unit(name);
  if (!unit) return {};
  return WrittenNumber{value * unit->factor, std::string(unit->si)};
}

std::string pasted(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.15g", value);
  const double size = std::abs(value);
  if (!(size >= 1e6 || (size > 1e-300 && size < 1e-4))) return text;
  const int power = static_cast<int>(std::floor(std::log10(size) / 3.0 + 1e-12)) * 3;
  std::snprintf(text, sizeof text, "%.15ge%d", value / std::pow(10.0, power), power);
  return text;
}

std::string number_to_write(std::string_view text) {
  const auto number = written_number(text);
  if (!number) return {};
  return "write " + pasted(number->value) + (number->unit.empty() ? "" : " (" + number->unit + ")");
}

}  // namespace wheeltap::apps
