#pragma once
// navigate, by camera: from the tiles of an image and the servicer's own GNSS orbit to the states of both spacecraft,
// and where the camera shall look next.

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
  /// Starts anew with the inbox's configurations of camera and angles-only navigation and its a-priori orbit; what is
  /// not there stays as it was.
  void configure(GpsTime now, Inbox& inbox, const orbit::EarthOrientation& earth);

  /// Takes the step's image, if there is one. `own_orbit`, to be brought to `now` afterwards, is brought to the image's
  /// time here. `burns`: the servicer's, known or commanded, in order of time.
  void update(GpsTime now, Inbox& inbox, navigation::GnssNavigation& own_orbit,
              std::span<const navigation::Burn> burns);

  /// The camera is told this until it is told otherwise.
  void set_pointing(const Pointing& pointing) { pointing_ = pointing; }

  /// Whether the step had an image, and what came of it.
  [[nodiscard]] bool has_image() const { return has_image_; }
  [[nodiscard]] const angles_only::AnglesOnlyTracking& tracking() const { return tracking_; }
  [[nodiscard]] navigation::BearingFate fate() const { return fate_; }
  [[nodiscard]] std::int32_t images_without_stars() const { return images_without_stars_; }

  [[nodiscard]] const navigation::AnglesOnlyNavigation& filter() const { return filter_; }

 private:
  void take_image(const angles_only::TakenImage& image, navigation::GnssNavigation& own_orbit,
                  std::span<const navigation::Burn> burns);
  [[nodiscard]] angles_only::Circumstances circumstances_of(GpsTime time, const Vector3& sun_eci,
                                                            std::span<const navigation::Burn> burns);

  angles_only::AnglesOnlyTracking tracking_;
  navigation::AnglesOnlyNavigation filter_;
  std::optional<camera_configuration> camera_;
  std::optional<angles_only_configuration> angles_only_;
  std::optional<Pointing> pointing_;
  std::array<tracking::OwnBurn, 64> burns_since_image_{};
  std::optional<GpsTime> last_image_;
  bool has_image_ = false;
  navigation::BearingFate fate_ = navigation::BearingFate::kNone;
  std::int32_t images_without_stars_ = 0;
};

}  // namespace vbar::fsw::gnc
