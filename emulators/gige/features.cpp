#include "emulators/gige/features.h"

#include <map>

#include <fmt/format.h>

#include "emulators/gige/registers.h"
#include "hil_drivers/gige/protocol/gvsp.h"

namespace vbar::gige {

namespace {

using enum FeatureKind;
using enum FeatureAccess;
using Entries = std::vector<std::pair<std::string_view, std::uint32_t>>;

// A region is placed and sized in steps of two pixels.
constexpr double kStep = 2.0;
constexpr double kMinSide = 16.0;

const Entries kAuto = {{"Off", 0}, {"Once", 1}, {"Continuous", 2}};
const Entries kOffOn = {{"Off", 0}, {"On", 1}};
constexpr double kContinuous = 2.0;

Feature integer(FeatureId id, std::string_view name, double initial, double min, double max, std::string_view max_of) {
  return {.id = id,
          .name = name,
          .category = "ImageFormatControl",
          .kind = kInteger,
          .access = kReadWrite,
          .initial = initial,
          .min = min,
          .max = max,
          .increment = kStep,
          .max_feature = max_of};
}

Feature read_only(FeatureId id, std::string_view name, double initial) {
  return {.id = id,
          .name = name,
          .category = "ImageFormatControl",
          .kind = kInteger,
          .access = kReadOnly,
          .initial = initial,
          .max = 4294967295.0};
}

Feature real(FeatureId id, std::string_view name, std::string_view category, std::string_view unit, double initial,
             double min, double max) {
  return {.id = id,
          .name = name,
          .category = category,
          .kind = kFloat,
          .access = kReadWrite,
          .initial = initial,
          .min = min,
          .max = max,
          .unit = unit};
}

Feature choice(FeatureId id, std::string_view name, std::string_view category, Entries entries, double initial) {
  return {.id = id,
          .name = name,
          .category = category,
          .kind = kEnumeration,
          .access = kReadWrite,
          .initial = initial,
          .entries = std::move(entries)};
}

Feature truth(FeatureId id, std::string_view name, std::string_view category, double initial) {
  return {.id = id,
          .name = name,
          .category = category,
          .kind = kBoolean,
          .access = kReadWrite,
          .initial = initial,
          .max = 1.0};
}

Feature command(FeatureId id, std::string_view name, std::string_view category) {
  return {.id = id, .name = name, .category = category, .kind = kCommand, .access = kWriteOnly};
}

std::uint32_t number_of(wire::PixelFormat format) {
  return static_cast<std::uint32_t>(format);
}

Feature locked(Feature feature) {
  feature.locked_in_acquisition = true;
  return feature;
}

void add_image_format(std::vector<Feature>& list, const Description& camera) {
  using enum FeatureId;
  const double width = camera.sensor_width;
  const double height = camera.sensor_height;
  list.push_back(read_only(kSensorWidth, "SensorWidth", width));
  list.push_back(read_only(kSensorHeight, "SensorHeight", height));
  list.push_back(read_only(kWidthMax, "WidthMax", width));
  list.push_back(read_only(kHeightMax, "HeightMax", height));
  list.push_back(read_only(kOffsetXMax, "OffsetXMax", 0.0));
  list.push_back(read_only(kOffsetYMax, "OffsetYMax", 0.0));
  list.push_back(locked(integer(kWidth, "Width", width, kMinSide, width, "WidthMax")));
  list.push_back(locked(integer(kHeight, "Height", height, kMinSide, height, "HeightMax")));
  list.push_back(integer(kOffsetX, "OffsetX", 0.0, 0.0, width, "OffsetXMax"));
  list.push_back(integer(kOffsetY, "OffsetY", 0.0, 0.0, height, "OffsetYMax"));
  Entries formats;
  for (const auto format : {wire::PixelFormat::kMono8, wire::PixelFormat::kMono12Packed, wire::PixelFormat::kMono16})
    formats.emplace_back(wire::name_of(format), number_of(format));
  list.push_back(
      locked(choice(kPixelFormat, "PixelFormat", "ImageFormatControl", formats, number_of(wire::PixelFormat::kMono8))));
  list.push_back(read_only(kPayloadSize, "PayloadSize", width * height));
}

// The names are those of Point Grey's description, where the standard says ...FrameRateEnable. A camera fresh from its
// box has its automatic functions on.
void add_acquisition(std::vector<Feature>& list) {
  using enum FeatureId;
  const std::string_view category = "AcquisitionControl";
  list.push_back(choice(kAcquisitionMode, "AcquisitionMode", category, {{"Continuous", 0}, {"SingleFrame", 1}}, 0.0));
  list.push_back(command(kAcquisitionStart, "AcquisitionStart", category));
  list.push_back(command(kAcquisitionStop, "AcquisitionStop", category));
  list.push_back(choice(kFrameRateAuto, "AcquisitionFrameRateAuto", category, kAuto, kContinuous));
  list.push_back(truth(kFrameRateEnabled, "AcquisitionFrameRateEnabled", category, 1.0));
  list.push_back(real(kFrameRate, "AcquisitionFrameRate", category, "Hz", 20.0, 0.1, 1000.0));
  list.push_back(choice(kTriggerSelector, "TriggerSelector", category, {{"FrameStart", 0}}, 0.0));
  list.push_back(choice(kTriggerMode, "TriggerMode", category, kOffOn, 0.0));
  list.push_back(choice(kTriggerSource, "TriggerSource", category, {{"Line0", 0}, {"Software", 7}}, 0.0));
  list.push_back(command(kTriggerSoftware, "TriggerSoftware", category));
  list.push_back(choice(kExposureMode, "ExposureMode", category, {{"Timed", 1}}, 1.0));
  list.push_back(choice(kExposureAuto, "ExposureAuto", category, kAuto, kContinuous));
  list.push_back(real(kExposureTime, "ExposureTime", category, "us", 10000.0, 5.0, 3.2e7));
}

void add_analog(std::vector<Feature>& list) {
  using enum FeatureId;
  const std::string_view category = "AnalogControl";
  list.push_back(choice(kGainAuto, "GainAuto", category, kAuto, kContinuous));
  list.push_back(real(kGain, "Gain", category, "dB", 0.0, 0.0, 48.0));
  list.push_back(real(kBlackLevel, "BlackLevel", category, "%", 1.5625, 0.0, 12.5));
  // Gamma and sharpness are registers only: pixels come without either.
  list.push_back(truth(kGammaEnabled, "GammaEnabled", category, 1.0));
  list.push_back(real(kGamma, "Gamma", category, "", 1.25, 0.5, 4.0));
  list.push_back(truth(kSharpnessEnabled, "SharpnessEnabled", category, 1.0));
}

}  // namespace

std::vector<Feature> features_of(const Description& description) {
  std::vector<Feature> list;
  add_image_format(list, description);
  add_acquisition(list);
  add_analog(list);
  return list;
}

namespace {

struct Node {
  std::string name, category, xml;
};

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string_view access_of(FeatureAccess access) {
  switch (access) {
    case FeatureAccess::kReadOnly:
      return "RO";
    case FeatureAccess::kReadWrite:
      return "RW";
    case FeatureAccess::kWriteOnly:
      return "WO";
  }
  return "";
}

std::string integer_register(std::string_view name, std::uint32_t address, std::string_view access) {
  return fmt::format(
      "<IntReg Name=\"{}\"><Address>0x{:x}</Address><Length>4</Length><AccessMode>{}</AccessMode>"
      "<pPort>Device</pPort><Cachable>NoCache</Cachable><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess>"
      "</IntReg>\n",
      name, address, access);
}

std::string register_of(const Feature& feature) {
  const std::string name = fmt::format("{}Register", feature.name);
  if (feature.kind != FeatureKind::kFloat) return integer_register(name, feature.address(), access_of(feature.access));
  return fmt::format(
      "<FloatReg Name=\"{}\"><Address>0x{:x}</Address><Length>8</Length><AccessMode>{}</AccessMode>"
      "<pPort>Device</pPort><Cachable>NoCache</Cachable><Endianess>BigEndian</Endianess></FloatReg>\n",
      name, feature.address(), access_of(feature.access));
}

std::string limits_of(const Feature& feature) {
  const std::string max = feature.max_feature.empty() ? fmt::format("<Max>{}</Max>", feature.max)
                                                      : fmt::format("<pMax>{}</pMax>", feature.max_feature);
  return fmt::format("<Min>{}</Min>{}", feature.min, max);
}

Node node_of(const Feature& feature) {
  const std::string value = fmt::format("<pValue>{}Register</pValue>", feature.name);
  std::string xml;
  switch (feature.kind) {
    case FeatureKind::kInteger:
      xml = fmt::format("<Integer Name=\"{}\">{}{}<Inc>{}</Inc></Integer>\n", feature.name, value, limits_of(feature),
                        feature.increment);
      break;
    case FeatureKind::kFloat:
      xml = fmt::format("<Float Name=\"{}\">{}{}<Unit>{}</Unit></Float>\n", feature.name, value, limits_of(feature),
                        feature.unit);
      break;
    case FeatureKind::kEnumeration:
      xml = fmt::format("<Enumeration Name=\"{}\">", feature.name);
      for (const auto& [entry, number] : feature.entries)
        xml += fmt::format("<EnumEntry Name=\"{}\"><Value>{}</Value></EnumEntry>", entry, number);
      xml += value + "</Enumeration>\n";
      break;
    case FeatureKind::kBoolean:
      xml = fmt::format("<Boolean Name=\"{}\">{}<OnValue>1</OnValue><OffValue>0</OffValue></Boolean>\n", feature.name,
                        value);
      break;
    case FeatureKind::kCommand:
      xml = fmt::format("<Command Name=\"{}\">{}<CommandValue>1</CommandValue></Command>\n", feature.name, value);
      break;
  }
  return {std::string(feature.name), std::string(feature.category), xml + register_of(feature)};
}

Node text_node(std::string_view name, std::uint32_t address, std::uint32_t length) {
  return {std::string(name), "DeviceControl",
          fmt::format("<StringReg Name=\"{}\"><Address>0x{:x}</Address><Length>{}</Length><AccessMode>RO</AccessMode>"
                      "<pPort>Device</pPort><Cachable>NoCache</Cachable></StringReg>\n",
                      name, address, length)};
}

Node transport_node(std::string_view name, std::uint32_t address, std::string_view access) {
  return {std::string(name), "TransportLayerControl",
          fmt::format("<Integer Name=\"{0}\"><pValue>{0}Register</pValue></Integer>\n", name) +
              integer_register(fmt::format("{}Register", name), address, access)};
}

Node packet_size_node() {
  return {"GevSCPSPacketSize", "TransportLayerControl",
          fmt::format("<Integer Name=\"GevSCPSPacketSize\"><pValue>GevSCPSPacketSizeRegister</pValue><Min>{}</Min>"
                      "<Max>{}</Max><Inc>4</Inc></Integer>\n"
                      "<MaskedIntReg Name=\"GevSCPSPacketSizeRegister\"><Address>0x{:x}</Address><Length>4</Length>"
                      "<AccessMode>RW</AccessMode><pPort>Device</pPort><Cachable>NoCache</Cachable><LSB>31</LSB>"
                      "<MSB>16</MSB><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></MaskedIntReg>\n",
                      bootstrap::kMinPacketSize, bootstrap::kMaxPacketSize, bootstrap::kPacketSize)};
}

std::vector<Node> nodes_of(const std::vector<Feature>& features) {
  std::vector<Node> nodes = {
      text_node("DeviceVendorName", bootstrap::kManufacturer, 32),
      text_node("DeviceModelName", bootstrap::kModel, 32),
      text_node("DeviceVersion", bootstrap::kVersionText, 32),
      text_node("DeviceManufacturerInfo", bootstrap::kManufacturerInfo, 48),
      text_node("DeviceID", bootstrap::kSerial, 16),
      text_node("DeviceSerialNumber", bootstrap::kSerial, 16),
      transport_node("GevHeartbeatTimeout", bootstrap::kHeartbeatMs, "RW"),
      transport_node("GevSCPD", bootstrap::kPacketDelay, "RW"),
      transport_node("GevSCDA", bootstrap::kStreamDestination, "RW"),
      transport_node("GevSCPHostPort", bootstrap::kStreamPort, "RW"),
      packet_size_node(),
  };
  for (const Feature& feature : features) nodes.push_back(node_of(feature));
  return nodes;
}

}  // namespace

std::string genicam_xml(const Description& description, const std::vector<Feature>& features) {
  std::map<std::string, std::string> categories;
  std::string body;
  for (const Node& node : nodes_of(features)) {
    categories[node.category] += fmt::format("<pFeature>{}</pFeature>", node.name);
    body += node.xml;
  }
  std::string root = "<Category Name=\"Root\">";
  std::string groups;
  for (const auto& [name, members] : categories) {
    root += fmt::format("<pFeature>{}</pFeature>", name);
    groups += fmt::format("<Category Name=\"{}\">{}</Category>\n", name, members);
  }
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<RegisterDescription ModelName=\"{}\" VendorName=\"{}\" ToolTip=\"emulated camera\" "
             "StandardNameSpace=\"GEV\" SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" SchemaSubMinorVersion=\"0\" "
             "MajorVersion=\"1\" MinorVersion=\"0\" SubMinorVersion=\"0\" "
             "ProductGuid=\"5b9f4d5c-6b0e-4d0e-9d2a-3a8f3c1b7e10\" "
             "VersionGuid=\"5b9f4d5c-6b0e-4d0e-9d2a-3a8f3c1b7e11\" "
             "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\" "
             "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
             "xsi:schemaLocation=\"http://www.genicam.org/GenApi/Version_1_1 GenApiSchema_Version_1_1.xsd\">\n",
             escaped(description.model), escaped(description.manufacturer)) +
         root + "</Category>\n" + groups + body + "<Port Name=\"Device\"/>\n</RegisterDescription>\n";
}

}  // namespace vbar::gige
