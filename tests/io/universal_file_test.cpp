#include "io/universal/universal_file.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "io/bytes.hpp"
#include "io/formats/formats.hpp"
#include "io/tables/delimited_text.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io::universal_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

UniversalFile parsed(const std::string& text) {
  return parse_universal_file(text, "test.uff");
}

void expect_refused(const std::string& text, const std::string& words) {
  try {
    static_cast<void>(parsed(text));
    ADD_FAILURE() << "not refused: " << words;
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

/// A small dataset 58; `form` is record 7, `data` the lines after the axes.
std::string dataset_58(const std::string& form, const std::string& data, int type = 1) {
  std::string out = "    -1\n    58\nid\nNONE\nNONE\nNONE\nNONE\n";
  char line[200];
  std::snprintf(line, sizeof line, "%5d%10d%5d%10d NONE      %10d%4d NONE      %10d%4d\n", type, 0,
                0, 0, 12, 3, 7, -1);
  out += line + form + "\n";
  out += "        17    0    0    0 Time                 s                   \n";
  out += "        12    1    0    0 Acceleration         m/s2                \n";
  out += "         0    0    0    0 NONE                 NONE                \n";
  out += "         0    0    0    0 NONE                 NONE                \n";
  return out + data + "    -1\n";
}
constexpr const char* kReal =
    "         2         4         1  0.00000E+00  5.00000E-01  0.00000E+00";

/// Functions of every data type, with values that need all of their digits.
UniversalFile all_sorts() {
  UniversalFile file;
  file.header.emplace();
  file.header->lines[0] = "a model";
  file.units = UniversalUnits{.code = 9,
                              .description = "USER_DEFINED",
                              .factors = {1000.0, 1.0, 1.0},
                              .temperature_offset = -273.15};
  file.nodes = {{.label = 1, .colour = 8, .at = {1.5, -2.25, 1e-3}},
                {.label = 20, .at = {0, 1, 2}}};
  file.traces = {{.number = 1, .id = "outline", .nodes = {1, 2, 3, 4, 5, 6, 7, 8, 0, 9, 1}}};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const bool is_complex : {false, true}) {
    UniversalShape s{.model = 1,
                     .analysis = is_complex ? 3 : 2,
                     .characteristic = 3,
                     .quantity = 8,
                     .is_complex = is_complex,
                     .values_a_node = 6,
                     .integers = {0, 4},
                     .nodes = {1, 20, 300}};
    s.ids[0] = "mode 4";
    s.reals = is_complex ? std::vector{-1.5, 62.5, 0.0, 0.0, 0.0, 0.0}
                         : std::vector{12.5, 1.0, 0.025, 0.0};
    for (int i = 0; i < 18; ++i)
      s.values.emplace_back(std::round(1e5 * uniform(random)) / 1e5,
                            is_complex ? std::round(1e5 * uniform(random)) / 1e5 : 0.0);
    file.shapes.push_back(s);
    for (const bool is_double : {false, true})
      for (const bool even : {false, true})
        for (const int storage : {0, 1, 2}) {  // text, little endian, big endian
          UniversalFunction f{.type = is_complex ? 4 : 1,
                              .response = {"beam", 12, 3},
                              .reference = {"", 7, -1},
                              .is_complex = is_complex,
                              .is_double = is_double,
                              .even = even,
                              .first = even ? 0.5 : 0.0,
                              .step = even ? 0.25 : 0.0,
                              .binary = storage > 0,
                              .big_endian = storage == 2};
          f.ids[0] = "function";
          f.abscissa = {.quantity = 18, .label = "Frequency", .unit = "Hz"};
          f.numerator = {
              .quantity = 12, .powers = {1, 0, 0}, .label = "Acceleration", .unit = "m/s2"};
          for (int i = 0; i < 7; ++i) {  // lines that are not full
            // Values that text or a float represents exactly.
            const auto held = [&](double value) {
              return is_double && storage > 0 ? value : std::round(value * 1024.0) / 1024.0;
            };
            f.x.push_back(even ? 0.5 + 0.25 * i : 0.125 * i * i);
            f.y.emplace_back(held(uniform(random)), is_complex ? held(uniform(random)) : 0.0);
          }
          file.functions.push_back(f);
        }
  }
  return file;
}

TEST(UniversalFile, RoundTripsFiniteElementGeometry) {
  UniversalFile file;
  file.nodes = {{.label = 7, .displacement = 2, .at = {1.0 / 3.0, -2e-17, 1e20}, .is_double = true},
                {.label = 8, .at = {0.5, 0, 0}}};
  file.elements = {
      {.label = 1, .descriptor = 21, .beam = {0, 3, 4}, .nodes = {7, 8}},
      {.label = 2,
       .descriptor = 115,
       .physical = 5,
       .material = 6,
       .colour = 7,
       .nodes = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20}}};
  file.systems = {{.label = 2,
                   .kind = 1,
                   .name = "skew",
                   .axes = {{{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}, {10, 20, 30}}}}};
  const std::string text = universal_text(file);
  const UniversalFile again = parsed(text);
  EXPECT_EQ(universal_text(again), text) << "byte for byte";
  ASSERT_THAT(again.nodes, SizeIs(2));
  EXPECT_EQ(again.nodes[1].at, file.nodes[0].at) << "double precision keeps every digit";
  EXPECT_EQ(again.nodes[1].displacement, 2);
  ASSERT_THAT(again.elements, SizeIs(2));
  EXPECT_EQ(again.elements[0].beam, file.elements[0].beam);
  EXPECT_EQ(again.elements[0].nodes, file.elements[0].nodes);
  EXPECT_EQ(again.elements[1].nodes, file.elements[1].nodes);
  EXPECT_EQ(again.elements[1].material, 6);
  ASSERT_THAT(again.systems, SizeIs(1));
  EXPECT_EQ(again.systems[0].axes, file.systems[0].axes);
  EXPECT_TRUE(again.left_out.empty());
}

