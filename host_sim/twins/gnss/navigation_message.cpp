#include "host_sim/twins/gnss/navigation_message.h"

#include <bit>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {

namespace {

constexpr double kSemicircle = std::numbers::pi;

// Least significant bits, in the units of Ephemeris.
struct Grid {
  double sqrt_a = 0x1p-19;
  double e = 0x1p-33;
  double angle = 0x1p-31 * kSemicircle;
  double angle_rate = 0x1p-43 * kSemicircle;
  double harmonic_angle;
  double harmonic_radius;
  double af0;
  double af1;
  double af2;
  double group_delay;
};

const Grid& grid_of(System system) {
  static constexpr Grid kGps{.harmonic_angle = 0x1p-29,
                             .harmonic_radius = 0x1p-5,
                             .af0 = 0x1p-31,
                             .af1 = 0x1p-43,
                             .af2 = 0x1p-55,
                             .group_delay = 0x1p-31};
  static constexpr Grid kGalileo{.harmonic_angle = 0x1p-29,
                                 .harmonic_radius = 0x1p-5,
                                 .af0 = 0x1p-34,
                                 .af1 = 0x1p-46,
                                 .af2 = 0x1p-59,
                                 .group_delay = 0x1p-32};
  static constexpr Grid kBeidou{.harmonic_angle = 0x1p-31,
                                .harmonic_radius = 0x1p-6,
                                .af0 = 0x1p-33,
                                .af1 = 0x1p-50,
                                .af2 = 0x1p-66,
                                .group_delay = 1e-10};
  switch (system) {
    case System::kGps:
      return kGps;
    case System::kGalileo:
      return kGalileo;
    case System::kBeidou:
      return kBeidou;
  }
  return kGps;
}

double rounded(double value, double grid) {
  return std::nearbyint(value / grid) * grid;
}

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

// Writes fields of bits, most significant first, as the signal carries them.
class SubframeWriter {
 public:
  /// `source` names the origin of the numbers in messages.
  SubframeWriter(Subframe& subframe, std::string source) : subframe_(subframe), source_(std::move(source)) {}

  void bits(std::uint64_t value, int count) {
    for (int k = count - 1; k >= 0; --k, ++position_)
      if (((value >> static_cast<unsigned>(k)) & 1U) != 0)
        subframe_[position_ / 8] = static_cast<std::uint8_t>(subframe_[position_ / 8] | (0x80U >> (position_ % 8)));
  }

  void skip(std::size_t count) { position_ += count; }

  void number(const char* name, double value, double grid, int count, bool is_signed = true) {
    const double scaled = std::nearbyint(value / grid);
    const double low = is_signed ? -std::ldexp(1.0, count - 1) : 0.0;
    const double high = std::ldexp(1.0, is_signed ? count - 1 : count) - 1.0;
    if (!(scaled >= low && scaled <= high))
      throw std::out_of_range(fmt::format("{}: {} = {} does not fit the navigation message", source_, name, value));
    bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(scaled)), count);
  }

  /// An angle: one above half a revolution wraps around.
  void angle(double value, int count) {
    const double scaled = std::nearbyint(wrapped(value) / (0x1p-31 * kSemicircle));
    bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(scaled)), count);
  }

 private:
  Subframe& subframe_;
  std::string source_;
  std::size_t position_ = 0;
};

constexpr double kUtcReferenceTime_s = 147456.0;  // seconds of the week, a multiple of 4096 s

std::int64_t seconds_of_week(fsw::GpsTime time) {
  return week_time(System::kGps, time).ns_of_week / fsw::kNanosecondsPerSecond;
}

// Telemetry word and handover word: preamble; time of week at the beginning of the NEXT subframe in units of 6 s.
void write_head(SubframeWriter& writer, unsigned subframe, std::int64_t transmission_s) {
  writer.bits(0x8B, 8);
  writer.bits(0, 16);
  const std::int64_t next = (transmission_s / 6 + subframe) % (kSecondsPerWeek / 6);
  writer.bits(static_cast<std::uint64_t>(next), 17);
  writer.bits(0, 2);  // alert, anti-spoof
  writer.bits(subframe, 3);
  writer.bits(0, 2);  // solved for parity, which is removed
}

}  // namespace

double node_at_week_begin(const Ephemeris& ephemeris) {
  const System system = ephemeris.satellite.system;
  return wrapped(ephemeris.node_at_toe + earth_rate(system) * week_time(system, ephemeris.toe).seconds_of_week());
}

Ephemeris rounded_to_message(const Ephemeris& ephemeris) {
  const System system = ephemeris.satellite.system;
  const Grid& grid = grid_of(system);
  Ephemeris message = ephemeris;
  message.sqrt_a = rounded(ephemeris.sqrt_a, grid.sqrt_a);
  message.e = rounded(ephemeris.e, grid.e);
  for (double* angle : {&message.m0, &message.i0, &message.omega}) *angle = rounded(wrapped(*angle), grid.angle);
  for (double* rate : {&message.delta_n, &message.omega_dot, &message.i_dot}) *rate = rounded(*rate, grid.angle_rate);
  for (double* harmonic : {&message.cuc, &message.cus, &message.cic, &message.cis})
    *harmonic = rounded(*harmonic, grid.harmonic_angle);
  for (double* harmonic : {&message.crc, &message.crs}) *harmonic = rounded(*harmonic, grid.harmonic_radius);
  message.node_at_toe = rounded(node_at_week_begin(ephemeris), grid.angle) -
                        earth_rate(system) * week_time(system, ephemeris.toe).seconds_of_week();
  message.af0 = rounded(ephemeris.af0, grid.af0);
  message.af1 = rounded(ephemeris.af1, grid.af1);
  message.af2 = rounded(ephemeris.af2, grid.af2);
  message.group_delay_s = rounded(ephemeris.group_delay_s, grid.group_delay);
  return message;
}

