#pragma once
// Faults of the emulator, as its control line names them: one JSON object in a line, such as
// {"kind": "late_frame", "frame": 100, "frames": 1}.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "emulators/common/faults.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::optical_stimulator::bench {

enum class FaultKind {
  kCameraAway,      ///< the camera does not answer and sends nothing
  kCameraBusy,      ///< another program has control of the camera
  kPacketLoss,      ///< packets of images are lost at random
  kPacketsDoubled,  ///< ... arrive twice
  kPacketsReordered,
  kAnswersLate,      ///< the camera's answers to commands
  kXmlDamaged,       ///< the camera's description of itself
  kRegionRefused,    ///< the camera rejects every region
  kTriggersIgnored,  ///< acknowledged and without effect
  kLateFrame,        ///< the display shows what the screen held at the exposure before
  kFrozenDisplay,    ///< the display keeps what it shows
  kCoveredDisplay,   ///< a window of another program lies over its middle
  kMirroredDisplay,  ///< left and right are exchanged
  kRotatedDisplay,   ///< by 180 deg
  kExposure,         ///< the camera exposes longer by a factor
  kGain,             ///< the camera's gain is off by a factor
  kBrightness,       ///< the display's light is off by a factor
  kBumped,           ///< the display has been displaced
  kRailStalled,      ///< the next move of an axis stalls
  kRailMoved,        ///< the carriage of an axis has been displaced by hand
  kBenchExit,        ///< the program ends at once, with exit code 3
};

/// Names the span for which a fault lasts.
enum class FaultSpan { kOnce, kFrames, kSeconds };

struct FaultRule {
  std::string_view name;
  FaultKind kind;
  FaultSpan span;
  bool has_axis = false;
  std::string_view value_key = {};
  mission::Range value_range = {};
  std::string_view second_key = {};  ///< key of a second number with the same range
};

inline constexpr mission::Range kFraction{0.0, 1.0};
inline constexpr mission::Range kFactor{0.0, 10.0};
inline constexpr mission::Range kMicrometres{-1e5, 1e5};

inline constexpr std::array<FaultRule, 21> kFaultRules{{
    {"camera_away", FaultKind::kCameraAway, FaultSpan::kSeconds},
    {"camera_busy", FaultKind::kCameraBusy, FaultSpan::kSeconds},
    {"packet_loss", FaultKind::kPacketLoss, FaultSpan::kSeconds, false, "fraction", kFraction},
    {"packets_doubled", FaultKind::kPacketsDoubled, FaultSpan::kSeconds, false, "fraction", kFraction},
    {"packets_reordered", FaultKind::kPacketsReordered, FaultSpan::kSeconds, false, "fraction", kFraction},
    {"answers_late", FaultKind::kAnswersLate, FaultSpan::kSeconds, false, "by_ms", {0.0, 60000.0}},
    {"xml_damaged", FaultKind::kXmlDamaged, FaultSpan::kSeconds},
    {"region_refused", FaultKind::kRegionRefused, FaultSpan::kSeconds},
    {"triggers_ignored", FaultKind::kTriggersIgnored, FaultSpan::kOnce, false, "count", {1.0, 1e6}},
    {"late_frame", FaultKind::kLateFrame, FaultSpan::kFrames},
    {"frozen_display", FaultKind::kFrozenDisplay, FaultSpan::kFrames},
    {"covered_display", FaultKind::kCoveredDisplay, FaultSpan::kFrames},
    {"mirrored_display", FaultKind::kMirroredDisplay, FaultSpan::kFrames},
    {"rotated_display", FaultKind::kRotatedDisplay, FaultSpan::kFrames},
    {"exposure", FaultKind::kExposure, FaultSpan::kFrames, false, "factor", kFactor},
    {"gain", FaultKind::kGain, FaultSpan::kFrames, false, "factor", kFactor},
    {"brightness", FaultKind::kBrightness, FaultSpan::kFrames, false, "factor", kFactor},
    {"bumped", FaultKind::kBumped, FaultSpan::kOnce, false, "x_um", kMicrometres, "y_um"},
    {"rail_stalled", FaultKind::kRailStalled, FaultSpan::kOnce, true},
    {"rail_moved", FaultKind::kRailMoved, FaultSpan::kOnce, true, "by_um", kMicrometres},
    {"bench_exit", FaultKind::kBenchExit, FaultSpan::kOnce},
}};

constexpr const FaultRule& rule_of(FaultKind kind) {
  return emulators::fault_rule_of(kFaultRules, kind);
}

struct Fault {
  FaultKind kind = FaultKind::kBenchExit;
  /// Number of the exposure, from 0, before which it is injected; empty: at once.
  std::optional<std::uint64_t> frame = std::nullopt;
  std::uint64_t frames = 0;  ///< number of exposures that it lasts for; 0: until the end
  double duration_s = 0.0;   ///< 0: until the end
  std::size_t axis = 0;      ///< from 0
  double value = 0.0, second = 0.0;
};

/// Reads the keys kind, frame, frames, duration_s, axis, ... of a table and finishes it. Throws MissionError.
[[nodiscard]] Fault read_fault(const mission::TableReader& section);
/// Reads a fault from one line of JSON. Throws MissionError.
[[nodiscard]] Fault fault_from_json(const std::string& line);

}  // namespace vbar::optical_stimulator::bench
