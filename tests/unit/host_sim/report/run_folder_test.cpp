#include "host_sim/report/run_folder.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "host_sim/files/output_file.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/gnss/gnss_rows.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class RunFolderTest : public ScratchFolder {
 protected:
  [[nodiscard]] fs::path run() const { return scratch_ / "run"; }

  void leave_a_run() const { RunFolder(run(), synthetic_run().summary).finish(synthetic_run()); }

  [[nodiscard]] std::string error_of_reading() const {
    try {
      static_cast<void>(read_run(run(), sensors::extensions()));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }

  [[nodiscard]] std::string error_of_making(const fs::path& folder) const {
    try {
      const RunFolder made(folder, {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }

  /// All tables and the summary as text.
  static std::string everything(const RunRecord& record) {
    std::string text = summary_json(record.summary, record.waypoints);
    for (const std::string& name : table_files(record.extensions)) text += name + "\n" + table_text(record, name);
    for (const GalleryImage& image : record.gallery) text.append(image.png.begin(), image.png.end());
    return text;
  }

  static std::vector<std::string> keys(const Json& json) {
    std::vector<std::string> all;
    for (const auto& item : json.items()) all.push_back(item.key());
    return all;
  }

  static std::string first_line(const fs::path& file) {
    const std::string text = content(file);
    return text.substr(0, text.find('\n'));
  }
};

// A folder may come from elsewhere: what is written in it stays in it.
TEST_F(RunFolderTest, NothingIsWrittenThroughALink) {
  leave_a_run();
  const fs::path victim = scratch_ / "victim";
  write(victim, "content");
  for (const std::string& name : {std::string("run.lock"), files::neighbour_of("summary.json").string(),
                                  files::PartialFile::part_of("truth.csv").string(), std::string("truth.csv")}) {
    fs::remove(run() / name);
    fs::create_symlink("../victim", run() / name);
  }
  leave_a_run();
  EXPECT_EQ(content(victim), "content");
  EXPECT_FALSE(fs::is_symlink(run() / "truth.csv"));
}

TEST_F(RunFolderTest, ASummaryIsWholeAtAnyTime) {
  RunFolder folder(run(), synthetic_run().summary);
  EXPECT_TRUE(is_summary(run() / "summary.json"));
  EXPECT_GE(fs::file_size(files::neighbour_of(run() / "summary.json")), 2 * fs::file_size(run() / "summary.json"))
      << "room for the last one";
  folder.give_up(synthetic_run().summary, "no space");
  EXPECT_EQ(read_summary(run() / "summary.json").incomplete_reason, "no space");
  EXPECT_FALSE(fs::exists(files::neighbour_of(run() / "summary.json")));
}

TEST_F(RunFolderTest, StandsWhereMissionAndSeedSay) {
  EXPECT_EQ(default_run_folder("experiment3", 7), fs::path("runs/experiment3-7"));
}

TEST_F(RunFolderTest, GivesBackEveryRow) {
  const RunRecord record = synthetic_run();
  leave_a_run();
  EXPECT_EQ(everything(read_run(run(), sensors::extensions())), everything(record));
}

TEST_F(RunFolderTest, WritingWhatWasReadGivesTheSameFiles) {
  leave_a_run();
  RunFolder again(scratch_ / "again", {});
  again.finish(read_run(run(), sensors::extensions()));
  for (const char* name : {"summary.json", "waypoints.csv", "truth.csv", "attitude.csv", "estimate.csv", "gnss.csv",
                           "images.csv", "objects.csv", "poses.csv", "keypoints.csv", "telemetry_health.csv",
                           "gallery.csv", "gallery/00003.png", "maneuvers.csv", "residuals.csv"}) {
    EXPECT_EQ(content(run() / name), content(again.path() / name)) << name;
    EXPECT_FALSE(content(run() / name).empty()) << name;
  }
}

// The columns are a contract with scripts: a change of these lines breaks them.
TEST_F(RunFolderTest, ColumnsAreAsAgreed) {
  RunFolder folder(run(), {});
  RunRecord record;
  record.extensions = sensors::extensions();
  record.attitudes.emplace_back();
  record.tables.rows<sensors::GnssRow>().emplace_back();
  folder.finish(record);
  const auto group = [](std::string name, std::initializer_list<const char*> members) {
    std::string text;
    for (const char* member : members) text += (text.empty() ? "" : ",") + name + "_" + member;
    return text;
  };
  const auto rtn = [&](const char* name) { return group(name, {"r_m", "t_m", "n_m"}); };
  const auto rtn_rate = [&](const char* name) { return group(name, {"r_mps", "t_mps", "n_mps"}); };
  const auto elements = [&](const char* name) {
    return group(name, {"da_m", "dlambda_m", "dex_m", "dey_m", "dix_m", "diy_m"});
  };

  EXPECT_FALSE(fs::exists(run() / "residuals.csv")) << "nothing but column names";
  EXPECT_EQ(content(run() / "maneuvers.csv"),
            "maneuver_id,waypoint_index,solver,command_time_s,execution_time_s,accepted," +
                rtn_rate("commanded_dv_rtn") + "," + rtn_rate("executed_dv_rtn") + "\n");
  EXPECT_EQ(first_line(run() / "waypoints.csv"),
            "index,time_s," + elements("a_roe_desired") + "," + elements("a_roe_actual") + "," +
                rtn("desired_position_rtn") + "," + rtn("actual_position_rtn") +
                ",control_error_m,navigation_error_m,navigation_velocity_error_mps,leg_dv_mps,cumulative_dv_mps,"
                "leg_maneuvers");
  const auto xyz = [&](const char* name) { return group(name, {"x_m", "y_m", "z_m"}); };
  const auto xyz_rate = [&](const char* name) { return group(name, {"x_mps", "y_mps", "z_mps"}); };
  EXPECT_EQ(first_line(run() / "truth.csv"),
            "time_s," + xyz("servicer_position_eci") + "," + xyz_rate("servicer_velocity_eci") + "," +
                xyz("target_position_eci") + "," + xyz_rate("target_velocity_eci") + "," +
                rtn("relative_position_rtn") + "," + rtn_rate("relative_velocity_rtn") + "," + elements("a_roe_mean"));
  EXPECT_EQ(first_line(run() / "attitude.csv"), "time_s,spacecraft," + group("q_body_eci", {"w", "x", "y", "z"}) + "," +
                                                    group("rate_body", {"x_radps", "y_radps", "z_radps"}));
  EXPECT_EQ(first_line(run() / "estimate.csv"),
            "time_s,step,navigation_source,navigation_valid," + rtn("relative_position_rtn") + "," +
                rtn_rate("relative_velocity_rtn") + "," +
                group("sigma_rtn", {"r_m", "t_m", "n_m", "r_mps", "t_mps", "n_mps"}) + "," + elements("a_roe_mean") +
                "," + elements("a_roe_desired") + "," + elements("predicted_a_roe_error") +
                ",mode,active_solver,waypoint_index,planned_burns,koenig_damico_status,closed_form_status,"
                "least_squares_status,safety_status,planned_dv_mps,passive_safety_distance_m,commanded_dv_mps,"
                "step_cost,stack_bytes");
}

TEST_F(RunFolderTest, ColumnsOfGnssAreAsAgreed) {
  RunFolder folder(run(), {});
  RunRecord record;
  record.extensions = sensors::extensions();
  record.tables.rows<sensors::GnssRow>().emplace_back();
  folder.finish(record);
  std::string covariance;
  const char* const kStates[] = {"r", "t", "n", "vr", "vt", "vn"};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column)
      covariance += std::string("covariance_rtn_") + kStates[row] + "_" + kStates[column] + ",";
  EXPECT_EQ(first_line(run() / "gnss.csv"),
            "time_s,epoch_s,step,epoch_gps_ns,pairs,alone,too_late,no_solution,codes_refused,phases_refused,slips,"
            "restarts,tracked,fixed,fixes,releases,obstacle,success_rate,ratio,codes_used,phases_used,code_nis,"
            "phase_nis," +
                covariance + "messages,messages_refused");
}

TEST_F(RunFolderTest, ColumnsOfImagesAreAsAgreed) {
  RunFolder folder(run(), {});
  RunRecord record;
  record.extensions = sensors::extensions();
  record.tables.rows<sensors::ImageRow>().emplace_back();
  record.tables.rows<sensors::ObjectRow>().emplace_back();
  record.gallery.emplace_back();
  folder.finish(record);
  std::string covariance;
  const char* const kElements[] = {"da", "dl", "dex", "dey", "dix", "diy"};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column)
      covariance += std::string("covariance_a_roe_") + kElements[row] + "_" + kElements[column] + "_m2,";
  EXPECT_EQ(first_line(run() / "images.csv"),
            "time_s,step_time_s,step,image,status,star_method,tiles_missing,objects,stars,hypotheses,target_object,"
            "background_dn,noise_dn,q_eci_camera_w,q_eci_camera_x,q_eci_camera_y,q_eci_camera_z,attitude_sigma_rad,"
            "bearing_eci_x,bearing_eci_y,bearing_eci_z,bearing_sigma_rad,prefit_x_rad,prefit_y_rad,postfit_x_rad,"
            "postfit_y_rad,nis,fate,filter_runs," +
                covariance +
                "a_roe_osculating_da_m,a_roe_osculating_dlambda_m,a_roe_osculating_dex_m,a_roe_osculating_dey_m,"
                "a_roe_osculating_dix_m,a_roe_osculating_diy_m,bearings_used,bearings_refused,images_without_stars,"
                "tiles_refused,true_object,chosen,range_m,sunlit,bearing_error_x_arcsec,bearing_error_y_arcsec,"
                "attitude_error_across_arcsec,attitude_error_roll_arcsec,nees");
  EXPECT_EQ(first_line(run() / "objects.csv"), "time_s,image,object,kind,star,x_px,y_px");
  EXPECT_EQ(first_line(run() / "gallery.csv"),
            "time_s,image,caption,origin_x_px,origin_y_px,width_px,height_px,target_radius_px,crop_left,crop_side,"
            "difference");
}

TEST_F(RunFolderTest, ImagesAreFilesOnlyWhereACameraNavigates) {
  leave_a_run();
  EXPECT_TRUE(fs::exists(run() / "gallery" / "00403.png"));
  RunRecord record = synthetic_run();
  record.tables.rows<sensors::ImageRow>().clear();
  record.tables.rows<sensors::ObjectRow>().clear();
  record.gallery.clear();
  RunFolder(run(), record.summary, RunFolder::Existing::kReplace, sensors::extensions()).finish(record);
  for (const char* name : {"images.csv", "objects.csv", "gallery.csv", "gallery"})
    EXPECT_FALSE(fs::exists(run() / name)) << name;
  EXPECT_EQ(everything(read_run(run(), sensors::extensions())), everything(record));
}

TEST_F(RunFolderTest, ImageOfATestbedHasThePicturesOfTheTwinBesideIt) {
  RunRecord record = synthetic_run();
  GalleryImage& image = record.gallery.back();
  image.difference = "median 0.0 DN, noise 4.0 DN";
  image.twin_png = {1, 2, 3};
  image.difference_png = {4, 5};
  RunFolder(run(), record.summary, RunFolder::Existing::kReplace, sensors::extensions()).finish(record);
  const RunRecord read = read_run(run(), sensors::extensions());
  EXPECT_EQ(read.gallery.back().difference, image.difference);
  EXPECT_EQ(read.gallery.back().twin_png, image.twin_png);
  EXPECT_EQ(read.gallery.back().difference_png, image.difference_png);
  EXPECT_TRUE(read.gallery.front().twin_png.empty());
  const std::string name = fmt::format("gallery/{:05}_twin.png", image.image);
  fs::remove(run() / name);
  EXPECT_THAT(error_of_reading(), HasSubstr(name + ": no such file"));
}

// Folders of earlier versions have neither column nor pictures.
TEST_F(RunFolderTest, GalleryWithoutTheColumnOfDifferencesIsRead) {
  leave_a_run();
  const std::string text = files::read_text_file(run() / "gallery.csv");
  std::string older;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) older += line.substr(0, line.rfind(',')) + "\n";
  files::replace_text_file(run() / "gallery.csv", older);
  EXPECT_EQ(read_run(run(), sensors::extensions()).gallery.size(), synthetic_run().gallery.size());
}

