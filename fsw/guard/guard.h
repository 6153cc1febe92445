#pragma once
// The guard: a second opinion that shares nothing with navigation and can only demand the retreat.
//
// Of the sensors it uses images, the attitude and the codes of both receivers, of guidance the burns commanded, of
// actuators the burns reported. It has its own range and range rate (range_filter.h), its own record of burns and its
// own timer of outages. What navigation states is compared with them, and used for nothing else.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/guard/apparent_size.h"
#include "fsw/guard/range_filter.h"

namespace vbar::fsw::guard {

struct GuardSettings {
  double target_size_m = 0.0;  ///< square root of the mean silhouette area
  /// Longest time without the target in an image or a code baseline, unless most of it was an eclipse
  /// (Guard::kLitShare).
  double data_timeout_s = 0.0;
  double data_timeout_range_m = 0.0;  ///< inside this range
};

/// A quantity that was judged in a step; nothing to judge: not checked.
struct Verdict {
  bool is_checked = false;
  bool is_alarm = false;
  double value = 0.0;
};

/// All verdicts of a step.
struct GuardVerdicts {
  Verdict range;  ///< logarithm of the guard's range of an image over that of navigation, nearer than kCompareWithin_m
  Verdict silence;  ///< time since the target was last seen or its receiver heard, s, eclipse included
  Verdict burns;    ///< difference of a burn from its command, share of the command
  Verdict closing;  ///< range rate, m/s
};

class Guard {
 public:
  /// Navigation's range is compared with that of an image inside this distance, m, by either.
  static constexpr double kCompareWithin_m = 150.0;
  /// Largest logarithm of the ratio: 0.45 to 2.2 times. Attitude and phase of the target scatter it by 0.2 (1 sigma)
  /// and for minutes alike.
  static constexpr double kLargestLogarithm = 0.8;
  /// Every image must contradict navigation for this long, s: attitude and phase change the lit area for minutes alike,
  /// and in penumbra the target is too dim to be measured.
  static constexpr double kLongestDisagreement_s = 300.0;
  /// At least this number of images: of those taken every five minutes, two in a row see similar attitudes.
  static constexpr std::int64_t kFewestDisagreeing = 5;

  /// Nearer than this, the errors of two code solutions are a large share of their distance.
  static constexpr double kCodeComparedFrom_m = 20.0;

  /// A silence is an alarm once this share of the timeout was in sunlight as well: an eclipse of 35 minutes and the
  /// time for which the target then turns its dark side to the camera are longer than the timeout, without any fault.
  static constexpr double kLitShare = 0.5;
  /// A position in the shadow of the Earth holds this long, s.
  static constexpr double kShadowHolds_s = 120.0;

  void configure(const GuardSettings& settings) { settings_ = settings; }

  /// An image in which a resolved target is exposed properly. `navigation_range_m`: what navigation states, 0 nothing.
  void take_image(GpsTime time, const imaging::ImageView& image, const GuardCamera& camera,
                  const Illumination& illumination, double navigation_range_m);

  /// Distance of the single-point solutions of both receivers, m: decimetres to metres, hence compared beyond
  /// kCodeComparedFrom_m only. Range and rate are those of images alone.
  void take_code_baseline(GpsTime time, double range_m, double navigation_range_m);

  /// Whether the own receiver's code solution is outside the shadow of the Earth. Without any, all time counts as lit.
  void take_sunlight(GpsTime time, bool is_sunlit);

  void take_command(std::int32_t maneuver_id, const Vector3& dv_rtn);
  /// A burn that was executed, whatever was commanded.
  void take_report(std::int32_t maneuver_id, const Vector3& dv_rtn);

  /// The verdicts on all that was taken since the last call.
  GuardVerdicts judge(GpsTime now);

  [[nodiscard]] const RangeFilter& range() const { return range_; }
  [[nodiscard]] std::optional<GpsTime> seen() const { return seen_; }

 private:
  struct Command {
    std::int32_t id = -1;
    Vector3 dv_rtn = Vector3::Zero();
  };

  /// Images that contradict navigation, without one between them that does not.
  struct Disagreement {
    GpsTime first;
    GpsTime last;
    std::int64_t count = 0;
  };
  // Without padding, which a copy may take from the stack into a snapshot.
  static_assert(std::has_unique_object_representations_v<Disagreement>);
  [[nodiscard]] bool disagrees(GpsTime time, double logarithm);
  void see(GpsTime time);
  void count_sunlight(GpsTime now);
  /// False if there is nothing to compare: far from the target, or no range of navigation.
  bool compare(GpsTime time, double range_m, double navigation_range_m);

  static constexpr std::size_t kCommands = 16;

  GuardSettings settings_;
  RangeFilter range_;
  /// The last image with a lit target, whether its size gives a range or not, or the last code baseline.
  std::optional<GpsTime> seen_;
  std::optional<GpsTime> in_shadow_;  ///< the newest own position, if it is in the shadow
  double lit_s_ = 0.0;                ///< in sunlight, from `seen_` to `counted_until_`
  GpsTime counted_until_;
  std::optional<Disagreement> disagreement_;
  GuardVerdicts pending_;
  std::array<Command, kCommands> commands_{};
  std::size_t next_command_ = 0;
};

}  // namespace vbar::fsw::guard
