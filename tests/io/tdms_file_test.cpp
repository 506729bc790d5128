#include "io/formats/tdms_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "io/formats/formats.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io::tdms_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The elements of segments, in one byte order.
struct Writer {
  bool big_endian = false;

  template <class T>
  std::string operator()(T value) const {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_endian) std::reverse(raw, raw + sizeof(T));
    return {raw, sizeof(T)};
  }
  std::string text(const std::string& x) const {
    return (*this)(static_cast<std::uint32_t>(x.size())) + x;
  }
  std::string number(const std::string& name, double x) const {
    return text(name) + (*this)(std::uint32_t{10}) + (*this)(x);
  }
  std::string word(const std::string& name, const std::string& x) const {
    return text(name) + (*this)(std::uint32_t{0x20}) + text(x);
  }
  std::string layout(std::uint32_t type, std::uint64_t count) const {
    return (*this)(std::uint32_t{20}) + (*this)(type) + (*this)(std::uint32_t{1}) + (*this)(count);
  }
  std::string object(const std::string& path, const std::string& layout,
                     const std::vector<std::string>& properties = {}) const {
    std::string out = text(path) + layout + (*this)(static_cast<std::uint32_t>(properties.size()));
    for (const std::string& property : properties) out += property;
    return out;
  }
  std::string segment(std::uint32_t contents, const std::vector<std::string>& objects,
                      const std::string& raw) const {
    std::string metadata;
    if (!objects.empty()) metadata = (*this)(static_cast<std::uint32_t>(objects.size()));
    for (const std::string& object : objects) metadata += object;
    if (big_endian) contents |= 1U << 6U;
    return "TDSm" + Writer{}(contents) + (*this)(std::uint32_t{4713}) +
           (*this)(std::uint64_t{metadata.size() + raw.size()}) +
           (*this)(std::uint64_t{metadata.size()}) + metadata + raw;
  }
};

constexpr std::uint32_t kBoth = 0x0E, kRawOnly = 0x08, kInterleaved = 0x20;
constexpr std::uint32_t kDouble = 10, kShort = 2;

std::string sound(const Writer& w, std::uint32_t more = 0) {
  const std::vector<std::string> properties = {w.number("wf_increment", 0.01),
                                               w.word("unit_string", "m/s^2")};
  const std::vector<std::string> objects = {
      w.object("/", w(0xFFFFFFFFU)), w.object("/'Test'", w(0xFFFFFFFFU)),
      w.object("/'Test'/'acc x'", w.layout(kDouble, 2), properties),
      w.object("/'Test'/'it''s raw'", w.layout(kShort, 2))};
  const auto a = [&](double x) { return w(x); };
  const auto b = [&](std::int16_t x) { return w(x); };
  const std::string raw = more == kInterleaved
                              ? a(1) + b(10) + a(2) + b(20) + a(3) + b(30) + a(4) + b(40)
                              : a(1) + a(2) + b(10) + b(20) + a(3) + a(4) + b(30) + b(40);
  const std::string last =
      more == kInterleaved ? a(5) + b(50) + a(6) + b(60) : a(5) + a(6) + b(50) + b(60);
  // Two chunks, then a segment that repeats the layout.
  return w.segment(kBoth | more, objects, raw) + w.segment(kRawOnly | more, {}, last);
}

std::string fault(const std::string& bytes) {
  try {
    static_cast<void>(parse_tdms(bytes, "r.tdms", {}));
  } catch (const FileError& error) {
    return error.reason();
  }
  return {};
}

