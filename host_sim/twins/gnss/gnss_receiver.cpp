#include "host_sim/twins/gnss/gnss_receiver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {
namespace {

using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;

// The time of a satellite is decoded after one subframe.
constexpr double kTimeDecoding_s = 6.0;

const std::shared_ptr<const Constellation>& needed(const std::shared_ptr<const Constellation>& constellation) {
  if (!constellation) throw std::invalid_argument("GNSS receiver: no constellation");
  return constellation;
}

const GnssReceiverSettings& checked(const GnssReceiverSettings& settings) {
  check(settings);
  return settings;
}

void check_truth(const BodyTruth& truth) {
  if (truth.time.ns % 1'000'000 != 0)
    throw std::invalid_argument(fmt::format("GNSS receiver: epoch {} ns is not a multiple of 1 ms", truth.time.ns));
  const bool finite = truth.position_eci.allFinite() && truth.velocity_eci.allFinite() &&
                      truth.rate_body_eci.allFinite() && truth.q_body_eci.coeffs().allFinite() &&
                      truth.R_ecef_eci.allFinite();
  if (!finite) throw std::invalid_argument("GNSS receiver: the truth holds a number that is not finite");
  const double radius_km = truth.position_eci.norm() / 1e3;
  if (!(radius_km > 6300.0 && radius_km < 15000.0))
    throw std::invalid_argument(
        fmt::format("GNSS receiver: {} km from the Earth's centre; accepted is 6300 to 15000", radius_km));
  if (std::abs(truth.q_body_eci.norm() - 1.0) > 1e-6)
    throw std::invalid_argument("GNSS receiver: the attitude quaternion is not of unit length");
}

}  // namespace

GnssReceiver::GnssReceiver(const GnssReceiverSettings& settings, std::shared_ptr<const Constellation> constellation,
                           const std::filesystem::path& data_directory, std::uint64_t seed, const std::string& name)
    : settings_(checked(settings)),
      seed_(seed),
      name_(name),
      constellation_(needed(constellation)),
      pattern_(AntennaPattern::read(data_directory / settings.link_budget.antenna_pattern)),
      body_errors_(draw_body_frame(settings.body_frame, seed, name)),
      antenna_noise_(seed, "gnss/" + name + "/antenna_noise"),
      clock_(settings.clock, seed, name),
      messages_(constellation_->size()) {
  tracking_.reserve(constellation_->size());
  for (std::size_t k = 0; k < constellation_->size(); ++k)
    tracking_.emplace_back(constellation_->id(k), settings.start, settings.tracking, seed, name);
  engine::RandomStream stream(seed, "gnss/" + name + "/biases");
  for (SignalBias& bias : biases_) {
    bias.code_m = stream.normal() * settings.tracking.code_bias_sigma_m;
    bias.carrier_fraction_cycles = stream.uniform();
  }
}

std::vector<std::uint8_t> GnssReceiver::bytes_at(const BodyTruth& truth) {
  check_truth(truth);
  advance(truth);
  const AntennaState antenna = antenna_state(truth);
  observe(antenna, truth.time);
  hear_messages(truth.time);
  const std::optional<PointSolution> solution = point_solution(antenna);

  oem::Header header;
  header.time = truth.time;
  header.position_valid = solution.has_value();
  header.status = time_status(truth.time, solution.has_value());
  const UtcOffset utc = utc_offset_at(truth.time);

  oem::Bytes bytes;
  oem::append_range(bytes, header, observations_);
  append_ephemerides(bytes, header);
  const bool due =
      !corrections_logged_ || seconds(truth.time - corrections_logged_at_) >= settings_.output.corrections_period_s;
  if (solution && due) {
    oem::append_ionutc(bytes, header, constellation_->corrections(), utc);
    corrections_logged_ = true;
    corrections_logged_at_ = truth.time;
  }
  append_solution(bytes, header, antenna, solution, utc);
  return bytes;
}

void GnssReceiver::command_slip(SatelliteId satellite, Signal signal, std::int64_t cycles, bool seen) {
  for (SatelliteTracking& tracking : tracking_)
    if (tracking.satellite() == satellite) tracking.command_slip(signal, cycles, seen);
}

bool GnssReceiver::upset(const Upset& upset) {
  switch (upset.kind) {
    case Upset::Kind::kCycleSlip:
      return slip_satellites(upset.satellite, std::llround(upset.value));
    case Upset::Kind::kClockJump:
      clock_step_s_ += upset.value;
      return true;
    case Upset::Kind::kReset:
      must_restart_ = true;
      return true;
  }
  return false;
}

