#include "io/universal/universal_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/constants.hpp"
#include "io/bytes.hpp"
#include "io/universal/universal_reader.hpp"

namespace wheeltap::io {

using namespace universal;

namespace {

UniversalDof dof(const Reader& in, std::string_view line, std::size_t from) {
  return {.entity = none_is_empty(field(line, from, 10)),
          .node = in.integer(field(line, from + 10, 10), "node"),
          .direction = in.integer(field(line, from + 20, 4), "direction")};
}

UniversalAxis axis(Reader& in) {
  const std::string_view line = in.next("an axis");
  UniversalAxis out;
  out.quantity = in.integer(field(line, 0, 10), "quantity");
  for (std::size_t k = 0; k < 3; ++k)
    out.powers[k] = in.integer(field(line, 10 + 5 * k, 5), "power");
  out.label = none_is_empty(field(line, 26, 20));
  out.unit = none_is_empty(field(line, 47, 20));
  return out;
}

template <class Real>
double binary_number(std::string_view bytes, std::size_t at, bool big_endian) {
  std::array<char, sizeof(Real)> raw{};
  std::memcpy(raw.data(), bytes.data() + at, sizeof(Real));
  if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
  Real value{};
  std::memcpy(&value, raw.data(), sizeof(Real));
  return static_cast<double>(value);
}

std::vector<double> binary_values(Reader& in, const UniversalFunction& f, std::size_t points,
                                  std::size_t announced) {
  const std::size_t wide = f.is_double ? 8 : 4;
  const std::size_t ordinates = f.is_complex ? 2 : 1;
  // Abscissae of uneven double functions are single by the format, but double in some programs.
  std::size_t abscissa = f.even ? 0 : 4;
  if (!f.even && f.is_double && announced == points * (8 + ordinates * wide)) abscissa = 8;
  const std::size_t each = abscissa + ordinates * wide;
  if (announced != 0 && announced != points * each)
    in.fail(std::to_string(announced) +
            " bytes of binary data are declared: " + std::to_string(points) + " points of " +
            std::to_string(each) + " bytes need " + std::to_string(points * each));
  const std::string_view bytes = in.raw(points * each);
  std::vector<double> out;
  out.reserve(points * (ordinates + (f.even ? 0 : 1)));
  const auto take = [&](std::size_t at, std::size_t size) {
    out.push_back(size == 8 ? binary_number<double>(bytes, at, f.big_endian)
                            : binary_number<float>(bytes, at, f.big_endian));
  };
  for (std::size_t i = 0; i < points; ++i) {
    std::size_t at = i * each;
    if (abscissa > 0) take(at, abscissa);
    at += abscissa;
    for (std::size_t k = 0; k < ordinates; ++k) take(at + k * wide, wide);
  }
  return out;
}

UniversalFunction function(Reader& in, std::string_view number_line) {
  UniversalFunction f{.line = in.line_number()};
  f.binary = trimmed(number_line).starts_with("58b");
  std::size_t announced = 0;
  if (f.binary) {
    const int order = in.integer(field(number_line, 7, 6), "byte order");
    const int floats = in.integer(field(number_line, 13, 6), "floating-point format");
    if (order != 1 && order != 2)
      in.fail("byte order " + std::to_string(order) + ": must be 1 (little) or 2 (big endian)");
    if (floats != 2)
      in.fail("floating-point format " + std::to_string(floats) + ": only IEEE 754 (2) is read");
    f.big_endian = order == 2;
    const int bytes = in.integer(field(number_line, 31, 12), "number of bytes");
    if (bytes < 0) in.fail("a negative number of bytes");
    announced = static_cast<std::size_t>(bytes);
  }
  for (std::string& id : f.ids) id = text_of(in.next("an ID line"));

  const std::string_view dofs = in.next("degrees of freedom");
  f.type = in.integer(field(dofs, 0, 5), "function type");
  f.number = in.integer(field(dofs, 5, 10), "function number");
  f.version = in.integer(field(dofs, 15, 5), "version");
  f.load_case = in.integer(field(dofs, 20, 10), "load case");
  f.response = dof(in, dofs, 31);
  f.reference = dof(in, dofs, 56);

  const std::string_view form = in.next("the form of the data");
  const int ordinate = in.integer(field(form, 0, 10), "data type");
  if (ordinate != 2 && ordinate != 4 && ordinate != 5 && ordinate != 6)
    in.fail("data type " + std::to_string(ordinate) +
            ": must be 2 or 4 (real, single or double), 5 or 6 (complex)");
  f.is_double = ordinate == 4 || ordinate == 6;
  f.is_complex = ordinate >= 5;
  const int points = in.integer(field(form, 10, 10), "number of points");
  if (points < 0) in.fail("a negative number of points");
  f.even = in.integer(field(form, 20, 10), "spacing") != 0;
  f.first = in.number(field(form, 30, 13), "first abscissa");
  f.step = in.number(field(form, 43, 13), "step");
  f.z = in.number(field(form, 56, 13), "z");
  f.abscissa = axis(in);
  f.numerator = axis(in);
  f.denominator = axis(in);
  f.z_axis = axis(in);

  const auto n = static_cast<std::size_t>(points);
  const std::size_t each = (f.is_complex ? 2 : 1) + (f.even ? 0 : 1);
  std::vector<double> values;
  if (f.binary) {
    values = binary_values(in, f, n, announced);
  } else {
    std::vector<std::size_t> widths(each, f.is_double ? 20 : 13);
    if (!f.even) widths[0] = 13;
    values = in.numbers(n * each, widths, "values");
  }
  f.x.reserve(n);
  f.y.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double* value = values.data() + i * each;
    f.x.push_back(f.even ? f.first + static_cast<double>(i) * f.step : *value++);
    f.y.emplace_back(value[0], f.is_complex ? value[1] : 0.0);
  }
  return f;
}

/// Reads the line of six codes in datasets 55 and 2414.
void codes(Reader& in, UniversalShape& s) {
  const std::vector<int> what = in.integers(in.next("what the data are"), 10, "code");
  if (what.size() < 6) in.fail("has " + std::to_string(what.size()) + " codes: must have 6");
  s.model = what[0];
  s.analysis = what[1];
  s.characteristic = what[2];
  s.quantity = what[3];
  // In dataset 2414, codes 4 and 6 are double precision.
  if (what[4] != 2 && what[4] != 4 && what[4] != 5 && what[4] != 6)
    in.fail("data type " + std::to_string(what[4]) + ": must be 2 (real) or 5 (complex)");
  s.is_complex = what[4] >= 5;
  s.values_a_node = what[5];
  if (s.values_a_node < 1 || s.values_a_node > 9)
    in.fail(std::to_string(s.values_a_node) + " values per node: must be 1 to 9");
}

/// Reads the values at nodes up to the end of the dataset.
void values_at_nodes(Reader& in, UniversalShape& s) {
  const auto each = static_cast<std::size_t>(s.values_a_node);
  while (!in.done() && !in.at_separator()) {
    const std::string_view line = in.next("a node");
    if (trimmed(line).empty()) continue;
    s.nodes.push_back(in.integer(field(line, 0, 10), "node"));
    const std::vector<double> values =
        in.numbers(each * (s.is_complex ? 2 : 1), {13}, "values of a node");
    for (std::size_t k = 0; k < each; ++k)
      s.values.push_back(s.is_complex ? std::complex(values[2 * k], values[2 * k + 1])
                                      : std::complex(values[k], 0.0));
  }
}

UniversalShape shape(Reader& in) {
  UniversalShape s{.line = in.line_number()};
  for (std::string& id : s.ids) id = text_of(in.next("an ID line"));
  codes(in, s);
  std::vector<int> head = in.integers(in.next("how many numbers follow"), 10, "number");
  if (head.size() < 2) in.fail("does not state how many numbers follow");
  const int integers = head[0], reals = head[1];
  if (integers < 0 || integers > 1000 || reals < 0 || reals > 1000)
    in.fail("declares " + std::to_string(integers) + " and " + std::to_string(reals) + " numbers");
  s.integers.assign(head.begin() + 2, head.end());
  while (s.integers.size() < static_cast<std::size_t>(integers))
    for (const int i : in.integers(in.next("numbers"), 10, "number")) s.integers.push_back(i);
  s.reals = in.numbers(static_cast<std::size_t>(reals), {13}, "numbers");
  values_at_nodes(in, s);
  return s;
}

/// Reads dataset 2414; returns std::nullopt if its values are not at nodes.
std::optional<UniversalShape> analysis_data(Reader& in) {
  UniversalShape s{.line = in.line_number()};
  static_cast<void>(in.next("the dataset's label"));
  static_cast<void>(in.next("the dataset's name"));
  const int where = in.integer(field(in.next("where the values are"), 0, 10), "location");
  for (std::string& id : s.ids) id = text_of(in.next("an ID line"));
  constexpr int kAtNodes = 1;
  if (where != kAtNodes) return {};
  codes(in, s);
  const std::vector<int> set = in.integers(in.next("the solution's numbers"), 10, "number");
  static_cast<void>(in.next("how the data were made"));
  const std::vector<double> first = in.numbers(6, {13}, "numbers of the solution");
  const std::vector<double> second = in.numbers(6, {13}, "numbers of the solution");
  const auto number = [&](std::size_t k) { return k < set.size() ? set[k] : 0; };
  s.integers = {number(4), number(5)};  // load set and mode
  if (s.analysis == 2)
    s.reals = {first[1], first[3], first[4], first[5]};  // frequency, modal mass, damping ratios
  else if (s.analysis == 3 || s.analysis == 7)
    s.reals = second;  // eigenvalue, modal a, modal b
  else
    s.reals = {first[0], first[1]};
  values_at_nodes(in, s);
  return s;
}

UniversalUnits units(Reader& in) {
  UniversalUnits u;
  const std::string_view line = in.next("a unit code");
  u.code = in.integer(field(line, 0, 10), "unit code");
  u.description = text_of(field(line, 10, 20));
  u.temperature_mode = in.integer(field(line, 30, 10), "temperature mode");
  const std::vector<double> values = [&] {
    // The factors are on one line, the offset on the next line; some programs omit the offset.
    std::vector<double> all = in.numbers(3, {25}, "unit factors");
    if (!in.done() && !in.at_separator() && !trimmed(in.peek()).empty())
      for (const double v : in.numbers(1, {25}, "temperature offset")) all.push_back(v);
    return all;
  }();
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(values[k] > 0.0)) in.fail("a unit factor must be positive");
    u.factors[k] = values[k];
  }
  if (values.size() > 3) u.temperature_offset = values[3];
  return u;
}

