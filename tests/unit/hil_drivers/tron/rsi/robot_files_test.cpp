// The controllers' files of hil_drivers/tron/robot, and what is refused of others.

#include "hil_drivers/tron/robot/robot_files.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/rsi/client/axis_positions.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::rsi {
namespace {

using testing::HasSubstr;

TEST(RobotFiles, BothRobotsAreAsTheDesignSays) {
  const RobotFiles camera = robot_files(kCameraRobot), target = robot_files(kTargetRobot);
  EXPECT_EQ(59152, camera.ethernet.port);
  EXPECT_EQ(59153, target.ethernet.port);
  for (const RobotFiles* files : {&camera, &target}) {
    EXPECT_EQ("VBAR", files->ethernet.sen_type);
    EXPECT_THAT(files->ethernet.sent, testing::ElementsAre("RIst", "AIPos", "EIPos", "Delay"));
    EXPECT_EQ("AK", files->ethernet.axis_element);
    EXPECT_EQ("Stop", files->ethernet.stop_element);
    EXPECT_EQ(100, files->context.timeout_cycles);
    EXPECT_EQ(4, files->context.precision);
    for (std::size_t k = 0; k < kWireAxes; ++k) {
      EXPECT_TRUE(files->ethernet.axes[k].holds_on);
      // From one end of the axis to the other: A6 turns 700 deg, the others up to 370.
      EXPECT_EQ(k == 5 ? 720.0 : 370.0, files->context.axes[k].upper);
      EXPECT_EQ(-files->context.axes[k].upper, files->context.axes[k].lower);
      EXPECT_EQ(files->context.axes[k].upper, files->context.monitor_deg[k]);
    }
  }
  EXPECT_EQ("EK", camera.ethernet.track_element);
  ASSERT_TRUE(camera.context.track);
  EXPECT_EQ(7000.0, camera.context.track->upper);
  EXPECT_EQ(7000.0, camera.context.track_monitor_mm);
  EXPECT_EQ("", target.ethernet.track_element);
  EXPECT_FALSE(target.context.track);
}

TEST(RobotFiles, CorrectionsReachFromOneEndOfEveryAxisToTheOther) {
  const BenchFile bench = read_bench_file(mission::data_directory() / "benches" / "tron.toml");
  for (const auto& [robot, name] :
       {std::pair{&bench.camera_robot, kCameraRobot}, {&bench.target_robot, kTargetRobot}}) {
    const RobotFiles files = robot_files(name);
    EXPECT_EQ(robot->line.rsi_port, files.ethernet.port);
    for (std::size_t k = 0; k < kWireAxes; ++k) {
      const AxisLimits& axis = robot->design.axes[k];
      EXPECT_LE((axis.upper - axis.lower) * kDegreesPerRadian, files.context.axes[k].upper) << name << k;
    }
  }
  const double travel_mm = (bench.track.axis.upper - bench.track.axis.lower) * kMillimetresPerMetre;
  EXPECT_LE(travel_mm, robot_files(kCameraRobot).context.track.value_or(CorrectionRange{}).upper);
}

class RefusedFiles : public testing::Test {
 protected:
  RefusedFiles() {
    std::filesystem::create_directories(folder_);
    for (const std::string name : {"camera_robot.rsi.xml", "camera_robot_ethernet.xml"})
      std::filesystem::copy_file(robot_directory() / name, folder_ / name,
                                 std::filesystem::copy_options::overwrite_existing);
  }
  ~RefusedFiles() override { std::filesystem::remove_all(folder_); }
  /// The error after `from` was replaced in one file.
  std::string error_of(const std::string& name, const std::string& from, const std::string& to) {
    const std::filesystem::path file = folder_ / name;
    std::ifstream original(robot_directory() / name);
    std::string text((std::istreambuf_iterator<char>(original)), {});
    const std::size_t at = text.find(from);
    EXPECT_NE(std::string::npos, at) << from;
    text.replace(at, from.size(), to);
    std::ofstream(file) << text;
    try {
      (void)read_robot_files(folder_, kCameraRobot);
    } catch (const mission::MissionError& error) {
      std::filesystem::copy_file(robot_directory() / name, file, std::filesystem::copy_options::overwrite_existing);
      const std::string what = error.what();
      EXPECT_EQ(0U, what.find(folder_.string())) << what;
      return what.substr(folder_.string().size() + 1);
    }
    return "accepted";
  }

  std::filesystem::path folder_ = testing::TempDir() + "vbar_robot_files_" + std::to_string(::getpid());
};

TEST_F(RefusedFiles, TheEthernetConfiguration) {
  const std::string file = "camera_robot_ethernet.xml";
  EXPECT_EQ("camera_robot_ethernet.xml:5: PORT: found 70000; accepted: 1 to 65535", error_of(file, "59152", "70000"));
  EXPECT_THAT(error_of(file, "DEF_RIst", "DEF_RSol"),
              HasSubstr("camera_robot_ethernet.xml:11: ELEMENT: found DEF_RSol; accepted: DEF_RIst, DEF_AIPos"));
  EXPECT_THAT(error_of(file, "DEF_AIPos", "DEF_RIst"), HasSubstr(":12: ELEMENT: found a second DEF_RIst"));
  EXPECT_THAT(error_of(file, "AK.A6", "AK.A5"), HasSubstr(":25: ELEMENT: found a second AK.A5"));
  EXPECT_THAT(error_of(file, "AK.A6", "BK.A6"), HasSubstr(":25: ELEMENT: found BK.A6 of TYPE DOUBLE"));
  EXPECT_THAT(error_of(file, "INDX=\"7\"", "INDX=\"6\""), HasSubstr(":25: ELEMENT: found INDX 6 again"));
  EXPECT_THAT(error_of(file, "INDX=\"7\"", "INDX=\"65\""), HasSubstr("INDX \"65\"; accepted: 1 to 64"));
  EXPECT_THAT(error_of(file, "FALSE", "TRUE"), HasSubstr(":7: ONLYSEND: found TRUE"));
  EXPECT_THAT(error_of(file, "</ROOT>", ""), HasSubstr("well-formed"));
  EXPECT_THAT(error_of(file, "<ROOT>", "<!DOCTYPE a><ROOT>"), HasSubstr("document type"));
}

TEST_F(RefusedFiles, TheContext) {
  const std::string file = "camera_robot.rsi.xml";
  EXPECT_THAT(error_of(file, "\"Timeout\" ParamID=\"1\" ParamValue=\"100\"", "\"Timeout\" ParamValue=\"0\""),
              HasSubstr("ParamValue \"0\"; accepted: 1 to"));
  EXPECT_THAT(error_of(file, "OutIdx=\"2\"", "OutIdx=\"3\""),
              HasSubstr("AXISCORR.A1: found output 3 of the ETHERNET object; accepted: INDX 2"));
  EXPECT_THAT(error_of(file, "OutIdx=\"8\"", "OutIdx=\"9\""), HasSubstr("AXISCORREXT.E1: found output 9"));
  EXPECT_THAT(error_of(file, "OutIdx=\"1\"", "OutIdx=\"9\""), HasSubstr("STOP: found output 9"));
  EXPECT_THAT(error_of(file, "-370.0", "nan"), HasSubstr("ParamValue \"nan\""));
  EXPECT_THAT(error_of(file, "-370.0", "371"), HasSubstr("limits of A1 in the wrong order"));
  EXPECT_THAT(error_of(file, "camera_robot_ethernet.xml", "missing.xml"), HasSubstr("missing.xml"));
}

}  // namespace
}  // namespace vbar::tron::rsi