/// Lets the satellites concerned slip. If these are all, each slips by another multiple: 1, -1, 2, -2, ...
bool GnssReceiver::slip_satellites(const std::string& satellite, std::int64_t cycles) {
  const auto highest = std::ranges::max_element(truth_.observations, {}, &ObservationTruth::elevation);
  if (highest == truth_.observations.end()) return false;
  std::int64_t slipped = 0;
  for (SatelliteTracking& tracking : tracking_) {
    const bool is_tracked = std::ranges::any_of(tracking.signals(), &SignalTrack::tracking);
    const bool is_meant = satellite == "all" || satellite == name_of(tracking.satellite()) ||
                          (satellite == "highest" && tracking.satellite() == highest->satellite);
    if (!is_tracked || !is_meant) continue;
    const std::int64_t multiple = (slipped % 2 == 0 ? 1 : -1) * (slipped / 2 + 1);
    for (const SignalTrack& track : tracking.signals()) tracking.command_slip(track.signal, multiple * cycles, false);
    ++slipped;
  }
  return slipped > 0;
}

void GnssReceiver::restart() {
  must_restart_ = false;
  on_ = false;
  clock_ = ReceiverClock(settings_.clock, seed_, fmt::format("{}/restart_{}", name_, ++restarts_));
  for (SatelliteTracking& tracking : tracking_) tracking.lose();
  std::ranges::fill(messages_, MessageState{});
  corrections_logged_ = false;
}

void GnssReceiver::advance(const BodyTruth& truth) {
  if (must_restart_) restart();
  if (on_) {
    if (truth.time <= last_epoch_) throw std::invalid_argument("GNSS receiver: the epoch is not later than the last");
    clock_.advance(seconds(truth.time - last_epoch_));
  } else {
    switched_on_ = truth.time;
  }
  // Added only if there is one: the clock of a run without keeps its bits.
  if (clock_step_s_ != 0.0) clock_.shift(std::exchange(clock_step_s_, 0.0));
}

AntennaState GnssReceiver::antenna_state(const BodyTruth& truth) {
  const BodyFrameSettings& body = settings_.body_frame;
  const double x = antenna_noise_.normal();
  const double y = antenna_noise_.normal();
  const double z = antenna_noise_.normal();
  truth_.antenna_from_com_body_m = antenna_from_com(body, body_errors_) + body.pco_noise_mm * 1e-3 * Vector3(x, y, z);

  // The clock shows the epoch `offset` before the true epoch: the antenna position there, by free-fall motion.
  AntennaState antenna;
  antenna.time = truth.time;
  antenna.offset_s = -clock_.offset_s();
  const double t = antenna.offset_s;
  const Vector3 arm = truth.q_body_eci.conjugate() * truth_.antenna_from_com_body_m;
  const double radius = truth.position_eci.norm();
  const Vector3 gravity = -fsw::gnss::kGmGps / (radius * radius * radius) * truth.position_eci;
  const Vector3 velocity = truth.velocity_eci + truth.rate_body_eci.cross(arm);
  const Vector3 position = truth.position_eci + arm + (velocity + 0.5 * t * gravity) * t;
  // The Earth rotates until that instant.
  const double turn = fsw::gnss::kEarthRateGps * t;
  const fsw::Matrix3 R_ecef_eci = Eigen::AngleAxisd(-turn, Vector3::UnitZ()).toRotationMatrix() * truth.R_ecef_eci;
  antenna.position_ecef = R_ecef_eci * position;
  antenna.velocity_ecef =
      R_ecef_eci * (velocity + t * gravity) - fsw::gnss::kEarthRateGps * Vector3::UnitZ().cross(antenna.position_ecef);
  antenna.boresight_ecef = R_ecef_eci * (truth.q_body_eci.conjugate() * true_boresight(body, body_errors_));

  truth_.clock_offset_s = clock_.offset_s();
  truth_.clock_drift = clock_.drift();
  truth_.clock_jumps = clock_.jumps();
  truth_.antenna_ecef = antenna.position_ecef;
  return antenna;
}

void GnssReceiver::observe(const AntennaState& antenna, fsw::GpsTime now) {
  observations_.clear();
  observed_satellites_.clear();

  truth_.observations.clear();
  truth_.visible_satellites = 0;
  for (std::size_t index = 0; index < tracking_.size(); ++index) observe_satellite(antenna, now, index);
  on_ = true;
  last_epoch_ = now;
}