/// Dataset 2414 with these six codes, the numbers of a mode and the values of node 12.
std::string analysis_data(const std::string& where, const std::string& codes,
                          const std::string& values) {
  return "    -1\n  2414\n         1\nModes of a frame\n" + where +
         "\nID 1\nID 2\nNONE\nNONE\nNONE\n" + codes +
         "\n         0         0         0         0         1         3         0         0\n"
         "         0         0\n"
         "  0.00000E+00  1.25000E+01  6.16850E+03  2.00000E+00  2.50000E-02  0.00000E+00\n"
         " -1.50000E+00  6.25000E+01  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n"
         "        12\n" +
         values + "\n    -1\n";
}

TEST(UniversalFile, AnalysisDataAtNodesAreShapes) {
  const UniversalFile normal = parsed(
      analysis_data("         1", "         1         2         2         8         2         3",
                    "  1.00000E+00 -5.00000E-01  2.50000E-01"));
  ASSERT_THAT(normal.shapes, SizeIs(1));
  EXPECT_EQ(normal.shapes[0].mode(), 3);
  EXPECT_EQ(normal.shapes[0].frequency_hz(), 12.5);
  EXPECT_EQ(normal.shapes[0].damping(), 0.025);
  EXPECT_EQ(normal.shapes[0].ids[0], "ID 1");
  EXPECT_EQ(normal.shapes[0].nodes, std::vector<int>{12});
  EXPECT_EQ(normal.shapes[0].values[1], std::complex(-0.5, 0.0));
  const UniversalFile again = parsed(universal_text(normal));
  EXPECT_EQ(again.shapes[0].mode(), 3) << "written as dataset 55";
  EXPECT_EQ(again.shapes[0].frequency_hz(), 12.5);

  const UniversalFile damped = parsed(
      analysis_data("         1", "         1         3         2         8         5         1",
                    "  1.00000E+00 -5.00000E-01"));
  EXPECT_EQ(damped.shapes[0].values[0], std::complex(1.0, -0.5));
  EXPECT_NEAR(damped.shapes[0].damping(), 1.5 / std::hypot(1.5, 62.5), 1e-12);

  const UniversalFile elsewhere = parsed(
      analysis_data("         2", "         1         2         2         8         2         3",
                    "  1.00000E+00 -5.00000E-01  2.50000E-01"));
  EXPECT_THAT(elsewhere.shapes, SizeIs(0)) << "values on elements";
  EXPECT_EQ(elsewhere.left_out.at(2414), 1);
}

TEST(UniversalFile, RejectsTruncatedGeometry) {
  expect_refused("    -1\n  2411\n         1         0         0         0\n    -1\n",
                 "only 0 of 3 coordinates");
  expect_refused(
      "    -1\n  2412\n         1        44         0         0         0         4\n"
      "         1         2\n    -1\n",
      "only 2 of 4 nodes");
  expect_refused("    -1\n  2420\n         1\npart\n         1         5         0\n    -1\n",
                 "must be 0 (Cartesian)");
}

