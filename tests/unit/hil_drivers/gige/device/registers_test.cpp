// Register memory: bootstrap registers at the addresses of GigE Vision 1.2, limits of the features.

#include "hil_drivers/gige/device/registers.h"

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "hil_drivers/gige/device/register_map.h"

namespace vbar::gige {
namespace {

using wire::Status;

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