void GnssReceiver::observe_satellite(const AntennaState& antenna, fsw::GpsTime now, std::size_t index) {
  SatelliteTracking& tracking = tracking_[index];
  const std::optional<SignalPath> path = visible_path(*constellation_, index, antenna, settings_.visibility);
  SignalStrengths strengths;
  if (path) {
    ++truth_.visible_satellites;
    const double attenuation_db = pattern_.attenuation_db(path->line_of_sight.dot(antenna.boresight_ecef));
    std::vector<double> cn0_dbhz;
    for (const SignalTrack& track : tracking.signals())
      cn0_dbhz.push_back(carrier_to_noise_dbhz(settings_.link_budget, track.signal, path->range_m, attenuation_db));
    strengths = signal_strengths(settings_.tracking, tracking.satellite().system, std::move(cn0_dbhz));
  }
  tracking.update(now, !on_, strengths.carrier);
  if (!path) return;

  const double sin_elevation = path->line_of_sight.dot(antenna.position_ecef.normalized());
  const double ionosphere_l1_m =
      settings_.ionosphere
          ? klobuchar_delay_in_orbit_m(constellation_->corrections().klobuchar, antenna.position_ecef,
                                       path->line_of_sight, week_time(System::kGps, now).seconds_of_week())
          : 0.0;
  for (std::size_t k = 0; k < tracking.signals().size(); ++k) {
    SignalTrack& track = tracking.signals()[k];
    if (track.tracking)
      observe_signal(track, {*path, ionosphere_l1_m, std::asin(sin_elevation), strengths.code[k]}, now, index);
  }
}

void GnssReceiver::observe_signal(SignalTrack& track, const Reception& reception, fsw::GpsTime now, std::size_t index) {
  const SignalPath& path = reception.path;
  const Signal signal = track.signal;
  const SignalBias& bias = biases_[static_cast<std::size_t>(signal)];
  const double lambda = wavelength_m(signal);
  const double ionosphere_m = reception.ionosphere_l1_m * ionosphere_scale(signal);
  const double common_m = path.range_m + path.shapiro_m + kSpeedOfLight * (clock_.offset_s() - path.satellite_clock_s);

  ObservationTruth truth;
  truth.satellite = constellation_->id(index);
  truth.signal = signal;
  truth.range_m = path.range_m;
  truth.code_m = common_m + kSpeedOfLight * code_delay_s(signal, constellation_->group_delay_s(index)) + ionosphere_m +
                 bias.code_m;
  truth.carrier_m = common_m - ionosphere_m;
  truth.ionosphere_m = ionosphere_m;
  truth.elevation = reception.elevation;
  truth.ambiguity_cycles = track.ambiguity_cycles;
  truth.carrier_fraction_cycles = bias.carrier_fraction_cycles;
  truth.carrier_wander_m = track.carrier_wander_m.at(now);
  truth.code_wander_m =
      code_wander_of(settings_.tracking, signal).sigma_m(std::sin(reception.elevation)) * track.code_wander.at(now);
  truth.slips = track.slips;
  truth_.observations.push_back(truth);

  oem::RangeRecord record;
  record.satellite = truth.satellite;
  record.signal = signal;
  record.channel = static_cast<int>(index % 32);
  record.pseudorange_sigma_m = code_noise_m(settings_.tracking, signal, reception.code_cn0_dbhz);
  record.carrier_sigma_cycles = carrier_noise_m(settings_.tracking, signal, track.cn0_dbhz) / lambda;
  const double rate_sigma_mps = range_rate_noise_mps(settings_.tracking, signal, track.cn0_dbhz);
  // Always drawn: the stream is the same with noise on or off.
  const double code_draw = track.stream.normal();
  const double carrier_draw = track.stream.normal();
  const double rate_draw = track.stream.normal();
  const double noise = settings_.tracking.thermal_noise ? 1.0 : 0.0;
  const double rate_mps = path.range_rate_mps + kSpeedOfLight * (clock_.drift() - path.satellite_clock_drift) +
                          noise * rate_draw * rate_sigma_mps;
  record.pseudorange_m = truth.code_m + noise * code_draw * record.pseudorange_sigma_m + truth.code_wander_m;
  record.carrier_phase_cycles = truth.carrier_m / lambda + static_cast<double>(track.ambiguity_cycles) +
                                bias.carrier_fraction_cycles + noise * carrier_draw * record.carrier_sigma_cycles +
                                truth.carrier_wander_m / lambda;
  record.doppler_hz = -rate_mps / lambda;
  record.cn0_dbhz = track.cn0_dbhz;
  record.lock_time_s = seconds(now - track.lock_since);
  for (const SignalTrack& other : tracking_[index].signals())
    record.grouped = record.grouped || (other.tracking && other.signal != signal);
  observations_.push_back(record);
  observed_satellites_.push_back(index);
}

