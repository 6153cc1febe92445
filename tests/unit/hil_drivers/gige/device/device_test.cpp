// The emulated camera over UDP, with commands and packets of the project's own coder: ownership, triggers, resends.

#include "hil_drivers/gige/device/device.h"

#include <bit>
#include <map>
#include <optional>

#include <boost/asio/ip/udp.hpp>
#include <gtest/gtest.h>
#include <poll.h>

#include "hil_drivers/gige/device/features.h"
#include "hil_drivers/gige/device/register_map.h"
#include "tests/unit/hil_drivers/gige/running_device.h"

namespace vbar::gige {
namespace {

using boost::asio::ip::udp;
using test::RunningDevice;
using wire::Status;

/// A host with a control socket and a stream socket.
class Host {
 public:
  explicit Host(const RunningDevice& device)
      : address_(boost::asio::ip::make_address_v4(device.address())), control_(context_), stream_(context_) {
    for (udp::socket* socket : {&control_, &stream_}) {
      socket->open(udp::v4());
      socket->bind(udp::endpoint(address_, 0));
    }
    control_.connect(udp::endpoint(address_, wire::kGvcpPort));
  }

  void send(wire::CommandBody body, std::uint16_t id) {
    control_.send(boost::asio::buffer(wire::encode_command({true, id, std::move(body)})));
  }
  wire::Acknowledge ask(wire::CommandBody body) {
    send(std::move(body), ++id_);
    const auto datagram = receive(control_);
    if (!datagram) throw std::runtime_error("no acknowledge");
    const auto acknowledge = wire::decode_acknowledge(*datagram);
    EXPECT_EQ(acknowledge.id, id_);
    return acknowledge;
  }
  Status write(std::uint32_t address, std::uint32_t value) {
    return ask(wire::WriteRegisters{{{address, value}}}).status;
  }
  Status write(FeatureId id, std::uint32_t value) {
    return write(features_of({})[static_cast<std::size_t>(id)].address(), value);
  }
  std::optional<wire::Bytes> packet(int limit_ms = 20'000) { return receive(stream_, limit_ms); }

  /// Takes control, and a triggered stream of 64 x 32 pixels.
  void start() {
    using enum FeatureId;
    for (const auto& [address, value] :
         std::vector<std::pair<std::uint32_t, std::uint32_t>>{{bootstrap::kControlPrivilege, bootstrap::kControlAccess},
                                                              {bootstrap::kStreamDestination, address_.to_uint()},
                                                              {bootstrap::kStreamPort, stream_.local_endpoint().port()},
                                                              {bootstrap::kPacketSize, 1436}})
      ASSERT_EQ(write(address, value), Status::kSuccess) << address;
    for (const auto& [id, value] : std::vector<std::pair<FeatureId, std::uint32_t>>{{kWidth, 64},
                                                                                    {kHeight, 32},
                                                                                    {kPixelFormat, 0x01100007},
                                                                                    {kTriggerSource, 7},
                                                                                    {kTriggerMode, 1},
                                                                                    {kAcquisitionStart, 1}})
      ASSERT_EQ(write(id, value), Status::kSuccess) << static_cast<std::size_t>(id);
  }

 private:
  static std::optional<wire::Bytes> receive(udp::socket& socket, int limit_ms = 20'000) {
    pollfd ready{socket.native_handle(), POLLIN, 0};
    if (::poll(&ready, 1, limit_ms) <= 0) return std::nullopt;
    wire::Bytes datagram(9000);
    datagram.resize(socket.receive(boost::asio::buffer(datagram)));
    return datagram;
  }

  boost::asio::io_context context_;
  boost::asio::ip::address_v4 address_;
  udp::socket control_, stream_;
  std::uint16_t id_ = 0;
};

TEST(GigeDevice, DiscoveryAnswersWithTheFirstRegisters) {
  RunningDevice device;
  const auto acknowledge = Host(device).ask(wire::Discovery{});
  EXPECT_EQ(acknowledge.command, 0x02);
  EXPECT_EQ(acknowledge.body.size(), 248U);
}

TEST(GigeDevice, OneOwnerAtATime) {
  RunningDevice device;
  Host first(device), second(device);
  EXPECT_EQ(first.write(FeatureId::kWidth, 500), Status::kAccessDenied);
  EXPECT_EQ(first.write(bootstrap::kControlPrivilege, bootstrap::kControlAccess), Status::kSuccess);
  EXPECT_EQ(second.write(bootstrap::kControlPrivilege, bootstrap::kControlAccess), Status::kAccessDenied);
  EXPECT_EQ(second.write(FeatureId::kWidth, 500), Status::kAccessDenied);
  EXPECT_EQ(second.ask(wire::ReadMemory{0x48, 32}).status, Status::kSuccess);
  EXPECT_EQ(first.write(bootstrap::kControlPrivilege, 0), Status::kSuccess);
  EXPECT_EQ(second.write(bootstrap::kControlPrivilege, bootstrap::kExclusiveAccess), Status::kSuccess);
  EXPECT_EQ(first.ask(wire::ReadMemory{0x48, 32}).status, Status::kAccessDenied);
  // Who owns it can be asked by all.
  const auto owner = first.ask(wire::ReadRegisters{{bootstrap::kControlPrivilege}});
  EXPECT_EQ(owner.status, Status::kSuccess);
  EXPECT_EQ(wire::load_u32(owner.body, 0), bootstrap::kExclusiveAccess);
}

TEST(GigeDevice, ImageComesInPackets) {
  RunningDevice device;
  Host host(device);
  host.start();
  ASSERT_EQ(host.write(FeatureId::kTriggerSoftware, 1), Status::kSuccess);
  // 4096 bytes in packets of 1400: leader, three of data, trailer.
  wire::Bytes payload;
  for (std::uint32_t number = 0; number < 5; ++number) {
    const auto datagram = host.packet();
    ASSERT_TRUE(datagram);
    const auto packet = wire::decode_stream_packet(*datagram);
    EXPECT_EQ(packet.header.packet, number);
    EXPECT_EQ(packet.header.block, 1);
    if (const auto* data = std::get_if<wire::Data>(&packet.body))
      payload.insert(payload.end(), data->bytes.begin(), data->bytes.end());
  }
  const auto picture = test::numbered_picture({{0, 0, 64, 32}, 0.0, 0.0, 0.0, 0});
  EXPECT_EQ(payload, wire::pack_pixels(wire::PixelFormat::kMono16, 12, picture.dn));
}

TEST(GigeDevice, PacketsAreSentAgainWithTheirStatus) {
  RunningDevice device;
  Host host(device);
  host.start();
  ASSERT_EQ(host.write(FeatureId::kTriggerSoftware, 1), Status::kSuccess);
  std::map<std::uint32_t, wire::Bytes> sent;
  for (int k = 0; k < 5; ++k) {
    const auto datagram = host.packet();
    ASSERT_TRUE(datagram);
    sent[wire::decode_stream_packet(*datagram).header.packet] = *datagram;
  }
  host.send(wire::PacketResend{0, 1, 2, 0xFFFFFF}, 1000);
  for (const std::uint32_t number : {2U, 3U, 4U}) {
    auto datagram = host.packet();
    ASSERT_TRUE(datagram);
    EXPECT_EQ(wire::load_u16(*datagram, 0), 0x0100);  // as Point Grey's cameras
    (*datagram)[0] = 0;
    EXPECT_EQ(*datagram, sent[number]);
  }
  host.send(wire::PacketResend{0, 99, 2, 3}, 1001);
  const auto unavailable = host.packet();
  ASSERT_TRUE(unavailable);
  EXPECT_EQ(wire::decode_stream_packet(*unavailable).header.status, Status::kPacketUnavailable);
  EXPECT_EQ(device.statistics().stream.packets_resent, 3);
}

TEST(GigeDevice, TriggerDuringAnExposureIsDropped) {
  Device::Settings settings;
  settings.pace = Pace::kReal;
  RunningDevice device(settings);
  Host host(device);
  host.start();
  using enum FeatureId;
  ASSERT_EQ(host.write(kExposureAuto, 0), Status::kSuccess);
  wire::Bytes ten_seconds;
  wire::append_u64(ten_seconds, std::bit_cast<std::uint64_t>(1e7));
  const auto address = features_of({})[static_cast<std::size_t>(kExposureTime)].address();
  ASSERT_EQ(host.ask(wire::WriteMemory{address, ten_seconds}).status, Status::kSuccess);
  for (int k = 0; k < 3; ++k) ASSERT_EQ(host.write(kTriggerSoftware, 1), Status::kSuccess);
  const auto statistics = device.statistics().acquisition;
  EXPECT_EQ(statistics.triggers, 3);
  EXPECT_EQ(statistics.triggers_dropped, 2);
  EXPECT_EQ(statistics.exposures, 1);
}

TEST(GigeDevice, RepeatedCommandIsAnsweredAndNotExecuted) {
  RunningDevice device;
  Host host(device);
  host.start();
  const auto address = features_of({})[static_cast<std::size_t>(FeatureId::kTriggerSoftware)].address();
  for (int k = 0; k < 3; ++k) host.send(wire::WriteRegisters{{{address, 1}}}, 500);
  EXPECT_EQ(device.statistics().acquisition.triggers <= 1, true);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(host.packet());
  EXPECT_EQ(device.statistics().acquisition.triggers, 1);
}

TEST(GigeDevice, TestPacketHasTheSizeAskedFor) {
  RunningDevice device;
  Host host(device);
  host.start();
  ASSERT_EQ(host.write(FeatureId::kAcquisitionStop, 1), Status::kSuccess);
  ASSERT_EQ(host.write(bootstrap::kPacketSize, 0xC0000000U | 1500U), Status::kSuccess);
  const auto packet = host.packet();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->size(), 1500U - 28U);  // without the headers of IP and UDP
}

TEST(GigeDevice, PortInUseIsNamed) {
  RunningDevice device;
  boost::asio::io_context context;
  Device::Settings settings;
  settings.address = device.address();
  try {
    const Device second(context, settings, nullptr);
    FAIL() << "two devices on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 17), "UDP port 3956 of ");
  }
}

}  // namespace
}  // namespace vbar::gige
