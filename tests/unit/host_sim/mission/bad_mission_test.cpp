// A bad mission file ends with one message that names file, line, key, what was found and what is accepted.

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/toml_file.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

const std::string kSmall(kSmallMission);

/// One change of the small mission, and the message it ends with: "m.toml:<line of `by`>: <message>".
struct BadChange {
  std::string_view label;
  std::string_view what;
  std::string_view by;
  std::string_view at;  ///< text on whose line the message points
  std::string_view message;
};

void PrintTo(const BadChange& change, std::ostream* out) {
  *out << change.label;
}

class BadMission : public testing::TestWithParam<BadChange> {};

TEST_P(BadMission, EndsWithOneMessage) {
  const BadChange& change = GetParam();
  const std::string text = changed(kSmall, change.what, change.by);
  EXPECT_EQ(message_of(text), "m.toml:" + line_of_text(text, change.at) + ": " + std::string(change.message));
}

INSTANTIATE_TEST_SUITE_P(
    OneChange, BadMission,
    testing::Values(
        BadChange{"UnknownKeyNearAnother", "duration_h = 2.0", "duration_h = 2.0\nduraton_h = 3.0", "duraton_h",
                  "mission.duraton_h: found an unknown key (did you mean duration_h?); accepted: name, description, "
                  "epoch_utc, start_h, duration_h, step_s or seed"},
        BadChange{"UnknownKeyNearNone", "duration_h = 2.0", "duration_h = 2.0\ncolour = 3", "colour",
                  "mission.colour: found an unknown key; accepted: name, description, epoch_utc, start_h, duration_h, "
                  "step_s or seed"},
        BadChange{"UnknownSection", "[mission]", "[trut]\n[mission]", "[trut]",
                  "trut: found an unknown key (did you mean truth?); accepted: mission, truth, testbed, waypoint, "
                  "spacecraft, guidance, safety, navigation, burn, fault, clock, links, lcm, telemetry, record, "
                  "limit, constellation or extends"},
        BadChange{"WrongTypeText", "duration_h = 2.0", "duration_h = \"two\"", "duration_h",
                  "mission.duration_h: found the text \"two\"; accepted: a number above 0, up to 2000"},
        BadChange{"WrongTypeInteger", "[mission]", "[mission]\nseed = 1.0", "seed",
                  "mission.seed: found the number 1; accepted: an integer from 0 to 9223372036854775807"},
        BadChange{"WrongTypeBoolean", "[mission]", "[lcm]\nmirror = 1\n[mission]", "mirror",
                  "lcm.mirror: found the integer 1; accepted: true or false"},
        BadChange{"AddressWithoutPort", "[mission]", "[telemetry]\nudp = \"127.0.0.1\"\n[mission]", "udp",
                  "telemetry.udp: found the text \"127.0.0.1\"; accepted: an IPv4 address and a port, "
                  "\"127.0.0.1:5005\""},
        BadChange{"WrongTypeTable", "[mission]", "truth = 3\n[mission]", "truth",
                  "truth: found the integer 3; accepted: a table"},
        BadChange{
            "WrongTypeOfArrayOfTables", "[mission]", "waypoint2 = 1\n[mission]", "waypoint2",
            "waypoint2: found an unknown key (did you mean waypoint?); accepted: mission, truth, testbed, waypoint, "
            "spacecraft, guidance, safety, navigation, burn, fault, clock, links, lcm, telemetry, record, limit, "
            "constellation or extends"},
        BadChange{"MissingRequiredKey", "duration_h = 2.0\n", "", "[mission]",
                  "mission.duration_h: found nothing; accepted: a number above 0, up to 2000"},
        BadChange{"NotANumber", "duration_h = 2.0", "duration_h = nan", "duration_h",
                  "mission.duration_h: found nan; accepted: a number above 0, up to 2000"},
        BadChange{"Infinity", "ex = 0.0015", "ex = inf",
                  "ex =", "spacecraft.servicer.elements.ex: found an infinity; accepted: a number from -0.9 to 0.9"},
        BadChange{"NotANumberInWaypoint", "[0, -600, 0, 18, 0, 18]", "[0, -600, 0, nan, 0, 18]", "nan",
                  "waypoint.1.a_roe_m[3]: found nan; accepted: a number from -1000000 to 1000000"},
        BadChange{"TooFewRoe", "[0, -600, 0, 18, 0, 18]", "[0, -600]", "[0, -600]",
                  "waypoint.1.a_roe_m: found an array of 2; accepted: an array of 6 numbers from -1000000 to 1000000"},
        BadChange{"TextAmongRoe", "[0, -600, 0, 18, 0, 18]", "[0, \"far\", 0, 18, 0, 18]", "far",
                  "waypoint.1.a_roe_m[1]: found the text \"far\"; accepted: a number from -1000000 to 1000000"},
        BadChange{"OutOfRange", "[mission]", "[truth]\ngravity_degree = 2191\n[mission]", "gravity_degree",
                  "truth.gravity_degree: found the integer 2191; accepted: an integer from 0 to 2190"},
        BadChange{"OrderAboveDegree", "[mission]", "[truth]\ngravity_degree = 20\ngravity_order = 21\n[mission]",
                  "gravity_order", "truth.gravity_order: found the integer 21; accepted: an integer from 0 to 20"},
        BadChange{"ZeroWhereAboveZero", "duration_h = 2.0", "duration_h = 0", "duration_h",
                  "mission.duration_h: found the integer 0; accepted: a number above 0, up to 2000"},
        BadChange{"UnknownEnumerator", "flight_computer = {}", "flight_computer.target = \"zynq_qmu\"", "zynq_qmu",
                  "spacecraft.servicer.flight_computer.target: found the text \"zynq_qmu\" (did you mean zynq_qemu?); "
                  "accepted: in_process, host_process, zynq_qemu, zynq_linux_qemu or board"},
        BadChange{
            "WaypointsOutOfOrder", "time_h = 0.0", "time_h = 2.5", "time_h = 2.0",
            "waypoint.1.time_h: found the number 2; accepted: a time after that of waypoint 0, which stands before "
            "it"},
        BadChange{
            "WaypointsAtTheSameTime", "time_h = 0.0", "time_h = 2", "time_h = 2.0",
            "waypoint.1.time_h: found the number 2; accepted: a time after that of waypoint 0, which stands before "
            "it"},
        BadChange{"WaypointIndexTwice", "index = 1", "index = 0  # again", "# again",
                  "waypoint.0.index: found a second waypoint 0; accepted: an index used once"},
        BadChange{"SpacecraftNameTwice", "name = \"target\"", "name = \"servicer\"  # again", "# again",
                  "spacecraft.1.name: found a second spacecraft \"servicer\"; accepted: a name used once"},
        BadChange{"SpacecraftNumberTwice", "name = \"target\"", "name = \"target\"\nnumber = 1", "number",
                  "spacecraft.target.number: found the number 1 of servicer; accepted: a number used once"},
        BadChange{"KeyTwice", "duration_h = 2.0", "duration_h = 2.0\nduration_h = 3.0", "duration_h = 3.0",
                  "found invalid TOML: Error while parsing key-value pair: cannot redefine existing "
                  "floating-point 'duration_h'; accepted: a TOML 1.0 document"},
        BadChange{"NoToml", "duration_h = 2.0", "duration_h = ", "duration_h",
                  "found invalid TOML: Error while parsing key-value pair: expected value, saw '\\n'; "
                  "accepted: a TOML 1.0 document"},
        BadChange{
            "NoUtc", "[mission]", "[mission]\nepoch_utc = \"yesterday\"", "epoch_utc",
            "mission.epoch_utc: found the text \"yesterday\"; accepted: a UTC time like 2011-07-18T01:00:00Z, from "
            "1980-01-06 to the year 2200"},
        BadChange{"NameThatIsNoPath", "[mission]", "[mission]\nname = \"../a\"", "name",
                  "mission.name: found the text \"../a\"; accepted: a name of 1 to 64 letters, digits, '_' and '-'"},
        BadChange{"NeitherOrbit",
                  "[[spacecraft]]\nname = \"target\"\nbody = \"tango\"\nrelative = { to = \"servicer\", waypoint = 0 }",
                  "[[spacecraft]] # bare\nname = \"target\"", "# bare",
                  "spacecraft.target: found none of elements, relative and orbit_file; accepted: exactly one of them"},
        BadChange{
            "RelativeToNobody", "to = \"servicer\"", "to = \"target\"", "to = ",
            "spacecraft.target.relative.to: found the text \"target\"; accepted: the name of a spacecraft further "
            "up in the file"},
        BadChange{"RelativeToNoWaypoint", "waypoint = 0", "waypoint = 7", "waypoint = 7",
                  "spacecraft.target.relative.waypoint: found the integer 7; accepted: the index of a waypoint"},
        BadChange{"NavigationOfNobody", "sensors.navigation = {}", "sensors.navigation = { target = \"moon\" }", "moon",
                  "spacecraft.servicer.sensors.navigation.target: found the spacecraft \"moon\"; accepted: servicer or "
                  "target"},
        BadChange{"RecordedWithoutLog", "sensors.navigation = {}", "sensors.navigation = { source = \"recorded\" }",
                  "recorded",
                  "spacecraft.servicer.sensors.navigation.log: found nothing; accepted: the packets.lcmlog to play, as "
                  "source is recorded"},
        BadChange{
            "UnknownSensor", "sensors.navigation = {}", "sensors.radar = {}", "radar",
            "spacecraft.servicer.sensors.radar.kind: found nothing, and the sensor has the name \"radar\"; accepted: "
            "navigation, gnss, camera or range_finder"},
        BadChange{"BoardWithoutDevice", "flight_computer = {}", "flight_computer = { target = \"board\" }", "board",
                  "spacecraft.servicer.flight_computer.device: found nothing; accepted: the tty of the board, e.g. "
                  "/dev/ttyUSB0"},
        BadChange{"BoardWithoutPort", "flight_computer = {}",
                  "flight_computer = { target = \"board\", link = \"udp\", address = \"127.0.0.1\" }", "board",
                  "spacecraft.servicer.flight_computer.port: found nothing; accepted: the UDP port of the board"},
        BadChange{
            "LibraryOnABoard", "flight_computer = {}",
            "flight_computer = { target = \"zynq_qemu\", library = \"x.so\" }", "x.so",
            "spacecraft.servicer.flight_computer.library: found the text \"x.so\"; accepted: nothing, unless target "
            "is in_process"},
        BadChange{"BurnsBeforeTheyAreComputed", "[mission]", "[guidance]\ncompute_latency_s = 0.5\n[mission]",
                  "compute_latency_s",
                  "guidance.compute_latency_s: found the number 0.5; accepted: at least the flight computer's "
                  "compute_latency_s, or its burns come too late"},
        BadChange{"MaximumBelowMinimum", "[mission]", "[guidance]\ndv_min_mmps = 2\ndv_max_mps = 0.001\n[mission]",
                  "dv_max_mps", "guidance.dv_max_mps: found the number 0.001; accepted: more than dv_min_mmps"},
        BadChange{"KeyOfAnotherDistribution", "[mission]",
                  "[links.board]\nlatency = { distribution = \"exponential\", max_s = 1 }\n[mission]", "exponential",
                  "links.board.latency.max_s: found an unknown key (did you mean mean_s?); accepted: distribution, "
                  "mean_s or min_s"},
        BadChange{"EmptyInterval", "[mission]",
                  "[links.board]\nlatency = { distribution = \"uniform\", min_s = 1, max_s = 1 }\n[mission]", "uniform",
                  "links.board.latency.max_s: found the integer 1; accepted: a number above min_s"},
        BadChange{"Probability", "[mission]", "[links.board]\nloss_probability = 1.5\n[mission]", "loss_probability",
                  "links.board.loss_probability: found the number 1.5; accepted: a number from 0 to 1"},
        BadChange{"NoLcmUrl", "[mission]", "[lcm]\nurl = \"loopback\"\n[mission]", "url",
                  "lcm.url: found the text \"loopback\"; accepted: an LCM provider, e.g. "
                  "udpm://239.255.76.67:7667?ttl=0"},
        BadChange{"ImagesInLog", "[mission]", "[record]\nimages = \"pixels\"\n[mission]", "images",
                  "record.images: found the text \"pixels\"; accepted: recipes or tiles"}),
    [](const testing::TestParamInfo<BadChange>& test) { return std::string(test.param.label); });

