#include "host_sim/flown_gnss/flown_receiver.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fsw/gnss/differential.h"
#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::flown_gnss {

LoggedReceiver::LoggedReceiver(const std::filesystem::path& log, std::uint8_t number, fsw::Duration period)
    : period_(period) {
  for (const twins::PacketRecord& record : twins::read_packet_log(log).records) {
    if (!record.to_flight || record.packet.empty()) continue;
    const auto packet = fsw::packets::parse_packet(record.packet);
    if (!packet.ok() || packet.value().header.spacecraft != number) continue;
    const auto message = fsw::packets::decode<gnss_bytes>(packet.value());
    if (!message.ok()) continue;
    constexpr auto kCapacity = static_cast<std::int32_t>(sizeof message.value().data);
    const auto count = std::clamp<std::int32_t>(message.value().count, 0, kCapacity);
    std::vector<std::uint8_t>& bytes = bytes_[packet.value().header.time];
    bytes.insert(bytes.end(), message.value().data, message.value().data + count);
  }
  if (bytes_.empty())
    throw std::runtime_error(
        fmt::format("{}: found no bytes of a receiver of spacecraft {}, expected packets of type gnss_bytes",
                    log.string(), number));
}

twins::gnss::ReceiverOutput LoggedReceiver::output_at(const twins::gnss::BodyTruth& truth) {
  twins::gnss::ReceiverOutput output;
  const auto end = bytes_.lower_bound(truth.time + period_);
  for (auto one = bytes_.lower_bound(truth.time); one != end; ++one)
    output.bytes.insert(output.bytes.end(), one->second.begin(), one->second.end());
  return output;
}

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

namespace {

constexpr std::size_t kFewestValues = 100;

class Figures {
 public:
  Figures(const FlownResult& flown, const FlownResult& twin) : flown_(flown), twin_(twin) {}

  template <class Figure>
  void add(const std::string& name, std::size_t count, const Figure& figure) {
    figures_.push_back({name, figure(flown_), figure(twin_), count});
  }

  /// `bins_of`: of a result; `scale`: from m to the unit of `name`.
  template <class BinsOf>
  void add_bins(const std::string& name, double scale, const BinsOf& bins_of) {
    for (std::size_t k = 0; k < kElevationBins; ++k) {
      const ElevationBin &flown = bins_of(flown_)[k], &twin = bins_of(twin_)[k];
      if (flown.count < kFewestValues || twin.count < kFewestValues) continue;
      const int from_deg = kFirstElevation_deg + kBinWidth_deg * static_cast<int>(k);
      figures_.push_back({fmt::format("{}, {} to {} deg", name, from_deg, from_deg + kBinWidth_deg),
                          scale * flown.sigma(), scale * twin.sigma(), flown.count});
    }
    const ElevationBin flown = sum_of(bins_of(flown_)), twin = sum_of(bins_of(twin_));
    figures_.push_back({name + ", all elevations", scale * flown.sigma(), scale * twin.sigma(), flown.count});
  }

  template <class CorrelationOf>
  void add_correlation(const std::string& name, double interval_s, const CorrelationOf& correlation_of) {
    const std::size_t count = correlation_of(flown_).pairs[0];
    for (const std::size_t lag : {1, 6, 30})
      add(fmt::format("{}, correlation after {:g} s", name, interval_s * static_cast<double>(lag)), count,
          [&](const FlownResult& result) { return correlation_of(result).at(lag); });
    add(name + ", correlation time beside white noise, s", count, [&](const FlownResult& result) {
      return interval_s * correlation_of(result).time_beside_white().value_or(0.0);
    });
  }

  [[nodiscard]] std::vector<ComparedFigure> take() { return std::move(figures_); }

 private:
  const FlownResult& flown_;
  const FlownResult& twin_;
  std::vector<ComparedFigure> figures_;
};

ErrorSums all_hours(const FlownResult& result) {
  return result.errors.of(0, result.errors.hours().size());
}

}  // namespace

std::vector<ComparedFigure> compare(const FlownResult& flown, const FlownResult& twin) {
  Figures figures(flown, twin);
  const std::size_t epochs = flown.epochs;
  figures.add("own orbit, m rms 3D", epochs, [](const FlownResult& r) { return all_hours(r).rms_m(); });
  figures.add("NEES of its position", epochs, [](const FlownResult& r) { return all_hours(r).mean_nees(); });
  figures.add("single points, m rms 3D", epochs, [](const FlownResult& r) { return all_hours(r).point_rms_m(); });
  figures.add("satellites of an epoch", epochs,
              [](const FlownResult& r) { return static_cast<double>(r.satellites) / static_cast<double>(r.epochs); });
  constexpr double kMillimetres = 1e3;
  figures.add_bins("range, m", 1.0, [](const FlownResult& r) -> const ElevationBins& { return r.ranges; });
  figures.add_bins("code L1, m", 1.0,
                   [](const FlownResult& r) -> const ElevationBins& { return r.signals.code_l1().bins; });
  figures.add_bins("code L2, m", 1.0,
                   [](const FlownResult& r) -> const ElevationBins& { return r.signals.code_l2().bins; });
  figures.add_bins("carriers, mm", kMillimetres,
                   [](const FlownResult& r) -> const ElevationBins& { return r.signals.carrier(); });
  const double interval_s = flown.signals.interval_s();
  const auto add_correlations = [&](const std::string& name, const auto& noise_of) {
    figures.add_correlation(name, interval_s,
                            [&](const FlownResult& r) -> const Correlation& { return noise_of(r).correlation; });
    figures.add_correlation(name + " above 30 deg", interval_s,
                            [&](const FlownResult& r) -> const Correlation& { return noise_of(r).high_correlation; });
  };
  add_correlations("code L1", [](const FlownResult& r) -> const SignalNoise& { return r.signals.code_l1(); });
  add_correlations("code L2", [](const FlownResult& r) -> const SignalNoise& { return r.signals.code_l2(); });
  return figures.take();
}

}  // namespace vbar::flown_gnss
