// The emulated lights under the driver's source, over a socket.

#include "hil_drivers/tron/bench/lights/light_receiver.h"

#include <optional>

#include <boost/asio/ip/udp.hpp>
#include <gtest/gtest.h>

#include "hil_drivers/tron/sacn/sender.h"

namespace vbar::tron::bench {
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
}  // namespace vbar::tron::bench