TEST(UniversalFile, RoundTripsWrittenFiles) {
  const UniversalFile file = all_sorts();
  const std::string text = universal_text(file);
  const UniversalFile again = parsed(text);
  EXPECT_EQ(universal_text(again), text) << "byte for byte";
  EXPECT_EQ(again.header->lines[0], "a model");
  EXPECT_EQ(again.units->factors[0], 1000.0);
  EXPECT_DOUBLE_EQ(again.metres(), 1e-3);
  ASSERT_THAT(again.nodes, SizeIs(2));
  EXPECT_EQ(again.nodes[0].at, file.nodes[0].at);
  EXPECT_EQ(again.traces[0].nodes, file.traces[0].nodes);
  ASSERT_THAT(again.shapes, SizeIs(2));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.shapes[i].nodes, file.shapes[i].nodes);
    EXPECT_EQ(again.shapes[i].values, file.shapes[i].values);
    EXPECT_EQ(again.shapes[i].mode(), 4);
  }
  EXPECT_EQ(again.shapes[0].frequency_hz(), 12.5);
  EXPECT_EQ(again.shapes[0].damping(), 0.025);
  EXPECT_NEAR(again.shapes[1].frequency_hz(), std::hypot(1.5, 62.5) / (2 * 3.14159265358979),
              1e-12);
  EXPECT_NEAR(again.shapes[1].damping(), 1.5 / std::hypot(1.5, 62.5), 1e-12);
  ASSERT_THAT(again.functions, SizeIs(24));
  for (std::size_t i = 0; i < 24; ++i) {
    const UniversalFunction &f = again.functions[i], &g = file.functions[i];
    EXPECT_EQ(f.x, g.x) << i;
    ASSERT_EQ(f.y.size(), g.y.size());
    const double digits = f.binary ? 0.0 : (f.is_double ? 1e-12 : 5e-6);
    for (std::size_t k = 0; k < f.y.size(); ++k) EXPECT_LE(std::abs(f.y[k] - g.y[k]), digits) << i;
    EXPECT_EQ(f.response.node, 12);
    EXPECT_EQ(f.reference.direction, -1);
    EXPECT_EQ(f.numerator.unit, "m/s2");
    EXPECT_EQ(f.type, g.type);
  }
}

TEST(UniversalFile, ReadsFortranNumbers) {
  const UniversalFile touching =
      parsed(dataset_58(kReal, " 1.00000E+000-2.00000D+000  3.00000-100 -4.00000E-00\n"));
  const auto& y = touching.functions[0].y;
  EXPECT_EQ(y[0], 1.0);
  EXPECT_EQ(y[1], -2.0);
  EXPECT_EQ(y[2], 3e-100);
  EXPECT_EQ(y[3], -4.0);
  // Some programs do not align columns.
  const UniversalFile loose = parsed(dataset_58(kReal, "1 -2.5\n\n3e0   4\n"));
  EXPECT_EQ(loose.functions[0].y[1], -2.5);
  EXPECT_EQ(loose.functions[0].x, (std::vector{0.0, 0.5, 1.0, 1.5}));
}

// Function type 9, lines with a CR, no newline after the last -1, blanks before the first.
TEST(UniversalFile, ReadsUnusualLineEndsAndBlanks) {
  std::string text = dataset_58(kReal, " 1.00000E+00\n 2.00000E+00 3.00000E+00 4.00000E+00\n", 9);
  EXPECT_EQ(function_in_words(parsed(text).functions[0].type), "power spectral density");
  text.pop_back();
  EXPECT_THAT(parsed(text).functions, SizeIs(1));
  std::string dos;
  for (const char c : text) dos += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_THAT(parsed("\n" + dos + "   \r\n").functions, SizeIs(1));
}

// A line end may follow the bytes, and the bytes may look like one.
TEST(UniversalFile, ReadsBinaryDataWithAndWithoutALastNewline) {
  UniversalFile file;
  UniversalFunction f{.type = 1, .is_double = false, .binary = true};
  for (const double y : {1.0, 2.0, 2.5660e-9}) f.y.emplace_back(y, 0.0);
  f.x.assign(3, 0.0);
  file.functions = {f, f};
  const std::string text = universal_text(file);
  EXPECT_THAT(parsed(text).functions, SizeIs(2));
  std::string tight = text;
  for (std::size_t at; (at = tight.find("\n    -1\n    -1")) != std::string::npos;)
    tight.erase(at, 1);
  const std::size_t last = tight.rfind("\n    -1");
  tight.erase(last, 1);
  EXPECT_THAT(parsed(tight).functions, SizeIs(2));
}

