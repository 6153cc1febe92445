#include "host_sim/engine/random_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Random123/philox.h>

namespace vbar::engine {

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) : key_{seed, fnv1a_64(name)} {}

std::array<std::uint64_t, 4> RandomStream::block(Domain domain, std::uint64_t index) const {
  const r123::Philox4x64 philox;
  const r123::Philox4x64::ctr_type counter{{index, static_cast<std::uint64_t>(domain), 0, 0}};
  const r123::Philox4x64::key_type key{{key_[0], key_[1]}};
  const r123::Philox4x64::ctr_type out = philox(counter, key);
  return {out[0], out[1], out[2], out[3]};
}

std::uint64_t RandomStream::bits() {
  const std::uint64_t index = position_ / 4;
  if (index != cached_index_) {
    cached_block_ = block(Domain::kSequence, index);
    cached_index_ = index;
  }
  return cached_block_[position_++ % 4];
}

double RandomStream::uniform() {
  return open_unit_interval(bits());
}

double RandomStream::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

double RandomStream::normal() {
  return normal_quantile(uniform());
}

double RandomStream::exponential() {
  return exponential_upper_quantile(uniform());
}

std::array<double, 4> RandomStream::uniforms_of(std::uint64_t index) const {
  const auto words = block(Domain::kNumbered, index);
  return {open_unit_interval(words[0]), open_unit_interval(words[1]), open_unit_interval(words[2]),
          open_unit_interval(words[3])};
}

namespace {

using Polynomial = std::array<double, 8>;  // lowest power first

double evaluate(const Polynomial& c, double x) {
  double sum = 0.0;
  for (std::size_t k = c.size(); k > 0; --k) sum = sum * x + c[k - 1];
  return sum;
}

// Coefficients of AS 241, routine PPND16: |p - 1/2| <= 0.425, then the near and the far tail.
constexpr Polynomial kCentreNumerator{3.3871328727963666080e0,  1.3314166789178437745e+2, 1.9715909503065514427e+3,
                                      1.3731693765509461125e+4, 4.5921953931549871457e+4, 6.7265770927008700853e+4,
                                      3.3430575583588128105e+4, 2.5090809287301226727e+3};
constexpr Polynomial kCentreDenominator{1.0,
                                        4.2313330701600911252e+1,
                                        6.8718700749205790830e+2,
                                        5.3941960214247511077e+3,
                                        2.1213794301586595867e+4,
                                        3.9307895800092710610e+4,
                                        2.8729085735721942674e+4,
                                        5.2264952788528545610e+3};
constexpr Polynomial kNearNumerator{1.42343711074968357734e0,  4.63033784615654529590e0, 5.76949722146069140550e0,
                                    3.64784832476320460504e0,  1.27045825245236838258e0, 2.41780725177450611770e-1,
                                    2.27238449892691845833e-2, 7.74545014278341407640e-4};
constexpr Polynomial kNearDenominator{1.0,
                                      2.05319162663775882187e0,
                                      1.67638483018380384940e0,
                                      6.89767334985100004550e-1,
                                      1.48103976427480074590e-1,
                                      1.51986665636164571966e-2,
                                      5.47593808499534494600e-4,
                                      1.05075007164441684324e-9};
constexpr Polynomial kFarNumerator{6.65790464350110377720e0,  5.46378491116411436990e0,  1.78482653991729133580e0,
                                   2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                   2.71155556874348757815e-5, 2.01033439929228813265e-7};
constexpr Polynomial kFarDenominator{1.0,
                                     5.99832206555887937690e-1,
                                     1.36929880922735805310e-1,
                                     1.48753612908506148525e-2,
                                     7.86869131145613259100e-4,
                                     1.84631831751005468180e-5,
                                     1.42151175831644588870e-7,
                                     2.04426310338993978564e-15};

}  // namespace

double normal_quantile(double p) {
  if (!(p > 0.0 && p < 1.0)) return std::numeric_limits<double>::quiet_NaN();
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * evaluate(kCentreNumerator, r) / evaluate(kCentreDenominator, r);
  }
  const double tail = q < 0.0 ? p : 1.0 - p;
  const double r = std::sqrt(-std::log(tail));
  const double x = r <= 5.0 ? evaluate(kNearNumerator, r - 1.6) / evaluate(kNearDenominator, r - 1.6)
                            : evaluate(kFarNumerator, r - 5.0) / evaluate(kFarDenominator, r - 5.0);
  return q < 0.0 ? -x : x;
}

double normal_distribution(double x) {
  constexpr double kInverseSqrt2 = 0.70710678118654752440;
  return 0.5 * std::erfc(-x * kInverseSqrt2);
}

double truncated_normal_quantile(double p, double low, double high) {
  // In the upper tail the distribution function is 1 to the last bit; there its mirror image is used.
  if (low > 0.0) return -truncated_normal_quantile(1.0 - p, -high, -low);
  const double p_low = normal_distribution(low);
  const double p_high = normal_distribution(high);
  constexpr double kLargestBelowOne = 1.0 - 0x1p-53;
  const double inside = std::min(p_low + p * (p_high - p_low), kLargestBelowOne);
  // An interval so far out that its probability underflows in double precision: all the mass is at its nearer end.
  if (!(inside > 0.0)) return high;
  return std::clamp(normal_quantile(inside), low, high);
}

double exponential_upper_quantile(double p) {
  return -std::log(p);
}

double GaussMarkov::at(fsw::GpsTime time) {
  if (sigma_ == 0.0 || (last_ && time <= *last_)) return value_;
  const double dt_over_time = last_ ? seconds(time - *last_) / time_s_ : INFINITY;
  const double decay = std::exp(-dt_over_time);
  // 1 - e^2 without cancellation where dt is short.
  value_ = decay * value_ + sigma_ * std::sqrt(-std::expm1(-2.0 * dt_over_time)) * stream_.normal();
  last_ = time;
  return value_;
}

}  // namespace vbar::engine
