// The program that makes the star tables, on star files that are damaged: it must fail with one message that names file
// and line, so that no build gets a catalogue cut short.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fsw/vision/stars/star_tables.h"
#include "tests/support/paths.h"

namespace {

const std::string kStarFile = vbar::tests::source_path("data/stars/hipparcos_v8.csv");
const std::string kHeading = "hip,ra_deg,dec_deg,pm_ra_mas,pm_dec_mas,v,b_v\n";

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class MakeStarTables : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  struct Outcome {
    int exit_code;
    std::string message;
  };
  [[nodiscard]] Outcome run(const std::string& star_file, const std::string& epoch = "2011.55") const {
    const std::string command = vbar::tests::build_path("fsw/vision/stars/make_star_tables ") + star_file + " " +
                                epoch + " " + (folder_ / "tables").string() + " " + (folder_ / "sizes").string() +
                                " 2> " + (folder_ / "message").string();
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(folder_ / "message")};
  }
  [[nodiscard]] Outcome run_on(const std::string& content) const {
    std::ofstream(folder_ / "stars.csv", std::ios::binary) << content;
    return run((folder_ / "stars.csv").string());
  }
  /// One line, of this line of the file, with these words.
  void expect_refused(const std::string& content, int line, const std::string& words) const {
    const Outcome outcome = run_on(content);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.message.find("stars.csv:" + std::to_string(line) + ": "), std::string::npos) << outcome.message;
    EXPECT_NE(outcome.message.find(words), std::string::npos) << outcome.message;
    EXPECT_EQ(outcome.message.find('\n'), outcome.message.size() - 1);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "tables"));
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("vbar_make_star_tables_" + std::to_string(getpid()));
};

TEST_F(MakeStarTables, GivesTheBytesThatFlightCodeHolds) {
  ASSERT_EQ(run(kStarFile).exit_code, 0);
  const std::string tables = content_of(folder_ / "tables");
  ASSERT_EQ(tables.size(), sizeof(vbar::fsw::stars::StarTables));
  EXPECT_EQ(std::memcmp(tables.data(), &vbar::fsw::stars::vbar_star_tables, tables.size()), 0);
}

TEST_F(MakeStarTables, RefusesAFileCutShort) {
  const std::string whole = content_of(kStarFile);
  const std::size_t half = whole.find('\n', whole.size() / 2) + 1;
  const auto lines = [](const std::string& text) {
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  };
  const std::string at_line_end = whole.substr(0, half);
  expect_refused(at_line_end, lines(at_line_end), "promises 41560");
  const std::string in_a_line = whole.substr(0, half + 20);
  expect_refused(in_a_line, lines(in_a_line) + 1, "cut short");
  const std::string in_a_number = whole.substr(0, whole.size() - 2);  // all columns there, the last a digit short
  expect_refused(in_a_number, lines(in_a_number) + 1, "cut short");
}

TEST_F(MakeStarTables, RefusesDamagedLines) {
  const std::string start = "# rows 1\n" + kHeading;
  expect_refused(start + "1,2,3,4,5,6\n", 3, "7 numbers");
  expect_refused(start + "1,2,3,4,5,6,1,8\n", 3, "b_v");
  expect_refused(start + "1,2,x3,4,5,6,1\n", 3, "dec_deg is 'x3'");
  expect_refused(start + "1,2,,4,5,6,1\n", 3, "dec_deg is ''");
  expect_refused(start + "1,361,3,4,5,6,1\n", 3, "ra_deg is '361'");
  expect_refused(start + "1,2,nan,4,5,6,1\n", 3, "dec_deg is 'nan'");
  expect_refused(start + "1,2,3,4,5,9.5,1\n", 3, "v is '9.5'");
  expect_refused("# rows 1\n1,2,3,4,5,6,1\n", 2, "columns");
  expect_refused(kHeading + "1,2,3,4,5,6,1\n", 2, "# rows N");
  expect_refused("", 0, "# rows N");
}

TEST_F(MakeStarTables, RefusesWhatItCannotUse) {
  const Outcome missing = run((folder_ / "absent.csv").string());
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.message.find("absent.csv: cannot be read"), std::string::npos);
  for (const char* epoch : {"1800", "x", "2011.55y", "nan"}) {
    const Outcome outcome = run(kStarFile, epoch);
    EXPECT_EQ(outcome.exit_code, 1) << epoch;
    EXPECT_NE(outcome.message.find("Julian year"), std::string::npos) << outcome.message;
  }
}

}  // namespace
