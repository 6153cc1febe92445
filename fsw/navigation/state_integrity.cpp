#include "fsw/navigation/state_integrity.h"

#include <cstddef>
#include <cstring>

namespace vbar::fsw::navigation {
namespace {

/// Returns a checksum that detects any change within one aligned word with certainty, because multiplication by an odd
/// number maps distinct words to distinct ones, and any other change with a probability of 1 - 2^-64. It is the hash of
/// Fowler, Noll and Vo with words of 64 bits in place of bytes: one multiplication for eight bytes. The words are
/// distributed over four sums, whose multiplications do not wait for each other.
std::uint64_t checksum(const filter::RelativeNavigationFilter& filter) {
  constexpr std::uint64_t kPrime = 0x100000001B3U, kBasis = 0xCBF29CE484222325U;
  constexpr std::size_t kWords = sizeof(filter::RelativeNavigationFilter) / sizeof(std::uint64_t);
  static_assert(sizeof(filter::RelativeNavigationFilter) % sizeof(std::uint64_t) == 0);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(&filter);
  const auto add = [bytes](std::uint64_t& sum, std::size_t place) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + place * sizeof word, sizeof word);
    sum = (sum ^ word) * kPrime;
  };
  std::uint64_t first = kBasis, second = kBasis + 1U, third = kBasis + 2U, fourth = kBasis + 3U;
  constexpr std::size_t kRest = kWords % 4U;
  for (std::size_t place = 0; place < kWords - kRest; place += 4U) {
    add(first, place);
    add(second, place + 1U);
    add(third, place + 2U);
    add(fourth, place + 3U);
  }
  for (std::size_t place = kWords - kRest; place < kWords; ++place) add(first, place);
  for (const std::uint64_t lane : {second, third, fourth}) first = (first ^ lane) * kPrime;
  return first;
}

/// Copies bytes with their padding: assignment would first read what may be damaged, such as whether an optional value
/// is present. The filter consists of plain objects without pointers.
void copy_bytes(filter::RelativeNavigationFilter& to, const filter::RelativeNavigationFilter& from) {
  std::memcpy(static_cast<void*>(&to), static_cast<const void*>(&from), sizeof(filter::RelativeNavigationFilter));
}

}  // namespace

void StateIntegrity::seal(const filter::RelativeNavigationFilter& filter) {
  copy_bytes(copy_, filter);
  checksum_ = checksum(filter);
  is_sealed_ = true;
}

Integrity StateIntegrity::verify(filter::RelativeNavigationFilter& filter) const {
  if (!is_sealed_) return Integrity::kIntact;
  const bool is_copy_intact = checksum(copy_) == checksum_;
  if (checksum(filter) == checksum_) return is_copy_intact ? Integrity::kIntact : Integrity::kCopyDamaged;
  if (!is_copy_intact) return Integrity::kLost;
  copy_bytes(filter, copy_);
  return Integrity::kRestored;
}

}  // namespace vbar::fsw::navigation