TEST_F(RunFolderTest, APictureThatIsGoneIsNamed) {
  leave_a_run();
  fs::remove(run() / "gallery" / "00403.png");
  EXPECT_THAT(error_of_reading(), HasSubstr("gallery/00403.png: no such file"));
}

TEST_F(RunFolderTest, GnssIsAFileOnlyWhereItNavigates) {
  leave_a_run();
  RunRecord record = synthetic_run();
  record.tables.rows<sensors::GnssRow>().clear();
  RunFolder(run(), record.summary, RunFolder::Existing::kReplace, sensors::extensions()).finish(record);
  EXPECT_FALSE(fs::exists(run() / "gnss.csv"));
  EXPECT_EQ(everything(read_run(run(), sensors::extensions())), everything(record));
}

// A mission without attitudes leaves the files it always left.
TEST_F(RunFolderTest, AttitudesAreAFileOnlyWhereThereAreSome) {
  leave_a_run();
  RunRecord record = synthetic_run();
  record.attitudes.clear();
  RunFolder(run(), record.summary, RunFolder::Existing::kReplace, sensors::extensions()).finish(record);
  EXPECT_FALSE(fs::exists(run() / "attitude.csv"));
  EXPECT_EQ(everything(read_run(run(), sensors::extensions())), everything(record));
}