void GnssReceiver::hear_messages(fsw::GpsTime now) {
  const fsw::Duration decoding = fsw::nearest_duration(settings_.start.ephemeris_decoding_s);
  for (std::size_t index = 0; index < messages_.size(); ++index) {
    MessageState& message = messages_[index];
    const bool known_before = settings_.start.mode == StartMode::kHot && now == switched_on_;
    const std::optional<fsw::GpsTime> heard_since = tracking_[index].heard_since();
    if (known_before) {
      message.set = constellation_->broadcast_set(index, now);
      message.received = true;
      continue;
    }
    // A set has been received when it was sent during all of the last half minute.
    if (!heard_since || now - decoding < *heard_since) continue;
    const BroadcastSet set = constellation_->broadcast_set(index, now - decoding);
    if (message.received && message.set.ephemeris.toe == set.ephemeris.toe) continue;
    message.set = set;
    message.received = true;
    message.logged = false;
  }
}

std::optional<PointSolution> GnssReceiver::point_solution(const AntennaState& antenna) const {
  std::vector<PointResidual> residuals;
  for (std::size_t k = 0; k < observations_.size(); ++k) {
    const oem::RangeRecord& record = observations_[k];
    const std::size_t index = observed_satellites_[k];
    if (record.signal != Signal::kGpsL1 || !messages_[index].received) continue;
    const Ephemeris& set = messages_[index].set.ephemeris;
    const SignalPath predicted = broadcast_path(set, antenna);
    PointResidual residual;
    residual.line_of_sight = predicted.line_of_sight;
    residual.code_m =
        record.pseudorange_m - predicted.range_m + kSpeedOfLight * (predicted.satellite_clock_s - set.group_delay_s);
    residual.range_rate_mps = -record.doppler_hz * wavelength_m(record.signal) - predicted.range_rate_mps +
                              kSpeedOfLight * predicted.satellite_clock_drift;
    residual.code_sigma_m = record.pseudorange_sigma_m;
    residuals.push_back(residual);
  }
  return solve_point(residuals);
}

oem::TimeStatus GnssReceiver::time_status(fsw::GpsTime now, bool solved) const {
  if (solved) return oem::TimeStatus::kFine;
  for (const SatelliteTracking& tracking : tracking_)
    if (tracking.heard_since() && seconds(now - *tracking.heard_since()) >= kTimeDecoding_s)
      return oem::TimeStatus::kCoarse;
  return settings_.start.mode == StartMode::kCold ? oem::TimeStatus::kUnknown : oem::TimeStatus::kApproximate;
}

void GnssReceiver::append_ephemerides(oem::Bytes& bytes, const oem::Header& header) {
  const fsw::Duration decoding = fsw::nearest_duration(settings_.start.ephemeris_decoding_s);
  for (std::size_t index = 0; index < messages_.size(); ++index) {
    MessageState& message = messages_[index];
    const bool tracked = tracking_[index].signals().front().tracking;
    const bool repeated =
        message.logged && seconds(header.time - message.logged_at) < settings_.output.ephemeris_period_s;
    if (!message.received || !tracked || repeated) continue;
    switch (constellation_->id(index).system) {
      case System::kGps:
        if (settings_.output.gps_ephemeris == GpsEphemerisLog::kRawEphem) {
          oem::append_rawephem(bytes, header, message.set, header.time - decoding);
        } else {
          oem::append_gpsephem(bytes, header, message.set, header.time - decoding);
        }
        break;
      case System::kGalileo:
        oem::append_galephemeris(bytes, header, message.set);
        break;
      case System::kBeidou:
        oem::append_bdsephemeris(bytes, header, message.set);
        break;
    }
    message.logged = true;
    message.logged_at = header.time;
  }
}

void GnssReceiver::append_solution(oem::Bytes& bytes, const oem::Header& header, const AntennaState& antenna,
                                   const std::optional<PointSolution>& solution, const UtcOffset& utc) const {
  oem::PositionRecord position;
  oem::ClockRecord clock;
  for (const SatelliteTracking& tracking : tracking_)
    if (tracking.signals().front().tracking) ++position.satellites_tracked;
  if (solution) {
    position.solved = clock.valid = true;
    position.position_ecef = antenna.position_ecef + solution->position_error_ecef;
    position.velocity_ecef = antenna.velocity_ecef + solution->velocity_error_ecef;
    position.position_sigma_m = solution->position_sigma;
    position.velocity_sigma_mps = solution->velocity_sigma;
    position.satellites_used = static_cast<int>(solution->satellites);
    clock.offset_s = solution->clock_offset_s;
    clock.sigma_s = solution->clock_sigma_s;
  }
  oem::append_bestxyz(bytes, header, position);
  oem::append_time(bytes, header, clock, utc);
}

}  // namespace vbar::twins::gnss
