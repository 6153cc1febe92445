#include "fsw/navigation/ephemeris_store.h"

#include <optional>

namespace vbar::fsw::navigation {
namespace {

/// Index in the table; no value for a number outside the constellation.
std::optional<std::size_t> place_of(gnss::SatelliteId satellite) {
  constexpr std::array<std::size_t, gnss::kConstellations> kFirst{0, 32, 68};
  constexpr std::array<std::size_t, gnss::kConstellations> kCount{32, 36, 63};
  const auto system = static_cast<std::size_t>(satellite.constellation);
  if (system >= gnss::kConstellations || satellite.prn < 1 || satellite.prn > kCount[system]) return std::nullopt;
  return kFirst[system] + satellite.prn - 1U;
}

Duration distance(GpsTime a, GpsTime b) {
  return a < b ? b - a : a - b;
}

}  // namespace

Status EphemerisStore::put(const gnss::Ephemeris& ephemeris) {
  const std::optional<std::size_t> place = place_of(ephemeris.satellite);
  if (!place) return Status::kOutOfRange;
  if (const Status status = gnss::check(ephemeris); status != Status::kOk) return status;
  Sets& sets = satellites_[*place];
  for (std::size_t k = 0; k < sets.count; ++k) {
    if (sets.set[k].issue == ephemeris.issue && sets.set[k].toe == ephemeris.toe) {
      sets.set[k] = ephemeris;
      return Status::kOk;
    }
  }
  if (sets.count < sets.set.size()) {
    sets.set[sets.count++] = ephemeris;
  } else {
    sets.set[sets.set[0].toe < sets.set[1].toe ? 0 : 1] = ephemeris;  // the older one is replaced
  }
  return Status::kOk;
}

const gnss::Ephemeris* EphemerisStore::find(gnss::SatelliteId satellite, GpsTime time) const {
  const std::optional<std::size_t> place = place_of(satellite);
  if (!place) return nullptr;
  const gnss::Ephemeris* nearest = nullptr;
  for (std::size_t k = 0; k < satellites_[*place].count; ++k) {
    const gnss::Ephemeris& candidate = satellites_[*place].set[k];
    const Duration age = distance(candidate.toe, time);
    if (!candidate.healthy || age > kLongestAge) continue;
    if (nearest == nullptr || age < distance(nearest->toe, time)) nearest = &candidate;
  }
  return nearest;
}

}  // namespace vbar::fsw::navigation
