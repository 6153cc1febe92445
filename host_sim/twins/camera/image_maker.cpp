#include "host_sim/twins/camera/image_maker.h"

#include <utility>

#include "host_sim/twins/camera/image_tiles.h"

namespace vbar::twins::camera {
ImageMaker::ImageMaker(const Settings& settings, Renderer renderer)
    : settings_(settings),
      renderer_(std::move(renderer)),
      detector_(settings.camera, settings.seed, settings.name),
      photons_{settings.camera.region, {}} {}

TakenImage ImageMaker::take(const Exposure& exposure) {
  const Region& region = settings_.camera.region;
  TakenImage image;
  {
    const Stopwatch watch(render_s_);
    photons_.region = region;
    photons_.electrons.assign(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height), 0.0F);
    renderer_(exposure, photons_);
  }
  const Stopwatch watch(detector_s_);
  detector_.expose(photons_, exposure.number, image.dn, exposure.duration_s);
  return image;
}

std::vector<Note> ImageMaker::statistics() const {
  return {{"render_s", render_s_}, {"detector_s", detector_s_}};
}

std::vector<Packet> ImageMaker::packets_of(const Exposure& exposure) {
  return camera::packets_of(settings_, exposure, take(exposure).dn);
}

std::vector<Packet> packets_of(const ImageMaker::Settings& settings, const Exposure& exposure,
                               std::span<const std::uint16_t> dn) {
  const ImageLabel label{exposure.time, exposure.number, settings.spacecraft, settings.unit,
                         exposure.duration_s.value_or(settings.camera.exposure_s)};
  return image_tiles(label, settings.camera.region, settings.camera.detector.bits, dn);
}

}  // namespace vbar::twins::camera
