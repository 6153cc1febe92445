#include "host_sim/twins/gnss/body_frame.h"

#include <cmath>
#include <string>

#include <Eigen/Geometry>

namespace vbar::twins::gnss {
namespace {

using fsw::Vector3;

Vector3 random_direction(engine::RandomStream& stream) {
  const double z = stream.uniform(-1.0, 1.0);
  const double angle = stream.uniform(0.0, 2.0 * std::numbers::pi);
  const double across = std::sqrt(1.0 - z * z);
  return {across * std::cos(angle), across * std::sin(angle), z};
}

Vector3 normal_vector(engine::RandomStream& stream, double sigma) {
  const double x = stream.normal();
  const double y = stream.normal();
  const double z = stream.normal();
  return sigma * Vector3(x, y, z);
}

double mean_square_m2(const BodyFrameSettings& settings) {
  const double com_m = settings.com_radius_mm * 1e-3;
  const double pco_m = settings.pco_bias_mm * 1e-3;
  // For a ball: 3/5 R^2. For a small rotation about each axis: twice the squared lever arm.
  const double lever_m = settings.antenna_in_body_m.norm() * settings.attitude_knowledge_arcsec * kArcsecond;
  return 0.6 * com_m * com_m + pco_m * pco_m + 2.0 * lever_m * lever_m;
}

}  // namespace

BodyFrameErrors draw_body_frame(const BodyFrameSettings& settings, std::uint64_t seed, std::string_view spacecraft) {
  engine::RandomStream stream(seed, "gnss/" + std::string(spacecraft) + "/body_frame");
  BodyFrameErrors errors;
  static_cast<void>(stream.normal());  // the draw of the true mass, mission::drawn_mass_error_kg
  const Vector3 com_direction = random_direction(stream);
  errors.com_m = settings.com_radius_mm * 1e-3 * std::cbrt(stream.uniform()) * com_direction;
  errors.pco_m = settings.pco_bias_mm * 1e-3 * random_direction(stream);
  errors.antenna_rotation = normal_vector(stream, settings.antenna_direction_arcsec * kArcsecond);
  errors.attitude_rotation = normal_vector(stream, settings.attitude_knowledge_arcsec * kArcsecond);
  return errors;
}

Vector3 antenna_from_com(const BodyFrameSettings& settings, const BodyFrameErrors& errors) {
  const Vector3 in_true_body =
      settings.antenna_in_body_m + errors.pco_m + errors.antenna_rotation.cross(errors.pco_m) - errors.com_m;
  return in_true_body + errors.attitude_rotation.cross(in_true_body);
}

Vector3 true_boresight(const BodyFrameSettings& settings, const BodyFrameErrors& errors) {
  const Vector3 rotation = errors.antenna_rotation + errors.attitude_rotation;
  return (settings.boresight_in_body + rotation.cross(settings.boresight_in_body)).normalized();
}

double static_floor_rms_m(const BodyFrameSettings& servicer, const BodyFrameSettings& target) {
  return std::sqrt(mean_square_m2(servicer) + mean_square_m2(target));
}

Vector3 static_floor_m(const BodyFrameSettings& servicer_settings, const BodyFrameErrors& servicer,
                       const BodyFrameSettings& target_settings, const BodyFrameErrors& target) {
  return (antenna_from_com(target_settings, target) - target_settings.antenna_in_body_m) -
         (antenna_from_com(servicer_settings, servicer) - servicer_settings.antenna_in_body_m);
}

}  // namespace vbar::twins::gnss
