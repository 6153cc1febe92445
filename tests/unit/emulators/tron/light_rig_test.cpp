// Lamp and boxes: response, arc, faults.

#include <cmath>
#include <numbers>
#include <optional>

#include <boost/asio/ip/udp.hpp>
#include <gtest/gtest.h>

#include "emulators/tron/lights.h"
#include "hil_drivers/tron/protocols/sacn.h"

namespace vbar::tron::bench {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Lamp lamp() {
  Lamp lamp;
  lamp.azimuth_low_rad = 45.0 * kDegree;
  lamp.azimuth_high_rad = 135.0 * kDegree;
  lamp.speed_rad_s = 10.0 * kDegree;
  return lamp;
}

LightValues values(std::uint16_t power, std::uint16_t place, std::uint16_t box = 0) {
  LightValues values;
  values.fill(box);
  values[0] = power;
  values[1] = place;
  return values;
}

TEST(LightRig, WithoutErrorsGivesLightInProportion) {
  LightRig rig(lamp(), LightErrorSizes::none(), 1);
  rig.command(values(65535, 0, 13107));
  EXPECT_DOUBLE_EQ(rig.lights().lamp_power, 1.0);
  for (const double power : rig.lights().box_power) EXPECT_NEAR(power, 0.2, 1e-12);
  rig.switch_off();
  EXPECT_EQ(rig.lights().lamp_power, 0.0);
  EXPECT_EQ(rig.lights().box_power[9], 0.0);
}

// From the middle, 90 deg, at 10 deg/s: 2 s to 110 deg, which 16 bits resolve to 0.0014 deg.
TEST(LightRig, TheLampTravelsAlongItsArc) {
  LightRig rig(lamp(), {}, 1);
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 90.0 * kDegree, 1e-12);
  rig.advance(5.0);
  rig.command(values(0, static_cast<std::uint16_t>(std::lround(65535.0 * (110.0 - 45.0) / 90.0))));
  rig.advance(6.0);
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 100.0 * kDegree, 1e-9);
  rig.advance(6.0);
  rig.advance(5.5);  // time does not run backwards
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 100.0 * kDegree, 1e-9);
  rig.advance(7.1);
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 110.0 * kDegree, 0.0007 * kDegree);
  rig.command(values(0, 0));
  rig.advance(8.0);
  rig.switch_off();  // the lamp stays where it is
  const double here = rig.lights().lamp_azimuth_rad;
  rig.advance(20.0);
  EXPECT_EQ(rig.lights().lamp_azimuth_rad, here);
}

// A power law: the logarithm of light is linear in that of the value, with the gain at the full value.
TEST(LightRig, SourcesHaveTheirOwnGammaAndGain) {
  double gamma = 0, gamma2 = 0, gain = 0, gain2 = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    LightRig rig(lamp(), {}, seed);
    rig.command(values(65535, 0, 65535));
    const TrueLights full = rig.lights();
    rig.command(values(6554, 0, 6554));
    const TrueLights tenth = rig.lights();
    const auto add = [&](double light, double light_of_tenth) {
      const double g = std::log(light_of_tenth / light) / std::log(6554.0 / 65535.0);
      gamma += g;
      gamma2 += g * g;
      gain += light;
      gain2 += light * light;
      ++count;
    };
    add(full.lamp_power, tenth.lamp_power);
    for (std::size_t k = 0; k < kBoxes; ++k) add(full.box_power[k], tenth.box_power[k]);
  }
  // Of 550 sources: the mean to 1/23 of a deviation, the deviation to 3 %.
  gamma /= count;
  gain /= count;
  EXPECT_NEAR(gamma, 2.2, 0.03);
  EXPECT_NEAR(std::sqrt(gamma2 / count - gamma * gamma), 0.15, 0.02);
  EXPECT_NEAR(gain, 1.0, 0.006);
  EXPECT_NEAR(std::sqrt(gain2 / count - gain * gain), 0.03, 0.004);
}

TEST(LightRig, FaultsHoldUntilTheyAreTakenBack) {
  LightRig rig(lamp(), {}, 1);
  rig.command(values(65535, 0, 65535));
  const TrueLights all = rig.lights();
  rig.set_box_out(3, true);
  rig.set_lamp_out(true);
  EXPECT_EQ(rig.lights().lamp_power, 0.0);
  EXPECT_EQ(rig.lights().box_power[3], 0.0);
  EXPECT_EQ(rig.lights().box_power[4], all.box_power[4]);
  rig.set_box_out(3, false);
  rig.set_lamp_out(false);
  EXPECT_EQ(rig.lights().lamp_power, all.lamp_power);
  EXPECT_EQ(rig.lights().box_power, all.box_power);
  EXPECT_ANY_THROW(rig.set_box_out(10, true));
}

