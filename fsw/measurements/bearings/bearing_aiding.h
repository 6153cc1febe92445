#pragma once
// Bearings of a camera as an aid of the filter: the initial relative orbit from a batch with the a-priori orbit, then
// rows at each image.

#include <cstdint>
#include <optional>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/measurements/aid.h"
#include "fsw/measurements/bearings/bearing_batch.h"
#include "fsw/measurements/bearings/kept_orbit.h"
#include "fsw/measurements/bearings/orbit_hypotheses.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/target_tracking/bearing.h"

namespace vbar::fsw::measurements {

// Measurement model of a bearing: rows of the filter.

struct BearingModel {
  /// 1 sigma, m, per axis, at a phase angle of 90 deg (target_tracking::centroid_scatter_growth): centroid of the
  /// target's light about its mean, independent from image to image (its attitude and illumination change meanwhile).
  /// In metres it is the same at all ranges: negligible beyond 30 km, most of the error within 10 km.
  double centroid_noise_m = 0.08;
  double scatter = 1.0;  ///< factor on the variance of a bearing, as its innovations show it

  bool operator==(const BearingModel&) const = default;
};

/// Fills the batch with the two components of the measured direction across the predicted one (bearing_axes(), rad).
/// The filter stands at the time of the bearing. Any status of the orbit conversions if there is no target to predict.
///
/// Model: axes (rho + offset s + earthlight e - o) / |...| + growth wander / |...| + bearing bias; s and e are the
/// displacements of unit offsets towards the Sun and the Earth, and `growth` that of the scatter of the centroid with
/// the phase angle. rho is sampled over the ROE, all others enter linearly.
Status bearing_rows(const filter::RelativeNavigationFilter& filter, const target_tracking::BearingMeasurement& bearing,
                    const Vector3& sun_eci, const BearingModel& model, filter::MeasurementBatch& batch);

struct BearingSettings {
  BearingModel model;
  measurements::BearingBatchSettings batch;
  double gate = 13.8;  ///< of the normalised innovation squared: 99.9 % of two degrees of freedom

  bool operator==(const BearingSettings&) const = default;
};

/// Edit status of a bearing; numbers of telemetry_image, edit status.
enum class BearingEditStatus : std::uint8_t { kNone, kRejected, kFilter, kBatch };

/// Result of one bearing. Residuals in rad, in the rows of bearing_axes().
struct BearingUpdate {
  Vector2 prefit = Vector2::Zero();
  Vector2 postfit = Vector2::Zero();
  double nis = 0.0;
};

struct BearingCounters {
  std::int32_t used = 0;
  std::int32_t rejected = 0;
  std::int32_t batches_failed = 0;
  std::int32_t revisions = 0;  ///< of the orbit, after bearings that an unknown burn explains and scatter does not
  std::int32_t restarts = 0;   ///< of the batch, after the orbit had been initialised
  std::int32_t returns = 0;    ///< to the orbit before a revision or restart, which was that of another satellite
};

class BearingAiding {
 public:
  static constexpr filter::MeasurementSource kSource{.bit = navigation_configuration::kUseBearings,
                                                     .confirms_orbit = true};

  /// Replaces the settings; a batch being collected stays unless its settings change.
  void configure(const BearingSettings& settings);

  /// Processes the bearing of an image; the filter stands at its time. Must be called for images without a bearing too,
  /// so that the burns since the last image enter the batch.
  BearingEditStatus process(GpsTime time, const std::optional<target_tracking::BearingMeasurement>& bearing,
                            const Vector3& sun_eci, filter::RelativeNavigationFilter& filter);

  /// Notes that nothing was measured until `now`: the state follows the age of the last accepted bearing.
  void check_age(GpsTime now);

