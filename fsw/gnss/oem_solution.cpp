#include "fsw/gnss/oem_solution.h"

#include "fsw/gnss/oem_fields.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

constexpr std::uint32_t kClockValid = 0;
constexpr std::uint32_t kSolutionComputed = 0;
constexpr std::uint32_t kWgs84 = 61;

// A receiver at the ground or in low orbit. Wide limits: navigation checks further.
constexpr double kMaxRadius = 1.0e8;
constexpr double kMaxSpeed = 2.0e4;
constexpr double kMaxClockOffset = 1.0;
constexpr double kMaxLatency = 60.0;
constexpr double kMaxSigma = 1.0e9;

/// False for NaN.
bool lies_between(double x, double low, double high) {
  return x >= low && x <= high;
}
bool lies_between(const Vector3& v, double low, double high) {
  return lies_between(v.x(), low, high) && lies_between(v.y(), low, high) && lies_between(v.z(), low, high);
}

Vector3 read_f64_vector(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return {read_f64(bytes, offset), read_f64(bytes, offset + 8), read_f64(bytes, offset + 16)};
}
Vector3 read_f32_vector(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return {read_f32(bytes, offset), read_f32(bytes, offset + 4), read_f32(bytes, offset + 8)};
}

/// Semi-major axis and flattening of WGS 84 (NGA.STND.0036).
Vector3 ecef_of_geodetic(double latitude, double longitude, double height) {
  constexpr double kA = 6378137.0;
  constexpr double kFlattening = 1.0 / 298.257223563;
  constexpr double kE2 = kFlattening * (2.0 - kFlattening);
  const double sin_latitude = math::sin(latitude);
  const double cos_latitude = math::cos(latitude);
  const double normal = kA / math::sqrt(1.0 - kE2 * sin_latitude * sin_latitude);
  return {(normal + height) * cos_latitude * math::cos(longitude),
          (normal + height) * cos_latitude * math::sin(longitude), (normal * (1.0 - kE2) + height) * sin_latitude};
}

}  // namespace

Result<KlobucharCoefficients> read_ionosphere(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 108;
  if (message.id != kOemIonosphere) return Status::kWrongType;
  if (message.body.size() < kBodyBytes) return Status::kTooShort;
  KlobucharCoefficients coefficients;
  for (std::size_t k = 0; k < coefficients.alpha.size(); ++k) {
    coefficients.alpha[k] = read_f64(message.body, 8 * k);
    coefficients.beta[k] = read_f64(message.body, 32 + 8 * k);
  }
  const Status status = check(coefficients);
  if (status != Status::kOk) return status;
  return coefficients;
}

Result<ReceiverClock> read_time(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 44;
  if (message.id != kOemTime) return Status::kWrongType;
  if (message.body.size() < kBodyBytes) return Status::kTooShort;
  const Result<GpsTime> time = time_of(message);
  if (!time.ok()) return time.status();
  if (read_u32(message.body, 0) != kClockValid) return Status::kNotReady;
  ReceiverClock clock;
  clock.receiver_time = time.value();
  clock.offset_s = read_f64(message.body, 4);
  clock.sigma_s = read_f64(message.body, 12);
  if (!lies_between(clock.offset_s, -kMaxClockOffset, kMaxClockOffset) ||
      !lies_between(clock.sigma_s, 0.0, kMaxSigma)) {
    return Status::kOutOfRange;
  }
  return clock;
}

Result<ReceiverPosition> read_best_xyz(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 112;
  if (message.id != kOemBestXyz) return Status::kWrongType;
  if (message.body.size() < kBodyBytes) return Status::kTooShort;
  const Result<GpsTime> time = time_of(message);
  if (!time.ok()) return time.status();
  if (read_u32(message.body, 0) != kSolutionComputed) return Status::kNotReady;
  ReceiverPosition solution;
  solution.receiver_time = time.value();
  solution.position_ecef = read_f64_vector(message.body, 8);
  solution.position_sigma_m = read_f32_vector(message.body, 32);
  solution.satellites_used = message.body[105];
  if (!lies_between(solution.position_ecef, -kMaxRadius, kMaxRadius) ||
      !lies_between(solution.position_sigma_m, 0.0, kMaxSigma)) {
    return Status::kOutOfRange;
  }
  if (read_u32(message.body, 44) != kSolutionComputed) return solution;
  solution.has_velocity = true;
  solution.velocity_ecef = read_f64_vector(message.body, 52);
  solution.velocity_sigma_mps = read_f32_vector(message.body, 76);
  solution.velocity_latency_s = read_f32(message.body, 92);
  if (!lies_between(solution.velocity_ecef, -kMaxSpeed, kMaxSpeed) ||
      !lies_between(solution.velocity_sigma_mps, 0.0, kMaxSigma) ||
      !lies_between(solution.velocity_latency_s, -kMaxLatency, kMaxLatency)) {
    return Status::kOutOfRange;
  }
  return solution;
}

Result<ReceiverPosition> read_best_position(const OemMessage& message) {
  constexpr std::size_t kBodyBytes = 72;
  if (message.id != kOemBestPosition) return Status::kWrongType;
  if (message.body.size() < kBodyBytes) return Status::kTooShort;
  const Result<GpsTime> time = time_of(message);
  if (!time.ok()) return time.status();
  if (read_u32(message.body, 0) != kSolutionComputed) return Status::kNotReady;
  const double latitude_deg = read_f64(message.body, 8);
  const double longitude_deg = read_f64(message.body, 16);
  const double height = read_f64(message.body, 24) + read_f32(message.body, 32);  // above the geoid, and the geoid's
  const Vector3 sigma_m = read_f32_vector(message.body, 40);
  if (!lies_between(latitude_deg, -90.0, 90.0) || !lies_between(longitude_deg, -360.0, 360.0) ||
      !lies_between(height, -kMaxRadius, kMaxRadius) || !lies_between(sigma_m, 0.0, kMaxSigma) ||
      read_u32(message.body, 36) != kWgs84) {
    return Status::kOutOfRange;
  }
  ReceiverPosition solution;
  solution.receiver_time = time.value();
  solution.position_ecef = ecef_of_geodetic(latitude_deg * math::kDegree, longitude_deg * math::kDegree, height);
  solution.position_sigma_m = Vector3::Constant(math::sqrt(sigma_m.squaredNorm()));
  solution.satellites_used = message.body[65];
  return solution;
}

}  // namespace vbar::fsw::gnss
