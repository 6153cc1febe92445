#include "host_sim/twins/gnss/tracking.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"

namespace vbar::twins::gnss {

namespace {

double power_ratio(double db) {
  return std::pow(10.0, db / 10.0);
}

// Reference point of the specified power: at 5 deg elevation on the ground, from the orbit's height.
double reference_distance_m(System system) {
  switch (system) {
    case System::kGps:
      return 25.24e6;
    case System::kGalileo:
      return 28.26e6;
    case System::kBeidou:
      return 26.55e6;
  }
  return 0.0;
}

}  // namespace

AntennaPattern AntennaPattern::load(const std::filesystem::path& data_directory) {
  return read(data_directory / LinkBudgetSettings{}.antenna_pattern);
}

AntennaPattern AntennaPattern::read(const std::filesystem::path& file) {
  files::DataStream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  AntennaPattern pattern;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.front() == '#' || line.starts_with("boresight_angle_deg,")) continue;
    Node node{};
    char comma = 0;
    std::istringstream text(line);
    const bool read = static_cast<bool>(text >> node.angle_deg >> comma >> node.attenuation_db) && comma == ',';
    const bool rising =
        pattern.nodes_.empty() ? node.angle_deg == 0.0 : node.angle_deg > pattern.nodes_.back().angle_deg;
    if (!read || !rising)
      throw std::runtime_error(fmt::format("{}:{}: {} is not an ascending angle and an attenuation", file.string(),
                                           number, files::quoted(line)));
    pattern.nodes_.push_back(node);
  }
  if (pattern.nodes_.size() < 2 || pattern.nodes_.back().angle_deg != 180.0)
    throw std::runtime_error(fmt::format("{}: the angles must reach 180 deg", file.string()));
  return pattern;
}

double AntennaPattern::attenuation_db(double cosine) const {
  const double angle_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
  const auto after = std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, angle_deg,
                                      [](double angle, const Node& node) { return angle < node.angle_deg; });
  const Node& low = *(after - 1);
  const double fraction = (angle_deg - low.angle_deg) / (after->angle_deg - low.angle_deg);
  return low.attenuation_db + fraction * (after->attenuation_db - low.attenuation_db);
}

double carrier_to_noise_dbhz(const LinkBudgetSettings& settings, Signal signal, double distance_m,
                             double antenna_attenuation_db) {
  constexpr double kBoltzmann = 1.380649e-23;
  constexpr double kReferenceTemperature_k = 290.0;
  const double temperature_k = settings.antenna_temperature_k +
                               kReferenceTemperature_k * (power_ratio(settings.lna_noise_figure_db) - 1.0) +
                               kReferenceTemperature_k * (power_ratio(settings.receiver_noise_figure_db) - 1.0) /
                                   power_ratio(settings.lna_gain_db);
  const SignalStructure& s = structure(signal);
  const double received_dbw = s.received_power_dbw + 20.0 * std::log10(reference_distance_m(s.system) / distance_m);
  return received_dbw + settings.boresight_gain_dbi - antenna_attenuation_db - settings.losses_db -
         10.0 * std::log10(kBoltzmann * temperature_k);
}

double semicodeless_cn0_dbhz(double cn0_dbhz, double other_cn0_dbhz, double w_code_rate_khz) {
  return cn0_dbhz - 10.0 * std::log10(1.0 + 1e3 * w_code_rate_khz / (2.0 * power_ratio(other_cn0_dbhz)));
}

SignalStrengths signal_strengths(const TrackingSettings& settings, System system, std::vector<double> cn0_dbhz) {
  SignalStrengths strengths{cn0_dbhz, std::move(cn0_dbhz)};
  if (system != System::kGps) return strengths;
  constexpr std::size_t kL1 = 0, kL2 = 1;
  constexpr double kPBelowCa_db = 3.0;
  const double l1_p_dbhz = strengths.carrier[kL1] - kPBelowCa_db, l2_p_dbhz = strengths.carrier[kL2];
  if (settings.l1_code == L1Code::kP)
    strengths.code[kL1] = semicodeless_cn0_dbhz(l1_p_dbhz, l2_p_dbhz, settings.w_code_rate_khz);
  // Not recomputed where nothing is lost: the logarithm would change its last bits.
  if (settings.w_code_rate_khz > 0.0)
    strengths.code[kL2] = strengths.carrier[kL2] =
        semicodeless_cn0_dbhz(l2_p_dbhz, l1_p_dbhz, settings.w_code_rate_khz);
  return strengths;
}

double code_noise_m(const TrackingSettings& settings, Signal signal, double cn0_dbhz) {
  const bool is_l1_by_p = signal == Signal::kGpsL1 && settings.l1_code == L1Code::kP;
  const SignalStructure& s = structure(is_l1_by_p ? Signal::kGpsL2 : signal);
  const double cn0 = power_ratio(cn0_dbhz);
  const double d = s.correlator_spacing_chips;
  const double chips = std::sqrt(settings.code_loop_bandwidth_hz * d / (2.0 * cn0) *
                                 (1.0 + 2.0 / ((2.0 - d) * settings.integration_s * cn0)));
  return fsw::gnss::kSpeedOfLight / s.chip_rate_hz * chips;
}

const CodeWander& code_wander_of(const TrackingSettings& settings, Signal signal) {
  return signal == Signal::kGpsL2 ? settings.code_wander_l2 : settings.code_wander_l1;
}

