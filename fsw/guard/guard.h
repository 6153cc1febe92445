#pragma once
// The safety monitor: a second judgement of the approach that can only demand the retreat.
//
// It uses images, the attitude, the codes of both receivers, the commanded and the reported burns. Its range and range
// rate (range_filter.h), its record of burns and its timer of outages are its own: no estimate of navigation enters
// them. The range that navigation states is compared with the monitor's own, and selects when to compare.
//
// It shares with navigation (fsw/gnc/guard_feed.h): the inbox and its image assembly, the decoded epochs of the
// receivers and the store of ephemerides (GnssFrontEnd), single_point(), the Earth orientation that was telecommanded,
// and the telecommanded camera parameters. An error in one of these may therefore affect both. The image range uses
// none of the GNSS parts, and the attitude only for the phase angle.

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

/// Holds the judgement of a quantity in a step; it is not checked without data.
struct Verdict {
  bool is_checked = false;
  bool is_alarm = false;
  double value = 0.0;
};

/// Holds all verdicts of a step.
struct GuardVerdicts {
  Verdict range;    ///< logarithm of the image's range over that of navigation, nearer than kCompareWithin_m
  Verdict silence;  ///< time since the last image of the target or code baseline, s, eclipse included
  Verdict burns;    ///< difference of a burn from its command, share of the command
  Verdict closing;  ///< range rate, m/s
};

class Guard {
 public:
  /// Distance, m, by either of them, inside which the range of navigation is compared with that of an image.
  static constexpr double kCompareWithin_m = 150.0;
  /// Largest logarithm of the ratio: 0.45 to 2.2 times. Attitude and phase of the target scatter it by 0.2 (1 sigma),
  /// correlated over minutes.
  static constexpr double kLargestLogarithm = 0.8;
  /// Duration, s, for which every image must contradict navigation: attitude and phase change the lit area for minutes,
  /// and in penumbra the target is too dim to be measured.
  static constexpr double kLongestDisagreement_s = 300.0;
  /// Smallest number of these images: of images every five minutes, two in a row show similar attitudes.
  static constexpr std::int64_t kFewestDisagreeing = 5;

  /// Shortest distance at which codes are compared: nearer, the errors of two solutions are a large share of it.
  static constexpr double kCodeComparedFrom_m = 20.0;

  /// Share of the timeout in sunlight after which a silence is an alarm. An eclipse of 35 minutes, and the time for
  /// which the camera then sees the unlit side of the target, are longer than the timeout without any fault.
  static constexpr double kLitShare = 0.5;
  /// Time, s, for which a position in the shadow of the Earth is valid.
  static constexpr double kShadowHolds_s = 120.0;

  void configure(const GuardSettings& settings) { settings_ = settings; }

  /// Processes an image that is exposed for a resolved target. `navigation_range_m` is what navigation states; 0:
  /// unknown.
  void take_image(GpsTime time, const imaging::ImageView& image, const GuardCamera& camera,
                  const Illumination& illumination, double navigation_range_m);

  /// Processes the distance of the single-point solutions of both receivers, m. Its error is decimetres to metres: it
  /// is compared beyond kCodeComparedFrom_m only, and does not update range and rate, which are those of images.
  void take_code_baseline(GpsTime time, double range_m, double navigation_range_m);

  /// Notes whether the code solution of the servicer is outside the shadow of the Earth. Without it, all time counts as
  /// sunlit.
  void take_sunlight(GpsTime time, bool is_sunlit);

  void take_command(std::int32_t maneuver_id, const Vector3& dv_rtn);
  /// Compares a burn that was executed with its command.
  void take_report(std::int32_t maneuver_id, const Vector3& dv_rtn);

  /// Returns the verdicts on the data since the last call.
  GuardVerdicts judge(GpsTime now);

  [[nodiscard]] const RangeFilter& range() const { return range_; }
  [[nodiscard]] std::optional<GpsTime> seen() const { return seen_; }

 private:
  struct Command {
    std::int32_t id = -1;
    Vector3 dv_rtn = Vector3::Zero();
  };

  /// Describes a sequence of images that all contradict navigation.
  struct Disagreement {
    GpsTime first;
    GpsTime last;
    std::int64_t count = 0;
  };
  // The type has no padding, which a copy might take from the stack into a snapshot.
  static_assert(std::has_unique_object_representations_v<Disagreement>);
  [[nodiscard]] bool disagrees(GpsTime time, double logarithm);
  void see(GpsTime time);
  void count_sunlight(GpsTime now);
  /// Compares a range with that of navigation. Returns false far from the target, or without a range of navigation.
  bool compare(GpsTime time, double range_m, double navigation_range_m);

  static constexpr std::size_t kCommands = 16;

  GuardSettings settings_;
  RangeFilter range_;
  /// Time of the last image with a lit target, whether its size gives a range or not, or of the last code baseline.
  std::optional<GpsTime> seen_;
  std::optional<GpsTime> in_shadow_;  ///< time of the newest position of the servicer, if it is in the shadow
  double lit_s_ = 0.0;                ///< time in sunlight from `seen_` to `counted_until_`
  GpsTime counted_until_;
  std::optional<Disagreement> disagreement_;
  GuardVerdicts pending_;
  std::array<Command, kCommands> commands_{};
  std::size_t next_command_ = 0;
};

}  // namespace vbar::fsw::guard
