#pragma once
// Earth orientation and space weather of a run: from the file that is named, from the data folder, or assumed. What is
// assumed or predicted is noted with the size of the error.

#include "host_sim/truth/force_list.h"

namespace vbar::truth {

/// Load data of the Earth. Both throw std::runtime_error for a missing or damaged file or, where settings do not accept
/// predictions, a predicted value, and std::out_of_range if a file that is named does not reach from the epoch to the
/// end.
void load_earth_orientation(const TruthSettings& settings, ForceData& data);
void load_space_weather(const TruthSettings& settings, ForceData& data);

}  // namespace vbar::truth
