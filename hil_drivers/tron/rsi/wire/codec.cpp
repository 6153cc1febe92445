#include "hil_drivers/tron/rsi/wire/codec.h"

#include <fmt/format.h>

#include "hil_drivers/tron/xml/document.h"
#include "hil_drivers/wire/bytes.h"

namespace vbar::tron::rsi {
namespace {

using xml::append_decimal;

constexpr int kAnswerDecimals = 4;
constexpr std::size_t kMaxIpocCharacters = 20;

bool append_six(std::string& text, std::string_view element, const std::array<std::string_view, kWireAxes>& names,
                const SixValues& values, int decimals) {
  text.append("<").append(element);
  for (std::size_t k = 0; k < kWireAxes; ++k) {
    text.append(" ").append(names[k]).append("=\"");
    if (!append_decimal(text, values[k], decimals)) return false;
    text += '"';
  }
  text += "/>";
  return true;
}

void append_ipoc(std::string& text, std::string_view ipoc) {
  text.append("<IPOC>").append(ipoc).append("</IPOC>");
}

bool append_sent(std::string& text, const std::string& name, const Rob& rob, int decimals) {
  if (name == "RIst") return append_six(text, name, xml::kCartesianNames, rob.cartesian, decimals);
  if (name == "AIPos") return append_six(text, name, xml::kAxisNames, rob.axes_deg, decimals);
  if (name == "EIPos") return append_six(text, name, xml::kExternalNames, rob.external_mm, decimals);
  if (name != "Delay") return false;
  text.append("<Delay D=\"").append(std::to_string(rob.delay)).append("\"/>");
  return true;
}

bool append_axes(std::string& text, const Sen& sen, const EthernetXml& ethernet) {
  bool is_empty = true;
  for (std::size_t k = 0; k < kWireAxes; ++k) {
    if (!sen.axes_deg[k]) continue;
    if (is_empty) text.append("<").append(ethernet.axis_element);
    is_empty = false;
    text.append(" ").append(ethernet.axes[k].attribute).append("=\"");
    if (!append_decimal(text, *sen.axes_deg[k], kAnswerDecimals)) return false;
    text += '"';
  }
  if (!is_empty) text += "/>";
  return true;
}

bool append_track(std::string& text, const Sen& sen, const EthernetXml& ethernet) {
  if (!sen.track_mm) return true;
  if (ethernet.track_element.empty()) return false;
  text.append("<").append(ethernet.track_element).append(" ").append(ethernet.track.attribute).append("=\"");
  if (!append_decimal(text, *sen.track_mm, kAnswerDecimals)) return false;
  text += "\"/>";
  return true;
}

}  // namespace

bool encode(const Rob& rob, const EthernetXml& ethernet, int precision, std::string& datagram) {
  datagram = "<Rob Type=\"KUKA\">";
  for (const std::string& name : ethernet.sent)
    if (!append_sent(datagram, name, rob, precision)) return false;
  append_ipoc(datagram, rob.ipoc.text);
  datagram += "</Rob>";
  return true;
}

bool encode(const Sen& sen, const EthernetXml& ethernet, std::string& datagram) {
  datagram = "<Sen Type=\"";
  datagram.append(sen.type).append("\">");
  if (sen.stop) {
    if (ethernet.stop_element.empty()) return false;
    datagram.append("<").append(ethernet.stop_element).append(*sen.stop ? ">1</" : ">0</");
    datagram.append(ethernet.stop_element).append(">");
  }
  if (!append_axes(datagram, sen, ethernet) || !append_track(datagram, sen, ethernet)) return false;
  append_ipoc(datagram, sen.ipoc);
  datagram += "</Sen>";
  return datagram.size() <= kMaxAnswerBytes;
}

struct Decoder::Parser {
  explicit Parser(const EthernetXml& config) : ethernet(config) {}

  /// The only child of this name, or none; false if there are two.
  bool find(const char* name, pugi::xml_node& found) {
    found = document.root().child(name);
    if (found && found.next_sibling(name)) return document.refuse(fmt::format("<{}> occurs twice", name));
    return true;
  }

  bool require(const char* name, pugi::xml_node& found) {
    if (!find(name, found)) return false;
    return static_cast<bool>(found) || document.refuse(fmt::format("<{}> is missing", name));
  }

