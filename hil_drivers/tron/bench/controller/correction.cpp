#include "hil_drivers/tron/bench/controller/correction.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace vbar::tron::bench {

Correction::Correction(const rsi::EthernetXml& ethernet, const rsi::ContextXml& context)
    : ethernet_(ethernet), context_(context) {}

void Correction::begin(const AxisArray& pose) {
  pose_ = command_ = pose;
  values_ = {};
  was_clamped_ = stop_ = stop_rises_ = false;
  beyond_monitor_.clear();
}

void Correction::take_value(std::size_t axis, const rsi::ReceivedValue& received, std::optional<double> value) {
  if (value)
    values_[axis] = *value;
  else if (!received.holds_on)
    values_[axis] = 0.0;
}

void Correction::take_stop(const rsi::Sen* answer) {
  const bool before = stop_;
  if (answer != nullptr && answer->stop)
    stop_ = *answer->stop;
  else if (!ethernet_.stop.holds_on)
    stop_ = false;
  stop_rises_ = stop_ && !before;
}

void Correction::apply(std::size_t axis, const rsi::CorrectionRange& range, double monitor) {
  const double value = std::clamp(values_[axis], range.lower, range.upper);
  was_clamped_ = was_clamped_ || value != values_[axis];
  if (!(std::abs(value) <= monitor) && beyond_monitor_.empty())
    beyond_monitor_ =
        fmt::format("{}: {:.4f} of {:.4f}", axis == kTrackAxis ? "E1" : fmt::format("A{}", axis + 1), value, monitor);
  command_[axis] = pose_[axis] + value / (axis == kTrackAxis ? rsi::kMillimetresPerMetre : rsi::kDegreesPerRadian);
}

void Correction::take(const rsi::Sen* answer) {
  was_clamped_ = false;
  take_stop(answer);
  for (std::size_t k = 0; k < rsi::kWireAxes; ++k) {
    take_value(k, ethernet_.axes[k], answer == nullptr ? std::nullopt : answer->axes_deg[k]);
    apply(k, context_.axes[k], context_.monitor_deg[k]);
  }
  if (!context_.track) return;
  take_value(kTrackAxis, ethernet_.track, answer == nullptr ? std::nullopt : answer->track_mm);
  apply(kTrackAxis, *context_.track, context_.track_monitor_mm);
}

}  // namespace vbar::tron::bench
