#include "hil_drivers/grand/trajectory/phase_centre_noise.h"

#include <stdexcept>
#include <string>

namespace vbar::grand {
namespace {

using fsw::Vector3;

/// Value and derivatives of the blend 10 u^3 - 15 u^4 + 6 u^5 with respect to u.
std::array<double, 4> quintic_blend(double u) {
  const double u2 = u * u;
  return {u2 * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u2 * (1.0 + u * (-2.0 + u)),
          60.0 * u * (1.0 + u * (-3.0 + 2.0 * u)), 60.0 * (1.0 + u * (-6.0 + 6.0 * u))};
}

std::int64_t floor_quotient(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

}  // namespace

PhaseCentreNoise::PhaseCentreNoise(double sigma_m, const ReceiverEpochs& epochs, std::uint64_t seed,
                                   std::string_view spacecraft)
    : sigma_m_(sigma_m), epochs_(epochs), stream_(seed, "gnss/" + std::string(spacecraft) + "/antenna_noise") {
  if (epochs.period.ns <= 0)
    throw std::invalid_argument("phase centre noise: the period of the epochs is not positive");
}

Vector3 PhaseCentreNoise::value_of(std::int64_t epoch) {
  constexpr std::uint64_t kNumbersPerEpoch = 3;
  stream_.seek(kNumbersPerEpoch * static_cast<std::uint64_t>(epoch));
  const double x = stream_.normal();
  const double y = stream_.normal();
  const double z = stream_.normal();
  return sigma_m_ * Vector3(x, y, z);
}

std::array<Vector3, 4> PhaseCentreNoise::at(fsw::GpsTime time) {
  const std::int64_t since_offset_ns = time.ns - epochs_.offset.ns;
  const std::int64_t epoch = floor_quotient(since_offset_ns, epochs_.period.ns);
  if (epoch != epoch_) {
    ends_[0] = epoch == epoch_ + 1 ? ends_[1] : value_of(epoch);
    ends_[1] = value_of(epoch + 1);
    epoch_ = epoch;
  }
  const double period_s = fsw::seconds(epochs_.period);
  const double u = fsw::seconds({since_offset_ns - epoch * epochs_.period.ns}) / period_s;
  const std::array<double, 4> blend = quintic_blend(u);
  const Vector3 step = ends_[1] - ends_[0];
  return {ends_[0] + blend[0] * step, blend[1] / period_s * step, blend[2] / (period_s * period_s) * step,
          blend[3] / (period_s * period_s * period_s) * step};
}

}  // namespace vbar::grand
