#include "hil_drivers/tron/protocols/rsi_messages.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil_drivers/tron/protocols/kuka_xml.h"
#include "hil_drivers/wire/bytes.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::rsi {

namespace {

// Internal values of the controller; motor currents and technology parameters are not among them.
constexpr std::array<std::string_view, 6> kInternal{"RIst", "RSol", "AIPos", "ASPos", "EIPos", "Delay"};
constexpr std::array<std::string_view, 3> kNeeded{"RIst", "AIPos", "Delay"};
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
    if (!config_.track_element.empty() && !sends("EIPos"))
      file_.refuse(file_.child(file_.child(file_.root(), "SEND"), "ELEMENTS"), "no DEF_EIPos",
                   "one, as the robot has a track");
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
        file_.refuse(element, tag, fmt::format("DEF_{}", fmt::join(kInternal, ", DEF_")));
      if (sends(name)) file_.refuse(element, "a second " + tag, "one");
      if (file_.attribute(element, "INDX") != "INTERNAL") file_.refuse(element, "an index", "INDX=\"INTERNAL\"");
      config_.sent.push_back(name);
    }
    for (const std::string_view name : kNeeded)
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

namespace {

constexpr double kMaxCorrection = 1e5;
constexpr int kFirstExternalInput = 7;  // AXISCORR and AXISCORREXT share their numbers

class ContextReader {
 public:
  explicit ContextReader(const std::filesystem::path& file) : file_(file, "RSIObjects") {}

  ContextXml read() {
    const pugi::xml_node ethernet = object("ETHERNET");
    if (!ethernet) file_.refuse(file_.root(), "no object ETHERNET", "one");
    ethernet_ = file_.attribute(ethernet, "ObjID");
    context_.ethernet_file = file_.attribute(parameter(ethernet, "ConfigFile"), "ParamValue");
    context_.timeout_cycles = integer(ethernet, "Timeout", context_.timeout_cycles, 1, 100'000);
    context_.precision = integer(ethernet, "Precision", context_.precision, 1, 9);
    read_axes();
    if (const pugi::xml_node track = object("AXISCORREXT")) context_.track = range(track, "E1", kFirstExternalInput);
    if (const pugi::xml_node stop = object("STOP")) read_stop(stop);
    if (const pugi::xml_node monitor = object("AXISCORRMON")) read_monitor(monitor);
    return context_;
  }

 private:
  void read_axes() {
    const pugi::xml_node axes = object("AXISCORR");
    if (!axes) file_.refuse(file_.root(), "no object AXISCORR", "one");
    for (std::size_t k = 0; k < kWireAxes; ++k)
      context_.axes[k] = range(axes, std::string(xml::kAxisNames[k]), static_cast<int>(k) + 1);
  }

  void read_stop(const pugi::xml_node& stop) {
    constexpr int kExitMoveCorr = 4;
    (void)integer(stop, "Mode", kExitMoveCorr, kExitMoveCorr, kExitMoveCorr);
    context_.stop_channel = channel(stop, 1);
  }

  void read_monitor(const pugi::xml_node& monitor) {
    for (std::size_t k = 0; k < kWireAxes; ++k)
      context_.monitor_deg[k] = number(monitor, fmt::format("Max{}", xml::kAxisNames[k]), context_.monitor_deg[k]);
    context_.track_monitor_mm = number(monitor, "MaxE1", context_.track_monitor_mm);
  }

  CorrectionRange range(const pugi::xml_node& axes, const std::string& axis, int input) {
    CorrectionRange range;
    range.lower = number(axes, "LowerLim" + axis, range.lower);
    range.upper = number(axes, "UpperLim" + axis, range.upper);
    if (range.lower > range.upper)
      file_.refuse(axes, "limits of " + axis + " in the wrong order", "the lower one first");
    range.channel = channel(axes, input);
    return range;
  }

  /// The only object of this type, or none.
  pugi::xml_node object(const char* type) {
    pugi::xml_node found;
    for (const pugi::xml_node node : file_.root().children("RSIObject")) {
      if (std::string_view(node.attribute("ObjType").value()) != type) continue;
      if (found) file_.refuse(node, fmt::format("a second {}", type), "one");
      found = node;
    }
    return found;
  }

  static pugi::xml_node parameter(const pugi::xml_node& object, const std::string& name) {
    return object.child("Parameters").find_child_by_attribute("Parameter", "Name", name.c_str());
  }

  double number(const pugi::xml_node& object, const std::string& name, double preset) {
    const pugi::xml_node found = parameter(object, name);
    return found ? file_.number(found, "ParamValue", -kMaxCorrection, kMaxCorrection) : preset;
  }

  int integer(const pugi::xml_node& object, const std::string& name, int preset, int lower, int upper) {
    const pugi::xml_node found = parameter(object, name);
    return found ? file_.integer(found, "ParamValue", lower, upper) : preset;
  }

  int channel(const pugi::xml_node& object, int input) {
    const std::string index = std::to_string(input);
    const pugi::xml_node found = object.child("Inputs").find_child_by_attribute("Input", "InIdx", index.c_str());
    if (!found) file_.refuse(object, "no input " + index, "one from " + ethernet_);
    if (file_.attribute(found, "OutObjID") != ethernet_)
      file_.refuse(found, file_.attribute(found, "OutObjID"), ethernet_);
    return file_.integer(found, "OutIdx", 1, 64);
  }

  xml::File file_;
  ContextXml context_;
  std::string ethernet_;
};

void require_same(const std::filesystem::path& file, const std::string& what, int context, int ethernet) {
  if (context != ethernet)
    throw mission::MissionError(file.string(), what, fmt::format("output {} of the ETHERNET object", context),
                                fmt::format("INDX {} of the Ethernet configuration", ethernet));
}

}  // namespace

ContextXml read_context_xml(const std::filesystem::path& file) {
  return ContextReader(file).read();
}

RobotFiles read_robot_files(const std::filesystem::path& directory, const std::string& name) {
  const std::filesystem::path file = directory / (name + ".rsi.xml");
  RobotFiles files;
  files.context = read_context_xml(file);
  files.ethernet = read_ethernet_xml(directory / std::filesystem::path(files.context.ethernet_file).filename());
  for (std::size_t k = 0; k < kWireAxes; ++k)
    require_same(file, fmt::format("AXISCORR.{}", xml::kAxisNames[k]), files.context.axes[k].channel,
                 files.ethernet.axes[k].index);
  require_same(file, "AXISCORREXT.E1", files.context.track ? files.context.track->channel : 0,
               files.ethernet.track.index);
  require_same(file, "STOP", files.context.stop_channel, files.ethernet.stop.index);
  return files;
}

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
  if (name == "RSol") return append_six(text, name, xml::kCartesianNames, rob.cartesian_setpoint, decimals);
  if (name == "ASPos") return append_six(text, name, xml::kAxisNames, rob.axes_setpoint_deg, decimals);
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
    // What the driver does not use need not be there: public simulators leave it out.
    if (name == "EIPos")
      return ethernet.track_element.empty() || read_six("EIPos", xml::kExternalNames, rob.external_mm);
    if (name != "Delay") return true;
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
