// Shares of workers, templates of schedulers, selections of cases.

#include "host_sim/campaign/engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/campaign/case_selection.h"
#include "host_sim/campaign/command_engine.h"
#include "host_sim/campaign/shell.h"

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
}  // namespace vbar::campaign
