#pragma once
// Binary logs as NovAtel's OEM6 and OEM7 receivers send them (OEM6 Family Firmware Reference Manual, OM-20000129):
// a long header of 28 bytes, a body, a CRC-32; little-endian. Each function appends one log to `bytes`.

#include <bit>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/system_time.h"

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

// One binary message of an OEM6 receiver: header, fields, CRC-32; little-endian.

/// Computes NovAtel's CRC-32: the standard polynomial, but initialised with 0 and not inverted.
std::uint32_t crc32(std::span<const std::uint8_t> bytes);

/// Writer of a message. The header is written at once, its length and the CRC by finish().
class MessageWriter {
 public:
  MessageWriter(Bytes& bytes, MessageId id, const Header& header, bool is_response = false);

  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) { little_endian(value); }
  void u32(std::uint32_t value) { little_endian(value); }
  void i32(std::int32_t value) { little_endian(static_cast<std::uint32_t>(value)); }
  void f32(double value) { little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void f64(double value) { little_endian(std::bit_cast<std::uint64_t>(value)); }
  void f64s(std::initializer_list<double> values) {
    for (const double value : values) f64(value);
  }
  void zeros(int count) {
    for (int k = 0; k < count; ++k) u8(0);
  }
  /// Writes a field of `size` characters, cut or filled with zeros.
  void text(std::string_view value, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k) u8(k < value.size() ? static_cast<std::uint8_t>(value[k]) : 0);
  }

  void finish();

 private:
  template <std::unsigned_integral T>
  void little_endian(T value) {
    for (std::size_t k = 0; k < sizeof(T); ++k)
      bytes_.push_back(static_cast<std::uint8_t>((value >> (8U * k)) & 0xFFU));
  }

  Bytes& bytes_;
  std::size_t begin_;
};

}  // namespace vbar::twins::gnss::oem
