#include "host_sim/report/sections/html_report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "host_sim/report/run_folder.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/gnss/gnss_rows.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {
namespace {

using testing::HasSubstr;

class HtmlReport : public ScratchFolder {
 protected:
  /// What an XML parser and a search for outside references have to say of the page.
  [[nodiscard]] std::string complaints(const std::string& html) const {
    const auto file = scratch_ / "page.html";
    write(file, html);
    const ProgramOutput output =
        output_of("python3 " + vbar::tests::source_path("tests/unit/host_sim/report/check_page.py ") + file.string());
    return output.status == 0 ? output.text : "check_page.py failed: " + output.text;
  }
};

TEST_F(HtmlReport, IsOneWellFormedPageThatNeedsNothingElse) {
  EXPECT_EQ(complaints(html_report(synthetic_run())), "");
}

TEST_F(HtmlReport, TheCheckSeesFaults) {
  EXPECT_NE(complaints("<html><p>open</html>"), "");
  EXPECT_NE(complaints("<html><img src=\"x.png\"/></html>"), "");
  EXPECT_NE(complaints("<html><path d=\"M1 nan\"/></html>"), "");
  EXPECT_NE(complaints("<html><a href=\"#nowhere\">x</a></html>"), "");
  const std::string plot = "<html><svg class=\"plot\" viewBox=\"0 0 10 10\"><path d=\"M1 2L";
  EXPECT_EQ(complaints(plot + "3 4\"/></svg></html>"), "");
  EXPECT_NE(complaints(plot + "3 1959047.0\"/></svg></html>"), "");
  EXPECT_NE(complaints(plot + "-0.1 4\"/></svg></html>"), "");
}

TEST_F(HtmlReport, TellsTheWholeRun) {
  const std::string html = html_report(synthetic_run());
  for (const char* heading :
       {"Mission at a glance", "Waypoints", "Trajectory", "Relative orbital elements", "Maneuvers", "Navigation",
        "Carrier-phase navigation", "Angles-only navigation", "Navigation by the pose network", "Attitude",
        "Guidance and passive safety", "Health of the flight software", "Flight computer, link and time"}) {
    EXPECT_THAT(html, HasSubstr("<h2>" + std::string(heading) + "</h2>"));
    EXPECT_THAT(html, HasSubstr("\">" + std::string(heading) + "</a>")) << "in the contents";
  }
  EXPECT_THAT(html, HasSubstr("&lt;a &quot;test&quot; &amp; nothing else&gt;")) << "the flight software's own name";
  EXPECT_THAT(html, HasSubstr(std::string(64, 'a')));
  EXPECT_THAT(html, HasSubstr("did not converge"));
  EXPECT_THAT(html, HasSubstr("Not nominal: inbox dropped 12, faults inbox_full.")) << "never without a word";
  EXPECT_THAT(html, HasSubstr("40 commanded, 39 executed, 1 not executed"));
  EXPECT_THAT(html, HasSubstr("300 s after the start"));
  EXPECT_THAT(html, HasSubstr("4.75 in 90 maneuvers")) << "the paper's, as the run meets its waypoints 1 to 7";
  EXPECT_THAT(html, HasSubstr("noise 11.25 arcsec per axis, bias 2.50 arcsec"));
  EXPECT_THAT(html, HasSubstr("2476, 2122 with a bearing, 353 without stars"));
  EXPECT_THAT(html, HasSubstr("0.1250 ± 0.0956")) << "the paper's of experiment 2, by the same waypoints";
  EXPECT_THAT(html, HasSubstr("136, 120 (88.2 %) with a PnP pose, 0 of them with an attitude error over 10 deg"));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,iVBORw0KGgo")) << "the signature of every PNG";
  EXPECT_THAT(html, HasSubstr("12.476 in 12 maneuvers")) << "the paper's, as the run meets its waypoints 9 and 10";
  EXPECT_THAT(html, HasSubstr("at most 350,000, on average 250,001 instructions; at most 21,000 bytes of stack"));
}

TEST_F(HtmlReport, StatesWhereThereIsNoEstimate) {
  constexpr double kLast_h = 11.0;
  RunRecord record = synthetic_run();
  EXPECT_THAT(html_report(record), testing::Not(HasSubstr("No estimate")));
  for (EstimateRow& row : record.estimates)
    if (row.time_s > 3600.0 * kLast_h) row.navigation_valid = 0;
  const std::string html = html_report(record);
  EXPECT_THAT(html, HasSubstr("No estimate after 11.00 h, waypoints 0 to "));
  EXPECT_THAT(html, HasSubstr("No estimate, waypoints "));
  EXPECT_EQ(complaints(html), "");
}

// What happened comes before what identifies the run; distances from kilometres to millimetres have their units.
TEST_F(HtmlReport, BeginsWithTheStory) {
  const std::string html = html_report(synthetic_run());
  EXPECT_LT(html.find("<h2>Mission at a glance"), html.find("SHA-256"));
  EXPECT_LT(html.find("<h2>Waypoints"), html.find("SHA-256"));
  EXPECT_THAT(html, HasSubstr(">10 km</text>"));
  EXPECT_THAT(html, HasSubstr(">1 m</text>"));
}

TEST_F(HtmlReport, ShowsWhichSourceAidedWhen) {
  RunRecord record = synthetic_run();
  const double start_s = record.truth.front().time_s;
  const auto change = [&](double after_s, std::int32_t source, std::int32_t state) {
    telemetry_event event{};
    event.event = telemetry_event::kEventAid;
    event.device = source;
    event.after = state;
    std::get<std::vector<TelemetryRow<telemetry_event>>>(record.telemetry)
        .push_back({start_s + after_s, start_s + after_s, event});
  };
  change(0.0, navigation_configuration::kUseBearings, telemetry_event::kAidWaiting);
  change(3600.0, navigation_configuration::kUseBearings, telemetry_event::kAidAiding);
  change(7200.0, navigation_configuration::kUseBearings, telemetry_event::kAidSuspended);
  change(9000.0, navigation_configuration::kUseBearings, telemetry_event::kAidOff);
  const std::string html = html_report(record);
  EXPECT_EQ(complaints(html), "");
  EXPECT_THAT(html, HasSubstr(">bearings</text>"));
  const double start_h = start_s / 3600.0;
  EXPECT_THAT(html, HasSubstr(fmt::format("aiding, {:.2f} h to {:.2f} h", start_h + 1.0, start_h + 2.0)));
  EXPECT_THAT(html, HasSubstr(fmt::format("suspended, {:.2f} h to {:.2f} h", start_h + 2.0, start_h + 2.5)));
  EXPECT_THAT(html, Not(HasSubstr("waiting,")));
}

TEST_F(HtmlReport, ShowsProvenanceAndFailuresOfSources) {
  RunRecord record = synthetic_run();
  EXPECT_THAT(html_report(record), Not(HasSubstr("mission epoch, UTC"))) << "a folder of an older version";
  Provenance& provenance = record.summary.provenance;
  provenance.vbar_version = "0.1.0";
  provenance.commit = "0123456789ab+";
  provenance.epoch_utc = "2011-07-18T01:00:00.000Z";
  provenance.overrides = {"mission.seed=3", "truth.drag=true"};
  record.summary.sources = {{"servicer/gnss", "digital", 100, 2, "no lock", 0, 0.0}};
  const std::string html = html_report(record);
  for (const char* text : {"0.1.0, commit 0123456789ab+", "2011-07-18T01:00:00.000Z", "mission.seed=3, truth.drag=true",
                           "failures of servicer/gnss", "2 of 100 epochs; the last: no lock"})
    EXPECT_THAT(html, HasSubstr(text));
}

TEST_F(HtmlReport, DrawsMarksOverThePictures) {
  const std::string html = html_report(synthetic_run());
  // Objects of image 403: 712.34, 722.34 and 732.34 px by 500.5 px, in a picture from 80, 50 px on.
  EXPECT_THAT(html, HasSubstr("<rect class=\"mark red\" x=\"634.8\" y=\"443.0\" width=\"16.0\" height=\"16.0\">"
                              "<title>star HIP 32349, at x 722.3, y 500.5 px</title>"));
  EXPECT_THAT(html, HasSubstr("<circle class=\"mark green\" cx=\"652.8\" cy=\"451.0\" r=\"13.0\">"));
  EXPECT_THAT(html, HasSubstr("<img class=\"picture\"")) << "of a folder that has its marks in the pixels";
  // Crop of 300 px about 400.5, 250.25 px, enlarged to 512 px; keypoint 0 at 400, 250.5 px.
  EXPECT_THAT(html, HasSubstr("<rect class=\"mark green\" x=\"171.0\" y=\"50.8\" width=\"300.0\" height=\"300.0\">"));
  EXPECT_THAT(html, HasSubstr("<path class=\"mark white\" d=\"M1058.1 256.4h10.0M1063.1 251.4v10.0\">"
                              "<title>keypoint 0, used, error "));
  EXPECT_THAT(html, HasSubstr("<title>keypoint 9, rejected"));
}

TEST_F(HtmlReport, TheStartIsNotAReachedWaypoint) {
  RunRecord record = synthetic_run();
  record.waypoints.resize(1);
  const std::string html = html_report(record);
  EXPECT_THAT(html, HasSubstr("0 (start)"));
  EXPECT_THAT(html, HasSubstr("No waypoint was reached after the start"));
  EXPECT_THAT(html, testing::Not(HasSubstr("control error at waypoint")));
}

// A flight computer of a user: no solver, no mean ROE, no passive safety.
TEST_F(HtmlReport, ShowsAFlightComputerThatReportsLittle) {
  RunRecord record = synthetic_run();
  for (ManeuverRow& row : record.maneuvers) row.solver = -1;
  for (EstimateRow& row : record.estimates) {
    row.a_roe_mean_m = {};
    row.passive_safety_distance_m = 0.0;
  }
  const std::string html = html_report(record);
  EXPECT_EQ(complaints(html), "");
  EXPECT_THAT(html, HasSubstr("solver: none"));
  EXPECT_THAT(html, testing::Not(HasSubstr("</svg>estimated</span>")));
  EXPECT_THAT(html, testing::Not(HasSubstr("</svg>passive safety distance</span>")));
}

TEST_F(HtmlReport, SharesOfTheWallClockAddUp) {
  RunRecord record = synthetic_run();
  record.summary.wall_s = 0.066;
  record.summary.wall_share = {.truth_s = 0.36, .flight_s = 0.01, .link_s = 0.0, .other_s = -0.29};
  const std::string html = html_report(record);
  EXPECT_THAT(html, HasSubstr("0.36 s (97.3 %)"));
  EXPECT_THAT(html, HasSubstr("0.01 s (2.7 %)"));
  EXPECT_THAT(html, testing::Not(HasSubstr("-0.29")));
}

TEST_F(HtmlReport, MarksFiguresOutsideTheirBand) {
  RunRecord record = synthetic_run();
  for (sensors::PoseRow& row : record.tables.rows<sensors::PoseRow>()) row.attitude_nees = 35.07;
  EXPECT_THAT(html_report(record), HasSubstr("<dd class=\"bad\">35.07, 6 expected; above the 95 % band "));
}

// 41 h at a step a minute; a page that a browser opens at once and a mail server takes.
TEST_F(HtmlReport, StaysSmall) {
  EXPECT_LT(html_report(synthetic_run()).size(), 1'500'000U);
}

TEST_F(HtmlReport, SaysWhyARunIsIncomplete) {
  RunRecord record = synthetic_run();
  record.summary.complete = false;
  record.summary.incomplete_reason = "the emulator was killed";
  const std::string html = html_report(record);
  EXPECT_THAT(html, HasSubstr("incomplete"));
  EXPECT_THAT(html, HasSubstr("the emulator was killed"));
}

TEST_F(HtmlReport, CopesWithARunThatNeverFlew) {
  RunRecord record;
  record.summary.incomplete_reason = "the board did not answer";
  EXPECT_EQ(complaints(html_report(record)), "");
}

TEST_F(HtmlReport, CopesWithASingleStep) {
  RunRecord record = synthetic_run();
  record.truth.resize(1);
  record.estimates.resize(1);
  record.waypoints.resize(1);
  record.tables.rows<sensors::GnssRow>().resize(1);
  record.tables.rows<sensors::ImageRow>().resize(1);
  record.maneuvers.clear();
  record.residuals.clear();
  EXPECT_EQ(complaints(html_report(record)), "");
}

TEST_F(HtmlReport, ImageOfAnEmulatedBenchStandsBesideThatOfTheTwin) {
  RunRecord record = synthetic_run();
  EXPECT_THAT(html_report(record), Not(HasSubstr("emulated bench")));
  record.summary.gnss = "digital";
  record.summary.camera = "optical_stimulator";
  record.summary.flight_computer = "in_process";
  record.summary.testbeds["optical_stimulator"]["bench"] = std::string("emulated");
  GalleryImage& image = record.gallery.back();
  image.difference = "median 0.0 DN, noise 4.0 DN";
  image.twin_png = image.difference_png = image.png;
  const std::string html = html_report(record);
  EXPECT_THAT(html, HasSubstr("this run, emulated bench"));
  EXPECT_THAT(html, HasSubstr(" h, HIL, emulated bench: target &amp; &lt;decoy&gt;"));
  EXPECT_THAT(html, HasSubstr(" h, SIL: the digital twin's image of the same exposure"));
  EXPECT_THAT(html, HasSubstr(" h, HIL less SIL: median 0.0 DN, noise 4.0 DN"));
  EXPECT_THAT(html, HasSubstr("their difference, red where the testbed's image is brighter"));
}

TEST_F(HtmlReport, NamesThePaperOnlyBesideItsWaypoints) {
  RunRecord record = synthetic_run();
  for (WaypointRow& waypoint : record.waypoints) waypoint.a_roe_desired_m[1] -= 1.0;
  EXPECT_THAT(html_report(record), testing::Not(HasSubstr("paper, software in the loop")));
}

TEST_F(HtmlReport, CopesWithACameraThatSawNothing) {
  RunRecord record = synthetic_run();
  for (sensors::ImageRow& row : record.tables.rows<sensors::ImageRow>()) {
    sensors::ImageRow dark;
    dark.time_s = row.time_s;
    dark.status = 1;
    row = dark;
  }
  record.summary.bearing_error_arcsec = std::nullopt;
  record.summary.star_attitude_error_arcsec = std::nullopt;
  record.gallery.clear();
  EXPECT_EQ(complaints(html_report(record)), "");
  record.tables.rows<sensors::ImageRow>().clear();
  EXPECT_THAT(html_report(record), testing::Not(HasSubstr("Angles-only navigation")));
}

TEST_F(HtmlReport, CopesWithANetworkThatSawNothing) {
  RunRecord record = synthetic_run();
  for (sensors::PoseRow& row : record.tables.rows<sensors::PoseRow>()) {
    sensors::PoseRow blind;
    blind.time_s = row.time_s;
    blind.status = 6;
    row = blind;
  }
  record.tables.rows<sensors::KeypointRow>().clear();
  record.gallery.clear();
  EXPECT_EQ(complaints(html_report(record)), "");
  EXPECT_THAT(html_report(record), HasSubstr("invalid"));
  record.tables.rows<sensors::PoseRow>().clear();
  EXPECT_THAT(html_report(record), testing::Not(HasSubstr("pose network")));
}

TEST_F(HtmlReport, CopesWithGnssThatNeverSolved) {
  RunRecord record = synthetic_run();
  for (EstimateRow& row : record.estimates) row.navigation_source = row.navigation_valid = 0;
  for (sensors::GnssRow& row : record.tables.rows<sensors::GnssRow>()) {
    sensors::GnssRow silent;
    silent.time_s = row.time_s;
    row = silent;
  }
  record.summary.first_fix_s = record.summary.navigation_nees = std::nullopt;
  EXPECT_EQ(complaints(html_report(record)), "");
  EXPECT_THAT(html_report(record), HasSubstr("never"));
  record.tables.rows<sensors::GnssRow>().clear();
  EXPECT_THAT(html_report(record), testing::Not(HasSubstr("Carrier-phase navigation")));
}

TEST_F(HtmlReport, CopesWithNumbersThatAreNone) {
  RunRecord record = synthetic_run();
  const double none = std::numeric_limits<double>::quiet_NaN();
  record.summary.speed_factor = none;
  record.summary.dv_mps = std::numeric_limits<double>::infinity();
  record.summary.flight_step.mean = none;
  record.waypoints[2].control_error_m = none;
  record.truth[100].relative_position_rtn = {none, none, none};
  record.truth[200].a_roe_mean_m.fill(std::numeric_limits<double>::infinity());
  record.tables.rows<sensors::GnssRow>()[400].phase_nis = none;
  record.tables.rows<sensors::ImageRow>()[100].nis = none;
  std::ranges::fill(record.tables.rows<sensors::ImageRow>()[110].prefit, none);
  record.tables.rows<sensors::ImageRow>()[120].bearing_error_x_arcsec = none;
  record.tables.rows<sensors::PoseRow>()[20].attitude_error_deg = none;
  std::ranges::fill(record.tables.rows<sensors::PoseRow>()[30].covariance_attitude, none);
  record.tables.rows<sensors::KeypointRow>()[40].error_x_px = none;
  record.tables.rows<sensors::KeypointRow>()[41].covariance_xx_px2 = std::numeric_limits<float>::quiet_NaN();
  std::ranges::fill(record.tables.rows<sensors::GnssRow>()[500].covariance_rtn, none);
  record.estimates[300].passive_safety_distance_m = none;
  record.maneuvers[5].executed_dv_rtn_mps = {none, 0.0, 0.0};
  EXPECT_EQ(complaints(html_report(record)), "");
}

TEST_F(HtmlReport, StandsInTheRunFolder) {
  const RunFolder folder(scratch_ / "run", {});
  EXPECT_EQ(write_html_report(folder.path(), synthetic_run()), scratch_ / "run" / "report.html");
  EXPECT_EQ(content(scratch_ / "run" / "report.html"), html_report(synthetic_run()));
}

TEST_F(HtmlReport, RunsSideBySideAreAPageToo) {
  std::vector<ComparedRun> runs{{"sil", synthetic_run()}, {"pil & <more>", synthetic_run()}};
  EXPECT_EQ(complaints(html_comparison(runs)), "");
  EXPECT_THAT(html_comparison(runs), HasSubstr("All runs gave the same maneuver commands and telemetry"));
  runs[1].record.summary.telemetry_sha256 = std::string(64, 'c');
  EXPECT_THAT(html_comparison(runs), HasSubstr("Not all runs gave the same"));
  runs[1].record.summary.seed = 2;
  EXPECT_THAT(html_comparison(runs), HasSubstr("not expected to be the same"));
  EXPECT_THAT(html_comparison(runs), testing::Not(HasSubstr("status bad\">incomplete")));
  runs[1].record.summary.complete = false;
  runs[1].record.summary.incomplete_reason = "the receiver <of the target> was lost";
  EXPECT_THAT(html_comparison(runs),
              HasSubstr("incomplete</span> pil &amp; &lt;more&gt;: the receiver &lt;of the target"));
  EXPECT_THAT(html_comparison(runs), testing::Not(HasSubstr("emulated bench")));
  runs[1].record.summary.gnss = "grand";
  runs[1].record.summary.testbeds["grand"]["bench"] = std::string("emulated");
  EXPECT_THAT(html_comparison(runs),
              HasSubstr("emulated bench</span> pil &amp; &lt;more&gt;: the testbed grand is emulated"));
  runs.push_back({"never flew", {}});
  EXPECT_EQ(complaints(html_comparison(runs)), "");
}

TEST_F(HtmlReport, RunsAreDrawnOverEachOther) {
  const std::vector<ComparedRun> runs{{"first", synthetic_run()}, {"second", synthetic_run()}};
  const std::string page = html_comparison(runs);
  for (const char* const heading : {"Flights over each other", "Trajectories"}) {
    const std::size_t begin = page.find(std::string(heading) + "</h2>");
    ASSERT_NE(begin, std::string::npos) << heading;
    const std::string section = page.substr(begin, page.find("<h2", begin) - begin);
    for (const char* const name : {"first", "second"}) EXPECT_THAT(section, HasSubstr(name)) << heading;
  }
  EXPECT_THAT(page, HasSubstr("Error of the relative position"));
  EXPECT_THAT(page, HasSubstr("T-R, "));
}

}  // namespace
}  // namespace vbar::report::test
