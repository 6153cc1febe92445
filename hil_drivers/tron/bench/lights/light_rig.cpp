#include "hil_drivers/tron/bench/lights/light_rig.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {
namespace {

constexpr double kFullValue = std::numeric_limits<std::uint16_t>::max();
constexpr double kMinGamma = 0.1;

}  // namespace

double LightRig::Response::light(std::uint16_t value) const {
  return value == 0 ? 0.0 : gain * std::pow(value / kFullValue, gamma);
}

LightRig::LightRig(const Lamp& lamp, const LightErrorSizes& sizes, std::uint64_t seed)
    : lamp_(lamp),
      azimuth_rad_(0.5 * (lamp.azimuth_low_rad + lamp.azimuth_high_rad)),
      wanted_azimuth_rad_(azimuth_rad_) {
  for (std::size_t k = 0; k < responses_.size(); ++k) {
    engine::RandomStream random(seed, "tron/lights/" + (k == 0 ? std::string("lamp") : "box " + std::to_string(k)));
    responses_[k].gamma = std::max(kMinGamma, sizes.gamma + sizes.gamma_spread * random.normal());
    responses_[k].gain = std::max(0.0, 1.0 + sizes.gain_spread * random.normal());
  }
}

void LightRig::command(const LightValues& values) {
  values_ = values;
  const double share = values[kPlace] / kFullValue;
  wanted_azimuth_rad_ = lamp_.azimuth_low_rad + share * (lamp_.azimuth_high_rad - lamp_.azimuth_low_rad);
}

void LightRig::switch_off() {
  values_ = {};
  wanted_azimuth_rad_ = azimuth_rad_;
}

void LightRig::advance(double bench_s) {
  const double way = lamp_.speed_rad_s * std::max(0.0, bench_s - time_s_);
  time_s_ = std::max(time_s_, bench_s);
  azimuth_rad_ += std::clamp(wanted_azimuth_rad_ - azimuth_rad_, -way, way);
}

TrueLights LightRig::lights() const {
  TrueLights lights;
  lights.lamp_power = is_lamp_out_ ? 0.0 : responses_[0].light(values_[kLamp]);
  lights.lamp_azimuth_rad = azimuth_rad_;
  for (std::size_t k = 0; k < kBoxes; ++k)
    lights.box_power[k] = is_box_out_[k] ? 0.0 : responses_[1 + k].light(values_[kFirstBox + k]);
  return lights;
}

}  // namespace vbar::tron::bench
