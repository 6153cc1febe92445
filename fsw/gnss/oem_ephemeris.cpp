#include "fsw/gnss/oem_ephemeris.h"

#include <optional>

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/oem_fields.h"
#include "fsw/gnss/oem_range.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

using Bytes = std::span<const std::uint8_t>;

Status shape(const OemMessage& message, std::uint16_t id, std::size_t body_bytes) {
  if (message.id != id) return Status::kWrongType;
  return message.body.size() < body_bytes ? Status::kTooShort : Status::kOk;
}

std::optional<SatelliteId> satellite(Constellation constellation, std::uint32_t prn) {
  if (prn == 0 || prn > highest_prn(constellation)) return std::nullopt;
  return SatelliteId{constellation, static_cast<std::uint8_t>(prn)};
}

/// A time of week sent as a real number; no value if it is invalid.
std::optional<Duration> of_week(double seconds_of_week) {
  if (!(seconds_of_week >= 0.0 && seconds_of_week < static_cast<double>(kSecondsPerWeek))) return std::nullopt;
  return nearest_duration(seconds_of_week);
}

Result<Ephemeris> checked(const Ephemeris& ephemeris) {
  const Status status = check(ephemeris);
  if (status != Status::kOk) return status;
  return ephemeris;
}

/// The six harmonic terms, three after sqrt(A) in the order of the three decoded logs.
void read_harmonics(Bytes body, std::size_t offset, Ephemeris& ephemeris) {
  ephemeris.cuc = read_f64(body, offset);
  ephemeris.cus = read_f64(body, offset + 8);
  ephemeris.crc = read_f64(body, offset + 16);
  ephemeris.crs = read_f64(body, offset + 24);
  ephemeris.cic = read_f64(body, offset + 32);
  ephemeris.cis = read_f64(body, offset + 40);
}

void read_clock(Bytes body, std::size_t offset, Ephemeris& ephemeris) {
  ephemeris.af0 = read_f64(body, offset);
  ephemeris.af1 = read_f64(body, offset + 8);
  ephemeris.af2 = read_f64(body, offset + 16);
}

}  // namespace

Result<Ephemeris> read_gps_ephemeris(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 224;
  const Status status = shape(message, kOemGpsEphemeris, kBodyBytes);
  if (status != Status::kOk) return status;
  const Bytes body = message.body;
  const std::uint32_t week = read_u32(body, 24);
  const auto id = satellite(Constellation::kGps, read_u32(body, 0));
  const auto toe = of_week(read_f64(body, 32));
  const auto toc = of_week(read_f64(body, 164));
  const double semi_major_axis = read_f64(body, 40);
  const std::uint32_t issue = read_u32(body, 16);
  if (!id || !toe || !toc || week == 0 || week > kMaxWeek || issue > 255) return Status::kOutOfRange;
  if (issue != read_u32(body, 20)) return Status::kBadSequence;

  Ephemeris ephemeris;
  ephemeris.satellite = *id;
  ephemeris.healthy = read_u32(body, 12) == 0;
  ephemeris.issue = static_cast<std::int32_t>(issue);
  ephemeris.toe = start_of_week(week) + *toe;
  ephemeris.toc = nearest_with_time_of_week(ephemeris.toe, *toc);
  ephemeris.toe_of_week_s = seconds(*toe);
  ephemeris.sqrt_a = semi_major_axis > 0.0 ? math::sqrt(semi_major_axis) : 0.0;
  ephemeris.delta_n = read_f64(body, 48);
  ephemeris.m0 = read_f64(body, 56);
  ephemeris.e = read_f64(body, 64);
  ephemeris.omega = read_f64(body, 72);
  read_harmonics(body, 80, ephemeris);
  ephemeris.i0 = read_f64(body, 128);
  ephemeris.i_dot = read_f64(body, 136);
  ephemeris.omega0 = read_f64(body, 144);
  ephemeris.omega_dot = read_f64(body, 152);
  ephemeris.group_delay_s = read_f64(body, 172);
  read_clock(body, 180, ephemeris);
  return checked(ephemeris);
}

