#pragma once
// Register memory of the emulated camera: bootstrap registers, features and the GenICam description. Writes from
// the network are checked here; their effects are the device's.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "emulators/gige/features.h"
#include "hil_drivers/gige/protocol/gvcp.h"

namespace vbar::gige::bootstrap {

// Addresses of the bootstrap registers (GigE Vision 1.2) and the limits of their values.

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
inline constexpr std::uint32_t kTimestampControl = 0x944;
inline constexpr std::uint32_t kTimestampHigh = 0x948;  ///< as latched last
inline constexpr std::uint32_t kTimestampLow = 0x94C;
inline constexpr std::uint32_t kControlPrivilege = 0xA00;
inline constexpr std::uint32_t kStreamPort = 0xD00;
inline constexpr std::uint32_t kPacketSize = 0xD04;
inline constexpr std::uint32_t kPacketDelay = 0xD08;  ///< ticks
inline constexpr std::uint32_t kStreamDestination = 0xD18;

inline constexpr std::uint32_t kExclusiveAccess = 1, kControlAccess = 2;
inline constexpr std::uint32_t kLatchTimestamp = 2;
inline constexpr std::uint32_t kFireTestPacket = 0x80000000, kDoNotFragment = 0x40000000;
inline constexpr std::uint32_t kMinPacketSize = 576, kMaxPacketSize = 9000;
inline constexpr std::uint32_t kTicksPerSecond = 1'000'000'000;

inline constexpr std::uint32_t kXml = 0x20000;  ///< where the description stands

}  // namespace vbar::gige::bootstrap

namespace vbar::gige {

class Registers {
 public:
  /// Throws std::invalid_argument if the description does not fit: text too long, a sensor without pixels, bits out of
  /// range. `ip_address` as a number.
  Registers(const Description& description, std::uint32_t ip_address);

  // Access by address, from the network.
  struct Read {
    wire::Status status = wire::Status::kSuccess;
    wire::Bytes bytes;
  };
  [[nodiscard]] Read read(std::uint32_t address, std::size_t count) const;
  struct Written {
    wire::Status status = wire::Status::kSuccess;
    std::optional<FeatureId> feature;  ///< empty for a bootstrap register
  };
  Written write(std::uint32_t address, wire::ByteSpan bytes);

  // Access by the device.
  [[nodiscard]] std::uint32_t word(std::uint32_t address) const;
  void set_word(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] double value(FeatureId id) const;
  [[nodiscard]] std::uint32_t integer(FeatureId id) const;

  void lock_for_acquisition(bool locked) { is_acquiring_ = locked; }
  void refuse_region(bool refused) { region_is_refused_ = refused; }
  /// Overwrites a part of the GenICam description, or restores it.
  void damage_xml(bool damaged);

 private:
  void put_text(std::uint32_t address, std::size_t size, const std::string& text, const char* what);
  void put_bootstrap(const Description& description, std::uint32_t ip_address);
  void put(const Feature& feature, double value);
  void update_dependent();
  [[nodiscard]] const Feature& feature(FeatureId id) const { return features_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] const Feature* feature_at(std::uint32_t address) const;
  [[nodiscard]] wire::Status check(const Feature& feature, double value) const;
  Written write_feature(const Feature& feature, wire::ByteSpan bytes);
  wire::Status write_bootstrap(std::uint32_t address, std::uint32_t value);

  std::vector<Feature> features_;
  std::string xml_;
  wire::Bytes memory_;
  bool is_acquiring_ = false;
  bool region_is_refused_ = false;
};

}  // namespace vbar::gige