TEST(BadMissionFile, SmallMissionIsGoodBeforeItIsChanged) {
  EXPECT_EQ(message_of(kSmall), "");
}

TEST(BadMissionFile, TooManyWaypoints) {
  std::string text = kSmall;
  for (int k = 2; k < 17; ++k)
    text += "[[waypoint]]\nindex = " + std::to_string(k) + "\ntime_h = " + std::to_string(k + 1) +
            "\na_roe_m = [0, 0, 0, 0, 0, 0]\n";
  EXPECT_EQ(message_of(text),
            "m.toml:" + line_of_text(text, "[[waypoint]]") + ": waypoint: found 17 waypoints; accepted: at most 16");
}

TEST(BadMissionFile, NoSpacecraft) {
  EXPECT_EQ(message_of("[mission]\nduration_h = 1\n"),
            "m.toml:1: spacecraft: found nothing; accepted: at least one [[spacecraft]]");
}

TEST(BadMissionFile, ApproachToNowhere) {
  std::string text = kSmall.substr(0, kSmall.find("[[waypoint]]"));
  text = text.substr(0, text.find("[[spacecraft]]\nname = \"target\""));
  text = changed(text, "sensors.navigation = {}\n", "");
  EXPECT_EQ(message_of(text),
            "m.toml: guidance.mode: found approach without a waypoint; accepted: at least one [[waypoint]], or another "
            "mode");
  EXPECT_EQ(message_of(text, {"guidance.mode=idle"}), "");
}

