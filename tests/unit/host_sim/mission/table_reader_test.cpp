// A table reader knows the keys that it was asked for, refuses all others, and names an unknown key before any other
// fault of the same table.

#include "host_sim/mission/table_reader.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/mission/toml_file.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

using testing::ElementsAre;

template <class Use>
std::string error_of(const Use& use) {
  try {
    use();
  } catch (const MissionError& error) {
    return error.what();
  }
  return "";
}

/// Reads a table with the keys `mass` (required, above 0) and `count`, and an inner table with `size`.
std::string error_of_text(const std::string& text) {
  const toml::table table = parse_toml(text, "t.toml");
  const TableReader reader(table, "t.toml");
  return error_of([&] {
    static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
    static_cast<void>(reader.integer("count", 1, 9, 1));
    static_cast<void>(reader.table("inner").flag("size", true));
    reader.finish();
  });
}

TEST(TableReader, RemembersWhatItWasAskedFor) {
  const toml::table table = parse_toml("mass = 1.0\n[inner]\nsize = true\n", "t.toml");
  const TableReader reader(table, "t.toml");
  static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
  static_cast<void>(reader.has("colour"));
  static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
  static_cast<void>(reader.table("inner").flag("size", true));
  EXPECT_THAT(reader.asked(), ElementsAre("mass", "colour", "inner"));
  EXPECT_THAT(reader.asked_of_all().at("inner"), ElementsAre(AcceptedKey{"size", "true or false", "true"}));
  EXPECT_THAT(reader.asked_of_all().at(""),
              ElementsAre(AcceptedKey{"mass", "a number above 0, up to 10", ""}, AcceptedKey{"colour", "", ""},
                          AcceptedKey{"inner", "a table", ""}));
  EXPECT_THAT(reader.keys(), ElementsAre("inner", "mass"));
  EXPECT_NO_THROW(reader.finish());
}

TEST(TableReader, RefusesWhatNobodyAskedFor) {
  EXPECT_EQ(error_of_text("mass = 1\n"), "");
  EXPECT_EQ(error_of_text("mass = 1\nmas = 2\n"),
            "t.toml:2: mas: found an unknown key (did you mean mass?); accepted: mass, count or inner");
  EXPECT_EQ(error_of_text("mass = 1\n[inner]\nsizes = true\n"),
            "t.toml:3: inner.sizes: found an unknown key (did you mean size?); accepted: size");
}

// A misspelt key leaves the right one missing: the message is about the spelling.
TEST(TableReader, NamesAnUnknownKeyBeforeOtherFaultsOfTheTable) {
  EXPECT_EQ(error_of_text("mas = 2\n"),
            "t.toml:1: mas: found an unknown key (did you mean mass?); accepted: mass, count or inner");
  EXPECT_EQ(error_of_text("mass = -1\ncolour = 2\n"),
            "t.toml:2: colour: found an unknown key; accepted: mass, count or inner");
}

TEST(TableReader, ReportsTheFirstFault) {
  EXPECT_EQ(error_of_text("mass = -1\ncount = 99\n"),
            "t.toml:1: mass: found the integer -1; accepted: a number above 0, up to 10");
  EXPECT_EQ(error_of_text("mass = nan\n"), "t.toml:1: mass: found nan; accepted: a number above 0, up to 10");
  EXPECT_EQ(error_of_text(""), "t.toml:1: mass: found nothing; accepted: a number above 0, up to 10");
}

// What is refused after a value that was replaced may be a consequence of the replacement.
TEST(TableReader, AnEarlierFaultComesBeforeOneOfTheCaller) {
  const toml::table table = parse_toml("mass = -1\n", "t.toml");
  const TableReader reader(table, "t.toml");
  EXPECT_EQ(error_of([&] {
              static_cast<void>(reader.number("mass", above_to(0.0, 10.0)));
              reader.refuse("mass", "a mass above the limit", "less");
            }),
            "t.toml:1: mass: found the integer -1; accepted: a number above 0, up to 10");
}

