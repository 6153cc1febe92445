// The order in which telecommands arrive has no effect on navigation by sensors: with the bytes of emulated receivers
// from then on, every output is the same byte for byte. Of the sources with a camera no image is needed: the a-priori
// orbit, which two telecommands can bring, is referred to the servicer's own orbit and points the camera.

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/gnc/gnc.h"
#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "tests/integration/experiment3/emulated_pair.h"
#include "tests/support/paths.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::test {
namespace {

namespace packets = fsw::packets;
using fsw::gnc::test::packet_of;
using Packets = std::vector<twins::Packet>;

constexpr int kArrivalSteps = 3;
constexpr int kOrders = 8;
constexpr fsw::Duration periods(int n) {
  return fsw::duration_of_seconds(10 * n);  // of the receivers
}
const fsw::Vector6 kRelative = (fsw::Vector6() << 0, -100, 0, 3, 0, 3).finished();

template <class Message>
const Message* last_of(const Packets& sent, Message& message) {
  const Message* found = nullptr;
  for (const twins::Packet& packet : sent) {
    const auto decoded = packets::decode<Message>(packets::parse_packet(packet).value());
    if (!decoded.ok()) continue;
    message = decoded.value();
    found = &message;
  }
  return found;
}

/// With sequence counts of zero: a source that is selected in an earlier step has sent telemetry since.
Packets without_counts(const Packets& sent) {
  Packets all;
  for (const twins::Packet& packet : sent) {
    const packets::PacketView view = packets::parse_packet(packet).value();
    packets::PacketHeader header = view.header;
    header.sequence_count = 0;
    twins::Packet& to = all.emplace_back(packets::kMaxPacketBytes);
    to.resize(packets::write_packet(header, view.payload, to).value());
  }
  return all;
}

constexpr std::int32_t kOwn = navigation_configuration::kUseOwnGnss;
constexpr std::int32_t kCarrier = kOwn + navigation_configuration::kUseCarrierPair;
constexpr std::int32_t kBearings = kOwn + navigation_configuration::kUseBearings;
constexpr std::int32_t kKeypoints = kOwn + navigation_configuration::kUseKeypoints;

class TelecommandOrder : public ::testing::TestWithParam<std::int32_t> {
 protected:
  TelecommandOrder() {
    const mission::Mission mission = sensors::load_mission(tests::source_path() + "/missions/experiment3.toml", {});
    const mission::Spacecraft& servicer = *mission.find_spacecraft("servicer");
    start_ = coast_.epochs().front().time;
    receive_all(mission, servicer);
    auto navigation = sensors::navigation_configuration_of(mission, servicer);
    navigation.sources = GetParam();
    const fsw::GpsTime sent = start_ - periods(kArrivalSteps);
    const auto add = [&](const auto& message) { telecommands_.push_back(packet_of(sent, message)); };
    add(navigation);
    add(sensors::earth_configuration_of(mission, coast_.earth_orientation()));
    add(mission.navigation.thruster);
    add(sensors::receiver_configuration_of(servicer));
    add(sensors::carrier_configuration_of(mission, servicer));
    add(fsw::gnc::test::camera());
    add(fsw::gnc::test::angles_only());
    add(fsw::gnc::test::pose());
    add(fsw::gnc::test::target_shape());
    add(GetParam() == kKeypoints ? fsw::gnc::test::target(kRelative) : target_of_truth());
    add(fsw::gnc::test::table_of({fsw::gnc::test::waypoint_at(8, 400 * 3600, 1, kRelative)}));
    add(fsw::gnc::test::configuration());
    add(fsw::gnc::test::mode(mode_command::kModeApproach));
  }

