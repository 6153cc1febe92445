#pragma once
// CCSDS messages in keyword = value notation, and what OEM and OPM share.

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "host_sim/files/text_lines.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/orbit_files/published_time.h"

namespace vbar::orbit_files {

struct Keyword {
  std::string_view name, value;
  std::string_view unit;  ///< between brackets behind the value; may be empty
};

/// Returns the keyword of a line "NAME = value [unit]"; nothing for another line.
[[nodiscard]] std::optional<Keyword> keyword_in(std::string_view line);

/// Whether the line is a COMMENT or blank.
[[nodiscard]] bool is_comment(const files::TextLines& lines);

/// Whether the first line, comments aside, is that of a message of this kind ("CCSDS_OEM_VERS").
[[nodiscard]] bool begins_with(std::string_view text, std::string_view version_keyword);

/// Holds the names of the keywords of which a block holds one each.
class UniqueKeywords {
 public:
  /// Throws files::FormatError at the current line for a second one of the name.
  void note(const files::TextLines& lines, const Keyword& keyword);

 private:
  std::set<std::string, std::less<>> names_;
};

/// Throws files::FormatError for a CCSDS_..._VERS that is not 1.0, 2.0 or 3.0.
void check_version(const files::TextLines& lines, const Keyword& keyword);

/// Axes of a message.
struct MessageFrame {
  Frame frame = Frame::kGcrf;  ///< whose axes those of the message become by the rotation
  Eigen::Matrix3d R_frame_message = Eigen::Matrix3d::Identity();
};

/// Metadata that both messages have.
struct Metadata {
  std::string object, object_id;
  std::optional<TimeSystem> time_system;
  bool has_centre = false;
  std::optional<MessageFrame> frame;  ///< empty without REF_FRAME

  /// Takes one of OBJECT_NAME, OBJECT_ID, CENTER_NAME, REF_FRAME, TIME_SYSTEM; false for another keyword. Throws
  /// files::FormatError for a value that is not accepted, and for a second keyword of one name.
  bool take(const files::TextLines& lines, const Keyword& keyword);

  /// Throws files::FormatError at the current line if something is missing.
  void check(const files::TextLines& lines) const;

  [[nodiscard]] fsw::GpsTime time(const files::TextLines& lines, std::string_view text) const;

  /// Converts a state from km and km/s along the axes of the message to m and m/s along those of its frame. Rejects
  /// what is not an orbit about the Earth in these units.
  [[nodiscard]] fsw::orbit::CartesianState state(const files::TextLines& lines, const fsw::Vector3& position_km,
                                                 const fsw::Vector3& velocity_kmps) const;

 private:
  UniqueKeywords unique_;
};

/// Throws files::FormatError for a state that cannot be one in orbit about the Earth; m, m/s.
void check_state(const files::TextLines& lines, const fsw::orbit::CartesianState& state, Frame frame);

}  // namespace vbar::orbit_files
