// RSI documents as public sources show them (protocol sheet, section 1).

#include <cmath>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/rsi_client.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::rsi {

namespace {

using testing::HasSubstr;

const EthernetXml& camera_ethernet() {
  static const EthernetXml ethernet = robot_files(kCameraRobot).ethernet;
  return ethernet;
}

const std::string kRob =
    "<Rob Type=\"KUKA\"><RIst X=\"1595.0000\" Y=\"0.0000\" Z=\"435.0000\" A=\"0.0000\" B=\"90.0000\" C=\"-0.0500\"/>"
    "<AIPos A1=\"1.2500\" A2=\"-90.0000\" A3=\"90.0000\" A4=\"0.0000\" A5=\"0.0000\" A6=\"349.9999\"/>"
    "<EIPos E1=\"-12.5000\" E2=\"0.0000\" E3=\"0.0000\" E4=\"0.0000\" E5=\"0.0000\" E6=\"0.0000\"/>"
    "<Delay D=\"7\"/><IPOC>4208163634</IPOC></Rob>";

Rob rob_of_text() {
  Rob rob;
  rob.cartesian = {1595.0, 0.0, 435.0, 0.0, 90.0, -0.05};
  rob.axes_deg = {1.25, -90.0, 90.0, 0.0, 0.0, 349.9999};
  rob.external_mm[0] = -12.5;
  rob.delay = 7;
  rob.ipoc = {"4208163634", 4208163634U};
  return rob;
}

TEST(RsiCodec, WritesTheStateAsAController) {
  std::string text;
  ASSERT_TRUE(encode(rob_of_text(), camera_ethernet(), 4, text));
  EXPECT_EQ(kRob, text);
}

TEST(RsiCodec, WritesTheAnswerAsConfigured) {
  Sen sen;
  sen.type = "VBAR";
  sen.stop = false;
  sen.axes_deg = {1.25, 0.0, -0.00004, -0.00006, 0.0, 359.99996};
  sen.track_mm = -3500.0;
  sen.ipoc = "0042";
  std::string text;
  ASSERT_TRUE(encode(sen, camera_ethernet(), text));
  // Four decimals, rounded to the nearest; no negative zero, no blank before "/>", the text of the IPOC as it came.
  EXPECT_EQ(
      "<Sen Type=\"VBAR\"><Stop>0</Stop><AK A1=\"1.2500\" A2=\"0.0000\" A3=\"0.0000\" A4=\"-0.0001\" A5=\"0.0000\" "
      "A6=\"360.0000\"/><EK E1=\"-3500.0000\"/><IPOC>0042</IPOC></Sen>",
      text);
}

TEST(RsiCodec, AnswersStayBelow1024Bytes) {
  Sen sen;
  sen.type = "VBAR";
  sen.stop = true;
  sen.axes_deg.fill(-123456789.1234);
  sen.track_mm = -123456789.1234;
  sen.ipoc = std::string(20, '9');
  std::string text;
  ASSERT_TRUE(encode(sen, camera_ethernet(), text));
  EXPECT_LT(text.size(), 1024U);
  sen.type = std::string(1000, 'X');
  EXPECT_FALSE(encode(sen, camera_ethernet(), text));
}

TEST(RsiCodec, DoesNotWriteWhatIsNotFinite) {
  std::string text;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e10}) {
    Sen sen;
    sen.axes_deg[2] = bad;
    EXPECT_FALSE(encode(sen, camera_ethernet(), text)) << bad;
    Rob rob = rob_of_text();
    rob.cartesian[1] = bad;
    EXPECT_FALSE(encode(rob, camera_ethernet(), 4, text)) << bad;
  }
  Sen with_track;
  with_track.track_mm = 1.0;
  EXPECT_FALSE(encode(with_track, robot_files(kTargetRobot).ethernet, text));  // which has none
}

void expect_same(const Rob& expected, const Rob& rob) {
  EXPECT_EQ(expected.cartesian, rob.cartesian);
  EXPECT_EQ(expected.axes_deg, rob.axes_deg);
  EXPECT_EQ(expected.external_mm, rob.external_mm);
  EXPECT_EQ(expected.delay, rob.delay);
  EXPECT_EQ(expected.ipoc.text, rob.ipoc.text);
  EXPECT_EQ(expected.ipoc.value, rob.ipoc.value);
}

TEST(RsiCodec, ReadsTheStateInEveryForm) {
  Decoder decoder(camera_ethernet());
  Rob rob;
  ASSERT_TRUE(decoder.decode(kRob, rob)) << decoder.problem();
  expect_same(rob_of_text(), rob);
  // Another order, TYPE, blanks before "/>", closing tags, other decimals, elements of other configurations, line ends.
  ASSERT_TRUE(decoder.decode(
      "<Rob TYPE=\"KUKA\" >\r\n<IPOC>4208163634</IPOC><EIPos E1=\"-12.5\" E2=\"0\" E3=\"0\" E4=\"0\" E5=\"0\" "
      "E6=\"0\" />\r\n<Delay D=\"7\" ></Delay><MACur A1=\"0.3\"/><AIPos A6='349.9999' A1=\"+1.25\" A2=\"-9.0E+01\" "
      "A3=\" 90.\" A4=\"0.000000\" A5=\"-0\" Extra=\"1\"></AIPos><RIst X=\"1595\" Y=\"0\" Z=\"435\" A=\"0\" B=\"90\" "
      "C=\"-.05\" /><Tech T11=\"0\"/></Rob>\r\n",
      rob))
      << decoder.problem();
  expect_same(rob_of_text(), rob);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(std::string::npos, at) << from;
  return text.replace(at, from.size(), to);
}

