// Faults: their lines, when they begin and end, and when they are acknowledged.

#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/tron/faults.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class TronFaults : public ::testing::Test {
 protected:
  TronFaults() {
    list.emplace(
        [this](const Fault& fault, bool is_on) {
          events.push_back(std::string(rule_of(fault.kind).name) + (is_on ? " on" : " off"));
        },
        file);
  }
  ~TronFaults() override { std::remove(file.c_str()); }

  void add(const std::string& line, double now_s = 0.0) {
    list->add(fault_from_json(line), now_s, [this](const std::string& text) { acknowledged.push_back(text); });
  }

  std::string file = testing::TempDir() + "vbar_tron_faults.jsonl";
  std::vector<std::string> events, acknowledged;
  std::optional<FaultList> list;
};

TEST_F(TronFaults, AtAnImageForItsImages) {
  add(R"({"kind": "lamp_out", "at_image": 2, "images": 2})");
  list->end_exposure(0, 0.0);
  EXPECT_THAT(events, IsEmpty());
  list->end_exposure(1, 0.0);
  EXPECT_THAT(events, ElementsAre("lamp_out on"));
  EXPECT_THAT(acknowledged, IsEmpty());
  list->end_exposure(2, 0.0);
  EXPECT_THAT(acknowledged, ElementsAre(R"({"kind":"lamp_out","image":2,"cycle":0})"));
  EXPECT_THAT(events, ElementsAre("lamp_out on"));
  list->end_exposure(3, 0.0);
  EXPECT_THAT(events, ElementsAre("lamp_out on", "lamp_out off"));
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, R"({"kind":"lamp_out","image":2,"cycle":0})");
}

TEST_F(TronFaults, CyclesAfterAnImageDuringTheMoveToTheNext) {
  add(R"({"kind": "emergency_stop", "robot": "target", "at_image": 1, "after_cycles": 30, "duration_s": 2.0})");
  list->begin_cycle(100, 0.0);
  list->end_exposure(0, 0.0);
  list->begin_cycle(129, 1.0);
  EXPECT_THAT(events, IsEmpty());
  list->begin_cycle(130, 1.0);
  EXPECT_THAT(events, ElementsAre("emergency_stop on"));
  EXPECT_THAT(acknowledged, ElementsAre(R"({"kind":"emergency_stop","image":1,"cycle":130,"robot":"target"})"));
  list->advance(2.9);
  EXPECT_EQ(events.size(), 1U);
  list->advance(3.0);
  list->advance(4.0);
  EXPECT_THAT(events, ElementsAre("emergency_stop on", "emergency_stop off"));
}

TEST_F(TronFaults, AtACycleForItsCycles) {
  add(R"({"kind": "axes_frozen", "robot": "camera", "at_cycle": 10, "cycles": 5})");
  for (std::uint64_t cycle = 1; cycle <= 20; ++cycle) {
    list->begin_cycle(cycle, 0.0);
    EXPECT_EQ(events.size(), cycle < 10 ? 0U : (cycle < 15 ? 1U : 2U)) << cycle;
  }
}

TEST_F(TronFaults, OfMotionCaptureIsAcknowledgedWithItsFrame) {
  add(R"({"kind": "vicon_offset", "object": "target", "by_mm": 20})");
  EXPECT_THAT(events, ElementsAre("vicon_offset on"));
  EXPECT_THAT(acknowledged, IsEmpty());
  list->vicon_frame_sent();
  list->vicon_frame_sent();
  EXPECT_THAT(acknowledged, ElementsAre(HasSubstr(R"("object":"target","by_mm":20.0)")));
}

TEST_F(TronFaults, OnceOnlyBegins) {
  add(R"({"kind": "frames_stale", "count": 2})");
  add(R"({"kind": "bench_exit", "at_image": 1})");
  list->end_exposure(0, 0.0);
  EXPECT_THAT(events, ElementsAre("frames_stale on", "bench_exit on"));
}

TEST_F(TronFaults, HostileLinesAreOneError) {
  for (const char* line : {"", "{}", "[]", "{\"kind\": 5}", R"({"kind": "nothing"})", R"({"kind": "emergency_stop"})",
                           R"({"kind": "emergency_stop", "robot": "third"})", R"({"kind": "box_out", "box": 11})",
                           R"({"kind": "box_out", "box": 0})", R"({"kind": "lamp_out", "at_image": -1})",
                           R"({"kind": "lamp_out", "at_image": 1, "at_cycle": 2})",
                           R"({"kind": "lamp_out", "cycles": 2})", R"({"kind": "gain", "factor": -1})",
                           R"({"kind": "gain", "factor": true})", R"({"kind": "bench_exit", "x": 1})"})
    EXPECT_THAT([&] { (void)fault_from_json(line); },
                ThrowsMessage<mission::MissionError>(HasSubstr("fault control line")))
        << line;
}

TEST(TronFaultFile, AnErrorNamesItsLine) {
  const std::string file = testing::TempDir() + "vbar_tron_faults_file.jsonl";
  std::ofstream(file) << R"({"kind": "lamp_out"})"
                      << "\n\n"
                      << R"({"kind": "box_out", "box": 3})"
                      << "\n";
  EXPECT_EQ(read_fault_file(file).size(), 2U);
  std::ofstream(file) << R"({"kind": "lamp_out"})"
                      << "\n{\n";
  EXPECT_THAT([&] { (void)read_fault_file(file); }, ThrowsMessage<mission::MissionError>(HasSubstr(file + ":2")));
  std::remove(file.c_str());
}

}  // namespace
}  // namespace vbar::tron::bench
