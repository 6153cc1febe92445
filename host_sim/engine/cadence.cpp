#include "host_sim/engine/cadence.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace vbar::engine {

Cadence::Cadence(std::vector<Part> parts) : parts_(std::move(parts)) {
  if (parts_.empty()) throw std::invalid_argument("a cadence without a period");
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (parts_[k].period.ns <= 0) throw std::invalid_argument("a period that is not above zero");
    if (k > 0 && parts_[k].from <= parts_[k - 1].from)
      throw std::invalid_argument("periods that are not in order of the times from which they hold");
  }
}

fsw::GpsTime Cadence::next_after(fsw::GpsTime time) const {
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const auto& [from, period] = parts_[k];
    const std::int64_t passed = time < from ? 0 : (time - from).ns / period.ns;
    const fsw::GpsTime next = from + fsw::Duration{(passed + 1) * period.ns};
    if (k + 1 == parts_.size() || next <= parts_[k + 1].from) return next;
  }
  throw std::logic_error("a cadence without a period");
}

std::int64_t Cadence::number_of(fsw::GpsTime time) const {
  std::int64_t count = 0;
  for (std::size_t k = 0; k < parts_.size() && parts_[k].from < time; ++k) {
    const auto& [from, period] = parts_[k];
    // Epochs in (from, end): up to the beginning of the next part, which itself counts if it is before `time`.
    const bool is_last = k + 1 == parts_.size() || parts_[k + 1].from >= time;
    const fsw::Duration span = (is_last ? time - fsw::Duration{1} : parts_[k + 1].from) - from;
    count += span.ns / period.ns;
  }
  return count;
}

fsw::Duration Cadence::shortest_period() const {
  return std::ranges::min_element(parts_, {}, &Part::period)->period;
}

}  // namespace vbar::engine