double carrier_noise_m(const TrackingSettings& settings, Signal signal, double cn0_dbhz) {
  const double cn0 = power_ratio(cn0_dbhz);
  return wavelength_m(signal) / (2.0 * std::numbers::pi) *
         std::sqrt(settings.carrier_loop_bandwidth_hz / cn0 * (1.0 + 1.0 / (2.0 * settings.integration_s * cn0)));
}

double range_rate_noise_mps(const TrackingSettings& settings, Signal signal, double cn0_dbhz) {
  return std::numbers::sqrt2 * carrier_noise_m(settings, signal, cn0_dbhz) * settings.carrier_loop_bandwidth_hz;
}

namespace {

// Initial integers of a count of cycles: large enough not to be guessed.
constexpr double kLargestAmbiguity_cycles = 0x1p22;
constexpr double kLargestSlip_cycles = 100.0;

std::string stream_name(std::string_view receiver, SatelliteId satellite) {
  return "gnss/" + std::string(receiver) + "/" + name_of(satellite);
}

// Uniform on -largest ... largest without 0.
std::int64_t nonzero_integer(engine::RandomStream& stream, double largest) {
  const auto magnitude = static_cast<std::int64_t>(stream.uniform(0.0, largest)) + 1;
  return stream.uniform() < 0.5 ? -magnitude : magnitude;
}

}  // namespace

SatelliteTracking::SatelliteTracking(SatelliteId satellite, const StartSettings& start,
                                     const TrackingSettings& tracking, std::uint64_t seed, std::string_view receiver)
    : satellite_(satellite), start_(start), tracking_(tracking), stream_(seed, stream_name(receiver, satellite)) {
  for (std::size_t k = 0; k < kSignals; ++k) {
    if (kSignalStructures[k].system != satellite.system) continue;
    const std::string name = stream_name(receiver, satellite) + "/" + kSignalStructures[k].name;
    const auto signal = static_cast<Signal>(k);
    signals_.emplace_back(
        signal, engine::RandomStream(seed, name),
        engine::GaussMarkov(1e-3 * tracking.carrier_wander_sigma_mm, tracking.carrier_wander_time_s,
                            engine::RandomStream(seed, name + "/carrier_wander")),
        engine::GaussMarkov(code_wander_of(tracking, signal).is_none() ? 0.0 : 1.0, tracking.code_wander_time_s,
                            engine::RandomStream(seed, name + "/code_wander")));
  }
}

void SatelliteTracking::update(fsw::GpsTime now, bool first, const std::vector<double>& cn0_dbhz) {
  const double elapsed_s = first ? 0.0 : seconds(now - last_update_);
  last_update_ = now;
  for (std::size_t k = 0; k < cn0_dbhz.size(); ++k) signals_[k].cn0_dbhz = cn0_dbhz[k];
  // All signals depend on the first one: it is acquired by its code, and aids the loops of the others.
  SignalTrack& leader = signals_.front();
  const double needed = leader.tracking ? tracking_.loss_threshold_dbhz : tracking_.acquisition_threshold_dbhz;
  if (cn0_dbhz.empty() || leader.cn0_dbhz < needed) {
    lose();
    return;
  }
  if (!found_) search(now, first);
  if (now < *found_) {
    commanded_.clear();
    return;
  }

  for (SignalTrack& track : signals_) {
    const double threshold = track.tracking ? tracking_.loss_threshold_dbhz : tracking_.acquisition_threshold_dbhz;
    if (track.cn0_dbhz < threshold) {
      track.tracking = false;
    } else if (!track.tracking) {
      begin(track, std::max(*found_, first ? now : now - fsw::nearest_duration(elapsed_s)));
    } else {
      slip_by_chance(track, now, elapsed_s);
    }
  }
  for (const CommandedSlip& command : commanded_)
    for (SignalTrack& track : signals_)
      if (track.signal == command.signal && track.tracking) slip(track, now, command.cycles, command.seen);
  commanded_.clear();
}

void SatelliteTracking::search(fsw::GpsTime now, bool first) {
  const bool cold = first && start_.mode == StartMode::kCold;
  const double delay_s = cold ? stream_.uniform(start_.cold_search_min_s, start_.cold_search_max_s)
                              : stream_.uniform(start_.reacquisition_min_s, start_.reacquisition_max_s);
  found_ = now + fsw::nearest_duration(delay_s);
  heard_since_ = found_;
}

void SatelliteTracking::lose() {
  for (SignalTrack& track : signals_) track.tracking = false;
  found_.reset();
  heard_since_.reset();
  commanded_.clear();
}

void SatelliteTracking::begin(SignalTrack& track, fsw::GpsTime since) {
  track.tracking = true;
  track.lock_since = since;
  track.ambiguity_cycles = nonzero_integer(track.stream, kLargestAmbiguity_cycles);
}

void SatelliteTracking::slip(SignalTrack& track, fsw::GpsTime now, std::int64_t cycles, bool seen) {
  track.ambiguity_cycles += cycles;
  ++track.slips;
  if (seen) track.lock_since = now;
}

void SatelliteTracking::slip_by_chance(SignalTrack& track, fsw::GpsTime now, double elapsed_s) {
  const double probability = -std::expm1(-tracking_.cycle_slips_per_hour / 3600.0 * elapsed_s);
  if (track.stream.uniform() >= probability) return;
  const std::int64_t cycles = nonzero_integer(track.stream, kLargestSlip_cycles);
  slip(track, now, cycles, track.stream.uniform() >= tracking_.undetected_slip_fraction);
}

void SatelliteTracking::command_slip(Signal signal, std::int64_t cycles, bool seen) {
  commanded_.push_back({signal, cycles, seen});
}

}  // namespace vbar::twins::gnss