TEST(TableReader, ReadsAnArrayOfTexts) {
  const auto read = [](const std::string& text) {
    const toml::table table = parse_toml(text, "t.toml");
    return TableReader(table, "t.toml").texts("lines");
  };
  EXPECT_THAT(read("lines = [\"a\", \"\"]\n"), ElementsAre("a", ""));
  EXPECT_THAT(read(""), ElementsAre());
  const std::string accepted = "; accepted: an array of texts, each on one line";
  EXPECT_EQ(error_of([&] { read("lines = \"a\"\n"); }), "t.toml:1: lines: found the text \"a\"" + accepted);
  EXPECT_EQ(error_of([&] { read("lines = [\"a\",\n 2]\n"); }), "t.toml:2: lines: found the integer 2" + accepted);
  EXPECT_THAT(error_of([&] { read("lines = [\"a\\nb\"]\n"); }), testing::EndsWith(accepted));
}

}  // namespace

namespace {

const std::string kSmall(kSmallMission);

TEST(Overrides, ReplaceWhatTheFileSays) {
  EXPECT_EQ(small_mission({"mission.duration_h=1.5"}).duration, fsw::duration_of_seconds(5400));
  EXPECT_EQ(small_mission({"mission.seed=3"}).seed, 3U);
  EXPECT_EQ(small_mission({"mission.seed=3", "mission.seed=4"}).seed, 4U) << "the last one counts";
}

TEST(Overrides, MakeTablesTheFileDoesNotHave) {
  const Mission mission = small_mission({"truth.gravity_degree=20", "links.board.latency.latency_s=0.25"});
  EXPECT_EQ(mission.truth.gravity_degree, 20);
  EXPECT_EQ(mission.truth.gravity_order, 20) << "the default follows the degree";
  EXPECT_EQ(mission.board_link.latency.mean_s, 0.25);
}

TEST(Overrides, ReachASpacecraftByNameAndAWaypointByIndex) {
  const Mission mission = small_mission({"spacecraft.target.mass_kg=41", "waypoint.1.time_h=3",
                                         "spacecraft.servicer.actuators.thruster.magnitude_error_percent=1"});
  EXPECT_EQ(mission.find_spacecraft("target")->surface.mass_kg, 41.0);
  EXPECT_EQ(mission.find_spacecraft("servicer")->surface.mass_kg, 154.0);
  EXPECT_EQ(mission.find_waypoint(1)->time - mission.epoch, fsw::duration_of_seconds(3 * 3600));
  EXPECT_DOUBLE_EQ(mission.find_spacecraft("servicer")->thruster->magnitude_error, 0.01);
}

TEST(Overrides, ReachAFaultByNameOrReplaceAllFaults) {
  const std::string faults = "fault=[{kind=\"thrust_scale\", name=\"weak\", at_h=1.0, value=0.5}]";
  const Mission mission = small_mission({faults, "fault.weak.value=0.25"});
  ASSERT_EQ(mission.faults.size(), 1U);
  EXPECT_EQ(mission.faults[0].value, 0.25);
  EXPECT_NE(message_of(kSmall, {faults, "fault.strong.value=2"}).find("fault.weak"), std::string::npos);
}

TEST(Overrides, FlightComputerAloneIsTheServicers) {
  const Mission brief = small_mission({"flight_computer.target=zynq_qemu", "flight_computer.link=udp"});
  const Mission full = small_mission(
      {"spacecraft.servicer.flight_computer.target=zynq_qemu", "spacecraft.servicer.flight_computer.link=udp"});
  for (const Mission& mission : {brief, full}) {
    EXPECT_EQ(mission.find_spacecraft("servicer")->flight_computer->target, FlightTarget::kZynqQemu);
    EXPECT_EQ(mission.find_spacecraft("servicer")->flight_computer->link, FlightLink::kUdp);
    EXPECT_FALSE(mission.find_spacecraft("target")->flight_computer.has_value());
  }
}

// The name of a sensor that the servicer has stands for that sensor.
TEST(Overrides, TheNameOfASensorAloneIsTheServicers) {
  const std::string text = changed(kSmall, "sensors.navigation = {}", "sensors.states = { kind = \"navigation\" }");
  EXPECT_EQ(message_of(text, {"states.source=seance"}),
            "--set states.source=seance: spacecraft.servicer.sensors.states.source: found the text \"seance\"; "
            "accepted: ideal or recorded");
  EXPECT_EQ(
      sensor_of<NavigationSensor>(parse_mission(text, "m.toml", std::vector<std::string>{"states.period_s=7"})).period,
      fsw::duration_of_seconds(7));
  EXPECT_EQ(message_of(text, {"camera.period_s=7"}).substr(0, 56),
            "--set camera.period_s=7: camera: found an unknown key; a");
}

TEST(Overrides, TextNeedsNoQuotesButMayHaveThem) {
  for (const std::string set : {"mission.name=run_7", "mission.name=\"run_7\""})
    EXPECT_EQ(small_mission({set}).name, "run_7");
  const std::vector<std::string> board{"flight_computer.target=board", "flight_computer.device=/dev/ttyUSB0"};
  EXPECT_EQ(small_mission(board).find_spacecraft("servicer")->flight_computer->device, "/dev/ttyUSB0");
  EXPECT_EQ(small_mission({"mission.description=say \"hello\" = \\o/"}).description, "say \"hello\" = \\o/");
  EXPECT_EQ(small_mission({"mission.description="}).description, "");
}

TEST(Overrides, ReplaceALabelledElementAsAWhole) {
  const Mission mission = small_mission({"waypoint.1={time_h=4, a_roe_m=[1, 2, 3, 4, 5, 6]}"});
  EXPECT_EQ(mission.find_waypoint(1)->time - mission.epoch, fsw::duration_of_seconds(4 * 3600));
  EXPECT_EQ(mission.find_waypoint(1)->a_roe_m(0), 1.0);
}

TEST(Overrides, WholeTablesAndArraysAreValuesToo) {
  const Mission mission = small_mission({"waypoint.1.a_roe_m=[1, 2, 3, 4, 5, 6]",
                                         "links.board.latency={distribution=\"uniform\", min_s=0.1, max_s=0.2}"});
  EXPECT_EQ(mission.find_waypoint(1)->a_roe_m(5), 6.0);
  EXPECT_EQ(mission.board_link.latency.kind, engine::LatencyKind::kUniform);
}

TEST(Overrides, DateTimeIsATimeOrAText) {
  const Mission mission = small_mission({"mission.epoch_utc=2011-07-18T02:00:00Z"});
  EXPECT_EQ(mission.epoch - small_mission().epoch, fsw::duration_of_seconds(3600));
}

struct BadOverride {
  std::string set;
  std::string message;  ///< after "--set <set>: "
};

TEST(Overrides, AreCheckedLikeTheFileAndNamedInTheMessage) {
  const BadOverride cases[] = {
      {"mission.seed=x", "mission.seed: found the text \"x\"; accepted: an integer from 0 to 9223372036854775807"},
      {"mission.duration_h=nan", "mission.duration_h: found nan; accepted: a number above 0, up to 2000"},
      {"mission.sed=1",
       "mission.sed: found an unknown key (did you mean seed?); accepted: name, description, epoch_utc, start_h, "
       "duration_h, step_s or seed"},
      {"clok.mode=real_time",
       "clok: found an unknown key (did you mean clock?); accepted: mission, truth, testbed, waypoint, "
       "spacecraft, guidance, safety, navigation, burn, fault, clock, links, lcm, telemetry, record, limit, "
       "constellation or "
       "extends"},
      {"waypoint.1.time_h=0",
       "waypoint.1.time_h: found the integer 0; accepted: a time after that of waypoint 0, which stands before it"},
      {"flight_computer.target=board",
       "spacecraft.servicer.flight_computer.device: found nothing; accepted: the tty of the board, e.g. /dev/ttyUSB0"},
      // Complaints about the assignment itself.
      {"mission.seed", "mission.seed: found no '='; accepted: path=value with a dotted path, e.g. mission.seed=3"},
      {"mission..seed=1",
       "mission..seed: found an empty name in the path; accepted: path=value with a dotted path, e.g. mission.seed=3"},
      {"=1", "found an empty name in the path; accepted: path=value with a dotted path, e.g. mission.seed=3"},
      {"spacecraft.moon.mass_kg=1",
       "spacecraft.moon.mass_kg: found no spacecraft whose name is \"moon\"; accepted: spacecraft.servicer or target"},
      {"waypoint.9.time_h=1", "waypoint.9.time_h: found no waypoint whose index is \"9\"; accepted: waypoint.0 or 1"},
      {"waypoint.1=1",
       "waypoint.1: found a path that ends too early; accepted: spacecraft.NAME.KEY=value or waypoint.INDEX.KEY=value, "
       "or a table as value"},
      {"mission.duration_h.unit=h",
       "mission.duration_h.unit: found a path through duration_h, which is the number 2; accepted: a path through "
       "tables"},
  };
  for (const BadOverride& bad : cases) {
    const std::string message = message_of(kSmall, {bad.set});
    // A key that is missing altogether has no override to blame; its table has.
    if (bad.set == "flight_computer.target=board") {
      EXPECT_TRUE(message.ends_with(bad.message)) << message;
    } else {
      EXPECT_EQ(message, "--set " + bad.set + ": " + bad.message);
    }
  }
}

}  // namespace