// So are the keys of the summary.
TEST_F(RunFolderTest, SummaryIsAsAgreed) {
  leave_a_run();
  const Json json = Json::parse(content(run() / "summary.json"));
  EXPECT_THAT(keys(json),
              ElementsAre("schema", "mission", "seed", "complete", "incomplete_reason", "verdict", "verdict_reason",
                          "missed_waypoints", "never_navigated", "flight_computer", "flight_software", "camera", "gnss",
                          "navigation", "target", "simulated_s", "wall_s", "speed_factor", "navigation_error_m",
                          "navigation_velocity_error_mps", "attitude_error_deg", "first_fix_s", "static_floor_m",
                          "navigation_nees", "navigation_nees_dimension", "navigation_nis", "navigation_nis_dimension",
                          "samples", "bearing_error_arcsec", "star_attitude_error_arcsec", "sensor_figures",
                          "min_distance_m", "min_distance_at_h", "dv_mps", "maneuvers", "thrust", "commands_sha256",
                          "telemetry_sha256", "health", "flight_output", "flight_step", "link", "deadlines", "sources",
                          "wall_share", "data_notes", "provenance", "testbeds", "waypoints"));
  EXPECT_THAT(keys(json.at("waypoints").at(3)),
              ElementsAre("index", "time_s", "navigation_error_m", "navigation_velocity_error_mps", "control_error_m",
                          "leg_dv_mps", "cumulative_dv_mps", "leg_maneuvers"));
  EXPECT_THAT(keys(json.at("flight_step")), ElementsAre("count", "unit", "max", "mean", "stack_bytes_max"));
  EXPECT_THAT(keys(json.at("link")),
              ElementsAre("bytes", "frames_resent", "frames_rejected", "frames_duplicated", "strangers_ignored", "baud",
                          "step_share_max", "step_share_mean", "wired_bytes", "wired_bytes_dropped",
                          "wired_bytes_missing", "wired_timeouts"));
  EXPECT_THAT(keys(json.at("deadlines")),
              ElementsAre("compute_overruns", "wakeups_late", "link_late", "simulation_late"));
  EXPECT_THAT(keys(json.at("wall_share")),
              ElementsAre("truth_s", "flight_s", "link_s", "other_s", "render_s", "detector_s", "packing_s"));
  EXPECT_EQ(json.at("wall_share").at("detector_s"), 12.25);
  EXPECT_EQ(json.at("first_fix_s"), 300.0);
  EXPECT_THAT(keys(json.at("bearing_error_arcsec")), ElementsAre("mean", "std", "bias"));
  EXPECT_EQ(json.at("bearing_error_arcsec").at("bias"), 2.5);
  EXPECT_THAT(keys(json.at("star_attitude_error_arcsec")), ElementsAre("mean", "std"));
  EXPECT_EQ(json.at("sensor_figures").at("images").at("images"), 2476);
  EXPECT_EQ(json.at("sensor_figures").at("images").at("without_truth"), 17);
  EXPECT_THAT(keys(json.at("sources").at(0)), ElementsAre("name", "kind", "epochs", "failures", "last_failure", "late",
                                                          "latest_s", "packets_rejected"));
  EXPECT_EQ(json.at("sources").at(0).at("last_failure"), "no lock");
  EXPECT_TRUE(json.at("camera").is_null());
  EXPECT_TRUE(json.at("incomplete_reason").is_null());
  EXPECT_EQ(json.at("attitude_error_deg").at("mean"), 2.5);
  EXPECT_EQ(json.at("sensor_figures").at("pose").at("lit_navigation_error_mean_m"), 0.0445);
  EXPECT_TRUE(json.at("waypoints").at(0).at("navigation_error_m").is_null());
  EXPECT_EQ(json.at("seed").get<std::uint64_t>(), 18446744073709551615ULL);
}

