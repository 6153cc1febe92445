#pragma once
// The list of all sources of navigation. A new source is a folder beside this file, with its header and its place in
// the list below.

#include <tuple>

#include "fsw/measurements/bearings/bearing_source.h"
#include "fsw/measurements/cdgnss/cdgnss_source.h"
#include "fsw/measurements/gnss_absolute_source.h"
#include "fsw/measurements/ideal_source.h"
#include "fsw/measurements/keypoints/keypoint_source.h"
#include "fsw/measurements/range_source.h"

namespace vbar::fsw::measurements {

/// Records of one time are processed in this order: the servicer's own position first.
using SourceList =
    std::tuple<IdealSource, GnssAbsoluteSource, CdgnssSource, BearingSource, KeypointSource, RangeSource>;

/// Whether the filter can distinguish all sources of the list.
template <class... Source>
constexpr bool have_places(const std::tuple<Source...>* /*list*/) {
  return ((filter::MeasurementSource{.bit = Source::kUse}.place() < filter::RelativeNavigationFilter::kMaxSources) &&
          ...);
}
static_assert(have_places(static_cast<const SourceList*>(nullptr)));

}  // namespace vbar::fsw::measurements
