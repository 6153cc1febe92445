#include "host_sim/report/csv_table.h"

#include <bit>
#include <cstdint>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::report::test {
namespace {

using testing::ElementsAre;

template <class Value>
std::string text_of(const Value& value) {
  std::string text;
  append_value(text, value);
  return text;
}

// Every finite double there is may come: bit patterns drawn at random cover signs, exponents and denormal numbers
// alike.
TEST(CsvTable, DoublesComeBackWithTheSameBits) {
  std::mt19937_64 random(1);  // NOLINT: the same numbers in every run
  std::vector<double> values{0.0, -0.0, 0.1, -1.0 / 3.0, 5e-324, 1.7976931348623157e308, 148500.0};
  while (values.size() < 20000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) values.push_back(value);
  }
  for (const double value : values) {
    double back = 1.0;
    ASSERT_TRUE(read_value(text_of(value), back)) << text_of(value);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << text_of(value);
  }
}

TEST(CsvTable, NumbersAreAsShortAsTheyCanBe) {
  EXPECT_EQ(text_of(0.1), "0.1");
  EXPECT_EQ(text_of(60.0), "60");
  EXPECT_EQ(text_of(-2000.5), "-2000.5");
}

TEST(CsvTable, WhatIsNoNumberIsAnEmptyCell) {
  EXPECT_EQ(text_of(std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_EQ(text_of(-std::numeric_limits<double>::infinity()), "");
  EXPECT_EQ(text_of(std::optional<double>{}), "");
  double value = 0.0;
  EXPECT_TRUE(read_value("", value));
  EXPECT_TRUE(std::isnan(value));
  std::optional<double> absent = 1.0;
  EXPECT_TRUE(read_value("", absent));
  EXPECT_FALSE(absent.has_value());
}

TEST(CsvTable, WhatIsNotAllOfANumberIsRefused) {
  double number = 0.0;
  for (const char* cell : {"1.0x", " 1", "1 ", "nan", "inf", "0x10", "1e999", "--1"}) {
    EXPECT_FALSE(read_value(cell, number)) << cell;
  }
  int count = 0;
  for (const char* cell : {"", "1.5", "99999999999", "one"}) EXPECT_FALSE(read_value(cell, count)) << cell;
  bool flag = false;
  for (const char* cell : {"", "2", "true"}) EXPECT_FALSE(read_value(cell, flag)) << cell;
  std::uint64_t large = 0;
  EXPECT_TRUE(read_value("18446744073709551615", large));
  EXPECT_FALSE(read_value("-1", large));
}

// The examples of RFC 4180, section 2.
TEST(CsvTable, QuotesAsInRfc4180) {
  std::vector<std::string> cells;
  EXPECT_TRUE(split_cells("aaa,bbb,ccc", cells));
  EXPECT_THAT(cells, ElementsAre("aaa", "bbb", "ccc"));
  EXPECT_TRUE(split_cells(R"("aaa","bbb","ccc")", cells));
  EXPECT_THAT(cells, ElementsAre("aaa", "bbb", "ccc"));
  EXPECT_TRUE(split_cells(R"("aaa","b""bb","c,c")", cells));
  EXPECT_THAT(cells, ElementsAre("aaa", "b\"bb", "c,c"));
  EXPECT_TRUE(split_cells(R"(,"",)", cells));
  EXPECT_THAT(cells, ElementsAre("", "", ""));
  EXPECT_FALSE(split_cells(R"(aaa,"bbb)", cells));
  EXPECT_FALSE(split_cells(R"(a"a,b)", cells));
  EXPECT_FALSE(split_cells(R"("a"a,b)", cells));
}

TEST(CsvTable, TextComesBack) {
  for (const std::string text : {"plain", "a,b", "say \"x\"", "", "\"", "\",\""}) {
    std::vector<std::string> cells;
    EXPECT_TRUE(split_cells("1," + text_of(text) + ",2", cells)) << text;
    EXPECT_THAT(cells, ElementsAre("1", text, "2"));
  }
  EXPECT_EQ(text_of(std::string("two\nlines")), "two lines");
}

}  // namespace
}  // namespace vbar::report::test
