#include "tests/integration/rendezvous/run_mission.h"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include "fsw/packets/packet.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/simulation/assembly.h"
#include "host_sim/simulation/flight_computer.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

/// Keeps the bytes of what the flight software said.
class OutputCollector final : public app::RunObserver {
 public:
  explicit OutputCollector(FlownMission& flown) : flown_(flown) {}

  void on_step(std::uint32_t, fsw::GpsTime, std::span<const pil::Packet>,
               std::span<const pil::Packet> outputs) override {
    for (const pil::Packet& packet : outputs) {
      const auto view = fsw::packets::parse_packet(packet);
      ASSERT_TRUE(view.ok()) << "the flight software sent something that is no packet";
      const fsw::packets::Apid apid = view.value().header.apid;
      const bool is_command = apid == fsw::packets::Apid::kManeuverCommand;
      ASSERT_TRUE(is_command || fsw::packets::is_telemetry(apid));
      pil::Packet& bytes = is_command ? flown_.commands : flown_.telemetry;
      bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
  }

 private:
  FlownMission& flown_;
};

bool is_for(const report::ManeuverRow& maneuver, int first, int last) {
  return maneuver.accepted && maneuver.waypoint_index >= first && maneuver.waypoint_index <= last;
}

}  // namespace

std::string sha256(std::span<const std::uint8_t> bytes) {
  std::array<unsigned char, 32> digest{};
  EXPECT_EQ(EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr), 1);
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

FlownMission fly(const std::string& file, const std::vector<std::string>& overrides, const Wrap& wrap,
                 app::RunObserver* observer) {
  const std::string root = vbar::tests::source_path();
  const mission::Mission mission = sensors::load_mission(root + "/missions/" + file, overrides);
  std::unique_ptr<pil::FlightComputer> computer = app::connect_flight_computer(app::flying_spacecraft(mission));
  if (wrap) computer = wrap(std::move(computer));

  FlownMission flown;
  flown.record.extensions = sensors::extensions();  // whose figures are part of the summary
  OutputCollector collector(flown);
  std::vector<app::RunObserver*> observers{&collector};
  if (observer != nullptr) observers.push_back(observer);
  engine::SteadyWallClock wall;
  app::AssembledMission assembled(mission, root + "/data");
  flown.complete = assembled.fly({*computer, wall, observers, {}, {}}, flown.record);
  computer->close();
  return flown;
}

double dv_commanded_for(const report::RunRecord& record, int first, int last) {
  double sum = 0.0;
  for (const report::ManeuverRow& maneuver : record.maneuvers) {
    const report::Triple& dv = maneuver.executed_dv_rtn_mps;
    if (is_for(maneuver, first, last)) sum += std::hypot(dv[0], dv[1], dv[2]);
  }
  return sum;
}

int maneuvers_commanded_for(const report::RunRecord& record, int first, int last) {
  int count = 0;
  for (const report::ManeuverRow& maneuver : record.maneuvers) count += is_for(maneuver, first, last) ? 1 : 0;
  return count;
}

report::WaypointRow waypoint(const report::RunRecord& record, int index) {
  for (const report::WaypointRow& row : record.waypoints) {
    if (row.index == index) return row;
  }
  ADD_FAILURE() << "waypoint " << index << " was not evaluated";
  return {};
}

}  // namespace vbar::test
