#pragma once
// The digital camera as a packet source: an image every period, made on a thread of its own while the simulation goes
// on, because at its epoch nobody waits for it yet: it leaves the camera when it has been read out.

#include <optional>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/camera/exposure_of_truth.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/worker.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

class CameraSensor final : public PacketSource {
 public:
  struct Settings {
    ImageMaker::Settings image;
    CameraMount mount;
    fsw::GpsTime start;     ///< middle of the first exposure
    fsw::Duration period;   ///< > 0, between exposures
    fsw::Duration readout;  ///< >= 0: from the middle of an exposure until its packets leave
  };

  /// `renderer` is called on the sensor's own thread, from one call to the next always the same. Throws
  /// std::invalid_argument if a recipe cannot hold the models of the mount (image_recipe.h).
  CameraSensor(const Settings& settings, Renderer renderer);

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Begins the image, whose packets are `pending`; `recipe` is from what they can be made again. kFailed if the truth
  /// lacks the spacecraft or its attitude.
  Measurement measure(const TruthSnapshot& truth) override;

  /// So far. Waits for the images begun.
  [[nodiscard]] ImagingTime time_spent();

 private:
  Settings settings_;
  ImageMaker maker_;
  Worker worker_;  // last: its thread uses the maker
};

}  // namespace vbar::twins::camera