std::array<Subframe, 3> lnav_subframes(const Ephemeris& ephemeris, int issue, fsw::GpsTime transmission) {
  const Grid& grid = grid_of(System::kGps);
  const auto issue_bits = static_cast<std::uint64_t>(issue);
  const double toe_s = week_time(System::kGps, ephemeris.toe).seconds_of_week();
  const WeekTime sent = week_time(System::kGps, transmission);
  const std::int64_t sent_s = sent.ns_of_week / fsw::kNanosecondsPerSecond;
  std::array<Subframe, 3> subframes{};

  SubframeWriter first(subframes[0], name_of(ephemeris.satellite));
  write_head(first, 1, sent_s);
  first.bits(static_cast<std::uint64_t>(sent.week % 1024), 10);
  first.bits(1, 2);                 // P code on L2
  first.bits(0, 4);                 // user range accuracy index
  first.bits(0, 6);                 // healthy
  first.bits(issue_bits >> 8U, 2);  // IODC, upper bits
  first.skip(1 + 87);               // L2 P data flag, reserved
  first.number("group delay", ephemeris.group_delay_s, grid.group_delay, 8);
  first.bits(issue_bits, 8);
  first.number("toc", toe_s, 16.0, 16, false);
  first.number("af2", ephemeris.af2, grid.af2, 8);
  first.number("af1", ephemeris.af1, grid.af1, 16);
  first.number("af0", ephemeris.af0, grid.af0, 22);

  SubframeWriter second(subframes[1], name_of(ephemeris.satellite));
  write_head(second, 2, sent_s);
  second.bits(issue_bits, 8);
  second.number("crs", ephemeris.crs, grid.harmonic_radius, 16);
  second.number("delta n", ephemeris.delta_n, grid.angle_rate, 16);
  second.angle(ephemeris.m0, 32);
  second.number("cuc", ephemeris.cuc, grid.harmonic_angle, 16);
  second.number("e", ephemeris.e, grid.e, 32, false);
  second.number("cus", ephemeris.cus, grid.harmonic_angle, 16);
  second.number("sqrt a", ephemeris.sqrt_a, grid.sqrt_a, 32, false);
  second.number("toe", toe_s, 16.0, 16, false);
  second.bits(0, 1);  // fit interval: four hours
  second.bits(0, 5);  // age of data offset

  SubframeWriter third(subframes[2], name_of(ephemeris.satellite));
  write_head(third, 3, sent_s);
  third.number("cic", ephemeris.cic, grid.harmonic_angle, 16);
  third.angle(node_at_week_begin(ephemeris), 32);
  third.number("cis", ephemeris.cis, grid.harmonic_angle, 16);
  third.angle(ephemeris.i0, 32);
  third.number("crc", ephemeris.crc, grid.harmonic_radius, 16);
  third.angle(ephemeris.omega, 32);
  third.number("omega dot", ephemeris.omega_dot, grid.angle_rate, 24);
  third.bits(issue_bits, 8);
  third.number("i dot", ephemeris.i_dot, grid.angle_rate, 14);
  return subframes;
}

Subframe lnav_page_18(const BroadcastCorrections& corrections, const UtcOffset& utc, fsw::GpsTime transmission) {
  constexpr std::uint64_t kDataId = 1;
  constexpr std::uint64_t kPageId = 56;
  Subframe subframe{};
  SubframeWriter page(subframe, "ionosphere and UTC");
  write_head(page, 4, seconds_of_week(transmission));
  page.bits(kDataId, 2);
  page.bits(kPageId, 6);
  constexpr std::array<double, 4> kAlphaGrid{0x1p-30, 0x1p-27, 0x1p-24, 0x1p-24};
  constexpr std::array<double, 4> kBetaGrid{0x1p11, 0x1p14, 0x1p16, 0x1p16};
  for (std::size_t k = 0; k < 4; ++k) page.number("alpha", corrections.klobuchar.alpha[k], kAlphaGrid[k], 8);
  for (std::size_t k = 0; k < 4; ++k) page.number("beta", corrections.klobuchar.beta[k], kBetaGrid[k], 8);
  page.number("A1", corrections.utc_a1, 0x1p-50, 24);
  page.number("A0", corrections.utc_a0_s, 0x1p-30, 32);
  page.number("tot", kUtcReferenceTime_s, 0x1p12, 8, false);
  page.bits(static_cast<std::uint64_t>(week_time(System::kGps, transmission).week % 256), 8);
  page.number("leap seconds", utc.gps_minus_utc_s, 1.0, 8);
  page.bits(static_cast<std::uint64_t>(utc.change_week % 256), 8);
  page.bits(static_cast<std::uint64_t>(utc.change_day), 8);
  page.number("leap seconds", utc.gps_minus_utc_s, 1.0, 8);
  return subframe;
}

Subframe lnav_dummy_page(unsigned subframe, fsw::GpsTime transmission) {
  constexpr int kContentBits = 240 - 48 - 8;
  Subframe bytes{};
  SubframeWriter page(bytes, "dummy page");
  write_head(page, subframe, seconds_of_week(transmission));
  page.bits(1, 2);  // data identification
  page.bits(0, 6);  // dummy satellite
  for (int k = 0; k < kContentBits / 2 - 1; ++k) page.bits(0b10, 2);
  return bytes;  // the last two bits are solved for parity
}

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
