// A table reader knows the keys that it was asked for, refuses all others, and names an unknown key before any other
// fault of the same table.

#include "host_sim/mission/table_reader.h"

#include <string>

#include <gmock/gmock.h>

#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission::test {
namespace {

using testing::ElementsAre;

template <class Use>
std::string error_of(const Use& use) {
  try {
    use();
  } catch (const MissionError& error) {
    return error.what();
  }
  return "";
}

/// Reads a table with the keys `mass` (required, above 0) and `count`, and an inner table with `size`.
std::string error_of_text(const std::string& text) {
  const toml::table table = parse_toml(text, "t.toml");
  const TableReader reader(table, "t.toml");
  return error_of([&] {
    static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
    static_cast<void>(reader.integer("count", 1, 9, 1));
    static_cast<void>(reader.table("inner").flag("size", true));
    reader.finish();
  });
}

TEST(TableReader, RemembersWhatItWasAskedFor) {
  const toml::table table = parse_toml("mass = 1.0\n[inner]\nsize = true\n", "t.toml");
  const TableReader reader(table, "t.toml");
  static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
  static_cast<void>(reader.has("colour"));
  static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
  static_cast<void>(reader.table("inner").flag("size", true));
  EXPECT_THAT(reader.asked(), ElementsAre("mass", "colour", "inner"));
  EXPECT_THAT(reader.asked_of_all().at("inner"), ElementsAre(AcceptedKey{"size", "true or false", "true"}));
  EXPECT_THAT(reader.asked_of_all().at(""),
              ElementsAre(AcceptedKey{"mass", "a number above 0, up to 10", ""}, AcceptedKey{"colour", "", ""},
                          AcceptedKey{"inner", "a table", ""}));
  EXPECT_THAT(reader.keys(), ElementsAre("inner", "mass"));
  EXPECT_NO_THROW(reader.finish());
}

TEST(TableReader, RefusesWhatNobodyAskedFor) {
  EXPECT_EQ(error_of_text("mass = 1\n"), "");
  EXPECT_EQ(error_of_text("mass = 1\nmas = 2\n"),
            "t.toml:2: mas: found an unknown key (did you mean mass?); accepted: mass, count or inner");
  EXPECT_EQ(error_of_text("mass = 1\n[inner]\nsizes = true\n"),
            "t.toml:3: inner.sizes: found an unknown key (did you mean size?); accepted: size");
}

// A misspelt key leaves the right one missing: the message is about the spelling.
TEST(TableReader, NamesAnUnknownKeyBeforeOtherFaultsOfTheTable) {
  EXPECT_EQ(error_of_text("mas = 2\n"),
            "t.toml:1: mas: found an unknown key (did you mean mass?); accepted: mass, count or inner");
  EXPECT_EQ(error_of_text("mass = -1\ncolour = 2\n"),
            "t.toml:2: colour: found an unknown key; accepted: mass, count or inner");
}

TEST(TableReader, ReportsTheFirstFault) {
  EXPECT_EQ(error_of_text("mass = -1\ncount = 99\n"),
            "t.toml:1: mass: found the integer -1; accepted: a number above 0, up to 10");
  EXPECT_EQ(error_of_text("mass = nan\n"), "t.toml:1: mass: found nan; accepted: a number above 0, up to 10");
  EXPECT_EQ(error_of_text(""), "t.toml:1: mass: found nothing; accepted: a number above 0, up to 10");
}

// What is refused after a value that was replaced may be a consequence of the replacement.
TEST(TableReader, AnEarlierFaultComesBeforeOneOfTheCaller) {
  const toml::table table = parse_toml("mass = -1\n", "t.toml");
  const TableReader reader(table, "t.toml");
  EXPECT_EQ(error_of([&] {
              static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
              reader.refuse("mass", "a mass above the limit", "less");
            }),
            "t.toml:1: mass: found the integer -1; accepted: a number above 0, up to 10");
}

TEST(TableReader, ReadsAnArrayOfTexts) {
  const auto read = [](const std::string& text) {
    const toml::table table = parse_toml(text, "t.toml");
    return TableReader(table, "t.toml").texts("lines");
  };
  EXPECT_THAT(read("lines = [\"a\", \"\"]\n"), ElementsAre("a", ""));
  EXPECT_THAT(read(""), ElementsAre());
  const std::string accepted = "; accepted: an array of texts, each on one line";
  EXPECT_EQ(error_of([&] { read("lines = \"a\"\n"); }), "t.toml:1: lines: found the text \"a\"" + accepted);
  EXPECT_EQ(error_of([&] { read("lines = [\"a\",\n 2]\n"); }), "t.toml:2: lines: found the integer 2" + accepted);
  EXPECT_THAT(error_of([&] { read("lines = [\"a\\nb\"]\n"); }), testing::EndsWith(accepted));
}

}  // namespace
}  // namespace vbar::mission::test
