#include "hil_drivers/grand/tag_check.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/gnss/gps_week.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::grand {
namespace {

constexpr std::int64_t kCycle_ns = 1024 * fsw::gnss::kNanosecondsPerWeek;
// An epoch cannot arrive before it was measured.
constexpr fsw::Duration kEarliest{-50'000'000};

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
  if (latency < kEarliest || latency > max_latency_)
    fail(
        fmt::format("{:.3f} s apart, where -0.05 to {:g} s are allowed; check the start time of the scenario, the leap "
                    "seconds and sensors.gnss.max_latency_s",
                    fsw::seconds(latency), fsw::seconds(max_latency_)));
  if (weeks != 0 && !accepts_week_shift_)
    fail(fmt::format("{} weeks apart, a rollover of its week number; testbed.grand.week_shift = true accepts it",
                     weeks));
  if (weeks_) fail(fmt::format("{} weeks apart, after {}", weeks, *weeks_));
  weeks_ = weeks;
}

}  // namespace vbar::grand
