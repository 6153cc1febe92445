#include "hil_drivers/tron/bench/vicon/bias_field.h"

#include <cmath>
#include <numbers>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {

BiasField::BiasField(std::uint64_t seed, const std::string& stream, double sigma, const Place& length)
    : amplitude_(sigma * std::sqrt(2.0 / static_cast<double>(kWaves))) {
  engine::RandomStream random(seed, stream);
  for (auto& component : waves_)
    for (PlaneWave& wave : component) {
      for (Eigen::Index k = 0; k < length.size(); ++k) wave.wave_vector[k] = random.normal() / length[k];
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
}

fsw::Vector3 BiasField::at(const Place& place) const {
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (std::size_t k = 0; k < waves_.size(); ++k)
    for (const PlaneWave& wave : waves_[k])
      sum[static_cast<Eigen::Index>(k)] += std::cos(wave.wave_vector.dot(place) + wave.phase);
  return amplitude_ * sum;
}

}  // namespace vbar::tron::bench
