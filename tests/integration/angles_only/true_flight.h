#pragma once
// The angles-only rendezvous as it truly goes, 75 km to 100 m in 36 h, under all forces and burns flown before; and
// what a camera and a GNSS receiver would tell of it, without images.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "fsw/filter/propagation.h"
#include "fsw/measurements/bearings/bearing_aiding.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::test {

inline constexpr double kTargetRadius_m = 0.35;

/// The truth at an image's time.
struct TrueEpoch {
  fsw::GpsTime time;
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();  ///< unit vector
  bool is_target_lit = true;
  /// Where the servicer was at 10 s steps since the last image.
  std::array<std::pair<fsw::GpsTime, fsw::Vector3>, 6> receiver{};
};

struct TrueFlight {
  std::vector<TrueEpoch> epochs;
  std::vector<fsw::filter::Burn> burns;
  fsw::orbit::EarthOrientation earth;

  /// Index in `epochs` of hours after the start.
  static std::size_t at_hours(double hours) { return static_cast<std::size_t>(hours * 60.0 + 0.5); }
};

/// From waypoint 0 on, an epoch a minute. `all_forces`: drag, sunlight, Sun, Moon, tides beside 60x60 gravity.
TrueFlight fly_truly(double hours, bool all_forces = true);

/// 1-sigma figures of the sensors.
struct SensorErrors {
  double bearing_arcsec = 12.0;  ///< each axis, white
  double bias_arcsec = 3.0;      ///< length, constant in bearing_axes(), direction from the seed
  double shape_share = 0.1;      ///< of the apparent radius, what the turning shape moves its centroid
  double shape_time_s = 300.0;
  double brightness_offset_m = 0.1;  ///< mean and half of it 1 sigma over seeds
  double gnss_white_m = 1.5;         ///< each axis, at 10 s
  double gnss_slow_m = 1.5;          ///< the same, correlated over half an hour
  double burn_relative = 0.0;        ///< of a burn's size, each axis: what is known of it against what was flown
  double outlier_share = 0.0;        ///< of bearings, to somewhere within a degree
};

/// What receiver and camera measured since the last image.
struct MeasuredEpoch {
  fsw::GpsTime time;  ///< of the image
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();
  std::vector<std::pair<fsw::GpsTime, fsw::filter::AbsolutePosition>> positions;
  std::optional<fsw::target_tracking::BearingMeasurement> bearing;
};

/// Measured epochs in order of time.
class SimulatedSensors {
 public:
  SimulatedSensors(const TrueFlight& flight, const SensorErrors& errors, unsigned seed);

  MeasuredEpoch measure(std::size_t index);
  /// Two-line-element quality: 1 sigma a * (da, dl, de, di) of 30, 1000, 200, 200 m.
  fsw::filter::TargetApriori apriori();
  /// As flight software has them.
  const std::vector<fsw::filter::Burn>& known_burns() const { return known_burns_; }

 private:
  double normal() { return standard_(random_); }
  fsw::Vector3 normal3() { return {normal(), normal(), normal()}; }

  const TrueFlight& flight_;
  SensorErrors errors_;
  std::mt19937 random_;
  std::normal_distribution<double> standard_;
  fsw::Vector2 bias_;
  double brightness_offset_m_;
  fsw::Vector2 shape_ = fsw::Vector2::Zero();
  fsw::Vector3 gnss_slow_ = fsw::Vector3::Zero();
  std::vector<fsw::filter::Burn> known_burns_;
};

/// The target's position in the servicer's RTN, m: true, and as navigation has it.
fsw::Vector3 true_position_rtn(const TrueEpoch& epoch);
/// RelativeNavigationFilter, own receiver and bearings, as the flight software composes them.
class AnglesOnlyFlight {
 public:
  AnglesOnlyFlight(const fsw::filter::FilterSettings& blocks, const fsw::measurements::BearingSettings& bearings,
                   const fsw::filter::TargetApriori& apriori);
  fsw::measurements::BearingEditStatus update(const MeasuredEpoch& epoch, const std::vector<fsw::filter::Burn>& burns);
  [[nodiscard]] bool valid() const { return filter_->solution_status() == fsw::filter::SolutionStatus::kEstimated; }
  [[nodiscard]] const fsw::filter::RelativeNavigationFilter& filter() const { return *filter_; }
  [[nodiscard]] const fsw::measurements::BearingAiding& bearings() const { return bearings_; }

 private:
  std::unique_ptr<fsw::filter::RelativeNavigationFilter> filter_;
  fsw::measurements::BearingAiding bearings_;
};

/// Normalised error squared of the estimated ROE: six on average if the filter is consistent.
double roe_nees(const TrueEpoch& epoch, const fsw::filter::RelativeNavigationFilter& filter);
/// Of the servicer's own orbit, position and velocity: likewise.
double own_orbit_nees(const TrueEpoch& epoch, const fsw::filter::RelativeNavigationFilter& filter);
fsw::Vector3 estimated_position_rtn(const fsw::filter::RelativeNavigationFilter& filter);

// How well any unbiased navigation could know the target's orbit: Cramer and Rao's bound from all bearings, with the
// dynamics, the servicer's orbit and its burns known exactly. What a filter is worse by, it or its models lose.

struct BoundSettings {
  double bearing_sigma = 12.0 / 206264.8;  ///< rad
  double resolved_share = 0.25;            ///< of the apparent radius, as the filter takes it
  double bias_sigma = 3.0 / 206264.8;      ///< rad, each axis, constant; 0: none
  fsw::Vector6 prior_sigma_a_roe_m = (fsw::Vector6() << 30.0, 1000.0, 200.0, 200.0, 200.0, 200.0).finished();
};

/// 1 sigma of the length of the relative position's error, m, at each of `epochs` (indices, increasing), from the lit
/// bearings up to and with it. The target never burns, so its orbit has six unknowns; slopes by central differences
/// over the whole arc in the on-board gravity field.
std::vector<double> position_bound(const TrueFlight& flight, const std::vector<std::size_t>& epochs,
                                   const BoundSettings& settings = {});

}  // namespace vbar::test
