// Writes universal files: the inverse of universal_file.cpp.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <limits>

#include "io/universal/universal_file.hpp"

namespace wheeltap::io {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string padded(const std::string& text, std::size_t width) {
  std::string out = text.substr(0, width);
  out.resize(width, ' ');
  return out;
}
std::string none_if_empty(const std::string& text, std::size_t width) {
  return padded(text.empty() ? "NONE" : text, width);
}

std::string e13(double x) {
  return formatted("%13.5E", x);
}
std::string e20(double x) {
  return formatted("%20.12E", x);
}
std::string d25(double x) {
  std::string text = formatted("%25.17E", x);
  for (char& c : text)
    if (c == 'E') c = 'D';
  return text;
}

/// A line of text, of 80 characters. A line that looks like the end of a dataset is put in
/// brackets.
std::string text_line(const std::string& text) {
  std::string line = padded(text, 80);
  const std::size_t begin = line.find_first_not_of(" \t\r"), end = line.find_last_not_of(" \t\r");
  if (begin != std::string::npos && line.substr(begin, end - begin + 1) == "-1")
    line = padded("(-1)", 80);
  return line + "\n";
}

constexpr const char* kSeparator = "    -1\n";

void begin(std::string& out, int number) {
  out += kSeparator + formatted("%6d\n", number);
}

std::string of(const UniversalDof& dof) {
  return " " + none_if_empty(dof.entity, 10) + formatted("%10d%4d", dof.node, dof.direction);
}

std::string of(const UniversalAxis& axis) {
  return formatted("%10d%5d%5d%5d ", axis.quantity, axis.powers[0], axis.powers[1],
                   axis.powers[2]) +
         none_if_empty(axis.label, 20) + " " + none_if_empty(axis.unit, 20) + "\n";
}

template <class Real>
void append(std::string& out, double value, bool big_endian) {
  const auto real = static_cast<Real>(value);
  std::array<char, sizeof(Real)> raw{};
  std::memcpy(raw.data(), &real, sizeof(Real));
  if (big_endian != (std::endian::native == std::endian::big))
    for (std::size_t i = 0; i < raw.size() / 2; ++i) std::swap(raw[i], raw[raw.size() - 1 - i]);
  out.append(raw.data(), raw.size());
}

std::string packed_values(const UniversalFunction& f) {
  std::string out;
  const auto add = [&](double value) {
    f.is_double ? append<double>(out, value, f.big_endian)
                : append<float>(out, value, f.big_endian);
  };
  for (std::size_t i = 0; i < f.y.size(); ++i) {
    if (!f.even) append<float>(out, f.x[i], f.big_endian);
    add(f.y[i].real());
    if (f.is_complex) add(f.y[i].imag());
  }
  return out;
}

std::string text_values(const UniversalFunction& f) {
  std::string out;
  // As many values per line as the format allows; each point of an uneven function is on one line.
  const std::size_t ordinates = f.is_complex ? 2 : 1;
  std::size_t points_a_line = 0;
  if (f.is_double) {
    points_a_line = f.even ? 4 / ordinates : (f.is_complex ? 1 : 2);
  } else {
    points_a_line = 6 / (ordinates + (f.even ? 0 : 1));
  }
  const auto ordinate = [&](double value) { return f.is_double ? e20(value) : e13(value); };
  for (std::size_t i = 0; i < f.y.size(); ++i) {
    if (!f.even) out += e13(f.x[i]);
    out += ordinate(f.y[i].real());
    if (f.is_complex) out += ordinate(f.y[i].imag());
    if ((i + 1) % points_a_line == 0 || i + 1 == f.y.size()) out += "\n";
  }
  return out;
}

void add(std::string& out, const UniversalFunction& f) {
  const std::string bytes = f.binary ? packed_values(f) : std::string();
  out += kSeparator;
  if (f.binary) {
    out += formatted("%6db%6d%6d%12d%12zu%6d%6d%12d%12d\n", 58, f.big_endian ? 2 : 1, 2, 11,
                     bytes.size(), 0, 0, 0, 0);
  } else {
    out += formatted("%6d\n", 58);
  }
  for (const std::string& id : f.ids) out += text_line(id);
  out += formatted("%5d%10d%5d%10d", f.type, f.number, f.version, f.load_case) + of(f.response) +
         of(f.reference) + "\n";
  const int ordinate = (f.is_double ? 4 : 2) + (f.is_complex ? (f.is_double ? 2 : 3) : 0);
  out += formatted("%10d%10zu%10d", ordinate, f.y.size(), f.even ? 1 : 0) + e13(f.first) +
         e13(f.step) + e13(f.z) + "\n";
  out += of(f.abscissa) + of(f.numerator) + of(f.denominator) + of(f.z_axis);
  out += f.binary ? bytes + "\n" : text_values(f);
  out += kSeparator;
}

void add(std::string& out, const UniversalShape& s) {
  begin(out, 55);
  for (const std::string& id : s.ids) out += text_line(id);
  out += formatted("%10d%10d%10d%10d%10d%10d\n", s.model, s.analysis, s.characteristic, s.quantity,
                   s.is_complex ? 5 : 2, s.values_a_node);
  out += formatted("%10zu%10zu", s.integers.size(), s.reals.size());
  for (std::size_t i = 0; i < s.integers.size(); ++i)
    out += formatted((i + 2) % 8 == 0 ? "\n%10d" : "%10d", s.integers[i]);
  out += "\n";
  for (std::size_t i = 0; i < s.reals.size(); ++i)
    out += e13(s.reals[i]) + ((i + 1) % 6 == 0 || i + 1 == s.reals.size() ? "\n" : "");
  const auto each = static_cast<std::size_t>(s.values_a_node);
  for (std::size_t n = 0; n < s.nodes.size(); ++n) {
    out += formatted("%10d\n", s.nodes[n]);
    std::size_t written = 0;
    const auto value = [&](double x) {
      out += (written++ % 6 == 0 && written > 1 ? "\n" : "") + e13(x);
    };
    for (std::size_t k = 0; k < each; ++k) {
      value(s.values[n * each + k].real());
      if (s.is_complex) value(s.values[n * each + k].imag());
    }
    out += "\n";
  }
  out += kSeparator;
}

/// Formats the nodes with eight numbers per line.
std::string in_rows(const std::vector<int>& nodes) {
  std::string out;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    out += formatted(i > 0 && i % 8 == 0 ? "\n%10d" : "%10d", nodes[i]);
  return out + (nodes.empty() ? "" : "\n");
}

/// Writes nodes of double precision as dataset 2411, other nodes as dataset 15.
void add(std::string& out, const std::vector<UniversalNode>& nodes) {
  for (const bool is_double : {false, true}) {
    if (std::ranges::count(nodes, is_double, &UniversalNode::is_double) == 0) continue;
    begin(out, is_double ? 2411 : 15);
    for (const UniversalNode& n : nodes) {
      if (n.is_double != is_double) continue;
      out += formatted("%10d%10d%10d%10d", n.label, n.definition, n.displacement, n.colour);
      if (is_double)
        out += "\n" + d25(n.at[0]) + d25(n.at[1]) + d25(n.at[2]) + "\n";
      else
        out += e13(n.at[0]) + e13(n.at[1]) + e13(n.at[2]) + "\n";
    }
    out += kSeparator;
  }
}

}  // namespace

