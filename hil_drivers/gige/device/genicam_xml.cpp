#include "hil_drivers/gige/device/genicam_xml.h"

#include <map>

#include <fmt/format.h>

#include "hil_drivers/gige/device/register_map.h"

namespace vbar::gige {
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
