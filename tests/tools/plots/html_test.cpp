#include "armcmc/plots/html.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace armcmc::plots::html_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(EscapeHtml, LeavesNothingThatHtmlReads) {
  EXPECT_EQ(EscapeHtml("<a href=\"x\" title='y'>&amp;"), "&lt;a href=&quot;x&quot; title=&#39;y&#39;&gt;&amp;amp;");
}

TEST(EscapeHtml, KeepsTextOfAllLanguages) { EXPECT_EQ(EscapeHtml("Kraft/µN – 力 🙂"), "Kraft/µN – 力 🙂"); }

TEST(EscapeHtml, ReplacesControlCharacters) { EXPECT_EQ(EscapeHtml(std::string("a\0b\x1B\tc\n", 7)), "a�b�\tc\n"); }

TEST(ValidUtf8, ReplacesWhatIsNone) {
  EXPECT_EQ(ValidUtf8("Kr\xE4"
                      "fte"),
            "Kr�fte");                               // Latin-1
  EXPECT_EQ(ValidUtf8("\xC0\xAF"), "��");            // overlong "/"
  EXPECT_EQ(ValidUtf8("\xED\xA0\x80"), "���");       // half of a surrogate pair
  EXPECT_EQ(ValidUtf8("\xF4\x90\x80\x80"), "����");  // beyond U+10FFFF
  EXPECT_EQ(ValidUtf8("cut \xE2\x82"), "cut ��");    // cut in a character
}

TEST(ScriptJson, CannotEndTheScript) {
  const std::string text = ScriptJson({{"</script><!--", "a & b\xE4"}});
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(text), (nlohmann::json{{"</script><!--", "a & b�"}}));
}

TEST(ScriptJson, WritesNullForWhatIsNotFinite) {
  EXPECT_EQ(ScriptJson({1.5, std::nan(""), kInfinity}), "[1.5,null,null]");
}

TEST(NumberText, KeepsSignificantDigits) {
  EXPECT_EQ(NumberText(0.0200499, 3), "0.0200");
  EXPECT_EQ(NumberText(-12.345, 3), "−12.3");
  EXPECT_EQ(NumberText(9.996, 3), "10.0");
  EXPECT_EQ(NumberText(48211.3, 3), "48211");
  EXPECT_EQ(NumberText(0.0, 3), "0");
  EXPECT_EQ(NumberText(-1.23e-7, 3), "−1.23 × 10⁻⁷");
  EXPECT_EQ(NumberText(4.5e12, 2), "4.5 × 10¹²");
  EXPECT_EQ(NumberText(std::nan(""), 3), "–");
  EXPECT_EQ(NumberText(-kInfinity, 3), "–");
}

TEST(FixedText, HasNoNegativeZero) {
  EXPECT_EQ(FixedText(-0.0004, 2), "0.00");
  EXPECT_EQ(FixedText(-0.006, 2), "−0.01");
}

TEST(PercentText, IsNeverCertain) {
  EXPECT_EQ(PercentText(0.991), "99.1 %");
  EXPECT_EQ(PercentText(1.0), "> 99.9 %");
  EXPECT_EQ(PercentText(0.0), "< 0.1 %");
  EXPECT_EQ(PercentText(-0.25), "−25.0 %");
  EXPECT_EQ(PercentText(std::nan("")), "–");
}

}  // namespace
}  // namespace armcmc::plots::html_test
