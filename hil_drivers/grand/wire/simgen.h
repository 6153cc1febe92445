#pragma once
// Spirent SimGEN: remote commands as lines over TCP, each answered by one XML message, and motion (MOT) as lines or as
// datagrams to the UDP port of the same number. Layouts from public clients.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/wire/bytes.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand::wire {

inline constexpr std::uint16_t kSimgenPort = 15650;
inline constexpr std::size_t kSimgenMotBytes = 216;        ///< size of the public structure, 8-aligned
inline constexpr std::size_t kSimgenMotPackedBytes = 212;  ///< without its padding

/// Status in every reply.
enum class SimgenStatus {
  kNoScenario = 0,
  kLoading = 1,
  kReady = 2,
  kArming = 3,
  kArmed = 4,
  kRunning = 5,
  kPaused = 6,
  kEnded = 7
};
std::string_view text_of(SimgenStatus status);

/// Motion of one vehicle.
struct SimgenMotion {
  unsigned vehicle = 1;  ///< from 1
  bool is_timed = true;  ///< valid at the sample's time, or now
  TrajectorySample sample;
};

/// Encodes 216 bytes; the angular jerk is zero. Throws WireError for a sample that is not finite or not on a whole
/// millisecond.
Bytes encode_mot(const SimgenMotion& motion);
/// Decodes 216 or 212 bytes. Throws WireError.
SimgenMotion decode_mot(std::span<const std::uint8_t> datagram);

// Lines, without line end.
/// Returns "0 00:00:00.100,MOT,v1_m1,x,y,z,..." with 24 numbers that read back exactly.
std::string mot_line(const SimgenMotion& motion);
/// Returns "START_TIME,19-JUL-2011 16:00:00,02:15:00".
std::string start_time_line(fsw::GpsTime start, fsw::Duration duration);

/// Parts of a command line: "[timestamp,]NAME[,argument...]".
struct SimgenCommand {
  std::optional<fsw::Duration> time = std::nullopt;  ///< a timestamp other than "-"
  std::string name = {};                             ///< upper case
  std::vector<std::string> arguments = {};
};
/// Splits a command line. Throws WireError.
SimgenCommand parse_simgen_command(std::string_view line);
/// Returns the motion of a command MOT. Throws WireError.
SimgenMotion motion_of(const SimgenCommand& command);
struct SimgenStart {
  fsw::GpsTime time;
  fsw::Duration duration;
};
/// Returns the start of a command START_TIME. Throws WireError.
SimgenStart start_of(const SimgenCommand& command);

struct SimgenReply {
  int status = 0;
  std::string data = {};
  std::string error = {};  ///< text of <error> or <fatal>
};
std::string encode_reply(const SimgenReply& reply);
/// Decodes a whole message, "<msg> ... </msg>". Throws WireError.
SimgenReply parse_reply(std::string_view message);
/// Returns the length of the first whole message of a stream; 0 if it is not complete. Throws WireError if the stream
/// is longer than a reply can be.
std::size_t reply_length(std::string_view stream);

/// Returns the time into run in the data of a reply to TIME. Throws WireError.
fsw::Duration time_of_data(std::string_view data);

}  // namespace vbar::grand::wire
