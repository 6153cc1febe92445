#pragma once
// Binary logs as NovAtel's OEM6 and OEM7 receivers send them (OEM6 Family Firmware Reference Manual, OM-20000129):
// a long header of 28 bytes, a body, a CRC-32; little-endian. Each function appends one log to `bytes`.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/leap_seconds.h"

namespace vbar::twins::gnss::oem {

using Bytes = std::vector<std::uint8_t>;

enum class MessageId : std::uint16_t {
  kGpsEphem = 7,
  kIonUtc = 8,
  kVersion = 37,
  kRawEphem = 41,
  kBestPos = 42,
  kRange = 43,
  kRxStatusEvent = 94,
  kTime = 101,
  kBestXyz = 241,
  kGalEphemeris = 1122,
  kBdsEphemeris = 1696,
};

/// The time status of the receiver, as in the header.
enum class TimeStatus : std::uint8_t {
  kUnknown = 20,
  kApproximate = 60,
  kCoarse = 100,
  kCoarseSteering = 120,
  kFreewheeling = 130,
  kFine = 160,
  kFineSteering = 180,
};

/// Bits of the receiver status word.
inline constexpr unsigned kTransmitOverrunBit = 8;  ///< bit of COM1; those of COM2 and COM3 follow
inline constexpr unsigned kPositionInvalidBit = 19;
inline constexpr unsigned kClockModelInvalidBit = 22;

/// The common header of all logs of one epoch.
struct Header {
  fsw::GpsTime time;  ///< by the receiver's clock, integer milliseconds; not sent while the status is kUnknown
  TimeStatus status = TimeStatus::kUnknown;
  bool position_valid = false;
  std::uint8_t port = 0x20;            ///< COM1
  std::uint32_t more_status_bits = 0;  ///< of the receiver status word, beside "position invalid"

  [[nodiscard]] std::uint32_t status_word() const {
    return more_status_bits | (position_valid ? 0U : 1U << kPositionInvalidBit);
  }
};

/// State of a channel's loops in the tracking status word.
struct TrackingState {
  unsigned state = 4;  ///< 1 search, 2 pull-in, 4 phase lock loop, 7 frequency lock loop
  bool phase_lock = true;
  bool parity_known = true;
  bool code_lock = true;
};

/// One signal in RANGE.
struct RangeRecord {
  SatelliteId satellite;
  Signal signal = Signal::kGpsL1;
  int channel = 0;       ///< 0 to 31
  bool grouped = false;  ///< another signal of the satellite is tracked too
  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;  ///< grows with the range; the log has the opposite sign
  double doppler_hz = 0.0;
  double pseudorange_sigma_m = 0.0;
  double carrier_sigma_cycles = 0.0;
  double cn0_dbhz = 0.0;
  double lock_time_s = 0.0;
  TrackingState tracking = {};
};
void append_range(Bytes& bytes, const Header& header, std::span<const RangeRecord> records);

/// Appends a GPS ephemeris as subframes; `heard` is when the first began.
void append_rawephem(Bytes& bytes, const Header& header, const BroadcastSet& set, fsw::GpsTime heard);
/// Appends a GPS ephemeris as numbers.
void append_gpsephem(Bytes& bytes, const Header& header, const BroadcastSet& set, fsw::GpsTime heard);
void append_galephemeris(Bytes& bytes, const Header& header, const BroadcastSet& set);
void append_bdsephemeris(Bytes& bytes, const Header& header, const BroadcastSet& set);

/// Appends ionosphere and UTC; `utc` as of the header's time.
void append_ionutc(Bytes& bytes, const Header& header, const BroadcastCorrections& corrections, const UtcOffset& utc);

/// BESTXYZ: a single-point solution, or "insufficient observations" if `solved` is false.
struct PositionRecord {
  bool solved = false;
  fsw::Vector3 position_ecef = fsw::Vector3::Zero();
  fsw::Vector3 velocity_ecef = fsw::Vector3::Zero();
  fsw::Vector3 position_sigma_m = fsw::Vector3::Zero();
  fsw::Vector3 velocity_sigma_mps = fsw::Vector3::Zero();
  int satellites_tracked = 0;
  int satellites_used = 0;
};
void append_bestxyz(Bytes& bytes, const Header& header, const PositionRecord& position);

/// Appends BESTPOS: the position in geodetic coordinates, height above the ellipsoid.
void append_bestpos(Bytes& bytes, const Header& header, const PositionRecord& position);

/// TIME: the clock's offset as the receiver estimates it (GPS time = receiver time - offset), and UTC.
struct ClockRecord {
  bool valid = false;
  double offset_s = 0.0;
  double sigma_s = 0.0;
};
void append_time(Bytes& bytes, const Header& header, const ClockRecord& clock, const UtcOffset& utc);

/// VERSION: one component, the receiver itself.
struct VersionRecord {
  std::string_view model, serial, hardware, software, boot;  ///< up to 16 characters
  std::string_view date, time;                               ///< date of the software, up to 12 characters
};
void append_version(Bytes& bytes, const Header& header, const VersionRecord& version);

/// RXSTATUSEVENT: a bit of the receiver status word has changed.
struct StatusEvent {
  unsigned bit = 0;
  bool set = false;
  std::string_view text;  ///< up to 32 characters
};
void append_status_event(Bytes& bytes, const Header& header, const StatusEvent& event);

/// Appends the answer to the binary command `id`.
void append_response(Bytes& bytes, const Header& header, std::uint16_t id, std::uint32_t response,
                     std::string_view text);

}  // namespace vbar::twins::gnss::oem
