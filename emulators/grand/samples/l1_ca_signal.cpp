#include "emulators/grand/samples/l1_ca_signal.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {

namespace {

// Stages of G2 whose sum gives the code of each number: column "code phase selection" of table 3-Ia.
struct PhaseSelection {
  std::size_t first, second;
};
constexpr std::array<PhaseSelection, kCaCodes> kPhaseSelections{
    {{2, 6}, {3, 7}, {4, 8}, {5, 9}, {1, 9},  {2, 10}, {1, 8}, {2, 9}, {3, 10}, {2, 3}, {3, 4},
     {5, 6}, {6, 7}, {7, 8}, {8, 9}, {9, 10}, {1, 4},  {2, 5}, {3, 6}, {4, 7},  {5, 8}, {6, 9},
     {1, 3}, {4, 6}, {5, 7}, {6, 8}, {7, 9},  {8, 10}, {1, 6}, {2, 7}, {3, 8},  {4, 9}}};

// Ten stages; stage n is element n - 1.
using Register = std::array<std::uint8_t, 10>;

void shift(Register& stages, std::uint8_t input) {
  for (std::size_t k = stages.size() - 1; k > 0; --k) stages[k] = stages[k - 1];
  stages[0] = input;
}

CaCode generated(const PhaseSelection& selection) {
  Register g1;
  Register g2;
  g1.fill(1);
  g2.fill(1);
  CaCode code{};
  for (std::uint8_t& chip : code) {
    chip = static_cast<std::uint8_t>(g1[9] ^ g2[selection.first - 1] ^ g2[selection.second - 1]);
    shift(g1, static_cast<std::uint8_t>(g1[2] ^ g1[9]));                                  // 1 + x^3 + x^10
    shift(g2, static_cast<std::uint8_t>(g2[1] ^ g2[2] ^ g2[5] ^ g2[7] ^ g2[8] ^ g2[9]));  // 1+x^2+x^3+x^6+x^8+x^9+x^10
  }
  return code;
}

}  // namespace

const CaCode& ca_code(int prn) {
  static const std::array<CaCode, kCaCodes> kCodes = [] {
    std::array<CaCode, kCaCodes> codes{};
    for (std::size_t k = 0; k < codes.size(); ++k) codes[k] = generated(kPhaseSelections[k]);
    return codes;
  }();
  if (prn < 1 || prn > kCaCodes)
    throw std::out_of_range(fmt::format("C/A code of PRN {}; accepted are 1 to {}", prn, kCaCodes));
  return kCodes[static_cast<std::size_t>(prn - 1)];
}

using twins::gnss::BroadcastSet;
using twins::gnss::SatelliteId;
using twins::gnss::Subframe;
using twins::gnss::System;
using twins::gnss::TransmittedSubframe;

LnavBits::LnavBits(std::shared_ptr<const twins::gnss::Constellation> constellation)
    : constellation_(std::move(constellation)), satellites_(kCaCodes + 1) {
  if (!constellation_) throw std::invalid_argument("navigation messages: no constellation");
  for (std::size_t k = 0; k < constellation_->size(); ++k) {
    const SatelliteId id = constellation_->id(k);
    if (id.system != System::kGps || id.prn < 1 || id.prn > kCaCodes) continue;
    Satellite& satellite = satellites_[static_cast<std::size_t>(id.prn)];
    satellite.index = k;
    satellite.present = true;
  }
}

LnavBits::Satellite& LnavBits::entry(SatelliteId satellite) {
  const bool known = satellite.system == System::kGps && satellite.prn >= 1 && satellite.prn <= kCaCodes &&
                     satellites_[static_cast<std::size_t>(satellite.prn)].present;
  if (!known)
    throw std::out_of_range(
        fmt::format("navigation messages: the constellation has no GPS satellite {}", name_of(satellite)));
  return satellites_[static_cast<std::size_t>(satellite.prn)];
}

Subframe LnavBits::content(std::size_t index, std::int64_t number) const {
  const fsw::GpsTime frame = fsw::GpsTime{} + fsw::duration_of_seconds(number / 5 * 30);
  const auto in_frame = static_cast<unsigned>(number % 5 + 1);
  if (in_frame == 4) return lnav_page_18(constellation_->corrections(), twins::gnss::utc_offset_at(frame), frame);
  if (in_frame == 5) return twins::gnss::lnav_dummy_page(in_frame, frame);
  const BroadcastSet set = constellation_->broadcast_set(index, frame);
  return lnav_subframes(set.ephemeris, set.issue, frame)[in_frame - 1];
}

const TransmittedSubframe& LnavBits::subframe(SatelliteId satellite, std::int64_t number) {
  Satellite& known = entry(satellite);
  Cached& cached = known.cached[static_cast<std::size_t>(number & 1)];
  if (cached.number != number) {
    cached.words = twins::gnss::lnav_transmitted(content(known.index, number));
    cached.number = number;
  }
  return cached.words;
}

bool LnavBits::bit(SatelliteId satellite, std::int64_t time_ms) {
  const TransmittedSubframe& words = subframe(satellite, time_ms / kSubframe_ms);
  const auto position = static_cast<std::size_t>(time_ms % kSubframe_ms / kBit_ms);
  return (words[position / 30] >> (29 - position % 30) & 1U) != 0;
}

}  // namespace vbar::grand::bench
