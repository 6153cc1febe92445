#pragma once
// Bits of the flight software's memory that change between two steps.

#include <span>
#include <vector>

#include "fsw/gnc/gnc.h"
#include "tests/unit/fsw/gnc/article.h"

namespace vbar::fsw::gnc::test {

const GncState& state_of(Article& article);

/// The bytes of a part of the state, to be changed.
template <class Part>
std::span<unsigned char> bytes_of(const Part& part, std::size_t size = sizeof(Part)) {
  return {const_cast<unsigned char*>(static_cast<const unsigned char*>(static_cast<const void*>(&part))), size};
}

void flip(unsigned char& byte, int bit);

inline constexpr int kFlips = 100;

/// kFlips times, from the memory of an article, one bit at a random place of a part changes before a step at `now` with
/// `packets`: the step reports it, and its answer is otherwise that without the flip.
void expect_flips_corrected(const std::vector<std::byte>& memory, std::span<unsigned char> (*part)(Article&),
                            GpsTime now, Duration period, const std::vector<Bytes>& packets);

}  // namespace vbar::fsw::gnc::test