// The state as the public simulator kuka_rsi_simulator (ros-industrial/kuka_experimental) writes it: no external axes,
// TYPE, attributes in alphabetical order, time stamps from 0.
TEST(RsiCodec, ReadsAnArmWithoutExternalAxes) {
  Decoder decoder(robot_files(kTargetRobot).ethernet);
  Rob rob;
  ASSERT_TRUE(
      decoder.decode("<Rob TYPE=\"KUKA\"><RIst A=\"0.0\" B=\"0.0\" C=\"0.0\" X=\"0.0\" Y=\"0.0\" Z=\"0.0\" />"
                     "<RSol A=\"0.0\" B=\"0.0\" C=\"0.0\" X=\"0.0\" Y=\"0.0\" Z=\"0.0\" />"
                     "<AIPos A1=\"0.0\" A2=\"-90.0\" A3=\"90.0\" A4=\"0.0\" A5=\"90.0\" A6=\"0.0\" />"
                     "<ASPos A1=\"0.0\" A2=\"-90.0\" A3=\"90.0\" A4=\"0.0\" A5=\"90.0\" A6=\"0.0\" />"
                     "<Delay D=\"0\" /><IPOC>0</IPOC></Rob>",
                     rob))
      << decoder.problem();
  EXPECT_EQ((SixValues{0.0, -90.0, 90.0, 0.0, 90.0, 0.0}), rob.axes_deg);
  EXPECT_EQ(0U, rob.ipoc.value);
  // A robot with a track needs its place.
  Decoder with_track(camera_ethernet());
  EXPECT_FALSE(with_track.decode(replaced(kRob, "<EIPos", "<EXPos"), rob));
  EXPECT_THAT(with_track.problem(), HasSubstr("<EIPos> is missing"));
}

// The order of the public configuration ros_rsi_ethernet.xml of the same repository.
TEST(RsiCodec, WritesSetpointsThatTheFileLists) {
  EthernetXml ethernet = robot_files(kTargetRobot).ethernet;
  ethernet.sent = {"RIst", "RSol", "AIPos", "ASPos", "Delay"};
  Rob rob;
  rob.cartesian_setpoint[0] = 1.0;
  rob.axes_setpoint_deg[1] = -90.0;
  rob.ipoc = {"4", 4};
  std::string text;
  ASSERT_TRUE(encode(rob, ethernet, 1, text));
  EXPECT_THAT(text, HasSubstr("<RSol X=\"1.0\" Y=\"0.0\""));
  EXPECT_THAT(text, HasSubstr("<ASPos A1=\"0.0\" A2=\"-90.0\""));
  EXPECT_LT(text.find("<RSol"), text.find("<AIPos"));
  EXPECT_EQ(std::string::npos, text.find("<EIPos"));
}

TEST(RsiCodec, ReadsTheAnswer) {
  Decoder decoder(camera_ethernet());
  Sen sen;
  ASSERT_TRUE(decoder.decode("<Sen Type=\"VBAR\"><EK E1=\"2.5\"/><AK A2=\"-1\" A6=\"3\"/><IPOC>007</IPOC></Sen>", sen));
  EXPECT_EQ("VBAR", sen.type);
  EXPECT_EQ("007", sen.ipoc);
  EXPECT_EQ(2.5, sen.track_mm);
  EXPECT_EQ(std::nullopt, sen.axes_deg[0]);
  EXPECT_EQ(-1.0, sen.axes_deg[1]);
  EXPECT_EQ(3.0, sen.axes_deg[5]);
  EXPECT_EQ(std::nullopt, sen.stop);
  // A value of the document before does not remain.
  ASSERT_TRUE(decoder.decode("<Sen Type=\"VBAR\"><Stop>1</Stop><IPOC>8</IPOC></Sen>", sen));
  EXPECT_EQ(true, sen.stop);
  EXPECT_EQ(std::nullopt, sen.track_mm);
  EXPECT_EQ(std::nullopt, sen.axes_deg[1]);
}

