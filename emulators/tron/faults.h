#pragma once
// Faults of the emulator, as its control line and its files name them: {"kind": "emergency_stop", "robot": "camera"}.
//
// A fault is due at once, when exposure number `at_image` (from 0) is the next one, or in robot cycle `at_cycle`; it
// begins `after_cycles` robot cycles later.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/common/faults.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::tron::bench {

enum class FaultKind {
  // Robots.
  kEmergencyStop,  ///< pressed, and released after its time
  kDrivesOff,      ///< with a stop message
  kAxesFrozen,     ///< the positions stated keep their values while the arm moves
  kRsiSilent,      ///< the controller sends nothing
  kAnswersLost,    ///< answers do not reach the controller: its Delay grows
  kIpocBack,       ///< the controller's time stamp jumps back
  kRsiDropped,     ///< RSI ends
  // Motion capture.
  kViconHidden,  ///< an object is missing from the frames
  kViconZeros,   ///< all numbers of an object are zero
  kViconFrozen,  ///< an object keeps its numbers
  kViconOffset,  ///< an object is displaced
  // Lights.
  kLampOut,
  kBoxOut,
  kMountSlipped,  ///< the mock-up slips along its x, for good
  // Camera.
  kCameraAway,  ///< does not answer and sends nothing
  kCameraBusy,  ///< another program has control of it
  kPacketLoss,  ///< packets of images are lost at random
  kPacketsDoubled,
  kPacketsReordered,
  kTriggersIgnored,  ///< acknowledged and without effect
  kFramesLost,       ///< exposed and never sent
  kFramesStale,      ///< the frame before is sent instead, with its time stamp
  kExposure,         ///< longer by a factor
  kGain,             ///< off by a factor
  kBenchExit,        ///< the program ends at once, with exit code 3
};

/// Names the span for which a fault lasts; each span has its key, and 0 lasts until the end.
enum class FaultSpan {
  kOnce,
  kImages,   ///< `images`: exposures
  kCycles,   ///< `cycles` of the robots
  kSeconds,  ///< `duration_s` of wall clock: bench time may stand still meanwhile
};

/// Names the effect at which a fault is acknowledged.
enum class FaultEffect {
  kAtOnce,
  kExposure,    ///< after an exposure that it has changed
  kViconFrame,  ///< after a frame of motion capture that it has changed
};

struct FaultRule {
  std::string_view name;
  FaultKind kind;
  FaultSpan span;
  FaultEffect effect = FaultEffect::kAtOnce;
  std::string_view subject_key = {};  ///< "robot" or "object": "camera" or "target"; "box": 1 to 10
  std::string_view value_key = {};
  mission::Range value_range = {};
};

inline constexpr mission::Range kCount{1.0, 1e6};
inline constexpr mission::Range kFraction{0.0, 1.0};
inline constexpr mission::Range kFactor{0.0, 10.0};
inline constexpr mission::Range kMillimetres{-1e3, 1e3};

inline constexpr std::array<FaultRule, 25> kFaultRules{{
    {"emergency_stop", FaultKind::kEmergencyStop, FaultSpan::kSeconds, FaultEffect::kAtOnce, "robot"},
    {"drives_off", FaultKind::kDrivesOff, FaultSpan::kOnce, FaultEffect::kAtOnce, "robot"},
    {"axes_frozen", FaultKind::kAxesFrozen, FaultSpan::kCycles, FaultEffect::kAtOnce, "robot"},
    {"rsi_silent", FaultKind::kRsiSilent, FaultSpan::kOnce, FaultEffect::kAtOnce, "robot", "cycles", kCount},
    {"answers_lost", FaultKind::kAnswersLost, FaultSpan::kOnce, FaultEffect::kAtOnce, "robot", "cycles", kCount},
    {"ipoc_back", FaultKind::kIpocBack, FaultSpan::kOnce, FaultEffect::kAtOnce, "robot", "by_ms", {1.0, 1e9}},
    {"rsi_dropped", FaultKind::kRsiDropped, FaultSpan::kOnce, FaultEffect::kAtOnce, "robot"},
    {"vicon_hidden", FaultKind::kViconHidden, FaultSpan::kImages, FaultEffect::kViconFrame, "object"},
    {"vicon_zeros", FaultKind::kViconZeros, FaultSpan::kImages, FaultEffect::kViconFrame, "object"},
    {"vicon_frozen", FaultKind::kViconFrozen, FaultSpan::kImages, FaultEffect::kViconFrame, "object"},
    {"vicon_offset", FaultKind::kViconOffset, FaultSpan::kImages, FaultEffect::kViconFrame, "object", "by_mm",
     kMillimetres},
    {"lamp_out", FaultKind::kLampOut, FaultSpan::kImages, FaultEffect::kExposure},
    {"box_out", FaultKind::kBoxOut, FaultSpan::kImages, FaultEffect::kExposure, "box"},
    {"mount_slipped", FaultKind::kMountSlipped, FaultSpan::kOnce, FaultEffect::kAtOnce, {}, "by_mm", kMillimetres},
    {"camera_away", FaultKind::kCameraAway, FaultSpan::kSeconds},
    {"camera_busy", FaultKind::kCameraBusy, FaultSpan::kSeconds},
    {"packet_loss", FaultKind::kPacketLoss, FaultSpan::kImages, FaultEffect::kAtOnce, {}, "fraction", kFraction},
    {"packets_doubled",
     FaultKind::kPacketsDoubled,
     FaultSpan::kImages,
     FaultEffect::kAtOnce,
     {},
     "fraction",
     kFraction},
    {"packets_reordered",
     FaultKind::kPacketsReordered,
     FaultSpan::kImages,
     FaultEffect::kAtOnce,
     {},
     "fraction",
     kFraction},
    {"triggers_ignored", FaultKind::kTriggersIgnored, FaultSpan::kOnce, FaultEffect::kAtOnce, {}, "count", kCount},
    {"frames_lost", FaultKind::kFramesLost, FaultSpan::kOnce, FaultEffect::kAtOnce, {}, "count", kCount},
    {"frames_stale", FaultKind::kFramesStale, FaultSpan::kOnce, FaultEffect::kAtOnce, {}, "count", kCount},
    {"exposure", FaultKind::kExposure, FaultSpan::kImages, FaultEffect::kExposure, {}, "factor", kFactor},
    {"gain", FaultKind::kGain, FaultSpan::kImages, FaultEffect::kExposure, {}, "factor", kFactor},
    {"bench_exit", FaultKind::kBenchExit, FaultSpan::kOnce},
}};