TEST(UniversalFile, CountsUnknownDatasets) {
  const UniversalFile file = parsed(
      "    -1\n  2430\n  anything\n    -1\n    -1\n  2430\n    -1\n    -1\n    18\n x\n    -1\n");
  EXPECT_THAT(file.left_out, ElementsAre(std::pair{18, 1}, std::pair{2430, 2}));
}

// Regression: a text line "-1" ended its dataset when the file was read again.
TEST(UniversalFile, WrittenTextNeverEndsADataset) {
  UniversalFile file;
  file.header.emplace();
  file.header->lines[1] = "  -1 ";
  file.header->lines[2] = "-1" + std::string(90, ' ') + "beyond the line";
  file.traces.push_back({.number = 1, .id = "-1", .nodes = {1, 2, 3}});
  const UniversalFile again = parse_universal_file(universal_text(file), "written");
  ASSERT_TRUE(again.header);
  EXPECT_EQ(again.header->lines[1].substr(0, 4), "(-1)");
  ASSERT_EQ(again.traces.size(), 1U);
  EXPECT_EQ(again.traces[0].nodes, (std::vector<int>{1, 2, 3}));
}

TEST(UniversalFile, RejectsInvalidFiles) {
  expect_refused("time,force\n0,1\n", "is not a universal file");
  expect_refused("", "is not a universal file");
  expect_refused(dataset_58(kReal, " 1.00000E+00 2.00000E+00\n"), "only 2 of 4 values");
  expect_refused(dataset_58(kReal, "1 2 3 4 5\n"), "1 more values than were declared");
  expect_refused(dataset_58(kReal, "1 2 three 4\n"), "line 14: 'three' is not a number");
  expect_refused(dataset_58("         3         4         1", "1 2 3 4\n"), "data type 3");
  expect_refused(dataset_58("         2        -4         1", ""), "negative number of points");
  expect_refused("    -1\n    58\nid\n", "the file ends where an ID line must follow");
  expect_refused("    -1\n   x\n    -1\n", "must be a whole number");
  expect_refused("    -1\n    58b     3     2          11           0\n", "byte order 3");
  expect_refused("    -1\n    58b     1     3          11           0\n", "only IEEE 754");
  const std::string line = "    -1\n    82\n         1         2         8\noutline\n";
  EXPECT_EQ(parsed(line + "         1         2         0\n    -1\n").traces[0].nodes.size(), 2U);
  expect_refused(line + "         1         2         3\n    -1\n", "more nodes than the 2");
  expect_refused(line + "         1        -2\n    -1\n", "node -2: must not be negative");
  // Nodes and trace lines do not state their number.
  expect_refused(line + "         1         2\n", "its last dataset does not end with -1");
  // 2^31 announced points must not allocate memory in advance.
  expect_refused(dataset_58("         2 999999999         1", "1 2 3 4\n"), "only 4 of");
  UniversalFile file;
  UniversalFunction f{.binary = true};
  f.y.assign(100, {1.0, 0.0});
  f.x.assign(100, 0.0);
  file.functions = {f};
  const std::string text = universal_text(file);
  expect_refused(text.substr(0, text.size() - 300), "bytes of binary data");
}

TEST(UniversalFile, ConvertsFunctionsToATable) {
  UniversalFile file;
  file.units = UniversalUnits{.factors = {1000.0, 1.0, 1.0}};  // millimetres
  for (const int node : {1, 2}) {
    UniversalFunction f{.type = 4, .response = {"", node, 2}, .reference = {"", 1, -3}};
    f.is_complex = true;
    f.abscissa = {.quantity = 18};
    f.numerator = {.quantity = 12, .powers = {1, 0, 0}};
    f.denominator = {.quantity = 13, .powers = {0, 1, 0}};
    f.x = {1.0, 2.0};
    f.first = f.step = 1.0;
    f.y = {{1000.0, 2000.0}, {3000.0, static_cast<double>(node)}};
    file.functions.push_back(f);
  }
  const Columns table = universal_columns(file, "test.uff");
  ASSERT_THAT(table.columns, SizeIs(5));
  EXPECT_EQ(table.columns[0].header, "frequency [Hz]");
  EXPECT_EQ(table.columns[1].header, "1:+Y / 1:-Z acceleration, real [m/s^2/N]");
  EXPECT_THAT(table.columns[1].values, ElementsAre(1.0, 3.0));
  EXPECT_EQ(table.columns[4].values[1], 2e-3);
  // Regression: without powers, values in millimetres were labelled as SI.
  UniversalFile without_powers = file;
  for (UniversalFunction& f : without_powers.functions) f.numerator.powers = {0, 0, 0};
  const Columns raw = universal_columns(without_powers, "test.uff");
  EXPECT_EQ(raw.columns[1].header.find("m/s^2"), std::string::npos) << raw.columns[1].header;
  EXPECT_EQ(raw.columns[1].values[0], 1000.0);
  file.functions[1].step = 2.0;
  EXPECT_THROW(static_cast<void>(universal_columns(file, "test.uff")), FileError);
}

