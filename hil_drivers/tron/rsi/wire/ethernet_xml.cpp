#include "hil_drivers/tron/rsi/wire/ethernet_xml.h"

#include <algorithm>

#include <fmt/format.h>

#include "hil_drivers/tron/xml/document.h"
#include "hil_drivers/tron/xml/file.h"

namespace vbar::tron::rsi {
namespace {

constexpr std::array<std::string_view, 4> kInternal{"RIst", "AIPos", "EIPos", "Delay"};
constexpr int kMaxChannel = 64;

struct Tag {
  std::string element, attribute;
};

Tag tag_of(const std::string& text) {
  const std::size_t dot = text.find('.');
  return dot == std::string::npos ? Tag{text, ""} : Tag{text.substr(0, dot), text.substr(dot + 1)};
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= 32 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

class EthernetReader {
 public:
  explicit EthernetReader(const std::filesystem::path& file) : file_(file, "ROOT") {}

  EthernetXml read() {
    read_configuration(file_.child(file_.root(), "CONFIG"));
    read_sent(file_.child(file_.child(file_.root(), "SEND"), "ELEMENTS"));
    read_received(file_.child(file_.child(file_.root(), "RECEIVE"), "ELEMENTS"));
    return config_;
  }

 private:
  void read_configuration(const pugi::xml_node& section) {
    config_.address = file_.child(section, "IP_NUMBER").text().get();
    const pugi::xml_node port = file_.child(section, "PORT");
    const auto number = xml::unsigned_number(port.text().get());
    if (!number || *number == 0 || *number > 65535) file_.refuse(port, port.text().get(), "1 to 65535");
    config_.port = static_cast<std::uint16_t>(*number);
    const pugi::xml_node type = file_.child(section, "SENTYPE");
    config_.sen_type = type.text().get();
    if (!is_name(config_.sen_type)) file_.refuse(type, config_.sen_type, "letters, digits and _, up to 32");
    const pugi::xml_node only_send = file_.child(section, "ONLYSEND");
    if (std::string_view(only_send.text().get()) != "FALSE")
      file_.refuse(only_send, only_send.text().get(), "FALSE: the robot needs answers");
  }

  void read_sent(const pugi::xml_node& elements) {
    for (const pugi::xml_node element : elements.children("ELEMENT")) {
      const std::string tag = file_.attribute(element, "TAG");
      const std::string name = tag.starts_with("DEF_") ? tag.substr(4) : "";
      if (std::find(kInternal.begin(), kInternal.end(), name) == kInternal.end())
        file_.refuse(element, tag, "DEF_RIst, DEF_AIPos, DEF_EIPos, DEF_Delay");
      if (sends(name)) file_.refuse(element, "a second " + tag, "one");
      if (file_.attribute(element, "INDX") != "INTERNAL") file_.refuse(element, "an index", "INDX=\"INTERNAL\"");
      config_.sent.push_back(name);
    }
    for (const std::string_view name : kInternal)
      if (!sends(name)) file_.refuse(elements, fmt::format("no DEF_{}", name), "one");
  }

  void read_received(const pugi::xml_node& elements) {
    config_.axis_element.clear();
    for (const pugi::xml_node element : elements.children("ELEMENT")) read_received_value(element);
    for (std::size_t k = 0; k < kWireAxes; ++k)
      if (config_.axes[k].index == 0)
        file_.refuse(elements, fmt::format("no correction {}", xml::kAxisNames[k]), "A1 to A6 of one element");
  }

  void read_received_value(const pugi::xml_node& element) {
    const std::string text = file_.attribute(element, "TAG");
    const Tag tag = tag_of(text);
    const std::string type = file_.attribute(element, "TYPE");
    const ReceivedValue value{tag.attribute, file_.integer(element, "INDX", 1, kMaxChannel),
                              file_.integer(element, "HOLDON", 0, 1) == 1};
    if (std::find(indices_.begin(), indices_.end(), value.index) != indices_.end())
      file_.refuse(element, fmt::format("INDX {} again", value.index), "an index that is not used");
    indices_.push_back(value.index);
    if (!is_name(tag.element)) file_.refuse(element, "TAG \"" + text + "\"", "a name, or name.attribute");
    const auto* const axis = std::find(xml::kAxisNames.begin(), xml::kAxisNames.end(), tag.attribute);
    if (type == "DOUBLE" && axis != xml::kAxisNames.end() && is_element(config_.axis_element, tag.element)) {
      config_.axis_element = tag.element;
      place(element, config_.axes[static_cast<std::size_t>(axis - xml::kAxisNames.begin())], value);
    } else if (type == "DOUBLE" && tag.attribute == "E1") {
      config_.track_element = tag.element;
      place(element, config_.track, value);
    } else if (type == "BOOL" && tag.attribute.empty() && tag.element != "IPOC") {
      config_.stop_element = tag.element;
      place(element, config_.stop, value);
    } else {
      file_.refuse(element, fmt::format("{} of TYPE {}", text, type),
                   "DOUBLE name.A1 to name.A6 of one name, DOUBLE name.E1, one BOOL name (stop)");
    }
  }

  void place(const pugi::xml_node& element, ReceivedValue& place, const ReceivedValue& value) const {
    if (place.index != 0) file_.refuse(element, "a second " + file_.attribute(element, "TAG"), "one");
    place = value;
  }

  [[nodiscard]] bool sends(std::string_view name) const {
    return std::find(config_.sent.begin(), config_.sent.end(), name) != config_.sent.end();
  }
  static bool is_element(const std::string& known, const std::string& name) { return known.empty() || known == name; }

  xml::File file_;
  EthernetXml config_;
  std::vector<int> indices_;
};

}  // namespace

EthernetXml read_ethernet_xml(const std::filesystem::path& file) {
  return EthernetReader(file).read();
}

}  // namespace vbar::tron::rsi