  /// Responds to innovations whose mean normalised square, per degree of freedom, has left its band above: white ones
  /// are scatter of the bearings, which get more of it; of others the orbit lags, whose covariance grows, where the
  /// last bearing determines it: across the line of sight and in what is correlated with it.
  void explain_excess(double mean_nis, filter::RelativeNavigationFilter& filter);

  /// The orbit before the first bearings that contradicted it and led to another one, at the epoch of the filter.
  const KeptOrbit& kept_at_epoch(const filter::RelativeNavigationFilter& filter);
  /// Returns to that orbit: what has been observed since is another satellite.
  void return_to_kept(GpsTime now, filter::RelativeNavigationFilter& filter);

  /// Deactivates the own blocks; the orbit stays.
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter);

  [[nodiscard]] const Aid& aid() const { return aid_; }
  [[nodiscard]] Aid& aid() { return aid_; }
  [[nodiscard]] const BearingUpdate& last_update() const { return last_update_; }
  [[nodiscard]] GpsTime last_accepted() const { return last_accepted_; }
  [[nodiscard]] const BearingCounters& counters() const { return counters_; }

 private:
  void follow_burns(const filter::RelativeNavigationFilter& filter);
  void activate_blocks(filter::RelativeNavigationFilter& filter) const;
  void deactivate_blocks(filter::RelativeNavigationFilter& filter) const;
  BearingEditStatus collect(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                            filter::RelativeNavigationFilter& filter);
  BearingEditStatus process_measurement(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                                        filter::RelativeNavigationFilter& filter);
  Status predict(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                 filter::RelativeNavigationFilter& filter);
  void forget_centroid(filter::RelativeNavigationFilter& filter);
  void adapt_noise(const target_tracking::BearingMeasurement& bearing, const filter::MeasurementBatch& batch,
                   filter::RelativeNavigationFilter& filter);
  void adapt_centroid_noise(const filter::RelativeNavigationFilter& filter);
  void adapt_scatter();
  void note_correlation(const target_tracking::BearingMeasurement& bearing, const filter::MeasurementBatch& batch);
  void count_rejection(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                       filter::RelativeNavigationFilter& filter);
  void add_to_window(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                     const filter::RelativeNavigationFilter& filter);
  void close_window();
  [[nodiscard]] EstimatedOrbit estimated_orbit(const filter::RelativeNavigationFilter& filter,
                                               const Vector3& sun_eci) const;
  void weigh_window(GpsTime time, const Vector3& sun_eci, filter::RelativeNavigationFilter& filter);
  void restart_batch(GpsTime time, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] BearingModel model_now() const;

  BearingSettings settings_;
  Aid aid_;
  measurements::BearingBatch batch_;
  KeptOrbit kept_;
  GpsTime burns_until_;  ///< impulses of the filter before this are in the batch
  GpsTime last_accepted_;
  GpsTime last_processed_;
  std::optional<target_tracking::BearingMeasurement> last_bearing_;  ///< the last one processed
  Vector3 last_sun_eci_ = Vector3::UnitX();
  GpsTime before_window_;       ///< the last accepted bearing before the window
  int rejected_in_window_ = 0;  ///< of the bearings in the batch, which since the first of them is a window of evidence
  int agreeing_in_window_ = 0;  ///< consecutive ones at its end that agree with the orbit as estimated
  int rejected_in_excess_ = 0;  ///< rejections in excess of accepted ones, while others confirm the orbit
  int agreeing_in_a_row_ = 0;   ///< while contradicting
  double scatter_ = 1.0;        ///< BearingModel::scatter
  double correlation_ = 0.0;    ///< of neighbouring normalised innovations: mean product,
  double mean_square_ = 1.0;    ///< and mean square, over some Consistency::kMemory bearings
  Vector2 last_normalised_ = Vector2::Zero();
  double centroid_scale_ =
      1.0;  ///< factor on the variances of the centroid, adapted while receivers determine the orbit
  BearingUpdate last_update_;
  BearingCounters counters_;
};

}  // namespace vbar::fsw::measurements
