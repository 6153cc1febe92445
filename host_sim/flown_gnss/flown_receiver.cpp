#include "host_sim/flown_gnss/flown_receiver.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "fsw/gnss/differential.h"

namespace vbar::flown_gnss {
namespace {

using fsw::Vector3;
using fsw::gnss::Observation;
using fsw::gnss::ObservationEpoch;
using fsw::gnss::SatelliteId;
using fsw::gnss::Signal;

/// Elevation of each satellite of an epoch, and residual of its range.
struct Sights {
  std::map<SatelliteId, double> elevations;
  std::vector<std::pair<double, double>> residuals;  ///< elevation, m
};

Sights sights_of(const ObservationEpoch& epoch, const fsw::gnss::EphemerisStore& ephemerides,
                 const fsw::gnss::EarthFrame& frame, const Vector3& antenna_eci) {
  constexpr double kGamma = (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz) * (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz);
  Sights sights;
  for (std::size_t k = 0; k < epoch.count; ++k) {
    const Observation& one = epoch.observations[k];
    if (one.signal != Signal::kGpsL1) continue;
    const auto source =
        fsw::gnss::signal_source(one.satellite, one.pseudorange_m, epoch.receiver_time, ephemerides, frame);
    if (!source.ok()) continue;
    const Vector3 sight = source.value().position_eci - antenna_eci;
    const double elevation = std::asin(sight.normalized().dot(antenna_eci.normalized()));
    sights.elevations[one.satellite] = elevation;
    double range_m = one.pseudorange_m;
    if (k + 1 < epoch.count && epoch.observations[k + 1].satellite == one.satellite)
      range_m = (kGamma * range_m - epoch.observations[k + 1].pseudorange_m) / (kGamma - 1.0);
    sights.residuals.emplace_back(elevation, range_m + source.value().clock_m - sight.norm());
  }
  return sights;
}

/// Adds the residuals less their median, which takes the receiver's clock away and no outlier with it.
void add_residuals(std::vector<std::pair<double, double>> residuals, ElevationBins& bins) {
  constexpr std::size_t kMinSatellites = 5;
  if (residuals.size() < kMinSatellites) return;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle, {}, &std::pair<double, double>::second);
  const double median = middle->second;
  for (const auto& [elevation, residual] : residuals) bins[bin_of(elevation)].add(residual - median);
}

}  // namespace

FlownResult fly(GivenOrbit& orbit, twins::gnss::ReceiverBytes& receiver, const FlownSettings& settings) {
  const Vector3 antenna_body(0.0, 0.0, settings.antenna_up_m);
  OwnOrbit navigation(settings.filter, settings.range_errors, orbit.on_board(), antenna_body);
  FlownResult result(orbit.first(), settings.period_s);
  const fsw::Duration period = fsw::nearest_duration(settings.period_s);
  const fsw::GpsTime first = orbit.first() + fsw::nearest_duration(settings.begin_s);
  const fsw::GpsTime end = std::min(orbit.last(), first + fsw::nearest_duration(settings.duration_s));
  for (fsw::GpsTime time = first; time < end; time = time + period) {
    const twins::gnss::BodyTruth body = orbit.at(time);
    const fsw::Matrix3 R_eci_body = body.q_body_eci.toRotationMatrix().transpose();
    const Vector3 antenna_eci = body.position_eci + R_eci_body * antenna_body;
    const twins::gnss::ReceiverOutput output = receiver.output_at(body);
    navigation.process(output.bytes, R_eci_body, [&](const OwnOrbitEpoch& estimate, const ObservationEpoch& epoch) {
      ++result.epochs;
      result.errors.add(estimate, {body.position_eci, body.velocity_eci}, antenna_eci);
      const fsw::gnss::EarthFrame frame{.time = time, .R_itrf_gcrf = body.R_ecef_eci};
      // The antenna at reception, as early as the receiver's clock is fast.
      const double clock_m = estimate.point.ok() ? estimate.point.value().clock_m : 0.0;
      const Vector3 at_reception = antenna_eci - clock_m / fsw::gnss::kSpeedOfLight * body.velocity_eci;
      const Sights sights = sights_of(epoch, navigation.ephemerides(), frame, at_reception);
      result.satellites += sights.elevations.size();
      add_residuals(sights.residuals, result.ranges);
      result.signals.add(epoch, [&](SatelliteId satellite) {
        const auto found = sights.elevations.find(satellite);
        return found == sights.elevations.end() ? -1.0 : found->second;
      });
    });
  }
  result.signals.finish();
  result.counters = navigation.counters();
  return result;
}

}  // namespace vbar::flown_gnss