TEST_F(RunFolderTest, SummaryWithoutGnssHasNulls) {
  RunFolder folder(run(), {});
  folder.finish({});
  const Json json = Json::parse(content(run() / "summary.json"));
  for (const char* key : {"first_fix_s", "static_floor_m", "navigation_nees"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
  EXPECT_FALSE(read_run(run(), sensors::extensions()).summary.first_fix_s.has_value());
  EXPECT_TRUE(json.at("sensor_figures").empty());
  EXPECT_TRUE(json.at("bearing_error_arcsec").at("bias").is_null());
  EXPECT_TRUE(json.at("attitude_error_deg").at("mean").is_null());
  EXPECT_FALSE(read_run(run(), sensors::extensions()).summary.bearing_error_arcsec.has_value());
}

TEST_F(RunFolderTest, SaysIncompleteUntilFinished) {
  Summary start;
  start.mission = "experiment3";
  start.complete = true;
  RunFolder folder(run(), start);
  const Json json = Json::parse(content(run() / "summary.json"));
  EXPECT_EQ(json.at("mission"), "experiment3");
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_EQ(json.at("incomplete_reason"), "running in process " + std::to_string(::getpid()) + ", or killed");
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr(run().string()), HasSubstr("did not end"), HasSubstr("running")));
}

