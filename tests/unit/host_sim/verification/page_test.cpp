// Pages follow the figures of a verification, and state where it has none.
#include "host_sim/verification/page.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/host_sim/verification/verification_record.h"

namespace vbar::verification {
namespace {

using testing::HasSubstr;
using testing::Not;

const Json kVerification =
    verification_of({flown_row("experiment3", {0.001, 0.0032, 0.0081}, 3), unflown_row("full_range")});

std::string marked(const std::string& figure, const std::string& rest) {
  return figure + "<!-- v:experiment3 waypoints.10.navigation_error_m " + rest + " -->";
}

TEST(Figures, FollowTheVerification) {
  EXPECT_EQ(with_figures("| " + marked("9.99", "median x1000 .1") + " mm", kVerification, "page"),
            "| " + marked("3.2", "median x1000 .1") + " mm");
  EXPECT_EQ(with_figures(marked("1", "worst x1000 .2"), kVerification, "page"), marked("8.10", "worst x1000 .2"));
  const std::string paper = "<!-- v:paper table_10.sil.waypoint_10.navigation_error_m cell x1000 .1 -->";
  EXPECT_EQ(with_figures("1" + paper, kVerification, "page"), "12.4" + paper);
  EXPECT_EQ(with_figures(marked("7", "seeds"), kVerification, "page"), marked("3", "seeds"));
}

TEST(Figures, OfARowThatWasNotFlownAreNotOlderOnes) {
  const std::string marker = "<!-- v:full_range waypoints.10.navigation_error_m median x100 .1 -->";
  EXPECT_EQ(with_figures("error 1.7" + marker, kVerification, "page"), "error not flown" + marker);
  EXPECT_EQ(with_figures("error not flown" + marker, kVerification, "page"), "error not flown" + marker);
}

TEST(Figures, OfTablesAreReplaced) {
  const std::string page = "a\n<!-- v:table experiment3 -->\nold\n<!-- v:end -->\nb\n";
  const std::string written = with_figures(page, kVerification, "page");
  EXPECT_THAT(written, HasSubstr("| median of waypoints.10.navigation_error_m | 3.20 mm | at most 12.4 mm | yes |"));
  EXPECT_THAT(written, Not(HasSubstr("old")));
  EXPECT_EQ(with_figures(written, kVerification, "page"), written);
}

TEST(Figures, ThatNameNothingAreRefusedWithTheirPlace) {
  const auto message = [](const std::string& text) {
    try {
      static_cast<void>(with_figures(text, kVerification, "docs/a.md"));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message("\n\n1<!-- v:experiment4 dv_mps median -->"),
              AllOf(HasSubstr("docs/a.md:3"), HasSubstr("experiment4"), HasSubstr("full_range")));
  EXPECT_THAT(message("1<!-- v:experiment3 dv_mps median -->"), HasSubstr("dv_mps"));
  EXPECT_THAT(message(marked("1", "middle")), HasSubstr("median, p90, worst"));
  EXPECT_THAT(message(marked("1", "median times2")), HasSubstr("times2"));
}

TEST(VerificationPage, StatesItsCommitAndWhatWasNotFlown) {
  const std::string page = verification_page(kVerification);
  EXPECT_THAT(page, HasSubstr("# Verification of commit 0123456789ab"));
  EXPECT_THAT(page, HasSubstr("`missions/verification/full_range.toml`: not flown (40 seeds asked)"));
  EXPECT_THAT(page, HasSubstr("3 of 100 seeds, 0.5 core-hours"));
  EXPECT_THAT(page, HasSubstr("12.4 mm"));  // of the paper
}

// A flight without waypoints has nothing to achieve: zero of sixty would read as a failure.
TEST(VerificationPage, StatesNoShareOfARowWithoutVerdict) {
  Json row = flown_row("a", {1.0, 2.0, 3.0}, 0);
  row["achieved"] = {{"count", 0}, {"of", 0}, {"confidence", 0.95}, {"lower", 0.0}};
  const std::string page = verification_page(verification_of({row}));
  EXPECT_THAT(page, HasSubstr("| no verdict |"));
  EXPECT_THAT(page, HasSubstr("achieved: no verdict, for want of waypoints."));
}

}  // namespace
}  // namespace vbar::verification
