#include "tests/integration/experiment3/flight.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"

namespace vbar::test {
namespace {

constexpr int kFixed = telemetry_navigation::kSourceGnssFixed;

double distance(const report::Triple& a, const report::Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

void judge(Flight& flight) {
  const report::RunRecord& record = flight.flown.record;
  ASSERT_EQ(record.estimates.size(), record.truth.size());
  double count = 0.0;
  for (std::size_t k = 0; k < record.estimates.size(); ++k) {
    const report::EstimateRow& estimate = record.estimates[k];
    if (estimate.navigation_source == kFixed && !flight.first_fix_s)
      flight.first_fix_s = estimate.time_s - record.truth.front().time_s;
    if (!flight.first_fix_s) continue;
    ASSERT_EQ(estimate.navigation_valid, 1) << estimate.time_s;
    const double position_m = distance(estimate.relative_position_rtn, record.truth[k].relative_position_rtn);
    flight.mean_position_m += position_m;
    flight.largest_position_m.add(position_m);
    flight.mean_velocity_mps += distance(estimate.relative_velocity_rtn, record.truth[k].relative_velocity_rtn);
    count += 1.0;
  }
  ASSERT_GT(count, 0.0) << "never fixed";
  flight.mean_position_m /= count;
  flight.mean_velocity_mps /= count;
}

}  // namespace

Flight fly_experiment3(std::uint64_t seed, std::vector<std::string> overrides, const Wrap& wrap) {
  overrides.push_back(fmt::format("mission.seed={}", seed));
  Flight flight;
  flight.flown = fly("experiment3.toml", overrides, wrap);
  EXPECT_TRUE(flight.flown.complete) << seed;
  judge(flight);
  return flight;
}

template <class Message>
std::vector<Message> telemetry_of(const FlownMission& flown) {
  std::vector<Message> messages;
  std::span<const std::uint8_t> rest = flown.telemetry;
  while (!rest.empty()) {
    const std::size_t size = 7U + 256U * rest[4] + rest[5];  // CCSDS 133.0-B: six bytes, and data length less one
    const auto packet = fsw::packets::parse_packet(rest.first(size));
    if (const auto message = fsw::packets::decode<Message>(packet.value()); message.ok()) {
      messages.push_back(message.value());
    }
    rest = rest.subspan(size);
  }
  return messages;
}

template std::vector<telemetry_health> telemetry_of(const FlownMission& flown);
template std::vector<telemetry_gnss> telemetry_of(const FlownMission& flown);
template std::vector<telemetry_navigation> telemetry_of(const FlownMission& flown);

}  // namespace vbar::test
