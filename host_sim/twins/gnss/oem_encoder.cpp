#include "host_sim/twins/gnss/oem_encoder.h"

#include <cmath>
#include <numbers>

#include "fsw/core/crc32.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/gnss/navigation_message.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss::oem {

namespace {

constexpr std::size_t kHeaderBytes = 28;

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  return fsw::crc32_after(0, bytes);
}

MessageWriter::MessageWriter(Bytes& bytes, MessageId id, const Header& header, bool is_response)
    : bytes_(bytes), begin_(bytes.size()) {
  const bool known = header.status != TimeStatus::kUnknown;
  const WeekTime time = week_time(System::kGps, header.time);
  constexpr std::uint8_t kResponse = 0x80;
  for (const std::uint8_t byte : {0xAA, 0x44, 0x12, static_cast<int>(kHeaderBytes)}) u8(byte);
  u16(static_cast<std::uint16_t>(id));
  u8(is_response ? kResponse : 0);  // binary
  u8(header.port);
  u16(0);   // body length, later
  u16(0);   // last of its sequence
  u8(180);  // idle time, half percents
  u8(static_cast<std::uint8_t>(header.status));
  u16(static_cast<std::uint16_t>(known ? time.week : 0));
  u32(static_cast<std::uint32_t>(known ? time.ns_of_week / 1'000'000 : 0));
  u32(header.status_word());
  u16(0);  // message definition
  u16(0);  // software version
}

void MessageWriter::finish() {
  const std::size_t body = bytes_.size() - begin_ - kHeaderBytes;
  bytes_[begin_ + 8] = static_cast<std::uint8_t>(body & 0xFFU);
  bytes_[begin_ + 9] = static_cast<std::uint8_t>(body >> 8U);
  u32(crc32(std::span(bytes_).subspan(begin_)));
}

namespace {

constexpr double kUserRangeAccuracy_m = 2.0;

std::uint32_t signal_code(SatelliteId satellite, Signal signal) {
  switch (signal) {
    case Signal::kGpsL1:
      return 0;  // L1 C/A
    case Signal::kGpsL2:
      return 9;  // L2 P(Y), semi-codeless
    case Signal::kGalileoE1:
      return 2;  // E1C
    case Signal::kBeidouB1I:
      return is_geostationary(satellite) ? 4U : 0U;  // with D2 or D1 message
  }
  return 0;
}

std::uint32_t system_code(System system) {
  switch (system) {
    case System::kGps:
      return 0;
    case System::kGalileo:
      return 3;
    case System::kBeidou:
      return 4;
  }
  return 0;
}

std::uint32_t tracking_status(const RangeRecord& record) {
  constexpr std::uint32_t kPhaseLock = 1U << 10U;
  constexpr std::uint32_t kParityKnown = 1U << 11U;
  constexpr std::uint32_t kCodeLock = 1U << 12U;
  constexpr std::uint32_t kNarrowCorrelator = 2U << 13U;
  const std::uint32_t primary = record.signal == Signal::kGpsL2 ? 0U : 1U << 27U;
  const TrackingState& tracking = record.tracking;
  return (tracking.state & 31U) | static_cast<std::uint32_t>(record.channel & 31) << 5U |
         (tracking.phase_lock ? kPhaseLock : 0U) | (tracking.parity_known ? kParityKnown : 0U) |
         (tracking.code_lock ? kCodeLock : 0U) | kNarrowCorrelator | system_code(record.satellite.system) << 16U |
         (record.grouped ? 1U << 20U : 0U) | signal_code(record.satellite, record.signal) << 21U | primary;
}

std::uint32_t whole_seconds(double seconds_of_week) {
  return static_cast<std::uint32_t>(std::lround(seconds_of_week));
}

// Fifteen numbers from sqrt(a) on.
void append_galileo_orbit(MessageWriter& log, const Ephemeris& e) {
  log.f64s({e.sqrt_a, e.delta_n, e.m0, e.e, e.omega, e.cuc, e.cus, e.crc, e.crs, e.cic, e.cis, e.i0, e.i_dot,
            node_at_week_begin(e), e.omega_dot});
}

}  // namespace

void append_range(Bytes& bytes, const Header& header, std::span<const RangeRecord> records) {
  MessageWriter log(bytes, MessageId::kRange, header);
  log.u32(static_cast<std::uint32_t>(records.size()));
  for (const RangeRecord& record : records) {
    log.u16(static_cast<std::uint16_t>(record.satellite.prn));
    log.u16(0);  // GLONASS frequency
    log.f64(record.pseudorange_m);
    log.f32(record.pseudorange_sigma_m);
    log.f64(-record.carrier_phase_cycles);
    log.f32(record.carrier_sigma_cycles);
    log.f32(record.doppler_hz);
    log.f32(record.cn0_dbhz);
    log.f32(record.lock_time_s);
    log.u32(tracking_status(record));
  }
  log.finish();
}

