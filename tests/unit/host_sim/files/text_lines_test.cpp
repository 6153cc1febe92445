#include "host_sim/files/text_lines.h"

#include <gmock/gmock.h>

namespace vbar::files {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TextLines first_line_of(std::string_view text) {
  TextLines lines(text, "f.txt");
  lines.next();
  return lines;
}

TEST(TextLines, NumbersInColumns) {
  const TextLines lines = first_line_of("  1 -2.50        7\n");
  EXPECT_EQ(lines.integer_in(1, 3, "a count"), 1);
  EXPECT_EQ(lines.number_in(4, 9, "a length"), -2.5);
  EXPECT_EQ(lines.number_or_blank_in(10, 14, "a width"), std::nullopt);
  EXPECT_EQ(lines.number_or_blank_in(15, 18, "a width"), 7.0);
  EXPECT_EQ(lines.number_or_blank_in(19, 24, "a width"), std::nullopt) << "behind the end of the line";
  EXPECT_THAT([&] { static_cast<void>(lines.number_in(10, 14, "a width")); },
              ThrowsMessage<FormatError>(
                  HasSubstr("f.txt:1: found \"  1 -2.50        7\", expected a width in columns 10 to 14")));
}

// 5.1537E+03 cut to 5.1537E+0 is a number too, a thousand times too small.
TEST(TextLines, ANumberThatIsCutShortIsRefused) {
  const std::string_view whole = "A 5.1537E+03\n";
  EXPECT_EQ(first_line_of(whole).number_in(3, 12, "sqrt_a"), 5153.7);
  for (std::size_t length = 4; length < 12; ++length) {
    const TextLines lines = first_line_of(whole.substr(0, length));
    EXPECT_TRUE(lines.is_cut_in(3, 12));
    EXPECT_FALSE(lines.is_ended());
    EXPECT_THROW(static_cast<void>(lines.number_in(3, 12, "sqrt_a")), FormatError) << length;
    EXPECT_THROW(static_cast<void>(lines.number_or_blank_in(3, 12, "sqrt_a")), FormatError) << length;
  }
  EXPECT_TRUE(first_line_of(whole).is_ended());
}

TEST(TextLines, MessagesHoldNoControlCharacters) {
  EXPECT_EQ(printable("a\x1b[2Jb\x07\x7f\r"), "a?[2Jb???");
  EXPECT_EQ(printable("Gr\xC3\xB6\xC3\x9F"
                      "e \xF0\x9F\x9B\xB0\n"),
            "Gr\xC3\xB6\xC3\x9F"
            "e \xF0\x9F\x9B\xB0\n");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "?31m")
      << "the control sequence introducer of ISO 6429";
  EXPECT_EQ(printable("\x9b\xC3("),
            "?"
            "?(")
      << "not UTF-8";
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "?x");
  EXPECT_THAT([] { first_line_of("a\n").refuse("norm \x1b[31m", "another"); },
              ThrowsMessage<FormatError>("f.txt:1: found norm ?[31m, expected another"));
}

}  // namespace
}  // namespace vbar::files
