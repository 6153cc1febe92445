#pragma once
// Documents of KUKA's RobotSensorInterface, one a datagram: <Rob> from the controller every cycle of 4 ms, <Sen> back.
// Values as on the wire: degrees, millimetres, milliseconds.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::tron::rsi {

inline constexpr std::size_t kWireAxes = 6;
inline constexpr double kCycle_s = 0.004;  ///< #IPO_FAST
inline constexpr std::uint64_t kCycle_ms = 4;
/// Number of bytes of a datagram that a decoder accepts; answers have less than 1,024 bytes.
inline constexpr std::size_t kMaxDatagramBytes = 65536;
inline constexpr std::size_t kMaxAnswerBytes = 1023;

using SixValues = std::array<double, kWireAxes>;

/// Holds the time stamp that the controller gives to a cycle. The answer repeats its text; only the controller makes
/// one.
struct Ipoc {
  std::string text = "0";
  std::uint64_t value = 0;
};

/// Holds the state of the robot in one cycle.
struct Rob {
  SixValues cartesian{};           ///< RIst: X Y Z in mm, A B C in deg (about z, y', x''), of the flange in the base
  SixValues axes_deg{};            ///< AIPos: A1 to A6 as measured by the motors
  SixValues external_mm{};         ///< EIPos: E1 to E6; unchanged by a decoder for a robot without a track
  SixValues cartesian_setpoint{};  ///< RSol: as RIst, without corrections; only encoded
  SixValues axes_setpoint_deg{};   ///< ASPos; only encoded
  std::uint64_t delay = 0;         ///< cycles since RSI_ON without a valid answer
  Ipoc ipoc;
};

/// Holds the answer of the computer. A value that it leaves out keeps its last value (HOLDON 1) or falls to zero
/// (HOLDON 0).
struct Sen {
  std::string type;
  std::optional<bool> stop;
  std::array<std::optional<double>, kWireAxes> axes_deg{};  ///< corrections, absolute to the pose at RSI_ON
  std::optional<double> track_mm;
  std::string ipoc;  ///< as received
};

// The Ethernet configuration of an RSI context (hil_drivers/tron/robot/*_ethernet.xml), which the controller loads:
// where it sends, and what the documents of both directions contain. Driver and emulator read the same file.

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
  /// Internal values that the controller sends, in their order on the wire: "RIst", "AIPos", "Delay", for a robot with
  /// a track "EIPos"; "RSol", "ASPos" and, without a track, "EIPos" if its file lists them.
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

// Values of an RSI context (hil_drivers/tron/robot/*.rsi.xml) that driver and emulator need, and its connections
// to the values of the Ethernet configuration.

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

// Codec of RSI documents. Encoding is strict: values in the order of the configuration, IPOC last, no blank before
// "/>", four decimals. Decoding accepts any order, both forms of an empty element, Type and TYPE, additional flat
// elements and any decimal notation; it rejects document types, entities, nested or repeated elements, numbers that are
// not finite, and oversize.

/// Replaces `datagram` by the document. `precision`: decimals, 0 to 9. Returns false if a value is not finite or beyond
/// 1e9.
[[nodiscard]] bool encode(const Rob& rob, const EthernetXml& ethernet, int precision, std::string& datagram);
/// Replaces `datagram`; values that `sen` leaves out are not written. Returns false as above, or if kMaxAnswerBytes is
/// exceeded.
[[nodiscard]] bool encode(const Sen& sen, const EthernetXml& ethernet, std::string& datagram);

/// Decodes one document after the other without throwing; memory is reused.
class Decoder {
 public:
  /// Copies `ethernet`.
  explicit Decoder(const EthernetXml& ethernet);
  ~Decoder();
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// Returns false if the document is rejected: problem() is one sentence, and the output is unspecified.
  [[nodiscard]] bool decode(std::string_view datagram, Rob& rob);
  [[nodiscard]] bool decode(std::string_view datagram, Sen& sen);
  [[nodiscard]] const std::string& problem() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace vbar::tron::rsi