TEST(LightRig, IsAFunctionOfTheSeed) {
  LightRig one(lamp(), {}, 8), same(lamp(), {}, 8), other(lamp(), {}, 9);
  for (LightRig* rig : {&one, &same, &other}) rig->command(values(30000, 0, 30000));
  EXPECT_EQ(one.lights().box_power, same.lights().box_power);
  EXPECT_NE(one.lights().box_power, other.lights().box_power);
}

}  // namespace

// The emulated lights under the driver's source, over a socket.

namespace {

class LightReceiverTest : public ::testing::Test {
 protected:
  LightReceiverTest() {
    settings_.address = "127.0.0.1";
    settings_.universe = 3;
    settings_.start_slot = 101;
    receiver_.emplace(context_, settings_, std::uint16_t{0}, rig_);
    settings_.port = receiver_->port();
  }
  static Lamp lamp() {
    Lamp lamp;
    lamp.azimuth_low_rad = 1.0;
    lamp.azimuth_high_rad = 2.0;
    lamp.speed_rad_s = 0.2;
    return lamp;
  }
  void cycle() { receiver_->begin_cycle(bench_s_ += 0.004); }
  /// A datagram on the loopback interface is there when the call that sent it returns.
  void cycles_for(double seconds) {
    for (const double end = bench_s_ + seconds; bench_s_ < end;) cycle();
  }

  boost::asio::io_context context_;
  SacnSettings settings_;
  LightRig rig_{lamp(), LightErrorSizes::none(), 1};
  std::optional<LightReceiver> receiver_;
  double bench_s_ = 0.0;
};

TEST_F(LightReceiverTest, APacketActsInTheNextCycle) {
  sacn::Sender sender(settings_, "tron");
  LightValues values;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<std::uint16_t>(5000 * k + 77);
  sender.send(values);
  cycle();
  EXPECT_NEAR(rig_.lights().lamp_power, 77 / 65535.0, 1e-12);
  for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(rig_.lights().box_power[k], values[2 + k] / 65535.0, 1e-12);
  cycles_for(2.0);
  sender.keep_alive();
  cycles_for(2.0);
  EXPECT_NEAR(rig_.lights().lamp_azimuth_rad, 1.0 + 5077 / 65535.0, 1e-9);
  EXPECT_EQ(receiver_->counts().accepted, 2U);
}

TEST_F(LightReceiverTest, TheEndOfTheSourceSwitchesTheLightsOff) {
  {
    sacn::Sender sender(settings_, "tron");
    sender.send(std::array<std::uint16_t, 1>{65535});
    cycle();
    EXPECT_EQ(rig_.lights().lamp_power, 1.0);
  }
  cycle();
  EXPECT_EQ(rig_.lights().lamp_power, 0.0);
  EXPECT_EQ(receiver_->counts().terminations, 1U);
}

TEST_F(LightReceiverTest, SilenceSwitchesTheLightsOffInBenchTime) {
  sacn::Sender sender(settings_, "tron");
  sender.send(std::array<std::uint16_t, 1>{65535});
  cycle();
  cycles_for(2.4);
  EXPECT_EQ(rig_.lights().lamp_power, 1.0);
  cycles_for(0.2);
  EXPECT_EQ(rig_.lights().lamp_power, 0.0);
  EXPECT_EQ(receiver_->counts().losses, 1U);
}

TEST_F(LightReceiverTest, HostileDatagramsAreCounted) {
  boost::asio::ip::udp::socket socket(context_, boost::asio::ip::udp::v4());
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{638}, std::size_t{60000}})
    socket.send_to(boost::asio::buffer(std::vector<std::uint8_t>(size, 0x41)),
                   {boost::asio::ip::address_v4::loopback(), receiver_->port()});
  cycle();
  EXPECT_EQ(receiver_->counts().unreadable, 4U);
  EXPECT_EQ(rig_.lights().lamp_power, 0.0);
}

TEST_F(LightReceiverTest, StatesItsAddress) {
  EXPECT_EQ(receiver_->address(), "127.0.0.1:" + std::to_string(receiver_->port()));
  EXPECT_THROW(LightReceiver(context_, settings_, receiver_->port(), rig_), std::runtime_error);
}

}  // namespace

// Rules of E1.31-2018 for several sources.

