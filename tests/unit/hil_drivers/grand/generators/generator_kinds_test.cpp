// The registry of generators, and what their tables in a mission accept.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/toml_file.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string error_in(const GeneratorKind& kind, const std::string& text) {
  const toml::table table = mission::parse_toml(text, "t.toml");
  try {
    static_cast<void>(kind.read(mission::TableReader(table, "t.toml")));
  } catch (const mission::MissionError& error) {
    return error.what();
  }
  return "";
}

const GeneratorKind& kind_of(std::string_view name) {
  for (const GeneratorKind* kind : generator_kinds())
    if (kind->name == name) return *kind;
  throw std::logic_error("unknown kind");
}

TEST(GeneratorKinds, AreTheseThree) {
  std::vector<std::string_view> names;
  for (const GeneratorKind* kind : generator_kinds()) names.push_back(kind->name);
  EXPECT_THAT(names, ElementsAre("skydel", "simgen", "template"));
}

TEST(GeneratorKinds, RefuseUnknownKeys) {
  EXPECT_EQ(error_in(kind_of("skydel"), ""), "");
  EXPECT_EQ(error_in(kind_of("simgen"), ""), "");
  EXPECT_THAT(error_in(kind_of("skydel"), "radios = \"X300\""), HasSubstr("radios: found an unknown key"));
  EXPECT_THAT(error_in(kind_of("simgen"), "trigger_mode = 3"), HasSubstr("trigger_mode"));
}

const std::string kFields =
    "start_lines = [\"GO\"]\n"
    "fields = [ { value = \"time_s\", type = \"f64\" }, { value = \"vehicle\", type = \"u32\" },"
    "{ value = \"position_ecef_x\", type = \"f64\" }, { value = \"position_ecef_y\", type = \"f64\" }";

TEST(GeneratorKinds, ATemplateIsReadFromTheMission) {
  EXPECT_EQ(error_in(kind_of("template"), kFields + ", { value = \"position_ecef_z\", type = \"f64\", scale = 1e3 },"
                                                    "{ constant = 7, type = \"u8\" } ]\nbyte_order = \"big\"\n"),
            "");
}

TEST(GeneratorKinds, ATemplateNamesTheKnownNames) {
  const auto error = [](const std::string& field) {
    return error_in(kind_of("template"), kFields + ", " + field + " ]\n");
  };
  EXPECT_THAT(error("{ value = \"position_ecef_z\", type = \"f16\" }"),
              HasSubstr("u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64"));
  EXPECT_THAT(error("{ value = \"position_z\", type = \"f64\" }"), HasSubstr("position_ecef_z"));
  EXPECT_THAT(error("{ value = \"yaw\", constant = 1, type = \"f64\" }"), HasSubstr("both value and constant"));
  EXPECT_THAT(error("{ value = \"yaw\", type = \"f64\" }"), HasSubstr("no position_ecef_z"));
  EXPECT_THAT(error("{ value = \"position_ecef_z\", type = \"f64\", scale = 0.0 }"), HasSubstr("the scale not 0"));
  EXPECT_THAT(error_in(kind_of("template"), "start_lines = \"GO\""), HasSubstr("an array of texts"));
  EXPECT_THAT(error_in(kind_of("template"), kFields + ", { constant = 300, type = \"u8\" } ]"),
              HasSubstr("300 does not fit"));
}

TEST(GeneratorKinds, NeedTheRightNumberOfPorts) {
  GeneratorPlan plan;
  plan.vehicles = {"servicer", "target"};
  plan.control_ports = {1};
  const toml::table table;
  const mission::TableReader section(table, "t.toml");
  const auto settings = kind_of("skydel").read(section);
  EXPECT_THAT(error_of([&] { static_cast<void>(kind_of("skydel").make(plan, *settings)); }),
              HasSubstr("1 control ports for 2 vehicles"));
}

}  // namespace
}  // namespace vbar::grand::test
