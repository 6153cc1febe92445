// The emulated camera and the client as programs, for tests with other programs at the other end.
//   gige_tool device ADDRESS                        until standard input ends
//   gige_tool take ADDRESS COUNT WIDTH HEIGHT FORMAT [compare] [buffer=BYTES]
// The second prints a line "image K retries R resent P" for each image, and with "compare" ends with an error unless
// every pixel is that of the emulated camera's picture of its number.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "hil_drivers/gige/camera/camera.h"
#include "tests/unit/emulators/gige/running_device.h"

namespace {

using namespace vbar::gige;

int run_device(const std::string& address) {
  boost::asio::io_context context;
  Device::Settings settings;
  settings.address = address;
  const auto picture = [](const Request& request) { return test::numbered_picture(request); };
  Device device(context, settings, picture);
  std::thread input([&context] {
    for (std::string line; std::getline(std::cin, line);) continue;
    context.stop();
  });
  fmt::print("listening\n");
  std::fflush(stdout);
  context.run();
  input.join();
  return 0;
}

wire::PixelFormat format_of(const std::string& name) {
  for (const auto format : {wire::PixelFormat::kMono8, wire::PixelFormat::kMono12Packed, wire::PixelFormat::kMono16})
    if (name == wire::name_of(format)) return format;
  throw std::invalid_argument("unknown pixel format " + name);
}

/// Ends with an exception after ten attempts.
Frame take_one(Camera& camera, int& retries) {
  constexpr int kAttempts = 10;
  for (retries = 0;; ++retries) {
    auto result = camera.take();
    if (auto* frame = std::get_if<Frame>(&result)) return std::move(*frame);
    const auto& failure = std::get<NoFrame>(result);
    fmt::print(stderr, "{}\n", failure.text);
    if (retries + 1 == kAttempts) throw std::runtime_error(failure.text);
  }
}

int take(const std::string& address, int count, int width, int height, const std::string& format,
         const std::vector<std::string>& options) {
  const bool is_compared = std::ranges::find(options, "compare") != options.end();
  Camera::Settings settings;
  for (const std::string& option : options)
    if (option.starts_with("buffer=")) settings.socket_buffer_bytes = std::stoul(option.substr(7));
  settings.address = address;
  settings.exposure_s = 0.005;
  settings.region = {0, 0, width, height};
  settings.pixel_format = format_of(format);
  Camera camera(settings);
  camera.open();
  fmt::print("{} {}: {}\n", camera.identity().vendor, camera.identity().model, camera.transport());
  // An image that was late for its own request may answer the next one: its number is one of those not seen before.
  std::int64_t first = 0, newest = -1;
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < count; ++k) {
    int retries = 0;
    const Frame frame = take_one(camera, retries);
    fmt::print("image {} retries {} resent {} bits {}\n", k, retries, frame.packets_resent, frame.bits);
    newest += 1 + retries;
    const auto has_pixels_of = [&](std::int64_t number) {
      return frame.dn == test::numbered_picture({settings.region, 0, 0, 0, number}).dn;
    };
    while (is_compared && first <= newest && !has_pixels_of(first)) ++first;
    if (first > newest) throw std::runtime_error(fmt::format("image {}: wrong pixels", k));
    if (is_compared) ++first;
  }
  const double spent_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  fmt::print("{} images in {:.2f} s\n", count, spent_s);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 2 && words[0] == "device") return run_device(words[1]);
    if (words.size() >= 6 && words[0] == "take")
      return take(words[1], std::stoi(words[2]), std::stoi(words[3]), std::stoi(words[4]), words[5],
                  {words.begin() + 6, words.end()});
    fmt::print(stderr,
               "usage: gige_tool device ADDRESS | gige_tool take ADDRESS COUNT WIDTH HEIGHT FORMAT [compare] "
               "[buffer=BYTES]\n");
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
