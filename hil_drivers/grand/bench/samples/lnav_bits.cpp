#include "hil_drivers/grand/bench/samples/lnav_bits.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/grand/bench/samples/ca_code.h"
#include "host_sim/twins/gnss/leap_seconds.h"

namespace vbar::grand::bench {

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
