#pragma once
// The figures of a flown receiver beside those of its twin on the same orbit.

#include <string>
#include <vector>

#include "host_sim/flown_gnss/flown_receiver.h"

namespace vbar::flown_gnss {

struct ComparedFigure {
  std::string name;  ///< with its unit
  double flown = 0.0, twin = 0.0;
  std::size_t count = 0;  ///< values of the flown receiver behind it
  [[nodiscard]] double ratio() const { return twin / flown; }
};

/// Returns errors of the orbit over all hours, satellites of an epoch, noise by elevation and correlation of code.
/// Elevations at which either has fewer than a hundred values are left out.
[[nodiscard]] std::vector<ComparedFigure> compare(const FlownResult& flown, const FlownResult& twin);

}  // namespace vbar::flown_gnss
