#include "hil_drivers/optical_stimulator/bench/light/display_light.h"

#include <algorithm>
#include <cmath>

#include "host_sim/engine/distributions.h"

namespace vbar::optical_stimulator::bench {

double DisplayLight::luminance(double count) const {
  if (!(count > first_count)) return 0.0;
  return full_luminance * std::pow((count - first_count) / (255.0 - first_count), gamma);
}

CountTable luminance_table(const DisplayLight& light) {
  CountTable table{};
  for (std::size_t count = 0; count < kCounts; ++count)
    table[count] = static_cast<float>(light.luminance(static_cast<double>(count)));
  return table;
}

double PixelEvenness::of(std::uint64_t pixel) const {
  const double uniform = stream_.uniforms_of(pixel / 4)[pixel % 4];
  return std::max(0.0, 1.0 + sigma_ * engine::normal_quantile(uniform));
}

}  // namespace vbar::optical_stimulator::bench
