#pragma once
// An emulated camera on a thread of its own, at an address of 127.0.0.0/8 that no other test uses.

#include <atomic>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "emulators/gige/device.h"

namespace vbar::gige::test {

/// By process and use, as tests run side by side.
inline std::string free_address() {
  static std::atomic<int> uses{0};
  const int use = uses++ + 1;
  const int process = static_cast<int>(::getpid());
  return fmt::format("127.{}.{}.{}", 64 + process / 256 % 128, process % 256, use % 254 + 1);
}

/// A picture in which every pixel depends on its place on the sensor and on the number of the exposure.
inline Image numbered_picture(const Request& request, int bits = 12) {
  Image image;
  const int mask = (1 << bits) - 1;
  for (int y = 0; y < request.region.height; ++y)
    for (int x = 0; x < request.region.width; ++x) {
      const int place = (request.region.y + y) * 7919 + (request.region.x + x) * 31;
      image.dn.push_back(static_cast<std::uint16_t>((place + static_cast<int>(request.number) * 101) & mask));
    }
  return image;
}

class RunningDevice {
 public:
  explicit RunningDevice(
      Device::Settings settings = {}, Expose expose = [](const Request& request) { return numbered_picture(request); })
      : address_(free_address()) {
    settings.address = address_;
    device_ = std::make_unique<Device>(context_, settings, std::move(expose));
    thread_ = std::thread([this] { context_.run(); });
  }
  ~RunningDevice() {
    if (thread_.joinable()) finish();
  }

  /// Runs `use` on the device's thread and waits for it.
  void with(const std::function<void(Device&)>& use) {
    std::promise<void> done;
    boost::asio::post(context_, [&] {
      use(*device_);
      done.set_value();
    });
    done.get_future().wait();
  }
  [[nodiscard]] Device::Statistics statistics() {
    Device::Statistics result;
    with([&](Device& device) { result = device.statistics(); });
    return result;
  }
  [[nodiscard]] const std::string& address() const { return address_; }
  /// The process of the camera is killed: its ports are closed.
  void finish() {
    with([this](Device& /*device*/) { device_.reset(); });
    guard_.reset();
    context_.stop();
    thread_.join();
  }

 private:
  boost::asio::io_context context_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> guard_ = make_work_guard(context_);
  std::string address_;
  std::unique_ptr<Device> device_;
  std::thread thread_;
};

}  // namespace vbar::gige::test
