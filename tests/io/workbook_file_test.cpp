#include "io/formats/workbook_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "io/formats/formats.hpp"
#include "tests/emulator/temporary_directory.hpp"
#include "tests/io/zip_writer.hpp"

namespace wheeltap::io::workbook_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kRelations = R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="rId1" Target="worksheets/sheet1.xml"/>
<Relationship Id="rId2" Target="/xl/worksheets/sheet2.xml"/>
<Relationship Id="rId3" Target="chartsheets/sheet1.xml"/></Relationships>)";

const std::string kStyles = R"(<styleSheet xmlns="urn:m">
<numFmts><numFmt numFmtId="164" formatCode="yyyy\-mm\-dd hh:mm:ss.000"/>
<numFmt numFmtId="165" formatCode="[h]:mm:ss.00"/>
<numFmt numFmtId="166" formatCode="0.000 &quot;m/s&quot;"/></numFmts>
<cellStyleXfs><xf numFmtId="14"/></cellStyleXfs>
<cellXfs><xf numFmtId="0"/><xf numFmtId="164"/><xf numFmtId="165"/><xf numFmtId="166"/>
<xf numFmtId="21"/></cellXfs></styleSheet>)";

std::string sheet(const std::string& rows) {
  return "<worksheet xmlns=\"urn:m\"><sheetData>" + rows + "</sheetData></worksheet>";
}

std::string text(const std::string& t) {
  return "<c t=\"inlineStr\"><is><t>" + t + "</t></is></c>";
}

std::string number(const std::string& value, int style = 0) {
  return "<c s=\"" + std::to_string(style) + "\"><v>" + value + "</v></c>";
}

/// A workbook with a sheet "Log", followed by `second` as a sheet "Notes (2)".
std::string workbook(const std::string& first, const std::string& second = {},
                     const std::string& state = {}, const std::string& properties = {}) {
  std::string list = "<sheet name=\"Log\" sheetId=\"1\" r:id=\"rId1\"" + state + "/>";
  std::vector<std::pair<std::string, std::string>> parts;
  if (!second.empty()) {
    list += "<sheet name=\"Notes &amp; 2\" sheetId=\"2\" r:id=\"rId2\"/>";
    parts.emplace_back("xl/worksheets/sheet2.xml", sheet(second));
  }
  parts.insert(parts.begin(),
               {{"xl/workbook.xml", "<workbook xmlns=\"urn:m\" xmlns:r=\"urn:r\">" + properties +
                                        "<sheets>" + list + "</sheets></workbook>"},
                {"xl/_rels/workbook.xml.rels", kRelations},
                {"xl/styles.xml", kStyles},
                {"xl/sharedStrings.xml",
                 "<sst xmlns=\"urn:m\"><si><t>time [s]</t></si><si><r><t>acc </t></r><r><t>[g]</t>"
                 "</r><rPh><t>x</t></rPh></si></sst>"},
                {"xl/worksheets/sheet1.xml", sheet(first)}});
  return test::zip(parts, true);
}

const std::string kNames =
    "<row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"B1\" t=\"s\"><v>1</v></c></row>";

std::string row(const std::string& cells) {
  return "<row>" + cells + "</row>";
}

std::string error(const std::string& bytes, const TextLayout& stated = {}) {
  try {
    (void)parse_workbook(bytes, "log.xlsx", {}, stated);
  } catch (const FileError& e) {
    return e.what();
  }
  return "nothing thrown";
}

TEST(WorkbookFile, ReadsNamesUnitsAndNumbers) {
  const Columns table = parse_workbook(workbook(kNames + row(number("0") + number("0.5")) +
                                                row(number("1E-2") + number("-0.25", 3)) +
                                                row(number("0.02") + "<c t=\"e\"><v>#N/A</v></c>") +
                                                row(number("0.03") + "<c><f>B2*2</f><v>1</v></c>")),
                                       "log.xlsx", {}, {});
  ASSERT_EQ(table.columns.size(), 2U);
  EXPECT_EQ(table.columns[0].name, "time");
  EXPECT_EQ(table.columns[1].name, "acc");
  EXPECT_EQ(table.columns[1].unit, "g");
  EXPECT_THAT(table.columns[0].values, ElementsAre(0.0, 0.01, 0.02, 0.03));
  EXPECT_THAT(table.columns[1].values, ElementsAre(0.5, -0.25, testing::IsNan(), 1.0));
  ASSERT_TRUE(table.layout);
  EXPECT_EQ(table.layout->used.sheet, "Log");
  EXPECT_EQ(table.layout->first_row, 2);
}

TEST(WorkbookFile, SkipsEmptyColumnsAndRowsBeforeTheTable) {
  const Columns table = parse_workbook(
      workbook("<row r=\"1\"><c r=\"C1\" t=\"inlineStr\"><is><t>Bridge 7</t></is></c></row>"
               "<row r=\"3\"><c r=\"C3\" t=\"s\"><v>0</v></c><c r=\"F3\" t=\"s\"><v>1</v></c></row>"
               "<row r=\"4\"><c r=\"C4\"><v>0</v></c><c r=\"F4\"><v>3</v></c></row>"
               "<row r=\"5\"><c r=\"C5\"><v>1</v></c><c r=\"F5\"><v>5</v></c></row>"
               "<row r=\"6\"><c r=\"C6\"><v>2</v></c><c r=\"F6\"><v>4</v></c></row>"),
      "log.xlsx", {}, {});
  ASSERT_EQ(table.columns.size(), 2U);
  EXPECT_THAT(table.columns[1].values, ElementsAre(3.0, 5.0, 4.0));
  EXPECT_EQ(table.layout->first_row, 4) << "as the sheet counts its rows";
}

