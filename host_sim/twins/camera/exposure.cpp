#include "host_sim/twins/camera/exposure.h"

#include <stdexcept>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/radiation_pressure.h"

namespace vbar::twins::camera {
namespace {

constexpr double kJ2000 = 2451545.0;
constexpr double kDaysPerJulianYear = 365.25;

}  // namespace

double sunlit_fraction(const fsw::Vector3& position_eci, const fsw::Vector3& sun_eci) {
  const truth::SkyDisks disks = truth::sky_disks(position_eci, sun_eci, truth::EarthFigure{});
  if (truth::penumbra_outer_edge(disks) > 0.0) return 1.0;
  return truth::penumbra_inner_edge(disks) > 0.0 ? truth::penumbra_sunlit_fraction(disks)
                                                 : truth::inner_sunlit_fraction(disks);
}

Exposure exposure_of_truth(const CameraMount& mount, const TruthSnapshot& truth, std::int64_t number) {
  const SpacecraftTruth* own = truth.find(mount.spacecraft);
  if (own == nullptr) throw std::invalid_argument("no spacecraft \"" + mount.spacecraft + "\"");
  if (!own->attitude) throw std::invalid_argument("\"" + mount.spacecraft + "\" has no attitude");
  const Eigen::Quaterniond q_eci_body = own->attitude->q_body_eci.conjugate();
  const fsw::Vector3& rate_body = own->attitude->rate_body;

  Exposure exposure;
  exposure.time = truth.time;
  exposure.number = number;
  exposure.q_camera_eci = (mount.q_camera_body * own->attitude->q_body_eci).normalized();
  exposure.rate_camera = mount.q_camera_body * rate_body;
  exposure.camera_position_eci = own->orbit.position_eci + q_eci_body * mount.position_body;
  exposure.camera_velocity_eci = own->orbit.velocity_eci + q_eci_body * rate_body.cross(mount.position_body);
  const truth::JulianDate tt = truth::tt_of(truth.time);
  const truth::SunMoon sky = truth::sun_moon_series(tt);
  exposure.earth_velocity_bcrs = truth::earth_velocity_bcrs(tt);
  exposure.sun_eci = sky.sun_eci;
  exposure.moon_eci = sky.moon_eci;
  exposure.years_since_j2000 = ((tt.day - kJ2000) + tt.fraction) / kDaysPerJulianYear;
  for (const CameraMount::Model& model : mount.models) {
    const SpacecraftTruth* other = truth.find(model.spacecraft);
    if (other == nullptr || other == own || !other->attitude) continue;
    ObjectInView& object = exposure.objects.emplace_back();
    object.name = model.spacecraft;
    object.model = model.model;
    // The orbit is the centre of mass's, the file's origin elsewhere.
    const Eigen::Quaterniond q_eci_other = other->attitude->q_body_eci.conjugate();
    const fsw::Vector3& centre = model.centre_of_mass_body;
    const fsw::Vector3 turning = other->attitude->rate_body.cross(centre);
    object.position_eci = other->orbit.position_eci - q_eci_other * centre - exposure.camera_position_eci;
    object.velocity_eci = other->orbit.velocity_eci - q_eci_other * turning - exposure.camera_velocity_eci;
    object.q_body_eci = other->attitude->q_body_eci;
    object.sunlit = sunlit_fraction(other->orbit.position_eci, sky.sun_eci);
  }
  return exposure;
}

}  // namespace vbar::twins::camera
