#pragma once
// Bands on rows over time, as SVG inside a page: what happened when.

#include <string>
#include <vector>

#include "host_sim/report/plot_axis.h"

namespace vbar::report {

struct Band {
  double start_h = 0.0, end_h = 0.0;
  int colour = 0;      ///< index in the page's palette, 0 to 5; 6 warns
  std::string text{};  ///< written inside where it has room, and shown on pointing at it
};

struct TimelineRow {
  std::string name;
  std::vector<Band> bands;
};

[[nodiscard]] std::string timeline(const std::vector<TimelineRow>& rows, const Range& hours);

}  // namespace vbar::report
