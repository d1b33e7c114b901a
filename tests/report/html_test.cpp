// Pages for people: escaping, embedding, tables.
#include "lte/report/html.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lte {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<unsigned char> bytes(const std::string& text) { return {text.begin(), text.end()}; }

TEST(Html, EscapesText) {
  EXPECT_EQ(html_escape("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
  EXPECT_THAT(html_table({"<x>"}, {{"<y>"}}), Not(HasSubstr("<x>")));
  EXPECT_THAT(html_page("<t>", ""), HasSubstr("<title>&lt;t&gt;</title>"));
}

TEST(Html, EncodesTheExamplesOfRfc4648) {
  const char* const examples[][2] = {{"", ""},
                                     {"f", "Zg=="},
                                     {"fo", "Zm8="},
                                     {"foo", "Zm9v"},
                                     {"foob", "Zm9vYg=="},
                                     {"fooba", "Zm9vYmE="},
                                     {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, encoded] : examples) EXPECT_EQ(base64(bytes(text)), encoded);
}

TEST(Html, MarksTheRowThatStandsOut) {
  const std::string table = html_table({"a", "b"}, {{"x", "1"}, {"y", "2"}}, "y");
  EXPECT_THAT(table, HasSubstr("<tr class=own><td>y</td><td>2</td></tr>"));
  EXPECT_THAT(table, HasSubstr("<tr><td>x</td>"));
}

TEST(Html, PagesFitNarrowScreens) {
  EXPECT_THAT(html_page("t", ""), HasSubstr("<meta name=viewport content=\"width=device-width"));
  EXPECT_THAT(html_table({"a"}, {{"b"}}), HasSubstr("<div class=scroll><table>"));
  EXPECT_THAT(html_text_table({"a"}, {{"b"}}), HasSubstr("<div class=text><div class=scroll>"));
}

TEST(Html, SaysNothingInAnEmptyParagraph) {
  EXPECT_EQ(html_warning(""), "");
  EXPECT_EQ(html_headline("a<b"), "<p class=headline>a&lt;b</p>\n");
}

}  // namespace
}  // namespace lte
