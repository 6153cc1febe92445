#pragma once
// The bytes of a receiver on their way to the flight software, for tests that spoil them: taken out of the packets of a
// step, changed, and put back into packets.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "pil_bridge/flight_computer.h"
#include "tests/integration/rendezvous/flown_mission.h"

namespace vbar::test {

using Bytes = std::vector<std::uint8_t>;

/// Both receivers' bytes of one step; either may be empty.
struct ReceiverBytes {
  Bytes servicer;
  Bytes target;
};

/// Changes the bytes of steps `first` to `last`.
Wrap spoil_steps(std::uint32_t first, std::uint32_t last, const std::function<void(ReceiverBytes&)>& spoil);

/// Calls `edit(id, message)` for each message of NovAtel's binary format in `bytes`, which holds whole ones; `message`
/// is header and body, which may change in content and length. Length field and check sum are then made right again.
void edit_messages(Bytes& bytes, const std::function<void(int id, Bytes& message)>& edit);

/// Bytes of a message's header, and its numbers (OM-20000129).
inline constexpr std::size_t kOemHeaderBytes = 28;
inline constexpr int kRange = 43, kRawEphem = 41, kGalEphemeris = 1122, kBdsEphemeris = 1696;

/// RANGE: a count, and records of so many bytes, which begin with the satellite's number (16 bits), GLONASS frequency
/// (16 bits), and pseudorange (double).
inline constexpr std::size_t kRangeRecordBytes = 44;

}  // namespace vbar::test
