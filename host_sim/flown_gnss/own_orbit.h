#pragma once
// The own-orbit navigation of the flight software on the bytes of a receiver: decoder, single point, filter.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/receiver_decoder.h"
#include "fsw/gnss/single_point.h"
#include "fsw/measurements/gnss_absolute_source.h"

namespace vbar::flown_gnss {

/// The estimate after an epoch, ECI.
struct OwnOrbitEpoch {
  fsw::GpsTime time;
  fsw::Result<fsw::gnss::SinglePoint> point;  ///< of the antenna
  bool is_started = false;                    ///< the filter has an orbit
  fsw::orbit::CartesianState state;           ///< of the centre of mass
  fsw::Matrix6 covariance;
  double nis = 0.0;  ///< of the single point; three degrees of freedom
};

class OwnOrbit {
 public:
  OwnOrbit(const fsw::filter::AbsoluteOrbitSettings& settings, const fsw::gnss::RangeErrors& range_errors,
           const fsw::orbit::EarthOrientation& earth, const fsw::Vector3& antenna_body_m);

  /// Processes the bytes of one call of the receiver; calls `on_epoch` for each epoch of observations that they
  /// complete.
  void process(std::span<const std::uint8_t> bytes, const fsw::Matrix3& R_eci_body,
               const std::function<void(const OwnOrbitEpoch&, const fsw::gnss::ObservationEpoch&)>& on_epoch);

  [[nodiscard]] const fsw::gnss::EphemerisStore& ephemerides() const { return ephemerides_; }
  [[nodiscard]] const fsw::measurements::OwnGnssCounters& counters() const { return aiding_.counters(); }
  [[nodiscard]] const fsw::gnss::ReceiverCounters& decoder_counters() const { return decoder_.counters(); }

 private:
  fsw::gnss::ReceiverDecoder decoder_;
  fsw::gnss::EphemerisStore ephemerides_;
  fsw::measurements::GnssAbsoluteAiding aiding_;
  std::unique_ptr<fsw::filter::RelativeNavigationFilter> filter_;
};

}  // namespace vbar::flown_gnss