  /// The sensors' packets by the epoch at which they have arrived.
  void receive_all(const mission::Mission& mission, const mission::Spacecraft& servicer) {
    arrived_.resize(coast_.epochs().size());
    for (const auto& sensor : sensors::make_sources(mission, servicer, tests::source_path() + "/data").sources) {
      for (const twins::TruthSnapshot& truth : coast_.epochs()) {
        const twins::Measurement measurement = sensor.packets->measure(truth);
        const auto step = ((measurement.available - start_ + periods(1)).ns - 1) / periods(1).ns;
        if (step >= static_cast<std::int64_t>(arrived_.size())) continue;
        Packets& to = arrived_[static_cast<std::size_t>(step)];
        to.insert(to.end(), measurement.packets.begin(), measurement.packets.end());
      }
    }
  }

  [[nodiscard]] target_apriori target_of_truth() const {
    target_apriori apriori{};
    const fsw::orbit::CartesianState& known = coast_.epochs().front().find("target")->orbit;
    for (int k = 0; k < 3; ++k) {
      apriori.position_eci[k] = known.position_eci(k);
      apriori.velocity_eci[k] = known.velocity_eci(k);
    }
    for (double& sigma : apriori.sigma_a_roe_m) sigma = 300.0;
    return apriori;
  }

  /// What is sent from the first measurement on. `steps` and `order`: of each telecommand.
  Packets fly(const std::vector<int>& steps, const std::vector<std::size_t>& order) {
    Packets sent;
    const auto keep = [](void* all, const std::uint8_t* packet, std::size_t size) {
      static_cast<Packets*>(all)->emplace_back(packet, packet + size);
    };
    const auto gnc = std::make_unique<fsw::gnc::Gnc>(fsw::gnc::test::kServicer, keep, &sent);
    const auto run = [&](fsw::GpsTime now) {
      tick message{};
      message.period_ns = periods(1).ns;
      EXPECT_EQ(gnc->receive(packet_of(now, message)), fsw::Status::kOk);
      EXPECT_EQ(gnc->step(now), fsw::Status::kOk);
    };
    for (int step = 0; step < kArrivalSteps; ++step) {
      for (const std::size_t k : order) {
        if (steps[k] == step) static_cast<void>(gnc->receive(telecommands_[k]));
      }
      run(start_ - periods(kArrivalSteps - step));
    }
    telemetry_health health{};
    EXPECT_NE(last_of(sent, health), nullptr);
    EXPECT_EQ(health.packets_accepted, kArrivalSteps + static_cast<int>(telecommands_.size()));
    EXPECT_EQ(health.rejected_content, 0);
    sent.clear();
    for (std::size_t k = 0; k < arrived_.size(); ++k) {
      for (const twins::Packet& packet : arrived_[k]) static_cast<void>(gnc->receive(packet));
      run(coast_.epochs()[k].time);
    }
    return without_counts(sent);
  }

  CoastingPair coast_{300};
  fsw::GpsTime start_;
  std::vector<Packets> arrived_;
  Packets telecommands_;
};

TEST_P(TelecommandOrder, HasNoEffect) {
  std::vector<std::size_t> order(telecommands_.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::vector<int> steps(telecommands_.size(), 0);
  const Packets reference = fly(steps, order);
  telemetry_navigation navigation{};
  ASSERT_NE(last_of(reference, navigation), nullptr);
  EXPECT_NE(navigation.source, telemetry_navigation::kSourceIdealNavigation);
  // By the receivers of both, or by the ROE of preceding navigation; an absolute orbit suffices to point only.
  EXPECT_EQ(navigation.valid, GetParam() == kBearings ? 0 : 1);
  pointing_command pointing{};
  EXPECT_EQ(last_of(reference, pointing) != nullptr, GetParam() != kCarrier);

  std::mt19937_64 random(7);
  for (int k = 0; k < kOrders; ++k) {
    std::shuffle(order.begin(), order.end(), random);
    for (int& step : steps) step = static_cast<int>(random() % kArrivalSteps);
    EXPECT_TRUE(fly(steps, order) == reference) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Sources, TelecommandOrder, ::testing::Values(kCarrier, kBearings, kKeypoints));

}  // namespace
}  // namespace vbar::test
