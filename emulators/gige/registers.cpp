#include "emulators/gige/registers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "emulators/gige/features.h"
#include "hil_drivers/gige/protocol/gvsp.h"

namespace vbar::gige {
namespace {

using wire::ByteSpan;
using wire::Status;

constexpr std::uint32_t kDefaultPacketSize = 1400;
constexpr std::uint32_t kDefaultHeartbeatMs = 3000;
constexpr std::uint32_t kMinHeartbeatMs = 500;
constexpr std::size_t kUserNameBytes = 16;
constexpr int kMaxSide = 65534;

bool is_region(FeatureId id) {
  using enum FeatureId;
  return id == kWidth || id == kHeight || id == kOffsetX || id == kOffsetY;
}

}  // namespace

Registers::Registers(const Description& description, std::uint32_t ip_address)
    : features_(features_of(description)), xml_(genicam_xml(description, features_)) {
  if (description.sensor_width < 16 || description.sensor_height < 16 || description.sensor_width > kMaxSide ||
      description.sensor_height > kMaxSide || description.sensor_width % 2 != 0 || description.sensor_height % 2 != 0)
    throw std::invalid_argument(fmt::format("a sensor of {} x {} pixels; accepted: even numbers, 16 to {}",
                                            description.sensor_width, description.sensor_height, kMaxSide));
  if (description.converter_bits < 8 || description.converter_bits > 16)
    throw std::invalid_argument(fmt::format("a converter of {} bits; accepted: 8 to 16", description.converter_bits));
  const std::size_t xml_bytes = (xml_.size() + 3) / 4 * 4;
  memory_.resize(bootstrap::kXml + xml_bytes);
  put_bootstrap(description, ip_address);
  for (const Feature& feature : features_) put(feature, feature.initial);
  damage_xml(false);
  update_dependent();
}

void Registers::put_text(std::uint32_t address, std::size_t size, const std::string& text, const char* what) {
  if (text.size() >= size)
    throw std::invalid_argument(
        fmt::format("{} \"{}\" has {} characters; at most {}", what, text, text.size(), size - 1));
  std::copy(text.begin(), text.end(), memory_.begin() + address);
}

void Registers::put_bootstrap(const Description& description, std::uint32_t ip_address) {
  using namespace bootstrap;
  set_word(kVersion, 0x00010002);     // GigE Vision 1.2
  set_word(kDeviceMode, 0x80000001);  // big-endian, UTF-8
  set_word(kMacHigh, 0x00000200);     // locally administered
  set_word(kMacLow, ip_address);
  set_word(kIpCapability, 0x00000005);  // persistent and link-local addresses
  set_word(kIpConfiguration, 0x00000005);
  set_word(kIpAddress, ip_address);
  set_word(kIpMask, 0xFF000000);
  put_text(kManufacturer, 32, description.manufacturer, "manufacturer");
  put_text(kModel, 32, description.model, "model");
  put_text(kVersionText, 32, description.version, "version");
  put_text(kManufacturerInfo, 48, description.manufacturer_info, "manufacturer_info");
  put_text(kSerial, 16, description.serial, "serial");
  put_text(kXmlUrl, 512, fmt::format("Local:vbar_camera.xml;{:x};{:x}", kXml, xml_.size()), "URL");
  set_word(kInterfaces, 1);
  set_word(kStreamChannels, 1);
  set_word(kCapability, 0x7);  // packet resend, write memory, several registers in one command
  set_word(kHeartbeatMs, kDefaultHeartbeatMs);
  set_word(kTickFrequencyLow, kTicksPerSecond);
  set_word(kPacketSize, kDefaultPacketSize);
}

Registers::Read Registers::read(std::uint32_t address, std::size_t count) const {
  if (address > memory_.size() || count > memory_.size() - address) return {Status::kInvalidAddress, {}};
  const auto begin = memory_.begin() + address;
  return {Status::kSuccess, wire::Bytes(begin, begin + static_cast<std::ptrdiff_t>(count))};
}

std::uint32_t Registers::word(std::uint32_t address) const {
  return wire::load_u32(memory_, address);
}

void Registers::set_word(std::uint32_t address, std::uint32_t value) {
  boost::endian::store_big_u32(memory_.data() + address, value);
}

double Registers::value(FeatureId id) const {
  const Feature& found = feature(id);
  if (found.kind != FeatureKind::kFloat) return word(found.address());
  return std::bit_cast<double>(wire::load_u64(memory_, found.address()));
}

std::uint32_t Registers::integer(FeatureId id) const {
  return word(feature(id).address());
}

void Registers::put(const Feature& feature, double value) {
  if (feature.kind == FeatureKind::kFloat)
    boost::endian::store_big_u64(memory_.data() + feature.address(), std::bit_cast<std::uint64_t>(value));
  else
    set_word(feature.address(), static_cast<std::uint32_t>(value));
}

void Registers::update_dependent() {
  using enum FeatureId;
  const auto put_difference = [this](FeatureId id, FeatureId sensor, FeatureId part) {
    set_word(feature(id).address(), integer(sensor) - integer(part));
  };
  put_difference(kWidthMax, kSensorWidth, kOffsetX);
  put_difference(kHeightMax, kSensorHeight, kOffsetY);
  put_difference(kOffsetXMax, kSensorWidth, kWidth);
  put_difference(kOffsetYMax, kSensorHeight, kHeight);
  const auto format = static_cast<wire::PixelFormat>(integer(kPixelFormat));
  const std::size_t pixels = std::size_t{integer(kWidth)} * integer(kHeight);
  set_word(feature(kPayloadSize).address(), static_cast<std::uint32_t>(wire::image_bytes(format, pixels)));
}

const Feature* Registers::feature_at(std::uint32_t address) const {
  const auto found =
      std::ranges::find_if(features_, [address](const Feature& one) { return one.address() == address; });
  return found == features_.end() ? nullptr : &*found;
}

Status Registers::check(const Feature& feature, double value) const {
  using enum FeatureId;
  if (feature.access == FeatureAccess::kReadOnly) return Status::kWriteProtect;
  if (feature.locked_in_acquisition && is_acquiring_) return Status::kWriteProtect;
  if (feature.id == kExposureTime && integer(kExposureAuto) != 0) return Status::kWriteProtect;
  if (feature.id == kGain && integer(kGainAuto) != 0) return Status::kWriteProtect;
  if (region_is_refused_ && is_region(feature.id)) return Status::kInvalidParameter;
  switch (feature.kind) {
    case FeatureKind::kCommand:
      return Status::kSuccess;
    case FeatureKind::kEnumeration:
      return std::ranges::any_of(feature.entries, [value](const auto& entry) { return entry.second == value; })
                 ? Status::kSuccess
                 : Status::kInvalidParameter;
    case FeatureKind::kInteger:
    case FeatureKind::kFloat:
    case FeatureKind::kBoolean:
      break;
  }
  double max = feature.max;
  if (!feature.max_feature.empty()) {
    const auto limit =
        std::ranges::find_if(features_, [&feature](const Feature& one) { return one.name == feature.max_feature; });
    max = this->value(limit->id);
  }
  if (!(value >= feature.min && value <= max)) return Status::kInvalidParameter;  // a NaN, too
  if (feature.kind == FeatureKind::kInteger && std::fmod(value - feature.min, feature.increment) != 0.0)
    return Status::kInvalidParameter;
  return Status::kSuccess;
}

Registers::Written Registers::write_feature(const Feature& feature, ByteSpan bytes) {
  if (bytes.size() != feature.size()) return {Status::kBadAlignment, {}};
  const double value = feature.kind == FeatureKind::kFloat ? std::bit_cast<double>(wire::load_u64(bytes, 0))
                                                           : static_cast<double>(wire::load_u32(bytes, 0));
  const Status status = check(feature, value);
  if (status != Status::kSuccess) return {status, {}};
  if (feature.kind != FeatureKind::kCommand) put(feature, value);
  update_dependent();
  return {Status::kSuccess, feature.id};
}

Status Registers::write_bootstrap(std::uint32_t address, std::uint32_t value) {
  using namespace bootstrap;
  switch (address) {
    case kPacketSize: {
      const std::uint32_t size = value & 0xFFFF;
      if (size < kMinPacketSize || size > kMaxPacketSize || size % 4 != 0) return Status::kInvalidParameter;
      if (is_acquiring_ && size != (word(kPacketSize) & 0xFFFF)) return Status::kWriteProtect;
      set_word(address, value & (kDoNotFragment | 0xFFFF));  // the command to fire reads as zero
      return Status::kSuccess;
    }
    case kStreamPort:
      set_word(address, value & 0xFFFF);
      return Status::kSuccess;
    case kHeartbeatMs:
      set_word(address, std::max(value, kMinHeartbeatMs));
      return Status::kSuccess;
    case kControlPrivilege:
    case kPacketDelay:
    case kStreamDestination:
      set_word(address, value);
      return Status::kSuccess;
    default:
      return address < memory_.size() ? Status::kWriteProtect : Status::kInvalidAddress;
  }
}

Registers::Written Registers::write(std::uint32_t address, ByteSpan bytes) {
  if (const Feature* feature = feature_at(address)) return write_feature(*feature, bytes);
  if (address == bootstrap::kUserName && bytes.size() == kUserNameBytes) {
    std::copy(bytes.begin(), bytes.end(), memory_.begin() + address);
    return {};
  }
  if (bytes.size() != 4) return {Status::kInvalidAddress, {}};
  return {write_bootstrap(address, wire::load_u32(bytes, 0)), {}};
}

void Registers::damage_xml(bool damaged) {
  std::copy(xml_.begin(), xml_.end(), memory_.begin() + bootstrap::kXml);
  if (!damaged) return;
  // A run of zeros, as a sector of flash memory that was lost.
  const auto begin = memory_.begin() + bootstrap::kXml + static_cast<std::ptrdiff_t>(xml_.size() / 3);
  std::fill(begin, begin + 512, std::uint8_t{0});
}

}  // namespace vbar::gige