TEST(RsiCodec, RefusesHostileStatesWithOneSentence) {
  struct Case {
    std::string text, problem;
  };
  const std::string many(kMaxDatagramBytes, ' ');
  std::string nested = "<Rob Type=\"KUKA\">";
  for (int k = 0; k < 4000; ++k) nested += "<a>";
  for (int k = 0; k < 4000; ++k) nested += "</a>";
  nested += "</Rob>";
  const std::vector<Case> cases = {
      {"", "empty"},
      {kRob + many, " bytes; accepted: up to 65536"},
      {"<!DOCTYPE r [<!ENTITY a \"b\">]>" + kRob, "byte 0 begins a declaration"},
      {"<?xml version=\"1.0\"?>" + kRob, "byte 0 begins a declaration"},
      {replaced(kRob, "<Delay", "<!-- --><Delay"), "begins a declaration or comment"},
      {replaced(kRob, "D=\"7\"", "D=\"&#55;\""), "begins an entity"},
      {replaced(kRob, "KUKA", std::string("KU\0A", 4)), "byte 13 is not printable ASCII"},
      {replaced(kRob, "1595.0000", "nan"), "<RIst>: X is missing or not a finite number"},
      {replaced(kRob, "1595.0000", "inf"), "<RIst>: X"},
      {replaced(kRob, "1595.0000", "1e999"), "<RIst>: X"},
      {replaced(kRob, "1595.0000", "12,5"), "<RIst>: X"},
      {replaced(kRob, "1595.0000", "0x10"), "<RIst>: X"},
      {replaced(kRob, "A6=\"349.9999\"", ""), "<AIPos>: A6"},
      {replaced(kRob, "A6=\"349.9999\"", "A5=\"1\""), "<AIPos> has attribute A5 twice"},
      {replaced(kRob, "D=\"7\"", "D=\"-7\""), "<Delay>: D"},
      {replaced(kRob, "</IPOC>", "</IPOC><IPOC>1</IPOC>"), "<IPOC> occurs twice"},
      {replaced(kRob, "<Delay D=\"7\"/>", "<Delay D=\"7\"/><Delay D=\"7\"/>"), "<Delay> occurs twice"},
      {replaced(kRob, "<Delay D=\"7\"/>", ""), "<Delay> is missing"},
      {replaced(kRob, "4208163634", "-4"), "<IPOC> is not an unsigned decimal number"},
      {replaced(kRob, "4208163634", "18446744073709551616"), "<IPOC> is not"},
      {replaced(kRob, "4208163634", std::string(30, '0')), "<IPOC> is not"},
      {replaced(kRob, "4208163634", "<a><b/></a>"), "is nested too deeply"},
      {nested, "is nested too deeply"},
      {replaced(kRob, "Type=\"KUKA\"", ""), "no Type \"KUKA\""},
      {replaced(kRob, "</Rob>", ""), "tags mismatch"},
      {kRob + kRob, "more than one root element"},
      {kRob + "x", "characters around the root element"},
      {"<Sen Type=\"KUKA\"/>", "root element <Sen>; accepted: <Rob>"},
      {"<Rob>short</Rob>", "no Type"},  // RSI up to 2.3 may send one first
  };
  Decoder decoder(camera_ethernet());
  for (const Case& hostile : cases) {
    Rob rob;
    EXPECT_FALSE(decoder.decode(hostile.text, rob)) << hostile.text.substr(0, 200);
    EXPECT_THAT(decoder.problem(), HasSubstr(hostile.problem));
    EXPECT_THAT(decoder.problem(), testing::Not(HasSubstr("\n")));
  }
  Rob rob;
  EXPECT_TRUE(decoder.decode(kRob, rob));  // the decoder goes on
}

TEST(RsiCodec, RefusesHostileAnswers) {
  Decoder decoder(camera_ethernet());
  for (const std::string text :
       {"<Sen Type=\"VBAR\"/>", "<Sen><IPOC></IPOC></Sen>", "<Sen><IPOC>1</IPOC><AK A1=\"\"/></Sen>",
        "<Sen><IPOC>1</IPOC><AK A1=\"1\"/><AK A1=\"1\"/></Sen>", "<Sen><IPOC>1</IPOC><EK E1=\"nan\"/></Sen>",
        "<Sen><IPOC>1</IPOC><Stop>2</Stop></Sen>", "<Sen><IPOC>1</IPOC><Stop/><Stop/></Sen>",
        "<Sen><IPOC> 1</IPOC></Sen>", "<Rob><IPOC>1</IPOC></Rob>"}) {
    Sen sen;
    EXPECT_FALSE(decoder.decode(text, sen)) << text;
    EXPECT_FALSE(decoder.problem().empty());
  }
}

}  // namespace

// The controllers' files of hil_drivers/tron/robot, and what is refused of others.

namespace {

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
  const TestbedDesign bench = read_testbed_design(mission::data_directory() / "benches" / "tron.toml");
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
  EXPECT_THAT(
      error_of(file, "DEF_RIst", "DEF_MACur"),
      HasSubstr("camera_robot_ethernet.xml:11: ELEMENT: found DEF_MACur; accepted: DEF_RIst, DEF_RSol, DEF_AIPos"));
  EXPECT_THAT(error_of(file, "DEF_RIst", "DEF_RSol"), HasSubstr("found no DEF_RIst"));
  EXPECT_THAT(error_of(file, "DEF_EIPos", "DEF_ASPos"),
              HasSubstr("found no DEF_EIPos; accepted: one, as the robot has"));
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
