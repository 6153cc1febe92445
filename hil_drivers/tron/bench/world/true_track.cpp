#include "hil_drivers/tron/bench/world/true_track.h"

#include <numbers>

#include "host_sim/engine/distributions.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {
namespace {

using engine::RandomStream;
using fsw::Vector3;

constexpr double kWavelengthLow_m = 2.5, kWavelengthHigh_m = 5.0;

Wave wave(std::uint64_t seed, const char* error, double sigma) {
  return {seed, std::string("bench/track/") + error, sigma, kWavelengthLow_m, kWavelengthHigh_m};
}

Wave rotation_wave(std::uint64_t seed, const char* error, double sigma_deg) {
  return wave(seed, error, sigma_deg * (std::numbers::pi / 180.0));
}

}  // namespace

TrueTrack::TrueTrack(const Track& design, const BasePose& base, const ErrorSizes& sizes, std::uint64_t seed)
    : design_(design),
      base_(base),
      scale_(sizes.track_scale * RandomStream(seed, "bench/track/scale").normal()),
      repeatability_m_(1e-3 * sizes.track_repeatability_mm),
      sideways_m_(wave(seed, "sideways", 1e-3 * sizes.track_offset_mm)),
      height_m_(wave(seed, "height", 1e-3 * sizes.track_offset_mm)),
      roll_rad_(rotation_wave(seed, "roll", sizes.track_rotation_deg)),
      pitch_rad_(rotation_wave(seed, "pitch", sizes.track_rotation_deg)),
      yaw_rad_(rotation_wave(seed, "yaw", sizes.track_rotation_deg)),
      seed_(seed) {}

Eigen::Isometry3d TrueTrack::T_L_base(double encoder_m) const {
  const double place_m = encoder_m + scale_ * (encoder_m - design_.home_m);
  const Vector3 carriage_m(place_m, sideways_m_.at(place_m), height_m_.at(place_m));
  const Eigen::Isometry3d base = base_.T_L_base();
  return Eigen::Translation3d(carriage_m + base.translation()) *
         Eigen::AngleAxisd(yaw_rad_.at(place_m), Vector3::UnitZ()) *
         Eigen::AngleAxisd(pitch_rad_.at(place_m), Vector3::UnitY()) *
         Eigen::AngleAxisd(roll_rad_.at(place_m), Vector3::UnitX()) * Eigen::Isometry3d(base.rotation());
}

double TrueTrack::repeatability_m(std::uint64_t number) const {
  const RandomStream stream(seed_, "bench/track/repeatability");
  return repeatability_m_ * engine::normal_quantile(stream.uniforms_of(number)[0]);
}

}  // namespace vbar::tron::bench