TEST(WorkbookFile, DatesAreTimeStampsByTheirNumberFormat) {
  // 44256 is 1 March 2021; a hundredth of a second is 1 / 8 640 000 of a day.
  const std::string head = row(text("Date") + text("acc [g]"));
  const std::string rows = row(number("44256.5", 1) + number("1")) +
                           row(number("44256.500000115741", 1) + number("2")) +
                           row(number("44256.500000231481", 1) + number("3"));
  const Columns table = parse_workbook(workbook(head + rows), "log.xlsx", {}, {});
  ASSERT_EQ(table.columns[0].cells, CellKind::stamp);
  EXPECT_EQ(table.layout->start, "2021-03-01 12:00:00.000000");
  EXPECT_NEAR(table.columns[0].values[1], 0.01, 2e-6);
  EXPECT_NEAR(table.columns[0].values[2], 0.02, 2e-6);

  const Columns since_1904 = parse_workbook(
      workbook(head + rows, {}, {}, "<workbookPr date1904=\"1\"/>"), "log.xlsx", {}, {});
  EXPECT_EQ(since_1904.layout->start, "2025-03-02 12:00:00.000000") << "1462 days later";
}

TEST(WorkbookFile, ElapsedTimesAreSeconds) {
  const Columns table = parse_workbook(
      workbook(row(text("time") + text("acc")) + row(number("1.25", 2) + number("1")) +
               row(number("1.25000115740741", 2) + number("2"))),
      "log.xlsx", {}, {});
  ASSERT_EQ(table.columns[0].cells, CellKind::number);
  EXPECT_THAT(table.columns[0].values, ElementsAre(testing::DoubleNear(108000.0, 1e-4),
                                                   testing::DoubleNear(108000.1, 1e-4)));
}

TEST(WorkbookFile, ReadsAnotherSheetByName) {
  const std::string first =
      kNames + row(number("0") + number("1")) + row(number("1") + number("2"));
  const std::string second = row(text("t") + text("b [mm]")) + row(number("0") + number("7")) +
                             row(number("1") + number("8"));
  const std::string bytes = workbook(first, second);
  EXPECT_THAT(parse_workbook(bytes, "log.xlsx", {}, {}).others,
              ElementsAre("the sheet \"Notes & 2\" (to read it, state \"sheet\": \"Notes & 2\")"));
  const Columns table = parse_workbook(bytes, "log.xlsx", {}, {.sheet = "Notes & 2"});
  EXPECT_EQ(table.columns[1].header, "b [mm]");
  const Columns visible =
      parse_workbook(workbook(first, second, " state=\"hidden\""), "log.xlsx", {}, {});
  EXPECT_EQ(visible.columns[1].header, "b [mm]") << "the first is hidden";
  EXPECT_THAT(error(bytes, {.sheet = "Nots"}),
              HasSubstr("has no sheet \"Nots\"; its sheets are \"Log\", \"Notes & 2\""));
}

TEST(WorkbookFile, RejectsOtherFilesWithTheRemedy) {
  EXPECT_THAT(error("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"), HasSubstr("save it as .xlsx"));
  EXPECT_THAT(error(test::zip({{"mimetype", "x"}})), HasSubstr("without a workbook"));
  EXPECT_THAT(error(workbook("<row r=\"1\"><c r=\"?\"><v>1</v></c></row>")),
              HasSubstr("a cell is at '?'"));
  EXPECT_THAT(error(workbook("<row><c t=\"s\"><v>7</v></c></row>")), HasSubstr("text 7 of 2"));
  EXPECT_THAT(error(workbook("")), HasSubstr("its sheet \"Log\" is empty"));
  EXPECT_THAT(error(workbook("<row>")), HasSubstr("is not XML"));
  EXPECT_THAT(error(workbook(kNames), {.separator = ','}), HasSubstr("leave out separator"));
  std::string cut = workbook(kNames);
  cut.resize(cut.size() / 2);
  EXPECT_NE(error(cut), "nothing thrown");
}

TEST(WorkbookFile, RejectsDocumentsThatExpand) {
  const std::string bomb =
      "<?xml version=\"1.0\"?><!DOCTYPE x [<!ENTITY a \"aaaa\">]><workbook>&a;</workbook>";
  EXPECT_THAT(error(test::zip({{"xl/workbook.xml", bomb}, {"xl/_rels/workbook.xml.rels", bomb}})),
              HasSubstr("DOCTYPE"));
}

TEST(WorkbookFile, IsRecognisedByItsExtension) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "log.xlsx", workbook(kNames + row(number("0") + number("1")) +
                                                   row(number("1") + number("2"))));
  EXPECT_EQ(read_columns(directory / "log.xlsx").rows(), 2);
  test::put_bytes(directory / "log.csv", "t,a\n0,1\n1,2\n");
  EXPECT_THROW((void)read_columns(directory / "log.csv", {}, formats(), {.sheet = "Log"}),
               FileError);
}

}  // namespace
}  // namespace wheeltap::io::workbook_file_test
