#pragma once
// The list of all sources of navigation. A new source is a folder beside this file, with its header and its place in
// the list below.

#include <tuple>

#include "fsw/sources/bearings/bearing_source.h"
#include "fsw/sources/carrier_pair/carrier_source.h"
#include "fsw/sources/ideal/ideal_source.h"
#include "fsw/sources/keypoints/keypoint_source.h"
#include "fsw/sources/own_gnss/own_gnss_source.h"
#include "fsw/sources/range_finder/range_source.h"

namespace vbar::fsw::sources {

/// Records of one time are processed in this order: the servicer's own position first.
using SourceList = std::tuple<IdealSource, OwnGnssSource, CarrierSource, BearingSource, KeypointSource, RangeSource>;

/// Whether the filter can distinguish all sources of the list.
template <class... Source>
constexpr bool have_places(const std::tuple<Source...>* /*list*/) {
  return ((filter::MeasurementSource{.bit = Source::kUse}.place() < filter::RelativeNavigationFilter::kMaxSources) &&
          ...);
}
static_assert(have_places(static_cast<const SourceList*>(nullptr)));

}  // namespace vbar::fsw::sources
