#include "hil_drivers/tron/rsi/wire/context_xml.h"

#include <fmt/format.h>

#include "hil_drivers/tron/xml/document.h"
#include "hil_drivers/tron/xml/file.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::rsi {
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

}  // namespace vbar::tron::rsi
