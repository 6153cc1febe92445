// Faults: their lines, when they begin and end, and when they are acknowledged.

#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/bench/faults/fault_list.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::optical_stimulator::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class FaultListTest : public ::testing::Test {
 protected:
  FaultListTest() {
    FaultActions actions;
    actions.camera = [this](const Fault& fault, bool on) {
      events.push_back(std::string(rule_of(fault.kind).name) + (on ? " on" : " off"));
    };
    actions.bump = [this](double x, double) { events.push_back("bump " + std::to_string(x)); };
    actions.stall_rail = [this](std::size_t axis) { events.push_back("stall " + std::to_string(axis)); };
    actions.move_rail = [this](std::size_t axis, double) { events.push_back("move " + std::to_string(axis)); };
    actions.rail_stalls = [this](std::size_t) { return stalls; };
    actions.exit = [this] { events.push_back("exit"); };
    list.emplace(actions, file);
  }
  ~FaultListTest() override { std::remove(file.c_str()); }

  void add(const std::string& line, double now_s = 0.0) {
    list->add(fault_from_json(line), now_s, [this](const std::string& text) { acknowledged.push_back(text); });
  }
  ExposureFaults expose(std::uint64_t frame) {
    const ExposureFaults faults = list->begin_exposure(frame, 0.0);
    list->end_exposure(frame);
    return faults;
  }

  std::string file = testing::TempDir() + "vbar_os_faults.jsonl";
  std::vector<std::string> events, acknowledged;
  std::uint64_t stalls = 0;
  std::optional<FaultList> list;
};

TEST_F(FaultListTest, ALateFrameAtItsNumberForItsLength) {
  add(R"({"kind": "late_frame", "frame": 2, "frames": 2})");
  std::vector<bool> late;
  for (std::uint64_t frame = 0; frame < 6; ++frame) {
    if (frame == 2) {
      EXPECT_THAT(acknowledged, IsEmpty());
    }
    late.push_back(expose(frame).panel.is_late);
  }
  EXPECT_THAT(late, ElementsAre(false, false, true, true, false, false));
  EXPECT_THAT(acknowledged, ElementsAre(R"({"kind":"late_frame","frame":2})"));
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, R"({"kind":"late_frame","frame":2})");
}

TEST_F(FaultListTest, WithoutANumberFromTheNextExposureToTheEnd) {
  (void)expose(0);
  add(R"({"kind": "brightness", "factor": 0.9})");
  EXPECT_THAT(acknowledged, IsEmpty());
  for (std::uint64_t frame = 1; frame < 5; ++frame) EXPECT_DOUBLE_EQ(expose(frame).brightness_factor, 0.9);
  EXPECT_EQ(acknowledged.size(), 1U);
}

TEST_F(FaultListTest, TheCameraReturnsAfterItsTime) {
  add(R"({"kind": "camera_away", "duration_s": 2.0})", 10.0);
  list->advance(11.9);
  EXPECT_THAT(events, ElementsAre("camera_away on"));
  list->advance(12.0);
  list->advance(13.0);
  EXPECT_THAT(events, ElementsAre("camera_away on", "camera_away off"));
}

TEST_F(FaultListTest, AStalledRailIsAcknowledgedWhenAMoveHasStalled) {
  add(R"({"kind": "rail_stalled", "axis": 2})");
  EXPECT_THAT(events, ElementsAre("stall 1"));
  EXPECT_THAT(acknowledged, IsEmpty());
  stalls = 1;
  list->advance(1.0);
  EXPECT_THAT(acknowledged, ElementsAre(HasSubstr(R"("axis":2)")));
}

TEST_F(FaultListTest, HostileLinesAreOneError) {
  for (const char* line : {"", "{}", "[]", "{\"kind\": 5}", R"({"kind": "nothing"})", R"({"kind": "gain"})",
                           R"({"kind": "gain", "factor": -1})", R"({"kind": "late_frame", "frames": -1})",
                           R"({"kind": "late_frame", "count": 1})", R"({"kind": "rail_moved", "axis": 3, "by_um": 1})",
                           R"({"kind": "bumped", "x_um": true})"})
    EXPECT_THAT([&] { (void)fault_from_json(line); },
                ThrowsMessage<mission::MissionError>(HasSubstr("fault control line")))
        << line;
}

TEST(Panel, ShowsWhatItsFaultsMakeOfTheScreen) {
  const auto picture = [](std::uint8_t first) {
    return Pictures{
        {std::make_shared<const std::vector<std::uint8_t>>(std::vector<std::uint8_t>{first, 1, 2, 3, 4, 5, 6, 7}),
         1.0}};
  };
  const auto shown = [](const Pictures& pictures) { return *pictures.front().counts; };
  Panel panel(4, 2);
  PanelFaults none, late, frozen, mirrored, rotated, covered;
  late.is_late = frozen.is_frozen = mirrored.is_mirrored = rotated.is_rotated = covered.is_covered = true;
  EXPECT_EQ(shown(panel.show(picture(10), none))[0], 10);
  EXPECT_EQ(shown(panel.show(picture(20), late))[0], 10);
  EXPECT_EQ(shown(panel.show(picture(20), none))[0], 20);
  EXPECT_EQ(shown(panel.show(picture(30), frozen))[0], 20);
  EXPECT_EQ(shown(panel.show(picture(40), frozen))[0], 20);
  EXPECT_EQ(shown(panel.show(picture(50), none))[0], 50);
  EXPECT_THAT(shown(panel.show(picture(0), mirrored)), ElementsAre(3, 2, 1, 0, 7, 6, 5, 4));
  EXPECT_THAT(shown(panel.show(picture(0), rotated)), ElementsAre(7, 6, 5, 4, 3, 2, 1, 0));
  EXPECT_THAT(shown(panel.show(picture(0), covered)), ElementsAre(0, 128, 128, 3, 4, 5, 6, 7));
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