constexpr const FaultRule& rule_of(FaultKind kind) {
  return emulators::fault_rule_of(kFaultRules, kind);
}

struct Fault {
  FaultKind kind = FaultKind::kBenchExit;
  std::optional<std::uint64_t> at_image = std::nullopt, at_cycle = std::nullopt;  ///< at most one of them
  std::uint64_t after_cycles = 0;
  std::uint64_t images = 0, cycles = 0;  ///< that it lasts for
  double duration_s = 0.0;
  bool is_of_target = false;  ///< robot or object: of the target, else of the camera
  std::size_t box = 0;        ///< from 0
  double value = 0.0;
};

/// Reads the keys of a table and finishes it. Throws MissionError.
[[nodiscard]] Fault read_fault(const mission::TableReader& section);
/// Reads a fault from one line of JSON. Throws MissionError.
[[nodiscard]] Fault fault_from_json(const std::string& line);
/// Reads a file with a JSON object a line; empty lines are ignored. Throws MissionError that names file and line.
[[nodiscard]] std::vector<Fault> read_fault_file(const std::filesystem::path& file);

// Faults of a session: each begins when it is due, lasts for its images, cycles or seconds, and is acknowledged
// when it has taken effect, on the control line and as one line of JSON in a file.

class FaultList {
 public:
  /// Lets a fault begin or end. A fault of FaultSpan::kOnce only begins.
  using Act = std::function<void(const Fault& fault, bool is_on)>;

  /// Opens `file`, which gets a line for each fault that took effect. Throws std::runtime_error if it cannot be made.
  FaultList(Act act, const std::filesystem::path& file);

  /// Adds a fault. `now_s`: wall clock, the same in all calls.
  void add(const Fault& fault, double now_s, emulators::Acknowledge acknowledge = {});

  /// Begins the faults that are due before a robot cycle, from 1.
  void begin_cycle(std::uint64_t cycle, double now_s);
  /// Counts the exposure with this number, from 0, after it has ended.
  void end_exposure(std::uint64_t image, double now_s);
  /// Counts a frame of motion capture, after it was sent.
  void vicon_frame_sent();
  /// Ends faults whose seconds have passed, in between.
  void advance(double now_s);

 private:
  enum class Phase { kWaiting, kDue, kActive, kOver };
  struct Entry {
    Fault fault;
    emulators::Acknowledge acknowledge;
    Phase phase = Phase::kWaiting;
    bool is_acknowledged = false;
    std::uint64_t due_cycle = 0, begun_cycle = 0, begun_image = 0;
    double begun_s = 0.0;
  };
  void step(Entry& entry, double now_s);
  void begin(Entry& entry, double now_s);
  void end(Entry& entry);
  [[nodiscard]] bool is_due(const Fault& fault) const;
  [[nodiscard]] bool is_over(const Entry& entry, double now_s) const;
  void take_effect(FaultEffect effect);
  void acknowledge(Entry& entry);

  Act act_;
  emulators::FaultLog log_;
  std::vector<Entry> entries_;
  std::uint64_t cycle_ = 0;  ///< the present one
  std::uint64_t image_ = 0;  ///< number of the next exposure
};

}  // namespace vbar::tron::bench
