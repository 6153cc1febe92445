// The emulated camera over UDP, with commands and packets of the project's own coder: ownership, triggers, resends.

#include "emulators/gige/device.h"

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include <boost/asio/ip/udp.hpp>
#include <gtest/gtest.h>
#include <poll.h>

#include "emulators/gige/features.h"
#include "emulators/gige/registers.h"
#include "tests/unit/emulators/gige/running_device.h"

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

// Register memory: bootstrap registers at the addresses of GigE Vision 1.2, limits of the features.

namespace {

constexpr std::uint32_t kAddress = 0x7F000D01;  // 127.0.13.1

std::uint32_t address_of(FeatureId id) {
  return features_of({})[static_cast<std::size_t>(id)].address();
}

Status write(Registers& registers, FeatureId id, std::uint32_t value) {
  wire::Bytes bytes;
  wire::append_u32(bytes, value);
  return registers.write(address_of(id), bytes).status;
}

Status write(Registers& registers, FeatureId id, double value) {
  wire::Bytes bytes;
  wire::append_u64(bytes, std::bit_cast<std::uint64_t>(value));
  return registers.write(address_of(id), bytes).status;
}

std::string text_at(const Registers& registers, std::uint32_t address, std::size_t size) {
  const auto bytes = registers.read(address, size).bytes;
  return std::string(bytes.begin(), bytes.end()).c_str();
}

TEST(Registers, TableIsInTheOrderOfItsIdentifiers) {
  const auto features = features_of({});
  for (std::size_t k = 0; k < features.size(); ++k) EXPECT_EQ(static_cast<std::size_t>(features[k].id), k);
}

TEST(Registers, BootstrapRegistersStandAtTheirAddresses) {
  const Registers registers({}, kAddress);
  EXPECT_EQ(registers.word(0x000), 0x00010002U);
  EXPECT_EQ(registers.word(0x004), 0x80000001U);
  EXPECT_EQ(registers.word(0x024), kAddress);
  EXPECT_EQ(text_at(registers, 0x048, 32), "Point Grey Research");
  EXPECT_EQ(text_at(registers, 0x068, 32), "Grasshopper3 GS3-PGE-23S6M");
  EXPECT_EQ(text_at(registers, 0x0A8, 48), "emulated GigE Vision device of vbar");
  EXPECT_EQ(text_at(registers, 0x200, 512).substr(0, 28), "Local:vbar_camera.xml;20000;");
  EXPECT_EQ(registers.word(0x904), 1U);
  EXPECT_EQ(registers.word(0x934) & 0x6U, 0x6U);
  EXPECT_EQ(registers.word(0x940), 1'000'000'000U);
}

TEST(Registers, LimitsHold) {
  using enum FeatureId;
  Registers registers({}, kAddress);
  EXPECT_EQ(write(registers, kWidth, 500U), Status::kSuccess);
  EXPECT_EQ(registers.integer(kOffsetXMax), 1420U);
  EXPECT_EQ(registers.integer(kPayloadSize), 500U * 1200U);
  EXPECT_EQ(write(registers, kOffsetX, 1422U), Status::kInvalidParameter);
  EXPECT_EQ(write(registers, kOffsetX, 711U), Status::kInvalidParameter);
  EXPECT_EQ(write(registers, kOffsetX, 710U), Status::kSuccess);
  EXPECT_EQ(write(registers, kWidth, 1212U), Status::kInvalidParameter);
  EXPECT_EQ(write(registers, kWidth, 4'000'000'000U), Status::kInvalidParameter);
  EXPECT_EQ(write(registers, kPixelFormat, 0x01100007U), Status::kSuccess);
  EXPECT_EQ(registers.integer(kPayloadSize), 500U * 1200U * 2U);
  EXPECT_EQ(write(registers, kPixelFormat, 0x01100005U), Status::kInvalidParameter);
  EXPECT_EQ(write(registers, kSensorWidth, 1000U), Status::kWriteProtect);
  EXPECT_EQ(registers.integer(kWidth), 500U);
}

TEST(Registers, AutomaticFunctionsLockTheirValues) {
  using enum FeatureId;
  Registers registers({}, kAddress);
  EXPECT_EQ(write(registers, kExposureTime, 200000.0), Status::kWriteProtect);
  EXPECT_EQ(write(registers, kExposureAuto, 0U), Status::kSuccess);
  EXPECT_EQ(write(registers, kExposureTime, 200000.0), Status::kSuccess);
  EXPECT_EQ(registers.value(kExposureTime), 200000.0);
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity(), -1.0, 0.0})
    EXPECT_EQ(write(registers, kExposureTime, wrong), Status::kInvalidParameter) << wrong;
  EXPECT_EQ(registers.value(kExposureTime), 200000.0);
}

TEST(Registers, AcquisitionLocksTheImage) {
  using enum FeatureId;
  Registers registers({}, kAddress);
  registers.lock_for_acquisition(true);
  EXPECT_EQ(write(registers, kWidth, 500U), Status::kWriteProtect);
  EXPECT_EQ(write(registers, kPixelFormat, 0x01100007U), Status::kWriteProtect);
  registers.lock_for_acquisition(false);
  EXPECT_EQ(write(registers, kWidth, 500U), Status::kSuccess);
}

TEST(Registers, AddressesOutsideAreRefused) {
  Registers registers({}, kAddress);
  EXPECT_EQ(registers.read(0xFFFFFFFC, 4).status, Status::kInvalidAddress);
  EXPECT_EQ(registers.read(0x100000, 4).status, Status::kInvalidAddress);
  EXPECT_EQ(registers.write(0xFFFFFFFC, wire::Bytes(4)).status, Status::kInvalidAddress);
  EXPECT_EQ(registers.write(0x000, wire::Bytes(4)).status, Status::kWriteProtect);
  EXPECT_EQ(registers.write(address_of(FeatureId::kExposureTime), wire::Bytes(4)).status, Status::kBadAlignment);
}

TEST(Registers, PacketSizeHasLimits) {
  Registers registers({}, kAddress);
  const auto set = [&registers](std::uint32_t value) {
    wire::Bytes bytes;
    wire::append_u32(bytes, value);
    return registers.write(bootstrap::kPacketSize, bytes).status;
  };
  EXPECT_EQ(set(0xC0000000 | 1400), Status::kSuccess);
  EXPECT_EQ(registers.word(bootstrap::kPacketSize), 0x40000000U | 1400U);  // the command to fire is not kept
  for (const std::uint32_t wrong : {0U, 36U, 1401U, 9004U, 65535U}) EXPECT_EQ(set(wrong), Status::kInvalidParameter);
}

TEST(Registers, ImpossibleDescriptionsAreRefused) {
  for (const auto change :
       {+[](Description& d) { d.sensor_width = 0; }, +[](Description& d) { d.sensor_height = 70000; },
        +[](Description& d) { d.converter_bits = 17; },
        +[](Description& d) { d.serial = "more than 15 characters"; }}) {
    Description description;
    change(description);
    EXPECT_THROW(Registers(description, kAddress), std::invalid_argument);
  }
}

}  // namespace

}  // namespace vbar::gige