TEST(BadMissionFile, AnEmptyFileLacksWhatIsRequired) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("vbar_empty_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file).close();
  try {
    static_cast<void>(load_mission(file));
    ADD_FAILURE() << "an empty file was a mission";
  } catch (const MissionError& error) {
    EXPECT_EQ(error.what(),
              file.string() + ": mission.duration_h: found nothing; accepted: a number above 0, up to 2000");
  }
  std::filesystem::remove(file);
}

TEST(BadMissionFile, ADateWithoutATimeOfDay) {
  EXPECT_EQ(
      message_of(std::string(kSmall), {"mission.epoch_utc=2011-07-18"}),
      "--set mission.epoch_utc=2011-07-18: mission.epoch_utc: found the date 2011-07-18; accepted: a UTC time like "
      "2011-07-18T01:00:00Z, from 1980-01-06 to the year 2200");
  EXPECT_EQ(small_mission({"mission.description=12:30:00"}).description, "12:30:00") << "a time is a text too";
}

TEST(BadMissionFile, ABodyThatIsNotThereIsRefusedByItsName) {
  const std::string typo = changed(std::string(kSmall), "body = \"tango\"", "body = \"tangoo\"");
  EXPECT_THAT(message_of(typo), testing::StartsWith("m.toml:19: spacecraft.target.body: found no file "));
  EXPECT_THAT(message_of(typo),
              testing::EndsWith("/bodies/tangoo.toml (did you mean tango?); accepted: mango, tango or "
                                "winged_box, or a body file seen from the mission file (./...)"));
  EXPECT_THAT(message_of(changed(std::string(kSmall), "body = \"tango\"", "body = \"../b/own.toml\"\nmass_kg = 3")),
              testing::HasSubstr("/b/own.toml; accepted: mango"));
}