void append_rawephem(Bytes& bytes, const Header& header, const BroadcastSet& set, fsw::GpsTime heard) {
  MessageWriter log(bytes, MessageId::kRawEphem, header);
  const WeekTime toe = week_time(System::kGps, set.ephemeris.toe);
  log.u32(static_cast<std::uint32_t>(set.ephemeris.satellite.prn));
  log.u32(static_cast<std::uint32_t>(toe.week));
  log.u32(whole_seconds(toe.seconds_of_week()));
  for (const Subframe& subframe : lnav_subframes(set.ephemeris, set.issue, heard))
    for (const std::uint8_t byte : subframe) log.u8(byte);
  log.finish();
}

void append_gpsephem(Bytes& bytes, const Header& header, const BroadcastSet& set, fsw::GpsTime heard) {
  MessageWriter log(bytes, MessageId::kGpsEphem, header);
  const Ephemeris& e = set.ephemeris;
  const WeekTime toe = week_time(System::kGps, e.toe);
  const WeekTime sent = week_time(System::kGps, heard);
  const double a = e.sqrt_a * e.sqrt_a;
  const auto issue = static_cast<std::uint32_t>(set.issue);
  log.u32(static_cast<std::uint32_t>(e.satellite.prn));
  log.f64(std::floor(sent.seconds_of_week() / 6.0) * 6.0);
  log.u32(0);  // healthy
  log.u32(issue);
  log.u32(issue);
  log.u32(static_cast<std::uint32_t>(toe.week));
  log.u32(static_cast<std::uint32_t>(sent.week));
  log.f64s({toe.seconds_of_week(), a, e.delta_n, e.m0, e.e, e.omega, e.cuc, e.cus, e.crc, e.crs, e.cic, e.cis, e.i0,
            e.i_dot, node_at_week_begin(e), e.omega_dot});
  log.u32(issue);
  log.f64s({toe.seconds_of_week(), e.group_delay_s, e.af0, e.af1, e.af2});
  log.u32(0);  // anti-spoofing off
  log.f64s({mean_motion(e), kUserRangeAccuracy_m * kUserRangeAccuracy_m});
  log.finish();
}

void append_galephemeris(Bytes& bytes, const Header& header, const BroadcastSet& set) {
  MessageWriter log(bytes, MessageId::kGalEphemeris, header);
  const Ephemeris& e = set.ephemeris;
  const std::uint32_t toe = whole_seconds(week_time(System::kGalileo, e.toe).seconds_of_week());
  constexpr std::uint8_t kAccuracyIndex = 107;  // 3.12 m, Galileo OS SIS ICD 2.1, table 89
  log.u32(static_cast<std::uint32_t>(e.satellite.prn));
  log.u32(0);    // F/NAV not received
  log.u32(1);    // I/NAV received
  log.zeros(6);  // healthy, data valid
  log.u8(kAccuracyIndex);
  log.u8(0);
  log.u32(static_cast<std::uint32_t>(set.issue));
  log.u32(toe);
  append_galileo_orbit(log, e);
  log.u32(0);
  log.f64s({0.0, 0.0, 0.0});  // F/NAV clock
  log.u32(toe);
  log.f64s({e.af0, e.af1, e.af2});
  log.f64s({0.0, e.group_delay_s});  // E1-E5a comes with F/NAV
  log.finish();
}

void append_bdsephemeris(Bytes& bytes, const Header& header, const BroadcastSet& set) {
  MessageWriter log(bytes, MessageId::kBdsEphemeris, header);
  const Ephemeris& e = set.ephemeris;
  const WeekTime toe = week_time(System::kBeidou, e.toe);
  log.u32(static_cast<std::uint32_t>(e.satellite.prn));
  log.u32(static_cast<std::uint32_t>(toe.week));
  log.f64(kUserRangeAccuracy_m);
  log.u32(0);  // healthy
  log.f64s({e.group_delay_s, 0.0});
  log.u32(static_cast<std::uint32_t>(set.issue));
  log.u32(whole_seconds(toe.seconds_of_week()));
  log.f64s({e.af0, e.af1, e.af2});
  log.u32(static_cast<std::uint32_t>(set.issue));
  log.u32(whole_seconds(toe.seconds_of_week()));
  log.f64s({e.sqrt_a, e.e, e.omega, e.delta_n, e.m0, node_at_week_begin(e), e.omega_dot, e.i0, e.i_dot, e.cuc, e.cus,
            e.crc, e.crs, e.cic, e.cis});
  log.finish();
}

void append_ionutc(Bytes& bytes, const Header& header, const BroadcastCorrections& corrections, const UtcOffset& utc) {
  MessageWriter log(bytes, MessageId::kIonUtc, header);
  constexpr std::uint32_t kReferenceTime_s = 589824;  // a multiple of 4096 s, as the message has it
  for (const double a : corrections.klobuchar.alpha) log.f64(a);
  for (const double b : corrections.klobuchar.beta) log.f64(b);
  log.u32(static_cast<std::uint32_t>(week_time(System::kGps, header.time).week));
  log.u32(kReferenceTime_s);
  log.f64s({corrections.utc_a0_s, corrections.utc_a1});
  log.u32(static_cast<std::uint32_t>(utc.change_week));
  log.u32(static_cast<std::uint32_t>(utc.change_day));
  log.i32(utc.gps_minus_utc_s);
  log.i32(utc.gps_minus_utc_s);
  log.u32(0);
  log.finish();
}

