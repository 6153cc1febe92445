// RAWEPHEM: subframes 1 to 3 as the satellite sends them, without parity: ten words of 24 bits, 30 bytes per subframe.

#include <optional>

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/oem_ephemeris.h"
#include "fsw/gnss/oem_fields.h"
#include "fsw/gnss/oem_range.h"

namespace vbar::fsw::gnss {
namespace {

constexpr std::size_t kBodyBytes = 102;
constexpr std::size_t kSubframeBytes = 30;
constexpr std::size_t kFirstSubframe = 12;
constexpr std::uint32_t kPreamble = 0x8B;
constexpr std::uint32_t kWeekModulus = 1024;
// Pi as in the interface document, for consistency with the control segment (IS-GPS-200N, 20.3.3.4.3.3).
constexpr double kSemicircle = 3.1415926535898;

constexpr double two_to_the(int power) {
  double value = 1.0;
  for (int k = 0; k < power; ++k) value *= 2.0;
  for (int k = 0; k > power; --k) value /= 2.0;
  return value;
}

/// Reads one subframe by word (1 to 10) and bit (1 to 24), as the interface document numbers them. A field may continue
/// in the next word.
class Subframe {
 public:
  Subframe(std::span<const std::uint8_t> body, std::size_t number)
      : bytes_(body.subspan(kFirstSubframe + (number - 1) * kSubframeBytes, kSubframeBytes)) {}

  [[nodiscard]] std::uint32_t bits(std::size_t word, std::size_t bit, unsigned count) const {
    return read_high_first_bits(bytes_, (word - 1) * 24 + bit - 1, count);
  }
  /// Unsigned, in units of 2^power.
  [[nodiscard]] double scaled(std::size_t word, std::size_t bit, unsigned count, int power) const {
    return static_cast<double>(bits(word, bit, count)) * two_to_the(power);
  }
  /// Two's complement, in units of 2^power.
  [[nodiscard]] double signed_scaled(std::size_t word, std::size_t bit, unsigned count, int power) const {
    return static_cast<double>(sign_extended(bits(word, bit, count), count)) * two_to_the(power);
  }
  /// Returns true if it begins as subframe `number` does.
  [[nodiscard]] bool is(std::uint32_t number) const { return bits(1, 1, 8) == kPreamble && bits(2, 20, 3) == number; }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Table 20-I.
void read_clock(const Subframe& one, Ephemeris& ephemeris) {
  ephemeris.healthy = one.bits(3, 17, 6) == 0;
  ephemeris.group_delay_s = one.signed_scaled(7, 17, 8, -31);
  ephemeris.af2 = one.signed_scaled(9, 1, 8, -55);
  ephemeris.af1 = one.signed_scaled(9, 9, 16, -43);
  ephemeris.af0 = one.signed_scaled(10, 1, 22, -31);
}

/// Table 20-III.
void read_orbit(const Subframe& two, const Subframe& three, Ephemeris& ephemeris) {
  ephemeris.crs = two.signed_scaled(3, 9, 16, -5);
  ephemeris.delta_n = two.signed_scaled(4, 1, 16, -43) * kSemicircle;
  ephemeris.m0 = two.signed_scaled(4, 17, 32, -31) * kSemicircle;
  ephemeris.cuc = two.signed_scaled(6, 1, 16, -29);
  ephemeris.e = two.scaled(6, 17, 32, -33);
  ephemeris.cus = two.signed_scaled(8, 1, 16, -29);
  ephemeris.sqrt_a = two.scaled(8, 17, 32, -19);
  ephemeris.toe_of_week_s = two.scaled(10, 1, 16, 4);
  ephemeris.cic = three.signed_scaled(3, 1, 16, -29);
  ephemeris.omega0 = three.signed_scaled(3, 17, 32, -31) * kSemicircle;
  ephemeris.cis = three.signed_scaled(5, 1, 16, -29);
  ephemeris.i0 = three.signed_scaled(5, 17, 32, -31) * kSemicircle;
  ephemeris.crc = three.signed_scaled(7, 1, 16, -5);
  ephemeris.omega = three.signed_scaled(7, 17, 32, -31) * kSemicircle;
  ephemeris.omega_dot = three.signed_scaled(9, 1, 24, -43) * kSemicircle;
  ephemeris.i_dot = three.signed_scaled(10, 9, 14, -43) * kSemicircle;
}

/// Returns true if the week of transmission, sent modulo 1024, is the one of the reference time or next to it.
bool week_agrees(std::uint32_t sent, std::uint32_t reference_week) {
  const std::uint32_t ahead = (sent + kWeekModulus - reference_week % kWeekModulus) % kWeekModulus;
  return ahead <= 1 || ahead == kWeekModulus - 1;
}

}  // namespace

Result<Ephemeris> read_raw_ephemeris(const OemMessage& message) {
  if (message.id != kOemRawEphemeris) return Status::kWrongType;
  if (message.body.size() < kBodyBytes) return Status::kTooShort;
  const std::uint32_t prn = read_u32(message.body, 0);
  const std::uint32_t week = read_u32(message.body, 4);
  const Subframe one(message.body, 1);
  const Subframe two(message.body, 2);
  const Subframe three(message.body, 3);
  const std::int64_t toe_s = static_cast<std::int64_t>(two.bits(10, 1, 16)) * 16;
  const std::int64_t toc_s = static_cast<std::int64_t>(one.bits(8, 9, 16)) * 16;
  if (prn == 0 || prn > highest_prn(Constellation::kGps) || week == 0 || week > kMaxWeek || toe_s >= kSecondsPerWeek ||
      toc_s >= kSecondsPerWeek) {
    return Status::kOutOfRange;
  }
  if (!one.is(1) || !two.is(2) || !three.is(3)) return Status::kBadSequence;
  const std::uint32_t issue = two.bits(3, 1, 8);
  const bool one_set = issue == three.bits(10, 1, 8) && issue == one.bits(8, 1, 8);
  const bool one_time = toe_s == read_u32(message.body, 8) && week_agrees(one.bits(3, 1, 10), week);
  if (!one_set || !one_time) return Status::kBadSequence;

  Ephemeris ephemeris;
  ephemeris.satellite = {Constellation::kGps, static_cast<std::uint8_t>(prn)};
  ephemeris.issue = static_cast<std::int32_t>(issue);
  ephemeris.toe = start_of_week(week) + duration_of_seconds(toe_s);
  ephemeris.toc = nearest_with_time_of_week(ephemeris.toe, duration_of_seconds(toc_s));
  read_clock(one, ephemeris);
  read_orbit(two, three, ephemeris);
  const Status status = check(ephemeris);
  if (status != Status::kOk) return status;
  return ephemeris;
}

}  // namespace vbar::fsw::gnss