TEST_F(RunFolderTest, AStoppedRunIsReadWithItsReason) {
  RunRecord record = synthetic_run();
  record.summary.complete = false;
  record.summary.incomplete_reason = "interrupted";
  RunFolder(run(), record.summary, RunFolder::Existing::kReplace, sensors::extensions()).finish(record);
  EXPECT_EQ(everything(read_run(run(), sensors::extensions())), everything(record));
}

TEST_F(RunFolderTest, ReplacesAnEarlierRunButNotWhatIsNotItsOwn) {
  leave_a_run();
  write(packet_log_file(run()), "old");
  write(report_file(run()), "old");
  write(run() / "notes.txt", "mine");
  RunFolder folder(run(), {});
  EXPECT_FALSE(fs::exists(run() / "truth.csv"));
  EXPECT_FALSE(fs::exists(folder.packet_log()));
  EXPECT_FALSE(fs::exists(report_file(run())));
  EXPECT_EQ(content(run() / "notes.txt"), "mine");
}

TEST_F(RunFolderTest, TakesAnEmptyFolder) {
  fs::create_directories(run());
  EXPECT_EQ(error_of_making(run()), "no error");
}

TEST_F(RunFolderTest, LeavesForeignFoldersAlone) {
  fs::create_directories(run());
  write(run() / "thesis.tex", "years of work");
  EXPECT_THAT(error_of_making(run()), AllOf(HasSubstr(run().string()), HasSubstr("other than a run")));
  write(run() / "summary.json", R"({"name": "something else"})");
  EXPECT_THAT(error_of_making(run()), HasSubstr("other than a run"));
  write(run() / "summary.json", "not even JSON");
  EXPECT_THAT(error_of_making(run()), HasSubstr("other than a run"));
  EXPECT_EQ(content(run() / "thesis.tex"), "years of work");
}

TEST_F(RunFolderTest, NamesWhatStandsInTheWay) {
  write(scratch_ / "file", "");
  EXPECT_THAT(error_of_making(scratch_ / "file"), AllOf(HasSubstr("file"), HasSubstr("is a file")));
  EXPECT_THAT(error_of_making(scratch_ / "file" / "below"), HasSubstr("cannot be made"));
}

TEST_F(RunFolderTest, AFailureToWriteNamesTheFile) {
  RunFolder folder(run(), {});
  fs::remove_all(run());
  try {
    folder.finish({});
    FAIL() << "written into a folder that is gone";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("waypoints.csv"), HasSubstr("cannot be written")));
  }
}