TEST(BadMissionFile, ExtendsIsNotSetOnTheCommandLine) {
  EXPECT_THAT(message_of(std::string(kSmall), {"extends=experiment3"}),
              testing::HasSubstr("resolved before any --set"));
}

TEST(BadMissionFile, MissingFileAndFolder) {
  EXPECT_THROW(
      {
        try {
          static_cast<void>(load_mission("no/such.toml"));
        } catch (const MissionError& error) {
          EXPECT_STREQ(error.what(), "no/such.toml: found no such file; accepted: a mission file (TOML)");
          throw;
        }
      },
      MissionError);
  try {
    static_cast<void>(load_mission("."));
    ADD_FAILURE() << "a folder was read";
  } catch (const MissionError& error) {
    EXPECT_STREQ(error.what(), ".: found something that is not a file; accepted: a mission file (TOML)");
  }
}

// Whatever bytes stand in a file, loading ends with a mission or with a MissionError: every prefix and every single
// byte broken.
TEST(BadMissionFile, BrokenTextEndsInAMessage) {
  for (std::size_t k = 0; k < kSmall.size(); ++k) {
    EXPECT_NO_FATAL_FAILURE(message_of(kSmall.substr(0, k)));
    for (const char broken : {'\0', '[', '"', '\xff', '9'}) {
      std::string text = kSmall;
      text[k] = broken;
      EXPECT_NO_FATAL_FAILURE(message_of(text));
    }
  }
}

}  // namespace