namespace {

const std::vector<std::string_view> kNames{"gravity_degree", "gravity_order", "threads", "seed"};

TEST(NearestName, FindsSlipsOfTheKeyboard) {
  EXPECT_EQ(nearest_name("gravity_degre", kNames), "gravity_degree");  // left out
  EXPECT_EQ(nearest_name("gravity_odrer", kNames), "gravity_order");   // swapped
  EXPECT_EQ(nearest_name("treads", kNames), "threads");
  EXPECT_EQ(nearest_name("sead", kNames), "seed");  // replaced
  EXPECT_EQ(nearest_name("seed", kNames), "seed");
}

TEST(NearestName, GivesNoneForSomethingElse) {
  EXPECT_FALSE(nearest_name("colour", kNames).has_value());
  EXPECT_FALSE(nearest_name("", kNames).has_value());
  EXPECT_FALSE(nearest_name("seed", {}).has_value());
}

}  // namespace

namespace {

TEST(WordSearch, FindsWordsNotParts) {
  EXPECT_EQ(match_of("isp", "X display"), Match::kNone);
  EXPECT_EQ(match_of("hold", "acquisition_threshold_dbhz"), Match::kNone);
  EXPECT_EQ(match_of("hold", "safety.hold_distance_m"), Match::kWord);
  EXPECT_EQ(match_of("hold", "holdover"), Match::kWordStart);
  EXPECT_EQ(match_of("hold", "a threshold, then holdover, then a hold"), Match::kWord) << "the best of several";
}

TEST(WordSearch, IgnoresCaseAndFindsSeveralWords) {
  EXPECT_EQ(match_of("klobuchar", "Klobuchar, scaled"), Match::kWord);
  EXPECT_EQ(match_of("keep_out", "guidance.keep_out_radius_m"), Match::kWord);
  EXPECT_EQ(match_of("sensors.cam", "spacecraft.sensors.camera.period_s"), Match::kWordStart);
  EXPECT_EQ(match_of("_deg", "inclination_deg"), Match::kWord);
}

TEST(WordSearch, EndsOfTheText) {
  EXPECT_EQ(match_of("", "anything"), Match::kWord);
  EXPECT_EQ(match_of("longer than it", "it"), Match::kNone);
  EXPECT_EQ(match_of("it", "it"), Match::kWord);
  EXPECT_EQ(match_of("a", ""), Match::kNone);
}

TEST(WordSearch, MeansANameOrAPartOfOne) {
  const std::vector<std::string> names{"links.crosslink.loss_probability", "truth.csv position_error_m"};
  EXPECT_EQ(word_meant("crosslnk", names), " (did you mean crosslink?)");
  EXPECT_EQ(word_meant("positon_error", names), " (did you mean position_error_m?)");
  EXPECT_EQ(word_meant("probabilty", names), " (did you mean probability?)");
  EXPECT_EQ(word_meant("gravity_gradient", names), "");
}

}  // namespace

}  // namespace vbar::mission::test
