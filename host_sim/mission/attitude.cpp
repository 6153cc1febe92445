#include "host_sim/mission/attitude.h"

#include <cmath>

#include "host_sim/engine/random_stream.h"

namespace vbar::mission {
namespace {

constexpr double kTwoPi = 2.0 * M_PI;

engine::RandomStream stream(std::uint64_t seed, std::string_view spacecraft, const char* what) {
  return {seed, std::string(spacecraft) + "/" + what};
}

}  // namespace

// Shoemake 1992, "Uniform random rotations".
Eigen::Quaterniond drawn_attitude(std::uint64_t seed, std::string_view spacecraft) {
  engine::RandomStream random = stream(seed, spacecraft, "attitude");
  const double share = random.uniform(), first = random.uniform(0.0, kTwoPi), second = random.uniform(0.0, kTwoPi);
  const double a = std::sqrt(1.0 - share), b = std::sqrt(share);
  return {b * std::cos(second), a * std::sin(first), a * std::cos(first), b * std::sin(second)};
}

fsw::Vector3 drawn_rate(std::uint64_t seed, std::string_view spacecraft, double slowest, double fastest) {
  engine::RandomStream random = stream(seed, spacecraft, "tumble");
  // Archimedes: the height of a uniform point on the sphere is uniform.
  const double height = random.uniform(-1.0, 1.0), longitude = random.uniform(0.0, kTwoPi);
  const double across = std::sqrt(1.0 - height * height);
  const double size = slowest + (fastest - slowest) * random.uniform();
  return size * fsw::Vector3(across * std::cos(longitude), across * std::sin(longitude), height);
}

truth::ControlError drawn_control_error(std::uint64_t seed, std::string_view spacecraft, double sigma) {
  constexpr double kShortest_s = 20.0, kLongest_s = 600.0;
  engine::RandomStream random = stream(seed, spacecraft, "control_error");
  truth::ControlError error;
  for (auto& axis : error) {
    // A sinusoid's mean square is half its amplitude's. Periods spread evenly over their logarithm.
    const double amplitude = sigma * std::sqrt(2.0 / static_cast<double>(axis.size()));
    for (truth::Sinusoid& one : axis) {
      const double period_s = kShortest_s * std::pow(kLongest_s / kShortest_s, random.uniform());
      one = {amplitude, kTwoPi / period_s, random.uniform(0.0, kTwoPi)};
    }
  }
  return error;
}

double drawn_mass_error_kg(std::uint64_t seed, std::string_view spacecraft, double sigma_kg) {
  // The first number of the stream of the unknown properties of the body; the receiver's antenna draws the others.
  return sigma_kg * engine::RandomStream(seed, "gnss/" + std::string(spacecraft) + "/body_frame").normal();
}

truth::AttitudeState start_of(const Tumble& tumble, std::uint64_t seed, std::string_view spacecraft) {
  truth::AttitudeState start;
  start.q_body_eci = tumble.q_body_eci ? *tumble.q_body_eci : drawn_attitude(seed, spacecraft);
  start.rate_body =
      tumble.rate_body ? *tumble.rate_body : drawn_rate(seed, spacecraft, tumble.slowest_radps, tumble.fastest_radps);
  return start;
}

}  // namespace vbar::mission
