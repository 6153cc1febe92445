#include "host_sim/app/line_usage.h"

#include <algorithm>

namespace vbar::app {
namespace {

constexpr int kBoardBaud = 921600;
constexpr double kBitsPerByte = 10.0;  // 8N1

int baud_of(const mission::FlightComputer& computer) {
  if (computer.target == mission::FlightTarget::kInProcess || computer.link != mission::FlightLink::kSerial) return 0;
  return computer.baud.value_or(computer.target == mission::FlightTarget::kBoard ? kBoardBaud : 0);
}

std::uint64_t bytes_of(const pil::LinkStatistics& link) {
  return link.bytes_sent + link.bytes_received;
}

}  // namespace

LineUsage::LineUsage(const mission::FlightComputer& computer, fsw::Duration step_period,
                     const pil::LinkStatistics& before)
    : baud_(baud_of(computer)), step_period_s_(fsw::seconds(step_period)), bytes_so_far_(bytes_of(before)) {}

void LineUsage::after_step(const pil::LinkStatistics& link) {
  const std::uint64_t bytes = bytes_of(link);
  const std::uint64_t of_step = bytes - bytes_so_far_;
  bytes_so_far_ = bytes;
  bytes_ += of_step;
  bytes_of_step_max_ = std::max(bytes_of_step_max_, of_step);
  ++steps_;
}

void LineUsage::summarise(report::Summary::Link& summary) const {
  summary.baud = baud_;
  if (baud_ == 0 || steps_ == 0) return;
  const double share_of_byte = kBitsPerByte / baud_ / step_period_s_;
  summary.step_share_max = static_cast<double>(bytes_of_step_max_) * share_of_byte;
  summary.step_share_mean = static_cast<double>(bytes_) / static_cast<double>(steps_) * share_of_byte;
}

}  // namespace vbar::app
