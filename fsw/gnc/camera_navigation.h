#pragma once
// navigate, by camera: from the tiles of an image and the servicer's own GNSS orbit to the states of both spacecraft,
// and the pointing of the camera.

#include <optional>
#include <span>

#include "fsw/angles_only/angles_only_tracking.h"
#include "fsw/core/gps_time.h"
#include "fsw/gnc/camera_configuration.h"
#include "fsw/gnc/camera_pointing.h"
#include "fsw/gnc/inbox.h"
#include "fsw/navigation/angles_only_navigation.h"
#include "fsw/navigation/gnss_navigation.h"

namespace vbar::fsw::gnc {

class CameraNavigation {
 public:
  /// Restarts with the configurations of camera and angles-only navigation and the a-priori orbit in the inbox; those
  /// not present remain unchanged.
  void configure(GpsTime now, Inbox& inbox, const orbit::EarthOrientation& earth);

  /// Processes the image of the step, if there is one. `own_orbit` is propagated here to the time of the image, and by
  /// the caller to `now` afterwards. `burns`: those of the servicer, executed or commanded, in order of time.
  void update(GpsTime now, Inbox& inbox, navigation::GnssNavigation& own_orbit,
              std::span<const navigation::Burn> burns);

  /// Commanded pointing of the camera, valid until the next command.
  void set_pointing(const Pointing& pointing) { pointing_ = pointing; }

  /// Whether the step had an image, and its result.
  [[nodiscard]] bool has_image() const { return has_image_; }
  [[nodiscard]] const angles_only::AnglesOnlyTracking& tracking() const { return tracking_; }
  [[nodiscard]] navigation::BearingEditStatus edit_status() const { return edit_status_; }
  [[nodiscard]] std::int32_t images_without_stars() const { return images_without_stars_; }

  [[nodiscard]] const navigation::AnglesOnlyNavigation& filter() const { return filter_; }

 private:
  void take_image(const angles_only::TakenImage& image, navigation::GnssNavigation& own_orbit,
                  std::span<const navigation::Burn> burns);
  [[nodiscard]] angles_only::ImagePriors priors_of(GpsTime time, const Vector3& sun_eci,
                                                   std::span<const navigation::Burn> burns);

  angles_only::AnglesOnlyTracking tracking_;
  navigation::AnglesOnlyNavigation filter_;
  std::optional<camera_configuration> camera_;
  std::optional<angles_only_configuration> angles_only_;
  std::optional<Pointing> pointing_;
  std::array<tracking::OwnBurn, 64> burns_since_image_{};
  std::optional<GpsTime> last_image_;
  bool has_image_ = false;
  navigation::BearingEditStatus edit_status_ = navigation::BearingEditStatus::kNone;
  std::int32_t images_without_stars_ = 0;
};

}  // namespace vbar::fsw::gnc
