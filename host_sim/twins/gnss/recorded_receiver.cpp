#include "host_sim/twins/gnss/recorded_receiver.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/system_time.h"
#include "host_sim/twins/gnss/tracking.h"

namespace vbar::twins::gnss {
namespace {

using fsw::GpsTime;
using observation_files::ObservedValue;
using observation_files::RecordedEpoch;
using observation_files::SatelliteObservations;

/// A set is sent from two hours before its reference time on, when a satellite begins to transmit it, for as long as
/// none is nearer.
constexpr double kLongestAge_s = 7200.0;

std::string text_in(const std::filesystem::path& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the file", file.string()));
  return stream.str();
}

/// C/N0 that is assumed where the file states no strength.
constexpr double kDefaultCn0_dbhz = 40.0;

double cn0_dbhz(double strength, bool is_amplitude) {
  if (!(strength > 0.0)) return kDefaultCn0_dbhz;
  return std::clamp(is_amplitude ? 20.0 * std::log10(strength) : strength, 10.0, 70.0);
}

/// The loop whose noise formula holds: code tracking of P(Y) by its own chips.
Signal loop_of(const std::string& code, Signal signal) {
  const bool is_precise = code.starts_with('P') || (code.size() == 3 && (code[2] == 'P' || code[2] == 'W'));
  return is_precise ? Signal::kGpsL2 : signal;
}

}  // namespace

RecordedReceiver::RecordedReceiver(const RecordingSettings& settings, const std::filesystem::path& data_directory)
    : settings_(settings) {
  const std::filesystem::path observations = data_directory / settings.observations;
  text_ = observation_files::plain_observations(text_in(observations), observations.string());
  reader_ = std::make_unique<observation_files::ObservationReader>(text_, observations.string());
  next_ = reader_->next();
  if (!next_) throw std::runtime_error(fmt::format("{}: found no epoch, expected at least one", observations.string()));
  first_epoch_ = next_->time;
  constexpr double kDefaultInterval_s = 30.0, kStepsOfGap = 1.5;
  const double interval_s = reader_->interval_s() > 0.0 ? reader_->interval_s() : kDefaultInterval_s;
  longest_step_ = fsw::nearest_duration(kStepsOfGap * interval_s);

  const std::filesystem::path navigation = data_directory / settings.navigation;
  const std::string records = text_in(navigation);
  auto file = read_rinex_sets(records, navigation.string(), {true, false, false});
  if (file.satellites.empty())
    throw std::runtime_error(
        fmt::format("{}: found no set of a GPS satellite, expected at least one", navigation.string()));
  if (!file.note.empty()) notes_.push_back(file.note);
  ionosphere_ = file.corrections.klobuchar;
  std::ranges::stable_sort(file.satellites, {}, &Ephemeris::toe);
  for (const Ephemeris& set : file.satellites) {
    auto& sets = sets_[set.satellite.prn].sets;
    if (sets.empty() || sets.back().toe < set.toe) sets.push_back(set);
  }
}

SignalTypes RecordedReceiver::types_of(Signal signal, int version) const {
  if (signal == Signal::kGpsL1)
    return settings_.l1.value_or(version == 2 ? SignalTypes{"C1", "L1", "S1"} : SignalTypes{"C1C", "L1C", "S1C"});
  return settings_.l2.value_or(version == 2 ? SignalTypes{"P2", "L2", "S2"} : SignalTypes{"C2W", "L2W", "S2W"});
}

/// Goes to the first epoch at or after `time`.
void RecordedReceiver::go_to(GpsTime time) {
  while (next_ && next_->time < time) {
    ++(next_->time.ns % 1'000'000 == 0 ? counts_.epochs_between : counts_.epochs_untimed);
    next_ = reader_->next();
  }
}

void RecordedReceiver::append_signal(const RecordedEpoch& epoch, const SatelliteObservations& satellite, Signal signal,
                                     std::vector<oem::RangeRecord>& records) {
  const SignalTypes types = types_of(signal, epoch.types->version());
  const ObservedValue code = epoch.value(satellite, types.code), phase = epoch.value(satellite, types.phase);
  const auto key = std::pair{satellite.number, signal};
  if (code.value == 0.0) {
    if (signal == Signal::kGpsL1) ++counts_.without_code;
    carriers_.erase(key);
    return;
  }
  const double lambda = wavelength_m(signal);
  oem::RangeRecord record;
  record.satellite = {System::kGps, satellite.number};
  record.signal = signal;
  record.channel = (satellite.number - 1) % 32;
  record.pseudorange_m = code.value;
  record.cn0_dbhz = cn0_dbhz(epoch.value(satellite, types.strength).value, settings_.strength_is_amplitude);
  record.pseudorange_sigma_m = code_noise_m(settings_.tracking, loop_of(types.code, signal), record.cn0_dbhz);
  record.carrier_sigma_cycles = carrier_noise_m(settings_.tracking, signal, record.cn0_dbhz) / lambda;
  if (phase.value == 0.0) {
    carriers_.erase(key);
    record.tracking.phase_lock = false;
  } else {
    const bool was_lost = (phase.loss_of_lock & 1U) != 0;
    record.tracking.parity_known = (phase.loss_of_lock & 2U) == 0;
    const auto [place, is_new] = carriers_.try_emplace(key);
    Carrier& carrier = place->second;
    const bool continues = !is_new && epoch.time - carrier.last <= longest_step_ && !epoch.after_power_failure;
    if (!continues) ++counts_.acquisitions;
    if (continues && was_lost) ++counts_.losses_of_lock;
    if (!continues || was_lost) {
      carrier.lock_since = epoch.time;
    } else {
      const double elapsed_s = fsw::seconds(epoch.time - carrier.last);
      record.doppler_hz = (carrier.phase_cycles - phase.value) / elapsed_s;
    }
    carrier.last = epoch.time;
    carrier.phase_cycles = phase.value;
    record.carrier_phase_cycles = phase.value;
    record.lock_time_s = fsw::seconds(epoch.time - carrier.lock_since);
  }
  records.push_back(record);
  ++counts_.observations;
}

const Ephemeris* RecordedReceiver::set_of(int number, GpsTime time) const {
  const auto found = sets_.find(number);
  if (found == sets_.end()) return nullptr;
  const auto age_s = [&](const Ephemeris& set) { return std::abs(fsw::seconds(set.toe - time)); };
  const auto nearest = std::ranges::min_element(found->second.sets, {}, age_s);
  return age_s(*nearest) > kLongestAge_s ? nullptr : &*nearest;
}

double RecordedReceiver::code_correction_m(int number, const BodyTruth& body) const {
  const Ephemeris* const set = set_of(number, body.time);
  if (set == nullptr) return 0.0;
  const fsw::Vector3 position_ecef = body.R_ecef_eci * body.position_eci;
  const fsw::Vector3 sight = (satellite_state(*set, body.time).position_ecef - position_ecef).normalized();
  const double second_of_week = week_time(System::kGps, body.time).seconds_of_week();
  return fsw::gnss::kSpeedOfLight * set->group_delay_s +
         klobuchar_delay_in_orbit_m(ionosphere_, position_ecef, sight, second_of_week);
}

/// The set nearest to the epoch of each satellite that is tracked, when it is another one than before, and repeated.
void RecordedReceiver::append_ephemerides(const RecordedEpoch& epoch, oem::Bytes& bytes, const oem::Header& header) {
  for (const SatelliteObservations& satellite : epoch.satellites) {
    const Ephemeris* const nearest = satellite.system == 'G' ? set_of(satellite.number, epoch.time) : nullptr;
    if (nearest == nullptr) continue;
    Sets& known = sets_.at(satellite.number);
    const auto place = static_cast<std::size_t>(nearest - known.sets.data());
    const bool is_known = known.sent == place;
    if (is_known && fsw::seconds(epoch.time - known.sent_at) < settings_.ephemeris_period_s) continue;
    constexpr int kIssues = 256;
    oem::append_gpsephem(bytes, header, {*nearest, static_cast<int>(place % kIssues)}, epoch.time);
    known.sent = place;
    known.sent_at = epoch.time;
  }
}

ReceiverOutput RecordedReceiver::output_at(const BodyTruth& truth) {
  const GpsTime time = truth.time;
  go_to(time);
  if (!next_ || next_->time != time) {
    ++counts_.missing;
    if (!std::exchange(is_in_gap_, true)) ++counts_.gaps;
    return {};
  }
  is_in_gap_ = false;
  const RecordedEpoch epoch = std::move(*next_);
  next_ = reader_->next();
  ++counts_.epochs;
  std::vector<oem::RangeRecord> records;
  for (const SatelliteObservations& satellite : epoch.satellites) {
    if (satellite.system != 'G') {
      ++counts_.other_systems[satellite.system];
      continue;
    }
    const std::size_t before = records.size();
    append_signal(epoch, satellite, Signal::kGpsL1, records);
    if (!settings_.uses_l2 || records.size() == before) continue;
    append_signal(epoch, satellite, Signal::kGpsL2, records);
    if (records.size() == before + 2) records[before].grouped = records[before + 1].grouped = true;
  }
  oem::Header header;
  header.time = epoch.time;
  header.status = oem::TimeStatus::kFine;
  oem::Bytes bytes;
  append_ephemerides(epoch, bytes, header);
  if (settings_.corrects_code)
    for (oem::RangeRecord& record : records)
      if (record.signal == Signal::kGpsL1) record.pseudorange_m -= code_correction_m(record.satellite.prn, truth);
  oem::append_range(bytes, header, records);
  return {bytes};
}

std::vector<Note> RecordedReceiver::statistics() const {
  std::size_t others = 0;
  for (const auto& [system, count] : counts_.other_systems) others += count;
  const auto note = [](const char* name, std::size_t count) { return Note{name, static_cast<double>(count)}; };
  return {note("epochs", counts_.epochs),
          note("epochs_missing", counts_.missing),
          note("gaps", counts_.gaps),
          note("epochs_between", counts_.epochs_between + counts_.epochs_untimed),
          note("losses_of_lock", counts_.losses_of_lock),
          note("satellites_of_other_systems", others)};
}

}  // namespace vbar::twins::gnss