// Texts that a recursive parser would overflow its stack with are refused before they are parsed, and no other text is.

namespace {

std::string repeated(std::string_view part, int times) {
  std::string text;
  for (int k = 0; k < times; ++k) text += part;
  return text;
}

constexpr int kMany = 50000;

TEST(TomlDepth, DeepTextsAreRefused) {
  const std::string dotted = repeated("a.", kMany) + "a";
  for (const std::string& text :
       {dotted + " = 1", "[" + dotted + "]", "[[" + dotted + "]]", "[ " + repeated("a . ", kMany) + "a ]",
        repeated("\"a\".", kMany) + "a = 1", repeated("'a'.", kMany) + "a = 1", "x = {" + dotted + " = 1}",
        "x = [{" + dotted + " = 1}]", "x = " + repeated("[", kMany) + repeated("]", kMany),
        "x = " + repeated("{a = ", kMany) + "1" + repeated("}", kMany),
        // Each part of them alone is below the limit.
        "[" + repeated("a.", 60) + "a]\n" + repeated("b.", 60) + "b = 1",
        repeated("a.", 60) + "a = {" + repeated("b.", 60) + "b = 1}",
        "x = " + repeated("[{a.a.a.a.a.a = ", 20) + "1" + repeated("}]", 20)}) {
    EXPECT_EQ(line_too_deep("# first\n" + text).value_or(0) >= 2, true) << text.substr(0, 80);
    EXPECT_THROW(static_cast<void>(parse_toml(text, "m.toml")), MissionError) << text.substr(0, 80);
  }
}

TEST(TomlDepth, TheMessageNamesTheLine) {
  try {
    static_cast<void>(parse_toml("a = 1\n\n" + repeated("a.", kMany) + "a = 1\n", "m.toml"));
    FAIL();
  } catch (const MissionError& error) {
    EXPECT_EQ(std::string(error.what()),
              "m.toml:3: found tables nested deeper than 100 levels; accepted: at most that many dotted names, inline "
              "tables and arrays within each other");
  }
}

TEST(TomlDepth, DotsOfValuesAreNotDepth) {
  const std::string dots = repeated("a.", kMany);
  for (const std::string& text :
       {"x = \"" + dots + "\"", "x = '" + dots + "'", "x = \"\"\"\n" + dots + "\"\n" + dots + "\"\"\"",
        "# " + dots + "\nx = 1", "x = '''\n" + dots + "\\'\n'''", "x = \"\\\"" + dots + "\"",
        "x = [" + repeated("1.5, ", 1000) + "2.5]", repeated("[[a.b]]\nx.y = 1.5\n", 1000),
        "x = [\n" + repeated("  {a.b = 1.5},\n", 1000) + "]"}) {
    EXPECT_EQ(line_too_deep(text), std::nullopt) << text.substr(0, 80);
    EXPECT_NO_THROW(static_cast<void>(parse_toml(text, "m.toml"))) << text.substr(0, 80);
  }
}

}  // namespace

}  // namespace vbar::mission::test