Result<Ephemeris> read_galileo_ephemeris(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 220;
  const Status status = shape(message, kOemGalileoEphemeris, kBodyBytes);
  if (status != Status::kOk) return status;
  const Bytes body = message.body;
  if (read_u32(body, 8) == 0) return Status::kNotReady;  // no I/NAV
  const Result<GpsTime> now = time_of(message);
  if (!now.ok()) return now.status();
  const auto id = satellite(Constellation::kGalileo, read_u32(body, 0));
  const std::uint32_t issue = read_u32(body, 20);
  const std::uint32_t toe_s = read_u32(body, 24);
  const std::uint32_t toc_s = read_u32(body, 176);
  if (!id || issue > 1023 || toe_s >= kSecondsPerWeek || toc_s >= kSecondsPerWeek) return Status::kOutOfRange;

  Ephemeris ephemeris;
  ephemeris.satellite = *id;
  const bool e1_signal_ok = body[12] == 0;
  const bool e1_data_valid = body[15] == 0;
  ephemeris.healthy = e1_signal_ok && e1_data_valid;
  ephemeris.issue = static_cast<std::int32_t>(issue);
  ephemeris.toe = nearest_with_time_of_week(now.value(), duration_of_seconds(toe_s));
  ephemeris.toc = nearest_with_time_of_week(ephemeris.toe, duration_of_seconds(toc_s));
  ephemeris.toe_of_week_s = toe_s;
  ephemeris.sqrt_a = read_f64(body, 28);
  ephemeris.delta_n = read_f64(body, 36);
  ephemeris.m0 = read_f64(body, 44);
  ephemeris.e = read_f64(body, 52);
  ephemeris.omega = read_f64(body, 60);
  read_harmonics(body, 68, ephemeris);
  ephemeris.i0 = read_f64(body, 116);
  ephemeris.i_dot = read_f64(body, 124);
  ephemeris.omega0 = read_f64(body, 132);
  ephemeris.omega_dot = read_f64(body, 140);
  read_clock(body, 180, ephemeris);
  ephemeris.group_delay_s = read_f64(body, 212);
  return checked(ephemeris);
}

Result<Ephemeris> read_beidou_ephemeris(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 196;
  const Status status = shape(message, kOemBeidouEphemeris, kBodyBytes);
  if (status != Status::kOk) return status;
  const Bytes body = message.body;
  const auto id = satellite(Constellation::kBeidou, read_u32(body, 0));
  const std::uint32_t week = read_u32(body, 4);
  const std::uint32_t toc_s = read_u32(body, 40);
  const std::uint32_t issue = read_u32(body, 68);
  const std::uint32_t toe_s = read_u32(body, 72);
  if (!id || week > kMaxWeek - kBeidouFirstGpsWeek || issue > 31 || toe_s >= kSecondsPerWeek ||
      toc_s >= kSecondsPerWeek) {
    return Status::kOutOfRange;
  }

  Ephemeris ephemeris;
  ephemeris.satellite = *id;
  ephemeris.healthy = read_u32(body, 16) == 0;
  ephemeris.issue = static_cast<std::int32_t>(issue);
  ephemeris.toe = start_of_week(kBeidouFirstGpsWeek + week) + duration_of_seconds(toe_s) + kGpsMinusBeidouTime;
  ephemeris.toc = nearest_with_time_of_week(ephemeris.toe, duration_of_seconds(toc_s) + kGpsMinusBeidouTime);
  ephemeris.toe_of_week_s = toe_s;
  ephemeris.group_delay_s = read_f64(body, 20);
  read_clock(body, 44, ephemeris);
  ephemeris.sqrt_a = read_f64(body, 76);
  ephemeris.e = read_f64(body, 84);
  ephemeris.omega = read_f64(body, 92);
  ephemeris.delta_n = read_f64(body, 100);
  ephemeris.m0 = read_f64(body, 108);
  ephemeris.omega0 = read_f64(body, 116);
  ephemeris.omega_dot = read_f64(body, 124);
  ephemeris.i0 = read_f64(body, 132);
  ephemeris.i_dot = read_f64(body, 140);
  read_harmonics(body, 148, ephemeris);
  return checked(ephemeris);
}

}  // namespace vbar::fsw::gnss
