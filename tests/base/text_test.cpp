// Texts from outside: what is refused as a name, and what is shown of anything.
#include "engine/base/text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace verisim::text_test {
namespace {

TEST(Text, NamesAreShortLinesOfUtf8) {
  for (const char* fit : {"inserted", "", "Bolzen \"5\" \\ 'x' {}", "größe", "日本", "\U0001f600"})
    EXPECT_EQ(name_fault(fit), "") << fit;
  EXPECT_EQ(name_fault(std::string("a\0b", 3)), "has a control character (0x00 at 2)");
  EXPECT_EQ(name_fault("\x1b[31m"), "has a control character (0x1b at 1)");
  EXPECT_EQ(name_fault("a\nb"), "has a control character (0x0a at 2)");
  EXPECT_EQ(name_fault("\xc2\x9b"), "has a control character (0x9b at 1)");  // CSI, as one character
  EXPECT_EQ(name_fault("ab\xff"), "is not UTF-8 (byte 0xff at 3)");
  EXPECT_EQ(name_fault(std::string(1 << 20, 'x')), "is 1048576 bytes long; 200 are allowed");
}

// RFC 3629: overlong forms, surrogates, codes above U+10FFFF and texts that end within a character are not UTF-8.
TEST(Text, WhatOnlyLooksLikeUtf8IsRefused) {
  for (const char* wrong : {"\xc0\x80", "\xc1\xbf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                            "\xf5\x80\x80\x80", "\xe2\x82", "\x80", "\xf0\x9f\x98", "\xc3("})
    EXPECT_NE(name_fault(wrong).find("is not UTF-8"), std::string::npos);
}

TEST(Text, ValuesMayHaveLines) {
  EXPECT_EQ(value_fault("a\n\tb"), "");
  EXPECT_NE(value_fault("a\rb"), "");
  EXPECT_NE(value_fault(std::string(kLongestValue + 1, 'x')), "");
}

TEST(Text, WhatIsShownIsFitToBeShownAgain) {
  EXPECT_EQ(shown("a\tb\n\x1b[31m\xff" + std::string(1, '\0')), "a\tb\\n\\x1b[31m\\xff\\x00");
  EXPECT_EQ(shown_lines("a\nb\r"), "a\nb\\x0d");
  EXPECT_EQ(shown(std::string(2000, 'x'), 10), "xxxxxxxxxx… (1990 more bytes)");
  std::string every;
  for (int i = 0; i < 256; ++i) every += static_cast<char>(i);
  std::string once = shown(every);
  EXPECT_EQ(shown(once), once);
}

TEST(Text, LinesAreCountedFromOne) {
  EXPECT_EQ(line_of_byte("a\nb\n", 1), 1U);
  EXPECT_EQ(line_of_byte("a\nb\n", 3), 2U);
  EXPECT_EQ(line_of_byte("a\nb", 99), 2U);
  EXPECT_EQ(line_of_byte("", 0), 1U);
}

TEST(Text, NoCharacterIsCutInTwo) {
  EXPECT_EQ(begin_of("aä", 2), "a");
  EXPECT_EQ(begin_of("aä", 3), "aä");
}

}  // namespace
}  // namespace verisim::text_test
