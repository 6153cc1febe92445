#include "host_sim/campaign_report/campaign.h"

#include <algorithm>

namespace vbar::campaign_report {

const Figure* Campaign::figure(std::string_view key) const {
  const auto found = std::ranges::find(figures, key, &Figure::key);
  return found == figures.end() ? nullptr : &*found;
}

std::string_view name_of(State state) {
  switch (state) {
    case State::kNotBegun:
      return "not begun";
    case State::kFlying:
      return "flying";
    case State::kComplete:
      return "complete";
    case State::kFailed:
      return "failed";
    case State::kOverTime:
      return "over time";
    case State::kKilled:
      return "killed";
    case State::kLost:
      return "lost";
    case State::kVoid:
      return "void";
  }
  return "unknown";
}

}  // namespace vbar::campaign_report
