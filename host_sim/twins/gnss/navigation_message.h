#pragma once
// Resolution of the navigation messages of the satellites: the grid of each number, and the GPS subframes.
// IS-GPS-200N, tables 20-I and 20-III, figure 20-1; Galileo OS SIS ICD 2.1, tables 67 to 70 and 76;
// BDS-SIS-ICD-B1I-3.0, tables 5-8 to 5-11.

#include <array>
#include <cstdint>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/satellite.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {

/// Returns the set as broadcast, every number rounded to the least significant bit of the message.
Ephemeris rounded_to_message(const Ephemeris& ephemeris);

/// Returns omega0 as the message has it: longitude of the node at the beginning of the system's week, rad in [-pi, pi].
double node_at_week_begin(const Ephemeris& ephemeris);

/// Ten words of 24 bits, without parity, as a receiver writes them.
using Subframe = std::array<std::uint8_t, 30>;

/// Returns subframes 1 to 3 of the GPS LNAV message for a healthy satellite, user range accuracy index 0 (2.4 m).
/// `transmission` is when subframe 1 begins; `issue` is 0 to 255 and becomes IODC and IODE. Throws std::out_of_range,
/// naming satellite and number, where one does not fit its field.
std::array<Subframe, 3> lnav_subframes(const Ephemeris& ephemeris, int issue, fsw::GpsTime transmission);

/// Returns page 18 of subframe 4: ionosphere and UTC parameters. `transmission` is when subframe 1 of the frame begins.
/// Throws std::out_of_range where a number does not fit its field.
Subframe lnav_page_18(const BroadcastCorrections& corrections, const UtcOffset& utc, fsw::GpsTime transmission);

/// Returns a page of subframe 4 or 5 without content: the almanac of dummy satellite 0, alternating ones and zeros
/// (IS-GPS-200N 20.3.3.5.1.2).
Subframe lnav_dummy_page(unsigned subframe, fsw::GpsTime transmission);

// The words of the GPS LNAV message as they are transmitted: parity of IS-GPS-200N 20.3.5.2, table 20-XIV.

/// Ten words of 30 bits, the first transmitted in bit 29.
using TransmittedSubframe = std::array<std::uint32_t, 10>;

/// Returns the word of 30 bits after `previous` (of which D29 and D30 are used) that carries the 24 bits of `data`.
std::uint32_t lnav_word(std::uint32_t data, std::uint32_t previous);

/// Returns the subframe with parity. The last two data bits of words 2 and 10 are solved so that D29 and D30 are zero,
/// so that subframes do not depend on each other.
TransmittedSubframe lnav_transmitted(const Subframe& subframe);

}  // namespace vbar::twins::gnss
