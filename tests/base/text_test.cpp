#include "lte/base/text.h"

#include <string>

#include <gtest/gtest.h>

namespace lte {
namespace {

TEST(Text, FormattedIsPrintfsText) {
  EXPECT_EQ(formatted("%.4g", 1.0 / 3), "0.3333");
  EXPECT_EQ(formatted("%-4s|%05d", "ab", 42), "ab  |00042");
  EXPECT_EQ(formatted("%s", ""), "");
  const std::string text(100'000, 'x');  // longer than any fixed buffer
  EXPECT_EQ(formatted("%s.", text.c_str()), text + ".");
}

TEST(Text, FirstLineEndsBeforeTheFirstBreak) {
  EXPECT_EQ(first_line("what\nbacktrace\n"), "what");
  EXPECT_EQ(first_line("what"), "what");
  EXPECT_EQ(first_line("\nwhat"), "");
}

TEST(Text, LowerCaseLeavesWhatIsNoLetter) {
  EXPECT_EQ(lower_case("Room_7.PBRT.gz"), "room_7.pbrt.gz");
  EXPECT_EQ(lower_case("\xc3\x84"), "\xc3\x84");
}

TEST(Text, QuotesStandAroundTheText) { EXPECT_EQ(quote("a b"), "\"a b\""); }

}  // namespace
}  // namespace lte
