#pragma once
// Addresses of the bootstrap registers (GigE Vision 1.2) and the limits of their values.

#include <cstdint>

namespace vbar::gige::bootstrap {

inline constexpr std::uint32_t kVersion = 0x000;
inline constexpr std::uint32_t kDeviceMode = 0x004;
inline constexpr std::uint32_t kMacHigh = 0x008;
inline constexpr std::uint32_t kMacLow = 0x00C;
inline constexpr std::uint32_t kIpCapability = 0x010;
inline constexpr std::uint32_t kIpConfiguration = 0x014;
inline constexpr std::uint32_t kIpAddress = 0x024;
inline constexpr std::uint32_t kIpMask = 0x034;
inline constexpr std::uint32_t kManufacturer = 0x048;
inline constexpr std::uint32_t kModel = 0x068;
inline constexpr std::uint32_t kVersionText = 0x088;
inline constexpr std::uint32_t kManufacturerInfo = 0x0A8;
inline constexpr std::uint32_t kSerial = 0x0D8;
inline constexpr std::uint32_t kUserName = 0x0E8;
inline constexpr std::uint32_t kDiscoveryBytes = 0x0F8;  ///< the acknowledge of a discovery is the registers below this
inline constexpr std::uint32_t kXmlUrl = 0x200;
inline constexpr std::uint32_t kInterfaces = 0x600;
inline constexpr std::uint32_t kStreamChannels = 0x904;
inline constexpr std::uint32_t kCapability = 0x934;
inline constexpr std::uint32_t kHeartbeatMs = 0x938;
inline constexpr std::uint32_t kTickFrequencyHigh = 0x93C;
inline constexpr std::uint32_t kTickFrequencyLow = 0x940;
inline constexpr std::uint32_t kControlPrivilege = 0xA00;
inline constexpr std::uint32_t kStreamPort = 0xD00;
inline constexpr std::uint32_t kPacketSize = 0xD04;
inline constexpr std::uint32_t kPacketDelay = 0xD08;  ///< ticks
inline constexpr std::uint32_t kStreamDestination = 0xD18;

inline constexpr std::uint32_t kExclusiveAccess = 1, kControlAccess = 2;
inline constexpr std::uint32_t kFireTestPacket = 0x80000000, kDoNotFragment = 0x40000000;
inline constexpr std::uint32_t kMinPacketSize = 576, kMaxPacketSize = 9000;
inline constexpr std::uint32_t kTicksPerSecond = 1'000'000'000;

inline constexpr std::uint32_t kXml = 0x20000;  ///< where the description stands

}  // namespace vbar::gige::bootstrap