void append_bestxyz(Bytes& bytes, const Header& header, const PositionRecord& position) {
  MessageWriter log(bytes, MessageId::kBestXyz, header);
  const std::uint32_t status = position.solved ? 0U : 1U;  // solution computed; insufficient observations
  log.u32(status);
  log.u32(position.solved ? 16U : 0U);  // single point; none
  for (const double x : position.position_ecef) log.f64(x);
  for (const double sigma : position.position_sigma_m) log.f32(sigma);
  log.u32(status);
  log.u32(position.solved ? 8U : 0U);  // from Doppler; none
  for (const double v : position.velocity_ecef) log.f64(v);
  for (const double sigma : position.velocity_sigma_mps) log.f32(sigma);
  log.zeros(4);  // base station
  log.f32(0.0);  // latency of the velocity
  log.f32(0.0);  // age of differential corrections
  log.f32(0.0);  // age of the solution
  log.u8(static_cast<std::uint8_t>(position.satellites_tracked));
  log.u8(static_cast<std::uint8_t>(position.satellites_used));
  log.u8(static_cast<std::uint8_t>(position.satellites_used));  // with L1
  log.u8(0);                                                    // with more frequencies
  log.zeros(3);
  log.u8(position.solved ? 1 : 0);  // GPS L1 used
  log.finish();
}

void append_bestpos(Bytes& bytes, const Header& header, const PositionRecord& position) {
  MessageWriter log(bytes, MessageId::kBestPos, header);
  const truth::GeodeticPosition geodetic =
      position.solved ? truth::geodetic_from_itrf(position.position_ecef) : truth::GeodeticPosition{};
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr std::uint32_t kWgs84 = 61;
  log.u32(position.solved ? 0U : 1U);
  log.u32(position.solved ? 16U : 0U);
  log.f64s({geodetic.latitude / kDegree, geodetic.longitude / kDegree, geodetic.altitude});
  log.f32(0.0);  // undulation: the height is above the ellipsoid
  log.u32(kWgs84);
  // One sigma for north, east and up: the root mean square of the three axes.
  for (int k = 0; k < 3; ++k) log.f32(position.position_sigma_m.norm() / std::numbers::sqrt3);
  log.zeros(4);  // base station
  log.f32(0.0);  // age of differential corrections
  log.f32(0.0);  // age of the solution
  log.u8(static_cast<std::uint8_t>(position.satellites_tracked));
  for (int k = 0; k < 2; ++k) log.u8(static_cast<std::uint8_t>(position.satellites_used));
  log.zeros(4);
  log.u8(position.solved ? 1 : 0);  // GPS L1 used
  log.finish();
}

void append_version(Bytes& bytes, const Header& header, const VersionRecord& version) {
  MessageWriter log(bytes, MessageId::kVersion, header);
  log.u32(1);  // components
  log.u32(1);  // a GNSS card
  for (const std::string_view text : {version.model, version.serial, version.hardware, version.software, version.boot})
    log.text(text, 16);
  for (const std::string_view text : {version.date, version.time}) log.text(text, 12);
  log.finish();
}

void append_status_event(Bytes& bytes, const Header& header, const StatusEvent& event) {
  MessageWriter log(bytes, MessageId::kRxStatusEvent, header);
  log.u32(1);  // the receiver status word
  log.u32(event.bit);
  log.u32(event.set ? 1U : 0U);
  log.text(event.text, 32);
  log.finish();
}

void append_response(Bytes& bytes, const Header& header, std::uint16_t id, std::uint32_t response,
                     std::string_view text) {
  MessageWriter log(bytes, static_cast<MessageId>(id), header, true);
  log.u32(response);
  log.text(text, text.size());
  log.finish();
}

void append_time(Bytes& bytes, const Header& header, const ClockRecord& clock, const UtcOffset& utc) {
  MessageWriter log(bytes, MessageId::kTime, header);
  const CalendarTime calendar = clock.valid ? utc_calendar(header.time, utc) : CalendarTime{};
  log.u32(clock.valid ? 0U : 3U);  // valid; invalid
  log.f64(clock.offset_s);
  log.f64(clock.sigma_s);
  log.f64(-static_cast<double>(utc.gps_minus_utc_s));
  log.u32(static_cast<std::uint32_t>(calendar.year));
  for (const unsigned part : {calendar.month, calendar.day, calendar.hour, calendar.minute})
    log.u8(static_cast<std::uint8_t>(part));
  log.u32(calendar.millisecond);
  log.u32(clock.valid ? 1U : 0U);
  log.finish();
}

}  // namespace vbar::twins::gnss::oem
