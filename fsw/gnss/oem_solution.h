#pragma once
// Solutions of a NovAtel receiver and data common to all satellites: the ionospheric model, its clock
// offset, its own position (OEM7 Commands and Logs Reference Manual, logs of these names).
//
// Errors of all functions: kWrongType for another id; kTooShort for a body shorter than the log; kNotReady if the
// receiver reports no solution; kNotFinite, kOutOfRange for invalid values; for logs with a time, the results of
// time_of().

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/gnss/ionosphere.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

inline constexpr std::uint16_t kOemIonosphere = 8;
inline constexpr std::uint16_t kOemBestPosition = 42;
inline constexpr std::uint16_t kOemTime = 101;
inline constexpr std::uint16_t kOemBestXyz = 241;

/// Offset of the receiver's clock from GPS time.
struct ReceiverClock {
  GpsTime receiver_time;
  double offset_s = 0.0;  ///< GPS time is the receiver's time minus this offset
  double sigma_s = 0.0;
};

/// The receiver's own single-point solution; 1-sigma values are its own.
struct ReceiverPosition {
  GpsTime receiver_time;
  Vector3 position_ecef = Vector3::Zero();
  Vector3 position_sigma_m = Vector3::Zero();  ///< along x, y, z
  bool has_velocity = false;
  Vector3 velocity_ecef = Vector3::Zero();
  Vector3 velocity_sigma_mps = Vector3::Zero();
  double velocity_latency_s = 0.0;  ///< age of the velocity at receiver_time
  std::uint8_t satellites_used = 0;
};

/// Reads IONUTC (id 8): the ionospheric model.
Result<KlobucharCoefficients> read_ionosphere(const OemMessage& message);

/// Reads TIME (id 101). kNotReady unless the clock model is valid.
Result<ReceiverClock> read_time(const OemMessage& message);

/// Reads BESTXYZ (id 241). Without a velocity solution has_velocity is false.
Result<ReceiverPosition> read_best_xyz(const OemMessage& message);

/// Reads BESTPOS (id 42): geodetic on WGS 84, converted to Cartesian here; no velocity. Its standard deviations are
/// those of north, east and up: each axis is assigned the root of their sum of squares.
Result<ReceiverPosition> read_best_position(const OemMessage& message);

}  // namespace vbar::fsw::gnss