TEST_F(RunFolderTest, NumbersThatAreNoneBecomeEmptyAndNull) {
  RunRecord record;
  record.extensions = sensors::extensions();
  record.summary.dv_mps = std::numeric_limits<double>::quiet_NaN();
  record.waypoints.emplace_back().control_error_m = std::numeric_limits<double>::infinity();
  RunFolder(run(), {}).finish(record);
  EXPECT_TRUE(Json::parse(content(run() / "summary.json")).at("dv_mps").is_null());
  EXPECT_THAT(content(run() / "waypoints.csv"), testing::Not(HasSubstr("inf")));
  const RunRecord back = read_run(run(), sensors::extensions());
  EXPECT_TRUE(std::isnan(back.summary.dv_mps));
  EXPECT_TRUE(std::isnan(back.waypoints.front().control_error_m));
}

TEST_F(RunFolderTest, DamagedFoldersAreRefusedWithFileAndLine) {
  const std::string residuals = "time_s,sensor,prefit,postfit,sigma\n";
  const std::pair<std::string, std::string> damages[] = {
      {"", "residuals.csv:1: the file is empty"},
      {"time_s,sensor,prefit,postfit,sigma,prefit\n", "residuals.csv:1: column \"prefit\" stands there twice"},
      {residuals + "1,camera,2,3,4\n5,camera,6,x,8\n", "residuals.csv:3: postfit is \"x\""},
      {residuals + "1,camera,2,3,4\n5,cam", "residuals.csv:3: 2 cells, expected 5"},
      {residuals + "1,\"camera,2,3,4\n", "residuals.csv:2: a quote is not closed"},
      {residuals + "1,camera,2,3,4\n\n", "residuals.csv:3: 1 cells, expected 5"},
  };
  leave_a_run();
  for (const auto& [text, expected] : damages) {
    write(run() / "residuals.csv", text);
    EXPECT_THAT(error_of_reading(), HasSubstr(run().string() + "/" + expected)) << text;
  }
  fs::remove(run() / "truth.csv");
  EXPECT_THAT(error_of_reading(), HasSubstr("truth.csv: no such file"));
}

// By name: a column more, less or elsewhere does not make a folder unreadable.
TEST_F(RunFolderTest, ColumnsAreFoundByTheirNames) {
  leave_a_run();
  write(run() / "residuals.csv", "sigma,mood,sensor,time_s,postfit\n4,good,camera,1,\n");
  const RunRecord record = read_run(run(), sensors::extensions());
  ASSERT_EQ(record.residuals.size(), 1U);
  const ResidualRow& row = record.residuals.front();
  EXPECT_EQ(row.time_s, 1.0);
  EXPECT_EQ(row.sensor, "camera");
  EXPECT_EQ(row.sigma, 4.0);
  EXPECT_TRUE(std::isnan(row.postfit));
  EXPECT_EQ(row.prefit, 0.0) << "no such column: the default";
  EXPECT_THAT(record.reading_notes, ElementsAre(AllOf(HasSubstr("residuals.csv"), HasSubstr("mood"))));
}

TEST_F(RunFolderTest, CodesAreWords) {
  leave_a_run();
  const std::string maneuvers = "maneuver_id,waypoint_index,solver,accepted\n";
  const std::pair<std::string, int> cells[] = {{"koenig_damico", 1}, {"1", 1}, {"none", -1}, {"-1", -1}, {"", -1}};
  for (const auto& [cell, solver] : cells) {
    write(run() / "maneuvers.csv", maneuvers + "1,2," + cell + ",1\n");
    EXPECT_EQ(read_run(run(), sensors::extensions()).maneuvers.front().solver, solver) << cell;
  }
  EXPECT_THAT(content(run() / "telemetry_health.csv"), HasSubstr("hold+inbox_full"));
  const auto health = read_run(run(), sensors::extensions()).of<telemetry_health>();
  ASSERT_FALSE(health.empty());
  EXPECT_EQ(health.front().message.faults, 6);
  write(run() / "maneuvers.csv", maneuvers + "1,2,brute_force,1\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("maneuvers.csv:2: solver is \"brute_force\""));
}

TEST_F(RunFolderTest, AKilledRunLeavesItsTables) {
  const RunRecord all = synthetic_run();
  RunRecord half;
  half.truth.assign(all.truth.begin(), all.truth.begin() + 10);
  half.maneuvers.assign(all.maneuvers.begin(), all.maneuvers.begin() + 2);
  RunFolder folder(run(), all.summary);
  folder.update(half);
  half.truth.push_back(all.truth[10]);
  half.maneuvers.push_back(all.maneuvers[2]);
  folder.update(half);
  EXPECT_FALSE(fs::exists(run() / "truth.csv"));
  write(run() / "truth.csv.part", content(run() / "truth.csv.part") + "660,1");  // killed in the middle of a row
  const RunRecord read = read_run(run(), sensors::extensions());
  EXPECT_FALSE(read.summary.complete);
  EXPECT_EQ(table_text(read, "truth.csv"), table_text(half, "truth.csv"));
  EXPECT_EQ(read.truth.size(), 11U);
  EXPECT_EQ(table_text(read, "maneuvers.csv"), table_text(half, "maneuvers.csv"));
}

