#include "hil_drivers/optical_stimulator/imaging/image_exchange.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>

#include <fmt/format.h>

namespace vbar::optical_stimulator {
namespace {

using Clock = std::chrono::steady_clock;

/// Adds the time from its construction to its destruction.
class Watch {
 public:
  explicit Watch(double& total_s) : total_s_(total_s) {}
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch() { total_s_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  double& total_s_;
  Clock::time_point start_ = Clock::now();
};

constexpr int kWrongBrightness = 2;  // images of wrong brightness that end the run

}  // namespace

struct Exchange::Trouble {
  std::string last;  // why the last image was not accepted
  std::vector<double> brightness;
};

void Exchange::wait(std::chrono::nanoseconds span) const {
  const auto until = Clock::now() + span;
  constexpr std::chrono::milliseconds kNap{50};  // to notice the end of the run
  while (!is_cancelled_ && Clock::now() < until)
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(kNap, until - Clock::now()));
  if (is_cancelled_) throw std::runtime_error("the run has been stopped");
}

ExchangedImage Exchange::take(Picture& picture) {
  ExchangedImage image;
  image.frame = next_++;
  image.tries = 0;
  strip_.draw(image.frame, picture);
  Trouble trouble;
  for (int k = 0; k <= settings_.retries; ++k) {
    {
      // Shown once more before each try: a window that was covered draws its pixels again.
      const Watch watch(image.show_s);
      screen_.show(picture);
      wait(settings_.settle + k * settings_.display_frame);
    }
    CameraFrame frame = take_frame(image);
    ++image.tries;
    if (!is_accepted(frame, image, trouble)) continue;
    const auto strip = static_cast<std::ptrdiff_t>(settings_.width) * kStripRows;
    image.dn.assign(frame.dn.begin() + strip, frame.dn.end());
    return image;
  }
  throw std::runtime_error(fmt::format("{} ({} images taken)", trouble.last, image.tries));
}

CameraFrame Exchange::take_frame(ExchangedImage& image) {
  for (;;) {
    try {
      CameraFrame frame = camera_.take();
      image.packets_resent += frame.packets_resent;
      image.receive_s += frame.receive_s;
      image.tries += frame.tries - 1;
      image.stale += frame.stale;
      return frame;
    } catch (const std::runtime_error& error) {
      if (is_cancelled_ || image.reconnects > 0) throw;
      reconnect(error.what(), image);
    }
  }
}

/// Once for a picture; a camera that is away is waited for.
void Exchange::reconnect(const std::string& reason, ExchangedImage& image) {
  ++image.reconnects;
  const auto until = Clock::now() + settings_.absence;
  constexpr std::chrono::milliseconds kBetween{200};
  for (;;) {
    try {
      camera_.reopen();
      return;
    } catch (const std::runtime_error& error) {
      if (Clock::now() >= until) throw std::runtime_error(fmt::format("{}; opened again: {}", reason, error.what()));
    }
    wait(kBetween);
  }
}

bool Exchange::is_accepted(const CameraFrame& frame, ExchangedImage& image, Trouble& trouble) const {
  const double white_dn = settings_.gain_dn_per_electron * settings_.white_electrons;
  constexpr double kContrast = 0.2;  // share of the white level: less is not a strip
  const StripReading reading = read_strip(frame.dn, settings_.width, kContrast * white_dn);
  switch (reading.status) {
    case StripStatus::kNone:
      trouble.last =
          "the display does not follow: no frame strip is in the image, so the display is covered, dark or rotated";
      return false;
    case StripStatus::kMirrored:
      throw std::runtime_error("the image is mirrored: its frame strip reads backwards");
    case StripStatus::kDamaged:
      trouble.last =
          "the display does not follow: the frame strip cannot be read, so the display is covered, mirrored or "
          "displaced";
      return false;
    case StripStatus::kRead:
      break;
  }
  if (reading.frame != image.frame) {
    ++image.stale;
    trouble.last = fmt::format("the display does not follow: the image shows picture {} in place of {}", reading.frame,
                               image.frame);
    return false;
  }
  image.brightness = (reading.white_dn - reading.black_dn) / white_dn;
  if (std::abs(image.brightness - 1.0) <= settings_.brightness_tolerance) return true;
  trouble.brightness.push_back(image.brightness);
  if (static_cast<int>(trouble.brightness.size()) >= kWrongBrightness)
    throw std::runtime_error(
        fmt::format("the frame strip has {:.3f} and {:.3f} of its calibrated brightness, accepted: {:.2f} to {:.2f}: "
                    "exposure, gain "
                    "or display have changed",
                    trouble.brightness.front(), trouble.brightness.back(), 1.0 - settings_.brightness_tolerance,
                    1.0 + settings_.brightness_tolerance));
  trouble.last = fmt::format("the frame strip has {:.3f} of its calibrated brightness", image.brightness);
  return false;
}

}  // namespace vbar::optical_stimulator
