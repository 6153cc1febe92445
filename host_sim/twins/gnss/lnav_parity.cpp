#include "host_sim/twins/gnss/lnav_parity.h"

#include <bit>
#include <initializer_list>

namespace vbar::twins::gnss {
namespace {

constexpr std::uint32_t kDataMask = 0xFFFFFF;

// Data bits d1 to d24 as bits 23 to 0.
constexpr std::uint32_t mask_of(std::initializer_list<unsigned> data_bits) {
  std::uint32_t mask = 0;
  for (const unsigned bit : data_bits) mask |= 1U << (24U - bit);
  return mask;
}

// Bits D25 to D30: the data bits summed, and which of the last two bits of the previous word is added.
struct ParityBit {
  std::uint32_t mask;
  bool adds_d29;  // otherwise D30
};
constexpr std::array<ParityBit, 6> kParityBits{{
    {mask_of({1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23}), true},
    {mask_of({2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24}), false},
    {mask_of({1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22}), true},
    {mask_of({2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23}), false},
    {mask_of({1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24}), false},
    {mask_of({3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24}), true},
}};

// With d23 and d24 such that the word ends with D29 = D30 = 0.
std::uint32_t solved_word(std::uint32_t data, std::uint32_t previous) {
  for (std::uint32_t last = 0; last < 4; ++last) {
    const std::uint32_t word = lnav_word((data & ~3U) | last, previous);
    if ((word & 3U) == 0) return word;
  }
  return 0;  // not reached: d24 sets D29, then d23 sets D30
}

}  // namespace

std::uint32_t lnav_word(std::uint32_t data, std::uint32_t previous) {
  const std::uint32_t d29 = previous >> 1U & 1U;
  const std::uint32_t d30 = previous & 1U;
  std::uint32_t word = (d30 != 0 ? ~data : data) & kDataMask;
  for (const ParityBit& bit : kParityBits) {
    const auto sum = static_cast<std::uint32_t>(std::popcount(data & bit.mask));
    word = word << 1U | ((sum + (bit.adds_d29 ? d29 : d30)) & 1U);
  }
  return word;
}

TransmittedSubframe lnav_transmitted(const Subframe& subframe) {
  TransmittedSubframe words{};
  std::uint32_t previous = 0;  // the word before ends with two zeros
  for (std::size_t k = 0; k < words.size(); ++k) {
    const auto data = static_cast<std::uint32_t>(subframe[3 * k]) << 16U |
                      static_cast<std::uint32_t>(subframe[3 * k + 1]) << 8U | subframe[3 * k + 2];
    words[k] = k == 1 || k == 9 ? solved_word(data, previous) : lnav_word(data, previous);
    previous = words[k];
  }
  return words;
}

}  // namespace vbar::twins::gnss
