// Lines with checksums: what a crash cuts is recognised, what was altered is counted.

#include "host_sim/campaign/record_file.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/campaign/result.h"

namespace vbar::campaign {
namespace {

class RecordFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("vbar_records_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path file(const std::string& name = "w.jsonl") const { return folder_ / name; }
  void write(const std::string& text, const std::string& name = "w.jsonl") const { std::ofstream(file(name)) << text; }

  std::filesystem::path folder_;
};

TEST(RecordLine, EndsWithItsIeeeChecksum) {
  // python3: zlib.crc32(b'{"case":1}') = 0x25cbd6a7
  EXPECT_EQ(line_of(Json{{"case", 1}}), R"({"case":1,"crc32":"25cbd6a7"})");
}

TEST_F(RecordFiles, AreReadAsTheyWereWritten) {
  RecordFile record(file());
  for (int k = 0; k < 3; ++k) record.append({{"case", k}, {"text", "a \"quote\" and\na line"}}, RecordFile::Sync::kYes);
  const ReadLines read = read_lines_of(file());
  ASSERT_EQ(read.lines.size(), 3U);
  EXPECT_EQ(read.lines[2]["case"], 2);
  EXPECT_EQ(read.damaged, 0U);
}

TEST_F(RecordFiles, LoseOnlyTheLineThatWasCut) {
  const std::string one = line_of({{"case", 1}}) + "\n", two = line_of({{"case", 2}}) + "\n";
  for (std::size_t cut = 0; cut < two.size(); ++cut) {
    write(one + two.substr(0, cut));
    const ReadLines read = read_lines_of(file());
    EXPECT_EQ(read.lines.size(), 1U) << cut;
    EXPECT_EQ(read.damaged, 0U) << cut;
  }
}

TEST_F(RecordFiles, CountALineThatWasAltered) {
  const std::string one = line_of({{"case", 1}}) + "\n", two = line_of({{"case", 2}}) + "\n";
  for (std::size_t place = 0; place + 1 < one.size(); ++place) {
    std::string altered = one;
    altered[place] = altered[place] == 'x' ? 'y' : 'x';
    write(altered + two);
    const ReadLines read = read_lines_of(file());
    EXPECT_EQ(read.lines.size(), 1U) << place;
    EXPECT_EQ(read.damaged, 1U) << place;
  }
}

TEST_F(RecordFiles, AreHeldByTheirWriter) {
  {
    const RecordFile record(file());
    EXPECT_TRUE(is_being_written(file()));
    EXPECT_THROW(RecordFile again(file()), std::runtime_error);
  }
  EXPECT_FALSE(is_being_written(file()));
  EXPECT_FALSE(is_being_written(file("missing")));
}

Result result_of_case(std::size_t number, State state, const std::string& hash) {
  Result result;
  result.number = number;
  result.attempt = "a";
  result.state = state;
  result.commands_sha256 = result.telemetry_sha256 = result.waypoints_sha256 = hash;
  result.numbers = {{"dv_mps", 0.1}};
  result.verdict = "missed";
  return result;
}

TEST_F(RecordFiles, GiveEachCaseOneResult) {
  ResultFile a(file("a.jsonl")), b(file("b.jsonl"));
  a.append(result_of_case(1, State::kFailed, ""));
  a.append(result_of_case(2, State::kComplete, "x"));
  b.append(result_of_case(1, State::kComplete, "y"));
  b.append(result_of_case(2, State::kFailed, ""));
  const AllResults all = read_results(folder_);
  ASSERT_EQ(all.of_case.size(), 2U);
  EXPECT_EQ(all.of_case.at(1).state, State::kComplete);
  EXPECT_EQ(all.of_case.at(2).state, State::kComplete);
  EXPECT_EQ(all.of_case.at(2).numbers, (Numbers{{"dv_mps", 0.1}}));
  EXPECT_EQ(all.of_case.at(2).verdict, "missed");
  EXPECT_TRUE(all.conflicts.empty());
}

TEST_F(RecordFiles, ReportACaseWhoseFlightsDiffer) {
  ResultFile a(file("a.jsonl")), b(file("b.jsonl"));
  a.append(result_of_case(1, State::kComplete, "x"));
  b.append(result_of_case(1, State::kComplete, "y"));
  ASSERT_EQ(read_results(folder_).conflicts.size(), 1U);
  EXPECT_NE(read_results(folder_).conflicts[0].find("case 1"), std::string::npos);
}

TEST_F(RecordFiles, NameNumbersOnceForAllResultsThatHaveThem) {
  Result other = result_of_case(3, State::kComplete, "z");
  other.numbers = {{"dv_mps", 0.25}, {"first_fix_s", 120.0}};
  {
    ResultFile results(file());
    results.append(result_of_case(1, State::kComplete, "x"));
    results.append(result_of_case(2, State::kComplete, "y"));
    results.append(other);
  }
  std::ifstream text(file());
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 5U) << "two lines of names, three results";
  const AllResults all = read_results(folder_);
  EXPECT_EQ(all.of_case.at(2).numbers, (Numbers{{"dv_mps", 0.1}}));
  EXPECT_EQ(all.of_case.at(3).numbers, other.numbers);

  lines[0][5] = '?';  // the names of the first two results
  write(lines[0] + "\n" + lines[1] + "\n" + lines[2] + "\n" + lines[3] + "\n" + lines[4] + "\n");
  const AllResults damaged = read_results(folder_);
  ASSERT_EQ(damaged.of_case.size(), 1U) << "a number is never given another name";
  EXPECT_EQ(damaged.of_case.at(3).numbers, other.numbers);
  EXPECT_EQ(damaged.damaged_lines, 3U);
}

TEST_F(RecordFiles, CountALineThatIsNotAResult) {
  write(line_of({{"case", 1}}) + "\n", "a.jsonl");
  const AllResults all = read_results(folder_);
  EXPECT_TRUE(all.of_case.empty());
  EXPECT_EQ(all.damaged_lines, 1U);
}

}  // namespace
}  // namespace vbar::campaign
