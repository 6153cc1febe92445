#include "fsw/gnc/camera_navigation.h"

#include "fsw/math/math.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::gnc {
namespace {

constexpr double kSpeedOfLight = 299792458.0;  // m/s

// Largest delay of an image with respect to its time tag.
constexpr Duration kLongestDelay = duration_of_seconds(600);

// The target is visible when it is illuminated. Near an edge of the shadow it may or may not be.
constexpr double kLitProbability = 0.95;
constexpr double kEdgeProbability = 0.5;
constexpr double kEdge_s = 20.0;

double detection_probability(const orbit::CartesianState& target, const Vector3& sun_eci) {
  const Vector3 on_the_way = kEdge_s * target.velocity_eci;
  const bool was_lit = navigation::is_sunlit(target.position_eci - on_the_way, sun_eci);
  const bool will_be_lit = navigation::is_sunlit(target.position_eci + on_the_way, sun_eci);
  if (was_lit && will_be_lit) return kLitProbability;
  return was_lit || will_be_lit ? kEdgeProbability : 0.0;
}

}  // namespace

void CameraNavigation::configure(GpsTime now, Inbox& inbox, const orbit::EarthOrientation& earth) {
  inbox.keep_newest(inbox.camera_configurations(), now, camera_);
  inbox.keep_newest(inbox.angles_only_configurations(), now, angles_only_);
  if (!camera_ || !angles_only_) return;
  const auto camera = camera_settings(*camera_, *angles_only_);
  const auto navigation = angles_only_settings(*angles_only_, earth);
  if (!camera.ok() || !navigation.ok()) {
    inbox.count_bad_content();
    camera_.reset();
    angles_only_.reset();
    return;
  }
  tracking_.configure(camera.value());
  filter_.configure(navigation.value());
  last_image_.reset();
  const auto& aprioris = inbox.target_aprioris();
  for (std::size_t k = 0; k < aprioris.size(); ++k) {
    const target_apriori& known = aprioris[k].value;
    navigation::TargetApriori apriori;
    apriori.time = aprioris[k].tag.time;
    for (int axis = 0; axis < 3; ++axis) {
      apriori.target.position_eci(axis) = known.position_eci[axis];
      apriori.target.velocity_eci(axis) = known.velocity_eci[axis];
    }
    bool is_usable = apriori.time <= now && orbit::qns_from_cartesian(apriori.target).ok();
    for (int element = 0; element < 6; ++element) {
      apriori.sigma_a_roe_m(element) = known.sigma_a_roe_m[element];
      is_usable = is_usable && known.sigma_a_roe_m[element] > 0.0 && known.sigma_a_roe_m[element] < 1e6;
    }
    if (is_usable) {
      filter_.set_apriori(apriori);
    } else {
      inbox.count_bad_content();
    }
  }
}

void CameraNavigation::update(GpsTime now, Inbox& inbox, navigation::GnssNavigation& own_orbit,
                              std::span<const navigation::Burn> burns) {
  has_image_ = false;
  edit_status_ = navigation::BearingEditStatus::kNone;
  const imaging::ImageAssembly& assembly = inbox.image();
  if (!camera_ || !assembly.has_image()) return;
  const bool is_timely = assembly.image_time() <= now && now - assembly.image_time() <= kLongestDelay &&
                         (!last_image_ || assembly.image_time() > *last_image_);
  if (!is_timely) {
    inbox.count_unusable_time();
    return;
  }
  take_image({assembly.image_time(), assembly.image_number(), assembly.tiles_missing(), assembly.view()}, own_orbit,
             burns);
}

void CameraNavigation::take_image(const angles_only::TakenImage& image, navigation::GnssNavigation& own_orbit,
                                  std::span<const navigation::Burn> burns) {
  has_image_ = true;
  own_orbit.update(image.time, burns);
  const Vector3 sun_eci = orbit::sun_position_gcrf(image.time).normalized();
  navigation::AnglesOnlyEpoch epoch;
  epoch.time = image.time;
  epoch.sun_eci = sun_eci;
  epoch.servicer_gnss = servicer_at(image.time, own_orbit, burns);
  static_cast<void>(filter_.update(epoch, burns));
  const angles_only::Sighting& sighting = tracking_.process(image, priors_of(image.time, sun_eci, burns));
  if (sighting.status == angles_only::SightingStatus::kNoStars) ++images_without_stars_;
  if (sighting.status == angles_only::SightingStatus::kBearing) {
    epoch.servicer_gnss.reset();  // already processed
    epoch.bearing = sighting.bearing;
    edit_status_ = filter_.update(epoch, burns);
  }
  last_image_ = image.time;
}

angles_only::ImagePriors CameraNavigation::priors_of(GpsTime time, const Vector3& sun_eci,
                                                     std::span<const navigation::Burn> burns) {
  angles_only::ImagePriors priors;
  priors.is_orbit_known = filter_.has_target();
  if (!priors.is_orbit_known) return priors;
  priors.servicer = filter_.servicer();
  priors.velocity_over_c_eci = orbit::earth_velocity_over_c_gcrf(time) + priors.servicer.velocity_eci / kSpeedOfLight;
  const Matrix3& R_camera_body = tracking_.settings().R_camera_body;
  Matrix3 R_body_eci = Matrix3::Identity();
  if (pointing_) {
    R_body_eci = R_body_eci_of(*pointing_, time, priors.servicer);
    priors.R_camera_eci = R_camera_body * R_body_eci;
  }
  if (const Result<orbit::CartesianState> target = filter_.target(); target.ok()) {
    orbit::RelativeState relative = orbit::relative_state_rtn(priors.servicer, target.value());
    if (pointing_) {
      const Vector3 camera_eci = R_body_eci.transpose() * tracking_.settings().position_body_m;
      relative.position_rtn -= orbit::R_rtn_eci(priors.servicer) * camera_eci;
    }
    const auto prediction = tracking::prediction_of(relative, filter_.covariance_rtn());
    if (prediction.ok()) priors.target = prediction.value();
    priors.detection_probability = detection_probability(target.value(), sun_eci);
  }
  std::size_t count = 0;
  for (const navigation::Burn& burn : burns) {
    const bool is_since = last_image_ && burn.time >= *last_image_ && burn.time < time;
    if (is_since && count < burns_since_image_.size()) {
      burns_since_image_[count++] = {burn.time, burn.dv_rtn, angles_only_->maneuver_sigma};
    }
  }
  priors.burns = std::span(burns_since_image_).first(count);
  return priors;
}

}  // namespace vbar::fsw::gnc
