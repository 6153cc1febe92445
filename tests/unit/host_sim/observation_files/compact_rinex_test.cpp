// Compact RINEX against RNXCMP 4.1.0 (Hatanaka, Geospatial Information Authority of Japan), whose rnx2crx and crx2rnx
// made the pairs of files.

#include <exception>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/observation_files/rinex_observations.h"
#include "tests/support/paths.h"

namespace vbar::observation_files {
namespace {

using testing::HasSubstr;

std::string text_of(const std::string& file) {
  std::ifstream stream(vbar::tests::source_path("tests/data/formats/" + file));
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(expand_compact_rinex(text, "log.10d"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  text.replace(text.find(what), what.size(), with);
  return text;
}

TEST(CompactRinex, IsWhatTheReferenceProgramExpandsItTo) {
  for (const std::string name : {"compact_rinex_1", "compact_rinex_3"})
    EXPECT_EQ(expand_compact_rinex(text_of(name + ".crx"), name), text_of(name + ".rnx")) << name;
}

TEST(CompactRinex, RefusesEachDamageInOneSentence) {
  const std::string text = text_of("compact_rinex_1.crx");
  const std::vector<std::pair<std::string, std::string>> kinds{
      {replaced(text, "1.0  ", "2.0  "), "log.10d:1: found"},
      {replaced(text, "1.0  ", "3.0  "), "log.10d:3: found RINEX version 2 in compact RINEX 3.0"},
      {replaced(text, "\n&", "\n "), "expected an epoch that begins with &"},
      {replaced(text, "3&", "x&"), "expected an order from 0 to 9"},
      {replaced(text, "3&", ""), "without a first value"},
      {replaced(text, "3&1", "3&999999999999999"), "found the"},
      {text.substr(0, text.size() - 200), "found the end of the file, expected the next line of"},
  };
  for (const auto& [damaged, error] : kinds) {
    EXPECT_THAT(error_of(damaged), HasSubstr(error));
    EXPECT_THAT(error_of(damaged), HasSubstr("log.10d:"));
  }
}

}  // namespace
}  // namespace vbar::observation_files
