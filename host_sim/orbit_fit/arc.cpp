#include "host_sim/orbit_fit/arc.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_fit {

namespace {

/// Calls `take(track, state)` for each state in the span.
template <class Take>
void for_each_state(const orbit_files::OrbitFile& file, const ArcSpan& span, const Take& take) {
  for (const orbit_files::Track& track : file.tracks)
    for (const orbit_files::TimedState& state : track.states)
      if ((!span.from || state.time >= *span.from) && (!span.to || state.time <= *span.to)) take(track, state);
}

}  // namespace

ArcSpan span_of(const orbit_files::OrbitFile& file, const ArcSpan& wanted) {
  ArcSpan span;
  std::size_t count = 0;
  for_each_state(file, wanted, [&](const auto&, const orbit_files::TimedState& state) {
    if (!span.from) span.from = state.time;
    if (span.to && state.time <= *span.to)
      throw std::runtime_error(fmt::format("{}: two states at {} or in descending order; accepted: one at a time",
                                           file.file, truth::format_utc(state.time)));
    span.to = state.time;
    ++count;
  });
  const double length_s = count > 0 ? fsw::seconds(*span.to - *span.from) : 0.0;
  if (count < kMinPositions || length_s < kMinArc_s)
    throw std::runtime_error(
        fmt::format("{}: {} positions over {:.0f} s in the span to fit; accepted: at least {} over {:.0f} s", file.file,
                    count, length_s, kMinPositions, kMinArc_s));
  return span;
}

Arc arc_of(const orbit_files::OrbitFile& file, const ArcSpan& span,
           std::shared_ptr<const truth::EarthOrientationSeries> orientation) {
  Arc arc;
  arc.object = file.tracks.front().object;
  arc.epoch = *span.from;
  truth::EarthRotation rotation(std::move(orientation), arc.epoch);
  for_each_state(file, span, [&](const orbit_files::Track& track, const orbit_files::TimedState& state) {
    const double seconds = fsw::seconds(state.time - arc.epoch);
    arc.seconds.push_back(seconds);
    arc.positions_eci.push_back(orbit_files::gcrf_state(track.frame, state.state, rotation, seconds).position_eci);
  });
  const orbit_files::FramedState first = orbit_files::state_at(file, arc.epoch);
  arc.first = orbit_files::gcrf_state(first.frame, first.state, rotation, 0.0);
  return arc;
}

Arc until(const Arc& arc, double seconds) {
  Arc part = arc;
  const auto count = std::max<std::ptrdiff_t>(1, std::ranges::upper_bound(arc.seconds, seconds) - arc.seconds.begin());
  part.seconds.resize(static_cast<std::size_t>(count));
  part.positions_eci.resize(static_cast<std::size_t>(count));
  return part;
}

}  // namespace vbar::orbit_fit
