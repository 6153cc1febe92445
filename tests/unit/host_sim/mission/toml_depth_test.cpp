// Texts that a recursive parser would overflow its stack with are refused before they are parsed, and no other text is.

#include "host_sim/mission/toml_depth.h"

#include <string>

#include <gtest/gtest.h>

#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission::test {
namespace {

std::string repeated(std::string_view part, int times) {
  std::string text;
  for (int k = 0; k < times; ++k) text += part;
  return text;
}

constexpr int kMany = 50000;

TEST(TomlDepth, DeepTextsAreRefused) {
  const std::string dotted = repeated("a.", kMany) + "a";
  for (const std::string& text :
       {dotted + " = 1", "[" + dotted + "]", "[[" + dotted + "]]", "[ " + repeated("a . ", kMany) + "a ]",
        repeated("\"a\".", kMany) + "a = 1", repeated("'a'.", kMany) + "a = 1", "x = {" + dotted + " = 1}",
        "x = [{" + dotted + " = 1}]", "x = " + repeated("[", kMany) + repeated("]", kMany),
        "x = " + repeated("{a = ", kMany) + "1" + repeated("}", kMany),
        // Each part of them alone is below the limit.
        "[" + repeated("a.", 60) + "a]\n" + repeated("b.", 60) + "b = 1",
        repeated("a.", 60) + "a = {" + repeated("b.", 60) + "b = 1}",
        "x = " + repeated("[{a.a.a.a.a.a = ", 20) + "1" + repeated("}]", 20)}) {
    EXPECT_EQ(line_too_deep("# first\n" + text).value_or(0) >= 2, true) << text.substr(0, 80);
    EXPECT_THROW(static_cast<void>(parse_toml(text, "m.toml")), MissionError) << text.substr(0, 80);
  }
}

TEST(TomlDepth, TheMessageNamesTheLine) {
  try {
    static_cast<void>(parse_toml("a = 1\n\n" + repeated("a.", kMany) + "a = 1\n", "m.toml"));
    FAIL();
  } catch (const MissionError& error) {
    EXPECT_EQ(std::string(error.what()),
              "m.toml:3: found tables nested deeper than 100 levels; accepted: at most that many dotted names, inline "
              "tables and arrays within each other");
  }
}

TEST(TomlDepth, DotsOfValuesAreNotDepth) {
  const std::string dots = repeated("a.", kMany);
  for (const std::string& text :
       {"x = \"" + dots + "\"", "x = '" + dots + "'", "x = \"\"\"\n" + dots + "\"\n" + dots + "\"\"\"",
        "# " + dots + "\nx = 1", "x = '''\n" + dots + "\\'\n'''", "x = \"\\\"" + dots + "\"",
        "x = [" + repeated("1.5, ", 1000) + "2.5]", repeated("[[a.b]]\nx.y = 1.5\n", 1000),
        "x = [\n" + repeated("  {a.b = 1.5},\n", 1000) + "]"}) {
    EXPECT_EQ(line_too_deep(text), std::nullopt) << text.substr(0, 80);
    EXPECT_NO_THROW(static_cast<void>(parse_toml(text, "m.toml"))) << text.substr(0, 80);
  }
}

}  // namespace
}  // namespace vbar::mission::test
