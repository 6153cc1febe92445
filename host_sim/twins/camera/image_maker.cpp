#include "host_sim/twins/camera/image_maker.h"

#include <chrono>
#include <utility>

#include "host_sim/twins/camera/image_tiles.h"

namespace vbar::twins::camera {
namespace {

/// Adds the time from its making to its end.
class Stopwatch {
 public:
  explicit Stopwatch(double& total_s) : total_s_(total_s) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { total_s_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& total_s_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

ImageMaker::ImageMaker(const Settings& settings, Renderer renderer)
    : settings_(settings),
      renderer_(std::move(renderer)),
      detector_(settings.camera, settings.seed, settings.name),
      photons_{settings.camera.region, {}} {}

std::vector<Packet> ImageMaker::packets_of(const Exposure& exposure) {
  const Region& region = settings_.camera.region;
  {
    const Stopwatch watch(time_spent_.render_s);
    photons_.region = region;
    photons_.electrons.assign(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height), 0.0F);
    renderer_(exposure, photons_);
  }
  {
    const Stopwatch watch(time_spent_.detector_s);
    detector_.expose(photons_, exposure.number, dn_);
  }
  ++time_spent_.images;
  const Stopwatch watch(time_spent_.packing_s);
  const ImageLabel label{exposure.time, exposure.number, settings_.spacecraft, settings_.unit};
  return image_tiles(label, region, settings_.camera.detector.bits, dn_);
}

}  // namespace vbar::twins::camera