namespace {

sacn::DataPacket packet(std::uint8_t source, std::uint8_t sequence, std::uint8_t level, std::uint8_t priority = 100) {
  sacn::DataPacket packet;
  packet.cid[0] = source;
  packet.sequence = sequence;
  packet.priority = priority;
  packet.slots = {level};
  return packet;
}

int level(const SourceArbiter& arbiter) {
  return arbiter.is_controlled() ? arbiter.slots()[0] : -1;
}

TEST(SourceArbiter, HighestPriorityControlsAndIsFollowedByTheNext) {
  SourceArbiter arbiter(1);
  EXPECT_EQ(level(arbiter), -1);
  arbiter.accept(packet(1, 0, 10), 0.0);
  EXPECT_EQ(level(arbiter), 10);
  arbiter.accept(packet(2, 0, 20, 101), 0.1);
  EXPECT_EQ(level(arbiter), 20);
  arbiter.accept(packet(1, 1, 11), 0.2);
  EXPECT_EQ(level(arbiter), 20);
  auto end = packet(2, 1, 0, 101);
  end.is_terminated = true;
  for (int k = 0; k < 3; ++k, ++end.sequence) arbiter.accept(end, 0.3);
  EXPECT_EQ(level(arbiter), 11);
  EXPECT_EQ(arbiter.counts().terminations, 1U);
}

TEST(SourceArbiter, OfEqualPrioritiesTheFirstControls) {
  SourceArbiter arbiter(1);
  arbiter.accept(packet(9, 0, 10), 0.0);
  arbiter.accept(packet(2, 0, 20), 0.0);
  EXPECT_EQ(level(arbiter), 10);
}

// E1.31 6.7.2: discarded if the difference of the sequence numbers is in (-20, 0].
TEST(SourceArbiter, DiscardsPacketsOutOfSequence) {
  SourceArbiter arbiter(1);
  arbiter.accept(packet(1, 5, 50), 0.0);
  for (const int behind : {0, 1, 6, 19}) {
    arbiter.accept(packet(1, static_cast<std::uint8_t>(5 - behind), 1), 0.0);
    EXPECT_EQ(level(arbiter), 50) << behind;
  }
  EXPECT_EQ(arbiter.counts().out_of_sequence, 4U);
  arbiter.accept(packet(1, static_cast<std::uint8_t>(5 - 20), 51), 0.0);  // the source was started again
  EXPECT_EQ(level(arbiter), 51);
  arbiter.accept(packet(1, 255, 52), 0.0);
  arbiter.accept(packet(1, 0, 53), 0.0);
  EXPECT_EQ(level(arbiter), 53);
}

// E1.31 6.7.1: 2.5 s.
TEST(SourceArbiter, ForgetsASourceThatIsSilent) {
  SourceArbiter arbiter(1);
  arbiter.accept(packet(1, 0, 10), 1.0);
  arbiter.advance(3.5);
  EXPECT_EQ(level(arbiter), 10);
  arbiter.advance(3.504);
  EXPECT_EQ(level(arbiter), -1);
  EXPECT_EQ(arbiter.counts().losses, 1U);
  arbiter.accept(packet(1, 0, 12), 4.0);  // its sequence begins again
  EXPECT_EQ(level(arbiter), 12);
}

TEST(SourceArbiter, CountsWhatIsNotForTheLights) {
  SourceArbiter arbiter(1);
  auto other = packet(1, 0, 10);
  other.universe = 2;
  arbiter.accept(other, 0.0);
  other.universe = 1;
  other.is_preview = true;
  arbiter.accept(other, 0.0);
  other.is_preview = false;
  other.start_code = 0xDD;  // priority of each slot, of a manufacturer
  arbiter.accept(other, 0.0);
  EXPECT_FALSE(arbiter.is_controlled());
  EXPECT_EQ(arbiter.counts().of_other_universes, 1U);
  EXPECT_EQ(arbiter.counts().previews, 1U);
  EXPECT_EQ(arbiter.counts().of_other_start_codes, 1U);
}

TEST(SourceArbiter, HasRoomForALimitedNumberOfSources) {
  SourceArbiter arbiter(1);
  for (int source = 0; source < 200; ++source) arbiter.accept(packet(static_cast<std::uint8_t>(source), 0, 1), 0.0);
  EXPECT_EQ(arbiter.counts().accepted, SourceArbiter::kMaxSources);
  EXPECT_EQ(arbiter.counts().refused_sources, 200U - SourceArbiter::kMaxSources);
}

}  // namespace

}  // namespace vbar::tron::bench