TEST(TdmsFile, ReadsChannelsOfEveryLayout) {
  const test::TemporaryDirectory directory;
  for (const bool big_endian : {false, true})
    for (const std::uint32_t more : {0U, kInterleaved}) {
      test::put_bytes(directory / "r.tdms", sound(Writer{big_endian}, more));
      const Columns t = read_columns(directory / "r.tdms");
      ASSERT_EQ(t.columns.size(), 3U);
      EXPECT_EQ(t.columns[0].header, "time [s]");
      EXPECT_DOUBLE_EQ(t.columns[0].values[5], 0.05);
      EXPECT_EQ(t.columns[1].header, "acc x [m/s^2]");
      EXPECT_THAT(t.columns[1].values, ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
      EXPECT_EQ(t.columns[2].header, "it's raw");
      EXPECT_THAT(t.columns[2].values, ElementsAre(10.0, 20.0, 30.0, 40.0, 50.0, 60.0));
    }
}

TEST(TdmsFile, AppliesTheScalesOfAChannel) {
  const Writer w;
  const std::vector<std::string> properties = {
      w.number("NI_Number_Of_Scales", 2.0),
      w.word("NI_Scale[0]_Scale_Type", "Linear"),
      w.number("NI_Scale[0]_Linear_Slope", 0.5),
      w.number("NI_Scale[0]_Linear_Y_Intercept", 1.0),
      w.number("NI_Scale[0]_Linear_Input_Source", 4294967295.0),
      w.word("NI_Scale[1]_Scale_Type", "Polynomial"),
      w.number("NI_Scale[1]_Polynomial_Coefficients_Size", 3.0),
      w.number("NI_Scale[1]_Polynomial_Coefficients[2]", 1.0),
      w.number("NI_Scale[1]_Polynomial_Input_Source", 0.0)};
  const std::string raw = w(std::int16_t{2}) + w(std::int16_t{4});
  const Columns t = parse_tdms(
      w.segment(kBoth, {w.object("/'g'/'c'", w.layout(kShort, 2), properties)}, raw), "r", {});
  EXPECT_THAT(t.columns[0].values, ElementsAre(4.0, 9.0)) << "(0.5 x + 1)^2";
}

TEST(TdmsFile, ChannelsOfOtherLengthsAndTextsAreListed) {
  const Writer w;
  const std::string text =
      w.object("/'h'/'note'", w(std::uint32_t{28}) + w(std::uint32_t{0x20}) + w(std::uint32_t{1}) +
                                  w(std::uint64_t{1}) + w(std::uint64_t{9}));
  const std::string raw =
      w(1.0) + w(2.0) + w(3.0) + w(7.0) + w(8.0) + w(std::uint32_t{5}) + std::string("words");
  const Columns t = parse_tdms(w.segment(kBoth,
                                         {w.object("/'g'/'a'", w.layout(kDouble, 3)),
                                          w.object("/'g'/'b'", w.layout(kDouble, 2)), text},
                                         raw),
                               "r", {});
  EXPECT_EQ(t.columns[0].name, "g/a") << "there are two groups";
  EXPECT_THAT(t.others,
              ElementsAre("h/note (text)",
                          "g/b (2 x 1, of another length: to read it, name 'g/b' in the case)"));
}

TEST(TdmsFile, RejectsDaqmxAndUnknownScalesWithTheRemedy) {
  const Writer w;
  EXPECT_THAT(fault(w.segment(kBoth | 0x80, {w.object("/'g'/'c'", w(0x1269U))}, "")),
              HasSubstr("export the data as text"));
  const std::vector<std::string> properties = {w.number("NI_Number_Of_Scales", 1.0),
                                               w.word("NI_Scale[0]_Scale_Type", "Thermocouple")};
  EXPECT_THAT(fault(w.segment(kBoth, {w.object("/'g'/'c'", w.layout(kDouble, 2), properties)},
                              w(1.0) + w(2.0))),
              HasSubstr("\"Thermocouple\", which is not read"));
}

TEST(TdmsFile, RejectsFilesTruncatedAtAnyByte) {
  const std::string whole = sound(Writer{}), first = whole.substr(0, whole.size() - 48);
  for (std::size_t kept = 0; kept < whole.size(); ++kept) {
    if (kept == first.size()) continue;  // a truncation between two segments gives a valid file
    EXPECT_NE(fault(whole.substr(0, kept)), "") << kept;
  }
}

TEST(TdmsFile, ReadsCompleteRowsOfAnInterruptedFile) {
  std::string bytes = sound(Writer{});
  const std::size_t last = bytes.rfind("TDSm");
  bytes.replace(last + 12, 8, std::string(8, '\xFF'));
  EXPECT_EQ(parse_tdms(bytes, "r", {}).columns[1].values.size(), 6U);
  bytes.resize(bytes.size() - 3);
  const Columns t = parse_tdms(bytes, "r", {});
  EXPECT_EQ(t.columns[1].values.size(), 4U);
  EXPECT_THAT(t.others, ElementsAre(HasSubstr("incomplete rows")));
}

}  // namespace
}  // namespace wheeltap::io::tdms_file_test