TEST_F(RunFolderTest, ASummaryWithoutSomeKeysHasDefaults) {
  leave_a_run();
  Json json = Json::parse(content(run() / "summary.json"));
  for (const char* key : {"schema", "static_floor_m", "health", "target", "link"}) json.erase(key);
  write(run() / "summary.json", json.dump());
  const Summary summary = read_run(run(), sensors::extensions()).summary;
  EXPECT_EQ(summary.mission, "synthetic");
  EXPECT_FALSE(summary.static_floor_m.has_value());
  EXPECT_FALSE(summary.health.has_value());
  EXPECT_EQ(summary.link.baud, 0);
}

TEST_F(RunFolderTest, DamagedSummariesAreRefused) {
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr(run().string()), HasSubstr("no such run folder")));
  leave_a_run();
  const std::string good = content(run() / "summary.json");
  write(run() / "summary.json", good.substr(0, good.size() / 2));
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr("summary.json"), HasSubstr("the file is cut off here")));
  Json json = Json::parse(good);
  json["schema"] = 3;
  write(run() / "summary.json", json.dump());
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr("summary.json"), HasSubstr("newer version"), HasSubstr("schema 3")));
  json = Json::parse(good);
  json["maneuvers"] = "many";
  write(run() / "summary.json", json.dump());
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr("summary.json"), HasSubstr("number")));
  fs::remove(run() / "summary.json");
  EXPECT_THAT(error_of_reading(), HasSubstr("summary.json: no such file"));
}

TEST_F(RunFolderTest, HasOneWriterAtATime) {
  {
    const RunFolder first(run(), {});
    EXPECT_TRUE(fs::exists(run() / RunLock::kFile));
    EXPECT_THAT(error_of_making(run()), HasSubstr("being written by a run in process " + std::to_string(::getpid())));
  }
  EXPECT_FALSE(fs::exists(run() / RunLock::kFile));
  EXPECT_EQ(error_of_making(run()), "no error");
}

TEST_F(RunFolderTest, IsReplacedOnlyIfThatIsAskedFor) {
  leave_a_run();
  const std::string before = content(run() / "summary.json");
  EXPECT_THROW(RunFolder(run(), {}, RunFolder::Existing::kRefuse), FolderRefused);
  EXPECT_EQ(content(run() / "summary.json"), before);
  EXPECT_NO_THROW(RunFolder(scratch_ / "new", {}, RunFolder::Existing::kRefuse));
}

TEST_F(RunFolderTest, GivenUpItSaysWhy) {
  const RunFolder folder(run(), {});
  folder.give_up(synthetic_run().summary, "truth.csv: cannot be written: No space left on device");
  const Json json = Json::parse(content(run() / "summary.json"));
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_THAT(json.at("incomplete_reason").get<std::string>(), HasSubstr("No space left"));
}

TEST_F(RunFolderTest, ProvenanceIsReadBack) {
  RunRecord record = synthetic_run();
  Provenance& provenance = record.summary.provenance;
  provenance.commit = "0123456789ab+";
  provenance.epoch_utc = "2011-07-18T01:00:00.000Z";
  provenance.overrides = {"mission.seed=3", "spacecraft.servicer.name=\"a b\""};
  provenance.flight_software = FileDigest{"libarticle.so", 12, "ab"};
  provenance.data = {{"gravity/field.txt", 3, "cd"}, {"/elsewhere/stars.csv", 4, "ef"}};
  RunFolder(run(), {}).finish(record);
  EXPECT_TRUE(read_run(run(), sensors::extensions()).summary.provenance == provenance);
  // A folder of an earlier version has none.
  Json json = Json::parse(content(run() / "summary.json"));
  json.erase("provenance");
  write(run() / "summary.json", json.dump());
  EXPECT_TRUE(read_run(run(), sensors::extensions()).summary.provenance == Provenance{});
}

}  // namespace
}  // namespace vbar::report::test
