#include "hil_drivers/optical_stimulator/hardware/x_screen.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/Xrandr.h>
#include <fmt/format.h>
#include <sys/socket.h>

namespace vbar::optical_stimulator {
namespace {

/// The byte of a channel whose mask is of 8 bits.
unsigned channel(unsigned long pixel, unsigned long mask) {
  unsigned shift = 0;
  while (((mask >> shift) & 1UL) == 0) ++shift;
  return static_cast<unsigned>((pixel & mask) >> shift) & 0xFFU;
}

/// All zeros: a ramp that was never set, as of Xvfb, which applies none.
bool is_identity(const unsigned short* ramp, int size) {
  if (std::all_of(ramp, ramp + size, [](unsigned short value) { return value == 0; })) return true;
  constexpr double kTolerance = 0.5 * 65535.0 / 255.0;  // half a count
  for (int k = 0; k < size; ++k)
    if (!(std::abs(ramp[k] - 65535.0 * k / (size - 1)) <= kTolerance)) return false;
  return true;
}

}  // namespace

void survive_loss(_XDisplay* connection, bool& is_lost) {
  XSetIOErrorHandler([](_XDisplay*) { return 0; });  // the default one writes to the terminal
  XSetIOErrorExitHandler(
      connection, [](_XDisplay*, void* flag) { *static_cast<bool*>(flag) = true; }, &is_lost);
}

AnswerLimit::AnswerLimit(_XDisplay* connection, std::chrono::milliseconds limit, bool& is_expired)
    : thread_([this, socket = XConnectionNumber(connection), limit, &is_expired] {
        std::unique_lock lock(mutex_);
        if (over_.wait_for(lock, limit, [this] { return is_over_; })) return;
        is_expired = true;
        ::shutdown(socket, SHUT_RDWR);
      }) {}

AnswerLimit::~AnswerLimit() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_all();
  thread_.join();
}

void wait_for_server(_XDisplay* connection) {
  XSync(connection, False);
}

Picture read_screen(_XDisplay* connection, int x, int y, int width, int height) {
  const auto destroy = [](XImage* image) { XDestroyImage(image); };
  const std::unique_ptr<XImage, decltype(destroy)> image(
      XGetImage(connection, DefaultRootWindow(connection), x, y, static_cast<unsigned>(width),
                static_cast<unsigned>(height), AllPlanes, ZPixmap),
      destroy);
  if (!image) throw std::runtime_error("the screen cannot be read");
  if (image->red_mask == 0 || image->green_mask == 0 || image->blue_mask == 0)
    throw std::runtime_error("the screen has no true colours");
  Picture picture(width, height);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const unsigned long pixel = XGetPixel(image.get(), column, row);
      const unsigned red = channel(pixel, image->red_mask);
      if (red != channel(pixel, image->green_mask) || red != channel(pixel, image->blue_mask))
        throw std::runtime_error(fmt::format("pixel ({}, {}) of the screen is not grey", column, row));
      picture.at(column, row) = static_cast<std::uint8_t>(red);
    }
  return picture;
}

std::string gamma_complaint(_XDisplay* connection) {
  int event = 0, error = 0, major = 0, minor = 0;
  if (XRRQueryExtension(connection, &event, &error) == 0 || XRRQueryVersion(connection, &major, &minor) == 0 ||
      (major == 1 && minor < 3))
    return "";  // older than gamma ramps of outputs
  const std::unique_ptr<XRRScreenResources, decltype(&XRRFreeScreenResources)> resources(
      XRRGetScreenResourcesCurrent(connection, DefaultRootWindow(connection)), XRRFreeScreenResources);
  if (!resources) return "";
  for (int k = 0; k < resources->ncrtc; ++k) {
    const std::unique_ptr<XRRCrtcGamma, decltype(&XRRFreeGamma)> gamma(XRRGetCrtcGamma(connection, resources->crtcs[k]),
                                                                       XRRFreeGamma);
    if (!gamma || gamma->size < 2) continue;
    for (const unsigned short* const ramp : {gamma->red, gamma->green, gamma->blue})
      if (!is_identity(ramp, gamma->size)) return fmt::format("the gamma ramp of output {} is not an identity", k);
  }
  return "";
}

}  // namespace vbar::optical_stimulator
