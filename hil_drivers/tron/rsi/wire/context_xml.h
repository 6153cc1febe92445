#pragma once
// Values of an RSI context (hil_drivers/tron/robot/*.rsi.xml) that driver and emulator need, and its connections
// to the values of the Ethernet configuration.

#include <filesystem>
#include <optional>

#include "hil_drivers/tron/rsi/wire/ethernet_xml.h"
#include "hil_drivers/tron/rsi/wire/messages.h"

namespace vbar::tron::rsi {

struct CorrectionRange {
  double lower = -5.0, upper = 5.0;  ///< deg (mm of the track): a correction beyond is clamped silently. KUKA's default
  int channel = 0;                   ///< output of the ETHERNET object from which it comes
};

struct ContextXml {
  std::string ethernet_file;  ///< name of the Ethernet configuration
  int timeout_cycles = 10;    ///< consecutive cycles without a valid answer that end RSI. KUKA's default
  int precision = 1;          ///< decimals that the controller sends. KUKA's default
  std::array<CorrectionRange, kWireAxes> axes{};
  std::optional<CorrectionRange> track;
  int stop_channel = 0;                                 ///< 0: no STOP object
  SixValues monitor_deg{6.0, 6.0, 6.0, 6.0, 6.0, 6.0};  ///< a correction beyond ends RSI (KSS29000). KUKA's default
  double track_monitor_mm = 6.0;
};

/// Throws mission::MissionError: one sentence with file and line.
[[nodiscard]] ContextXml read_context_xml(const std::filesystem::path& file);

/// Holds the content of both files of a robot.
struct RobotFiles {
  EthernetXml ethernet;
  ContextXml context;
};

/// Reads <name>.rsi.xml of `directory` and the Ethernet configuration that it names, and compares the channels of both.
/// Throws mission::MissionError.
[[nodiscard]] RobotFiles read_robot_files(const std::filesystem::path& directory, const std::string& name);

}  // namespace vbar::tron::rsi
