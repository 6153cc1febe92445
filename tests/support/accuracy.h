#pragma once
// How a test says a row of docs/accuracy.md: a claim, what it was checked against, the largest difference found and the
// limit that holds it. The row is an expectation of the test and, by the same call, properties of its result (gtest's
// RecordProperty), which ci/accuracy.sh gathers into the page; so the page cannot claim what no test holds.
//
//   accuracy::Largest largest;
//   for (...) largest.add(relative_difference(...));
//   accuracy::expect_below("gravity 60x60", "GeographicLib SphericalHarmonic, 10,000 points", largest, 1e-13,
//   "relative");
//
// The limit's reason stands beside the call, as beside any tolerance. A test may say several rows. A claim is told
// once: no two rows of the page have the same one.

#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::accuracy {

namespace detail {

inline std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

/// Properties of one test need different keys: the number already recorded tells the next.
inline std::string next_key() {
  const int recorded = testing::UnitTest::GetInstance()->current_test_info()->result()->test_property_count();
  return "accuracy." + std::to_string(recorded) + ".";
}

inline void record(const std::string& claim, const std::string& reference, const std::string& measured,
                   const std::string& limit, const std::string& unit) {
  const std::string key = next_key();
  testing::Test::RecordProperty(key + "claim", claim);
  testing::Test::RecordProperty(key + "reference", reference);
  testing::Test::RecordProperty(key + "measured", measured);
  testing::Test::RecordProperty(key + "limit", limit);
  testing::Test::RecordProperty(key + "unit", unit);
}

}  // namespace detail

/// Expects `measured` <= `limit` (a NaN fails) and records the row. `unit` as a reader writes it: "m", "m/s^2",
/// "relative". `reference` names where the expected numbers come from and how many cases were compared.
inline void expect_below(const std::string& claim, const std::string& reference, double measured, double limit,
                         const std::string& unit, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  detail::record(claim, reference, detail::number_text(measured), detail::number_text(limit), unit);
  if (!(measured <= limit)) {
    ADD_FAILURE_AT(file, line) << claim << " against " << reference << ": " << measured << " " << unit << ", at most "
                               << limit << " is allowed";
  }
}

/// Expects a count (of steps, of digits, of cases) to be exactly the reference's and records the row.
inline void expect_count(const std::string& claim, const std::string& reference, long measured, long expected,
                         const std::string& unit, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  detail::record(claim, reference, std::to_string(measured), "= " + std::to_string(expected), unit);
  if (measured != expected) {
    ADD_FAILURE_AT(file, line) << claim << " against " << reference << ": " << measured << " " << unit << ", expected "
                               << expected;
  }
}

/// Records a table that stands below the rows of the test's folder: numbers that explain, where a row claims. Cells are
/// text without tabs and line ends; all lines as long as the first, the head.
inline void record_table(const std::string& title, const std::vector<std::vector<std::string>>& lines) {
  std::string text = title;
  for (const std::vector<std::string>& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) text += (i == 0 ? "\n" : "\t") + line[i];
  }
  testing::Test::RecordProperty(detail::next_key() + "table", text);
}

}  // namespace vbar::accuracy