std::string universal_text(const UniversalFile& file) {
  std::string out;
  if (file.header) {
    begin(out, 151);
    for (const std::string& line : file.header->lines) out += text_line(line);
    out += kSeparator;
  }
  if (file.units) {
    const UniversalUnits& u = *file.units;
    begin(out, 164);
    out += formatted("%10d", u.code) + padded(u.description, 20) +
           formatted("%10d\n", u.temperature_mode);
    out += d25(u.factors[0]) + d25(u.factors[1]) + d25(u.factors[2]) + "\n" +
           d25(u.temperature_offset) + "\n" + kSeparator;
  }
  if (!file.systems.empty()) {
    begin(out, 2420);
    out += formatted("%10d\n", 1) + text_line("");
    for (const UniversalSystem& s : file.systems) {
      out += formatted("%10d%10d%10d\n", s.label, s.kind, s.colour) + text_line(s.name);
      for (const std::array<double, 3>& row : s.axes)
        out += d25(row[0]) + d25(row[1]) + d25(row[2]) + "\n";
    }
    out += kSeparator;
  }
  add(out, file.nodes);
  if (!file.elements.empty()) {
    begin(out, 2412);
    for (const UniversalElement& e : file.elements) {
      out += formatted("%10d%10d%10d%10d%10d%10zu\n", e.label, e.descriptor, e.physical, e.material,
                       e.colour, e.nodes.size());
      if (e.is_beam()) out += formatted("%10d%10d%10d\n", e.beam[0], e.beam[1], e.beam[2]);
      out += in_rows(e.nodes);
    }
    out += kSeparator;
  }
  for (const UniversalTrace& t : file.traces) {
    begin(out, 82);
    out += formatted("%10d%10zu%10d\n", t.number, t.nodes.size(), t.colour) + text_line(t.id);
    out += in_rows(t.nodes) + kSeparator;
  }
  for (const UniversalShape& s : file.shapes) add(out, s);
  for (const UniversalFunction& f : file.functions) add(out, f);
  return out;
}

}  // namespace wheeltap::io