  bool begin(std::string_view datagram, std::string_view root) {
    if (!document.parse(datagram, kMaxDatagramBytes)) return false;
    if (root == document.root().name()) return true;
    return document.refuse(
        fmt::format("root element <{}>; accepted: <{}>", wire::printable(document.root().name()), root));
  }

  bool read_six(const char* name, const std::array<std::string_view, kWireAxes>& names, SixValues& values) {
    pugi::xml_node element;
    if (!require(name, element)) return false;
    const std::string_view wrong = xml::read_attributes(element, names, values);
    return wrong.empty() || document.refuse(fmt::format("<{}>: {} is missing or not a finite number", name, wrong));
  }

  bool read_sent(const std::string& name, Rob& rob) {
    if (name == "RIst") return read_six("RIst", xml::kCartesianNames, rob.cartesian);
    if (name == "AIPos") return read_six("AIPos", xml::kAxisNames, rob.axes_deg);
    if (name == "EIPos") return read_six("EIPos", xml::kExternalNames, rob.external_mm);
    pugi::xml_node element;
    if (!require("Delay", element)) return false;
    const auto delay = xml::unsigned_number(element.attribute("D").value());
    if (!delay) return document.refuse("<Delay>: D is missing or not a count");
    rob.delay = *delay;
    return true;
  }

  bool read_ipoc(std::string& text, std::uint64_t& value) {
    pugi::xml_node element;
    if (!require("IPOC", element)) return false;
    text = element.text().get();
    const auto number = xml::unsigned_number(text);
    if (!number || text.size() > kMaxIpocCharacters) return document.refuse("<IPOC> is not an unsigned decimal number");
    value = *number;
    return true;
  }

  /// A number that the answer may leave out.
  bool read_number(const pugi::xml_node& element, const ReceivedValue& received, std::optional<double>& value) {
    value.reset();
    const pugi::xml_attribute attribute = element.attribute(received.attribute.c_str());
    if (!attribute) return true;
    value = xml::finite_number(attribute.value());
    return value || document.refuse(fmt::format("<{}>: {} is not a finite number", element.name(), received.attribute));
  }

  bool read_corrections(Sen& sen) {
    pugi::xml_node axes, track;
    if (!find(ethernet.axis_element.c_str(), axes)) return false;
    for (std::size_t k = 0; k < kWireAxes; ++k)
      if (!read_number(axes, ethernet.axes[k], sen.axes_deg[k])) return false;
    sen.track_mm.reset();
    if (ethernet.track_element.empty()) return true;
    if (!find(ethernet.track_element.c_str(), track)) return false;
    return read_number(track, ethernet.track, sen.track_mm);
  }

  bool read_stop(Sen& sen) {
    sen.stop.reset();
    if (ethernet.stop_element.empty()) return true;
    pugi::xml_node element;
    if (!find(ethernet.stop_element.c_str(), element)) return false;
    if (!element) return true;
    const std::string_view text = element.text().get();
    if (text != "0" && text != "1") return document.refuse(fmt::format("<{}> is not 0 or 1", ethernet.stop_element));
    sen.stop = text == "1";
    return true;
  }

  EthernetXml ethernet;
  xml::Document document;
};

Decoder::Decoder(const EthernetXml& ethernet) : parser_(std::make_unique<Parser>(ethernet)) {}

Decoder::~Decoder() = default;

const std::string& Decoder::problem() const {
  return parser_->document.problem();
}

bool Decoder::decode(std::string_view datagram, Rob& rob) {
  Parser& parser = *parser_;
  if (!parser.begin(datagram, "Rob")) return false;
  const pugi::xml_node root = parser.document.root();
  const pugi::xml_attribute type = root.attribute("Type") ? root.attribute("Type") : root.attribute("TYPE");
  if (std::string_view(type.value()) != "KUKA") return parser.document.refuse("<Rob> has no Type \"KUKA\"");
  for (const std::string& name : parser.ethernet.sent)
    if (!parser.read_sent(name, rob)) return false;
  return parser.read_ipoc(rob.ipoc.text, rob.ipoc.value);
}

bool Decoder::decode(std::string_view datagram, Sen& sen) {
  Parser& parser = *parser_;
  if (!parser.begin(datagram, "Sen")) return false;
  sen.type = parser.document.root().attribute("Type").value();
  std::uint64_t ipoc = 0;
  return parser.read_corrections(sen) && parser.read_stop(sen) && parser.read_ipoc(sen.ipoc, ipoc);
}

}  // namespace vbar::tron::rsi
