#pragma once
// The safety monitor: a second judgement of the approach that can only demand the retreat.
//
// It uses images, the attitude, the codes of both receivers, the commanded and the reported burns. Its range and range
// rate, its record of burns and its timer of outages are its own: no estimate of navigation enters
// them. The range that navigation states is compared with the monitor's own, and selects when to compare.
//
// It shares with navigation (fsw/fdir/safety_monitor_inputs.h): the inbox and its image assembly, the decoded epochs of
// the receivers and the store of ephemerides (GnssFrontEnd), single_point(), the Earth orientation that was
// telecommanded, and the telecommanded camera parameters. An error in one of these may therefore affect both. The image
// range uses none of the GNSS parts, and the attitude only for the phase angle.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/vision/imaging/image.h"

namespace vbar::fsw::fdir {

// Range and range rate of the safety monitor: an alpha-beta filter of the logarithm of the range, without a covariance.
// Attitude and phase of the target change its apparent size by a third within minutes, hence the memory of minutes.

class RangeFilter {
 public:
  /// Adds a range, m, at `time`. A range that is not later than the last one is ignored.
  void add(GpsTime time, double range_m);

  [[nodiscard]] bool is_known() const { return samples_ > 0; }
  /// Returns whether the data span twice the memory, so that the rate is valid.
  [[nodiscard]] bool has_rate() const { return seconds(last_ - first_) > 2.0 * kMemory_s; }
  [[nodiscard]] GpsTime last() const { return last_; }
  [[nodiscard]] double range_m(GpsTime time) const;
  [[nodiscard]] double range_rate(GpsTime time) const { return range_m(time) * rate_; }  ///< m/s

  static constexpr double kMemory_s = 300.0;
  /// Longest gap: after a longer one the filter is re-initialised by the next range.
  static constexpr double kLongestGap_s = 600.0;

 private:
  GpsTime first_;
  GpsTime last_;
  int samples_ = 0;
  double logarithm_ = 0.0;  ///< logarithm of the range in m
  double rate_ = 0.0;       ///< rate of the logarithm, 1/s
};

// Range of the safety monitor, from the lit area of the target in an image. It uses neither the shape nor the attitude
// of the target: the square root of the mean silhouette area, which the attitude changes by a tenth, and the share that
// the Sun lights at a phase angle, as on a sphere: (1 + cos(phase)) / 2.

/// Holds the parameters of a camera that the safety monitor needs.
struct SafetyMonitorCamera {
  double focal_length_px = 0.0;
  double dark_level_dn = 0.0;  ///< level of a pixel without light
  double noise_dn = 0.0;       ///< noise of such a pixel, 1 sigma
};

/// Holds the directions of light and line of sight: unit vectors in one frame.
struct Illumination {
  Vector3 line_of_sight = Vector3::UnitZ();  ///< from the servicer to the target
  Vector3 to_sun = Vector3::UnitX();
};

/// Counts the lit pixels of an image, and states whether they touch its rim. The count is 0 if the brightest pixels are
/// hardly brighter than the noise, as in penumbra.
struct LitArea {
  int pixels = 0;
  bool is_cut = false;
};

/// Counts the pixels brighter than a twelfth of the brightest ones, so that neither exposure nor penumbra has an
/// effect: white and dark surfaces of a target differ by about that factor.
LitArea lit_area(const imaging::ImageView& image, const SafetyMonitorCamera& camera);

/// Returns the range, m. Returns nothing for fewer lit pixels than a shape needs, a target cut by the rim, or a phase
/// angle beyond 90 deg, where at most a crescent is lit.
std::optional<double> range_from_size(const LitArea& area, const SafetyMonitorCamera& camera,
                                      const Illumination& illumination, double target_size_m);

struct SafetyMonitorSettings {
  double target_size_m = 0.0;  ///< square root of the mean silhouette area
  /// Longest time without the target in an image or a code baseline, unless most of it was an eclipse
  /// (SafetyMonitor::kLitShare).
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
struct SafetyMonitorVerdicts {
  Verdict range;    ///< logarithm of the image's range over that of navigation, nearer than kCompareWithin_m
  Verdict silence;  ///< time since the last image of the target or code baseline, s, eclipse included
  Verdict burns;    ///< difference of a burn from its command, share of the command
  Verdict closing;  ///< range rate, m/s
};

class SafetyMonitor {
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

  void configure(const SafetyMonitorSettings& settings) { settings_ = settings; }

  /// Processes an image that is exposed for a resolved target. `navigation_range_m` is what navigation states; 0:
  /// unknown.
  void take_image(GpsTime time, const imaging::ImageView& image, const SafetyMonitorCamera& camera,
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
  SafetyMonitorVerdicts judge(GpsTime now);

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

  SafetyMonitorSettings settings_;
  RangeFilter range_;
  /// Time of the last image with a lit target, whether its size gives a range or not, or of the last code baseline.
  std::optional<GpsTime> seen_;
  std::optional<GpsTime> in_shadow_;  ///< time of the newest position of the servicer, if it is in the shadow
  double lit_s_ = 0.0;                ///< time in sunlight from `seen_` to `counted_until_`
  GpsTime counted_until_;
  std::optional<Disagreement> disagreement_;
  SafetyMonitorVerdicts pending_;
  std::array<Command, kCommands> commands_{};
  std::size_t next_command_ = 0;
};

}  // namespace vbar::fsw::fdir
