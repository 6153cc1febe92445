// Shares of workers, templates of schedulers, selections of cases.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/campaign/case.h"
#include "host_sim/campaign/case_records.h"
#include "host_sim/campaign/engine.h"
#include "host_sim/campaign/status.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::campaign {

namespace {

using testing::ElementsAre;

TEST(Workers, TakeFiveMinutesOfWorkEach) {
  EXPECT_EQ(workers_for(140.0, 200, 1000), 1U);
  EXPECT_EQ(workers_for(301.0, 200, 1000), 2U);
  EXPECT_EQ(workers_for(1e6, 10000, 1000), 500U);
  EXPECT_EQ(workers_for(1e6, 10000, 100), 100U) << "the largest array that the scheduler takes";
  EXPECT_EQ(workers_for(1e6, 7, 1000), 7U);
  EXPECT_EQ(workers_for(0.0, 7, 1000), 1U);
}

TEST(CommandEngine, FillsItsTemplate) {
  EXPECT_EQ(filled_template("qsub -t {k} of {n} {worker}", "vbar campaign worker 'a b'", 3, 5),
            "qsub -t 3 of 5 vbar campaign worker 'a b'");
  EXPECT_EQ(filled_template("ssh node{k} {worker_word}", "run 'a b'", 3, 5), R"(ssh node3 'run '\''a b'\''')");
  EXPECT_THROW(static_cast<void>(filled_template("qsub {k}", "vbar", 0, 1)), app::Refused);
}

TEST(CommandEngine, QuotesForTheShell) {
  const std::string text = "a 'quoted' $HOME `x` \"y\" \\ *";
  const CommandResult result = run_command({"/bin/sh", "-c", "printf %s " + shell_word(text)});
  ASSERT_TRUE(result.succeeded) << result.trouble;
  EXPECT_EQ(result.output, text);
}

TEST(CommandEngine, SaysWhyACommandFailed) {
  const CommandResult failed = run_command({"/bin/sh", "-c", "echo no queue; exit 3"});
  EXPECT_FALSE(failed.succeeded);
  EXPECT_NE(failed.trouble.find("exit status 3"), std::string::npos) << failed.trouble;
  EXPECT_NE(failed.trouble.find("no queue"), std::string::npos) << failed.trouble;
  EXPECT_FALSE(run_command({"/bin/sleep", "10"}, std::chrono::seconds(0)).succeeded);
  EXPECT_FALSE(run_command({"no-such-program-anywhere"}).succeeded);
}

TEST(CaseSelection, TakesNumbersAndRanges) {
  EXPECT_THAT(selected_cases("0-2,7,5-5", 10), ElementsAre(0, 1, 2, 5, 7));
  for (const char* wrong : {"", "3-1", "10", "0-10", "a", "1,", "-1", "1-"})
    EXPECT_THROW(static_cast<void>(selected_cases(wrong, 10)), app::Refused) << wrong;
}

}  // namespace

// Lines with checksums: what a crash cuts is recognised, what was altered is counted.

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

// The keys by which criteria and results.csv name the numbers of a summary.

