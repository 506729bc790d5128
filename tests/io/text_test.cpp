#include "io/text/text.hpp"

#include <gtest/gtest.h>

namespace wheeltap::io {
namespace {

TEST(Text, EscapesUnprintableCharacters) {
  EXPECT_EQ(printable("a beam, 12 µm, Größe, 梁, 🔧"), "a beam, 12 µm, Größe, 梁, 🔧");
  EXPECT_EQ(printable("a\x1b[31mb\nwheeltap: done\t\x7f"), R"(a\x1b[31mb\nwheeltap: done\t\x7f)");
  EXPECT_EQ(printable("a\xff"
                      "b"),
            R"(a\xffb)");
  EXPECT_EQ(printable("\xc2\x9b[2J"), R"(\u{9b}[2J)");    // a C1 control sequence
  EXPECT_EQ(printable("a\xe2\x80\xae"), R"(a\u{202e})");  // right-to-left override
  EXPECT_EQ(printable(std::string("a\0b", 3)), R"(a\x00b)");
  EXPECT_EQ(printable(""), "");
}

TEST(Text, DetectsInvalidUtf8) {
  for (const char* wrong : {"\x80", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                            "\xc3", "\xe2\x82", "\xf8\x88\x80\x80\x80"}) {
    EXPECT_EQ(first_unprintable(wrong), 0U) << printable(wrong);
    // Escaped text contains nothing to escape.
    EXPECT_FALSE(first_unprintable(printable(wrong)));
  }
}

TEST(Text, ReadsInvalidUtf8AsLatin1) {
  EXPECT_EQ(in_utf8("Weg [\xb5m]"), "Weg [µm]");
  EXPECT_EQ(in_utf8("Gr\xf6\xdf"
                    "e"),
            "Größe");
  for (const char* fine : {"", "force [N]", "Weg [µm]", "梁, 🔧", "a\nb\x1b"})
    EXPECT_EQ(in_utf8(fine), fine);
}

TEST(Text, AllowsLineBreaksOnRequest) {
  EXPECT_EQ(first_unprintable("ab\nc"), 2U);
  EXPECT_FALSE(first_unprintable("ab\nc\td", "\n\t"));
  EXPECT_EQ(first_unprintable("ab\nc\r", "\n\t"), 4U);
}

}  // namespace
}  // namespace wheeltap::io