/// Advances to the line after the dataset's closing separator and skips the lines before it.
void finish(Reader& in, bool may_hold_more) {
  while (!in.done()) {
    const bool separator = in.at_separator();
    const std::string_view line = in.next("the end of a dataset");
    if (separator) return;
    if (!may_hold_more && !trimmed(line).empty())
      in.fail("'" + std::string(trimmed(line)).substr(0, 40) +
              "' where a dataset must end with -1");
  }
  in.fail("the file is truncated: its last dataset does not end with -1");
}

}  // namespace

int UniversalShape::mode() const {
  return integers.size() > 1 ? integers[1] : 0;
}

double UniversalShape::frequency_hz() const {
  if (analysis == 2 && !reals.empty()) return reals[0];
  if ((analysis == 3 || analysis == 7) && reals.size() > 1)
    return std::hypot(reals[0], reals[1]) / kTwoPi;
  return kNaN;
}

double UniversalShape::damping() const {
  if (analysis == 2 && reals.size() > 2) return reals[2];
  if ((analysis == 3 || analysis == 7) && reals.size() > 1)
    return -reals[0] / std::hypot(reals[0], reals[1]);
  return kNaN;
}

UniversalFile parse_universal_file(const std::string& bytes, const std::filesystem::path& name) {
  UniversalFile out;
  Reader in(bytes, name);
  in.skip_blanks();
  if (in.done() || !in.at_separator())
    throw FileError(FileError::Kind::foreign, name,
                    "is not a universal file: it must begin with a line that holds -1");
  while (!in.done()) {
    if (!in.at_separator()) {
      const std::string_view line = in.next("a dataset");
      if (!trimmed(line).empty())
        in.fail("'" + std::string(trimmed(line)).substr(0, 40) +
                "' where a dataset must begin with -1");
      continue;
    }
    static_cast<void>(in.next("a dataset"));
    if (in.done()) break;
    const std::string_view kind = in.next("a dataset's number");
    const std::string_view word = Reader::split(kind).empty() ? "" : Reader::split(kind)[0];
    if (word.empty()) in.fail("a dataset without a number");
    bool exact = true;
    if (word == "58" || word == "58b" || word == "58B") {
      out.functions.push_back(function(in, kind));
      if (out.functions.back().binary) in.skip_blanks();
    } else if (word == "55") {
      out.shapes.push_back(shape(in));
    } else if (word == "15") {
      read_nodes(in, out.nodes);
    } else if (word == "2411") {
      read_double_nodes(in, out.nodes);
    } else if (word == "2412") {
      read_elements(in, out.elements);
    } else if (word == "2414") {
      if (auto s = analysis_data(in); s) {
        out.shapes.push_back(std::move(*s));
      } else {
        ++out.left_out[2414];
        exact = false;
      }
    } else if (word == "2420") {
      read_systems(in, out.systems);
    } else if (word == "82") {
      read_traces(in, out.traces);
    } else if (word == "151") {
      out.header.emplace();
      for (std::string& line : out.header->lines)
        if (!in.done() && !in.at_separator()) line = text_of(in.next("the header"));
      exact = false;
    } else if (word == "164") {
      out.units = units(in);
    } else {
      ++out.left_out[in.integer(word, "a dataset's number")];
      exact = false;
    }
    finish(in, !exact);
  }
  return out;
}

UniversalFile read_universal_file(const std::filesystem::path& path) {
  return parse_universal_file(read_bytes(path), path);
}

}  // namespace wheeltap::io