namespace {

using testing::IsEmpty;

report::Summary summary() {
  report::Summary summary;
  summary.mission = "m";
  summary.wall_s = 3.0;
  summary.navigation_error_m = report::MeanAndDeviation{0.003, 0.001};
  summary.navigation_velocity_error_mps = report::MeanAndDeviation{1e-5, 2e-6};
  summary.samples = {{.time_h = 39.5, .nees = 5.5, .nees_dimension = 6.0}, {.time_h = 40.0}};
  summary.sources = {{.name = "servicer/gnss", .kind = "digital", .epochs = 12, .last_failure = "", .latest_s = 0.5}};
  summary.sensor_figures["gnss"]["time_to_20_mm_s"] = 120.0;
  summary.dv_mps = 0.25;
  return summary;
}

Numbers numbers() {
  report::WaypointRow waypoint;
  waypoint.index = 10;
  waypoint.navigation_error_m = 0.004;
  return numbers_of(Json::parse(report::summary_json(summary(), {waypoint})));
}

TEST(SummaryNumbers, StandUnderWhatIdentifiesThem) {
  const Numbers all = numbers();
  EXPECT_EQ(find_number(all, "waypoints.10.navigation_error_m"), 0.004);
  EXPECT_EQ(find_number(all, "navigation_error_mean_m"), 0.003);
  EXPECT_EQ(find_number(all, "navigation_error_std_m"), 0.001);
  EXPECT_EQ(find_number(all, "navigation_velocity_error_mean_mps"), 1e-5);
  EXPECT_EQ(find_number(all, "samples.39.5h.nees"), 5.5);
  EXPECT_EQ(find_number(all, "samples.39.5h.nees_dimension"), 6.0);
  EXPECT_EQ(find_number(all, "sources.servicer/gnss.epochs"), 12.0);
  EXPECT_EQ(find_number(all, "sensor_figures.gnss.time_to_20_mm_s"), 120.0);
  EXPECT_EQ(find_number(all, "dv_mps"), 0.25);
}

TEST(SummaryNumbers, HoldNothingOfTheWallClockAndNothingThatIsMissing) {
  const Numbers all = numbers();
  for (const char* key : {"wall_s", "speed_factor", "wall_share.truth_s", "sources.servicer/gnss.latest_s",
                          "samples.40h.nees", "first_fix_s", "schema", "seed"})
    EXPECT_FALSE(find_number(all, key)) << key;
}

TEST(Criteria, AreNotMetByANumberThatIsMissing) {
  Plan plan;
  plan.passes = {{"dv_mps", 0.3, 0.2}, {"first_fix_s", 100.0, std::nullopt}};
  Result result;
  result.numbers = numbers();
  EXPECT_THAT(failed_limits(plan, result), ElementsAre("first_fix_s"));
  EXPECT_FALSE(has_passed(plan, result));
  plan.passes = {{"dv_mps", 0.25, 0.25}};
  EXPECT_THAT(failed_limits(plan, result), IsEmpty());
  EXPECT_TRUE(has_passed(plan, result));
  result.state = State::kVoid;
  EXPECT_FALSE(has_passed(plan, result));
}

class PlanFile : public RecordFiles {
 protected:
  [[nodiscard]] std::string complaint_of(const std::string& text) const {
    const std::filesystem::path file = folder_ / "campaign.json";
    std::ofstream(file, std::ios::binary) << text;
    try {
      static_cast<void>(read_plan(file));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(PlanFile, IsReadAsItWasWritten) {
  Plan plan;
  plan.name = "n";
  plan.commit = "4c048e93e2a1";
  plan.seeds_from = "4c048e93e2a1+";
  plan.passes = {{"dv_mps", 0.3, std::nullopt}};
  plan.requirements = {Requirement::pass_rate(0.9, 0.95)};
  plan.keep = {Keep::Kind::kWorst, 3};
  const std::string text = plan_json(plan);
  EXPECT_EQ(complaint_of(text), "accepted");
  EXPECT_EQ(plan_json(read_plan(folder_ / "campaign.json")), text);
}

// One sentence with the place: a file that was cut anywhere, or has other contents.
TEST_F(PlanFile, ThatIsDamagedIsAnsweredWithItsPlace) {
  const std::string text = plan_json(Plan());
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    const std::string complaint = complaint_of(text.substr(0, length));
    EXPECT_THAT(complaint, testing::MatchesRegex(".*campaign.json:[0-9]+: the file is cut off here; accepted: a whole "
                                                 "JSON file, as this program writes it"))
        << length;
  }
  std::string damaged = text;
  damaged[text.find("\"cases\"")] = '#';
  EXPECT_THAT(complaint_of(damaged), testing::HasSubstr("campaign.json:10: the file is damaged here"));
  damaged = text;
  damaged.replace(text.find("\"cases\": 0"), 10, "\"cases\": -1");
  EXPECT_THAT(complaint_of(damaged), testing::HasSubstr("key \"cases\": -1 is not an integer from 0 on"));
  damaged = text;
  damaged.replace(text.find("\"keys\""), 6, "\"kegs\"");
  EXPECT_THAT(complaint_of(damaged), testing::HasSubstr("campaign.json: key \"keys\": is missing"));
  EXPECT_THAT(complaint_of("[]"), testing::HasSubstr("campaign.json: a JSON object is expected"));
}

}  // namespace

}  // namespace vbar::campaign
