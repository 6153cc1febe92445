// Patterns write texts as std::format does and read them back.

#include "hil_drivers/grand/wire/text_pattern.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/wire/wire_test.h"

namespace vbar::grand::wire::test {
namespace {

using testing::HasSubstr;

const std::vector<std::string_view> kKnown = {"a", "b"};

TEST(TextPattern, WritesAndReads) {
  const TextPattern pattern("T{a:.3f};{{{b:08.2f}}}\\r\\n", kKnown);
  const std::string text = pattern.format({{"a", 1.0 / 3.0}, {"b", -12.345}});
  EXPECT_EQ(text, "T0.333;{-0012.35}\r\n");
  const NamedValues values = pattern.parse(text);
  EXPECT_EQ(values.at("a"), 0.333);
  EXPECT_EQ(values.at("b"), -12.35);
}

TEST(TextPattern, WithoutAFormatNumbersReadBackExactly) {
  const TextPattern pattern("{a},{b}", kKnown);
  for (const double value : {1.0 / 3.0, 6378137.123456789, -5e-324, 1e300}) {
    const NamedValues values = pattern.parse(pattern.format({{"a", value}, {"b", -value}}));
    EXPECT_EQ(values.at("a"), value);
    EXPECT_EQ(values.at("b"), -value);
  }
}

TEST(TextPattern, IntegersAreRounded) {
  EXPECT_EQ(TextPattern("{a:d} {b:04d}", kKnown).format({{"a", 2.6}, {"b", 7.0}}), "3 0007");
  EXPECT_THAT(error_of([] {
                static_cast<void>(TextPattern("{a:d}", kKnown).format({{"a", 1e18}}));
              }),
              HasSubstr("too large"));
}

TEST(TextPattern, BadPatternsAreRefusedWithTheirPosition) {
  const auto error = [](std::string_view pattern) { return error_of([&] { TextPattern(pattern, kKnown); }); };
  EXPECT_EQ(error("x{c}"), "pattern \"x{c}\", character 2: unknown name \"c\"; known are a, b");
  EXPECT_THAT(error("x{a"), HasSubstr("character 2: '{' without '}'"));
  EXPECT_THAT(error("x}"), HasSubstr("character 2: '}' without '{'"));
  EXPECT_THAT(error("{a:s}"), HasSubstr("format \"s\""));
  EXPECT_THAT(error("{a:{}}"), HasSubstr("format \"{\""));
  EXPECT_THAT(error("{a:9999f}"), HasSubstr("format"));
  EXPECT_THAT(error("{a:.2d}"), HasSubstr("no precision"));
  EXPECT_THAT(error("{a}{b}"), HasSubstr("no text between \"a\" and \"b\""));
  EXPECT_THAT(error("\\q"), HasSubstr("after a backslash"));
  EXPECT_THAT(error("\\"), HasSubstr("after a backslash"));
}

TEST(TextPattern, TextsOfAnotherFormAreRefusedWithTheirPosition) {
  const TextPattern pattern("T{a},{b}!", kKnown);
  const auto error = [&](std::string_view text) { return error_of([&] { static_cast<void>(pattern.parse(text)); }); };
  EXPECT_EQ(error("T1;2!"), "text \"T1;2!\", character 3: \",\" is expected");
  EXPECT_THAT(error("T1,x!"), HasSubstr("character 4: a finite number is expected (b)"));
  EXPECT_THAT(error("T1,2!!"), HasSubstr("longer than expected"));
  EXPECT_THAT(error("Tnan,2!"), HasSubstr("finite"));
  EXPECT_THAT(error("Tinf,2!"), HasSubstr("finite"));
  EXPECT_THAT(error(""), HasSubstr("\"T\" is expected"));
  EXPECT_FALSE(pattern.matches("T1"));
  EXPECT_TRUE(pattern.matches("T 1,+2!"));
  EXPECT_FALSE(pattern.matches("T+-1,2!"));
}

TEST(TextPattern, ValuesThatAreMissingOrNotFiniteAreNotWritten) {
  const TextPattern pattern("{a}", kKnown);
  EXPECT_NE(error_of([&] { static_cast<void>(pattern.format({})); }), "");
  EXPECT_NE(error_of([&] { static_cast<void>(pattern.format({{"a", std::nan("")}})); }), "");
}

}  // namespace
}  // namespace vbar::grand::wire::test