class UniversalSamples : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "needs " << folder_;
  }
  const std::filesystem::path folder_ = WHEELTAP_UFF_SAMPLES;
};

TEST_F(UniversalSamples, MeasuredAccelerances) {
  const UniversalFile file = read_universal_file(folder_ / "measurement_points1-2.uff");
  ASSERT_THAT(file.functions, SizeIs(2));
  EXPECT_EQ(function_in_words(file.functions[0].type), "frequency response");
  EXPECT_EQ(file.functions[0].y.size(), 1001U);
  const DelimitedText text(read_bytes(folder_ / "accelerance_points1-2.csv"), "a.csv");
  const Columns table = text.columns();
  ASSERT_EQ(table.rows(), 1001);
  double worst = 0.0;
  for (std::size_t i = 1; i < 1001; ++i)
    for (std::size_t p = 0; p < 2; ++p) {
      const auto y = file.functions[p].y[i];
      worst = std::max({worst, std::abs(y.real() - table.columns[1 + 2 * p].values[i]),
                        std::abs(y.imag() - table.columns[2 + 2 * p].values[i])});
    }
  EXPECT_LT(worst, 1e-4);
  const std::string again = universal_text(file);
  EXPECT_EQ(universal_text(parsed(again)), again);
}

TEST_F(UniversalSamples, BinaryPressure) {
  const UniversalFile file = read_universal_file(folder_ / "Sample_UFF58b_bin.uff");
  ASSERT_THAT(file.functions, SizeIs(1));
  const UniversalFunction& f = file.functions[0];
  EXPECT_EQ(f.y.size(), 79292U);
  EXPECT_EQ(f.numerator.unit, "Pa");
  EXPECT_NEAR(f.step, 1.52588e-5, 1e-12);
  for (const auto& y : f.y) ASSERT_LT(std::abs(y), 1e3);
  EXPECT_EQ(universal_text(parsed(universal_text(file))), universal_text(file));
}

TEST_F(UniversalSamples, UnevenSpectrumAndShortLines) {
  const UniversalFile psd = read_universal_file(folder_ / "sample_dataset58_psd.uff");
  ASSERT_THAT(psd.functions, SizeIs(1));
  EXPECT_EQ(psd.functions[0].type, 9);
  EXPECT_FALSE(psd.functions[0].even);
  EXPECT_EQ(psd.functions[0].x[3200], 3200.0);
  EXPECT_NEAR(psd.functions[0].y[1].real(), 1.255863e-06, 1e-15);
  EXPECT_EQ(psd.functions[0].numerator.unit, "g\xC2\xB2/Hz") << "Latin-1 becomes UTF-8";
  const Columns history = read_columns(folder_ / "time-history-not-all-columns-filled.uff");
  ASSERT_THAT(history.columns, SizeIs(2));
  EXPECT_EQ(history.columns[0].header, "Time [s]");
  EXPECT_EQ(history.columns[1].header, "1x [m/s\xC2\xB2]");
  EXPECT_EQ(history.rows(), 13);
  EXPECT_EQ(history.columns[1].values[12], -5.84096);
}

TEST_F(UniversalSamples, TestLabsGeometry) {
  const UniversalFile file = read_universal_file(folder_ / "TestLab_161_164_18_15_82.uff");
  EXPECT_THAT(file.header->lines[0], "AME_Test");
  EXPECT_EQ(file.units->description, "USER_DEFINED");
  EXPECT_NEAR(file.units->temperature_offset, -273.15, 1e-10);
  EXPECT_GT(file.nodes.size(), 10U);
  EXPECT_GT(file.traces.size(), 0U);
  EXPECT_THAT(file.left_out, ElementsAre(std::pair{18, 1}));
  EXPECT_EQ(universal_text(parsed(universal_text(file))), universal_text(file));
}

}  // namespace
}  // namespace wheeltap::io::universal_file_test
