#include "hil_drivers/grand/tag_check.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/gnss/gps_week.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::grand {
namespace {

constexpr std::int64_t kCycle_ns = 1024 * fsw::gnss::kNanosecondsPerWeek;
// An epoch cannot arrive before it was measured. The bytes of sixty signals at 115,200 baud take 0.24 s, so that a
// scenario that is off by a second shows in either direction.
constexpr fsw::Duration kEarliest{-50'000'000};
constexpr fsw::Duration kLatest{950'000'000};

bool is_plausible(fsw::Duration latency) {
  return latency >= kEarliest && latency <= kLatest;
}

}  // namespace

void TagCheck::check(fsw::GpsTime tag, fsw::GpsTime arrival) {
  const fsw::Duration apart = arrival - tag;
  const std::int64_t cycles = std::llround(static_cast<double>(apart.ns) / static_cast<double>(kCycle_ns));
  const fsw::Duration latency{apart.ns - cycles * kCycle_ns};
  const int weeks = static_cast<int>(1024 * cycles);
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(fmt::format("{}: its time is {} where the run's is {}: {}", receiver_,
                                         truth::format_utc(tag), truth::format_utc(arrival), what));
  };
  // After the first tag a late epoch is one of a slow line: the flight software goes by its tag.
  if (weeks_ && weeks == *weeks_) return;
  if (!is_plausible(latency))
    fail(fmt::format("{:.3f} s apart; check the start time of the scenario and the leap seconds",
                     fsw::seconds(latency)));
  if (weeks != 0 && !accepts_week_shift_)
    fail(fmt::format("{} weeks apart, a rollover of its week number; testbed.grand.week_shift = true accepts it",
                     weeks));
  if (weeks_) fail(fmt::format("{} weeks apart, after {}", weeks, *weeks_));
  weeks_ = weeks;
}

}  // namespace vbar::grand
