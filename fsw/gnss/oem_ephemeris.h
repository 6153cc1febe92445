#pragma once
// The broadcast ephemerides output by a NovAtel receiver (OEM7 Commands and Logs Reference Manual, logs of these
// names): GPS as the navigation message's own bits or decoded, Galileo and BeiDou decoded.
//
// Errors of all functions: kWrongType for another id; kTooShort for a body shorter than the log (a longer one is
// accepted: the manual appends new fields); kBadSequence if the parts of the set are of different issues; otherwise the
// result of check().

#include "fsw/core/result.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

inline constexpr std::uint16_t kOemGpsEphemeris = 7;
inline constexpr std::uint16_t kOemRawEphemeris = 41;
inline constexpr std::uint16_t kOemGalileoEphemeris = 1122;
inline constexpr std::uint16_t kOemBeidouEphemeris = 1696;

/// Reads RAWEPHEM (id 41): subframes 1 to 3 of the GPS navigation message, scaled as IS-GPS-200N, tables 20-I and
/// 20-III.
Result<Ephemeris> read_raw_ephemeris(const OemMessage& message);

/// Reads GPSEPHEM (id 7).
Result<Ephemeris> read_gps_ephemeris(const OemMessage& message);

/// Reads GALEPHEMERIS (id 1122): orbit and I/NAV clock, with the group delay of E1 against E5b. The log has no week: it
/// is the one that brings toe nearest to the message's own time, so that results of time_of() may occur. kNotReady: the
/// receiver has no I/NAV clock yet.
Result<Ephemeris> read_galileo_ephemeris(const OemMessage& message);

/// Reads BDSEPHEMERIS (id 1696): weeks and seconds of BeiDou time, converted to GPS time here.
Result<Ephemeris> read_beidou_ephemeris(const OemMessage& message);

}  // namespace vbar::fsw::gnss
