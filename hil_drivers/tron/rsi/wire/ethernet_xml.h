#pragma once
// The Ethernet configuration of an RSI context (hil_drivers/tron/robot/*_ethernet.xml), which the controller loads:
// where it sends, and what the documents of both directions contain. Driver and emulator read the same file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil_drivers/tron/rsi/wire/messages.h"

namespace vbar::tron::rsi {

/// Describes a value of the answer and how it is kept.
struct ReceivedValue {
  std::string attribute;  ///< empty: the text of the element
  int index = 0;          ///< output of the ETHERNET object in the context
  bool holds_on = true;   ///< a missing value is the last one; otherwise zero
};

struct EthernetXml {
  std::string address;  ///< address of the computer
  std::uint16_t port = 0;
  std::string sen_type;
  /// Internal values that the controller sends, in their order on the wire: "RIst", "AIPos", "EIPos", "Delay".
  std::vector<std::string> sent;
  std::string axis_element = "AK";  ///< element of the corrections A1 to A6
  std::array<ReceivedValue, kWireAxes> axes{};
  std::string track_element;  ///< element of the correction E1; empty: the robot has no track
  ReceivedValue track;
  std::string stop_element;  ///< empty: there is no stop
  ReceivedValue stop;
};

/// Throws mission::MissionError: one sentence with file and line.
[[nodiscard]] EthernetXml read_ethernet_xml(const std::filesystem::path& file);

}  // namespace vbar::tron::rsi
