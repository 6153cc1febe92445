#include "hil_drivers/gige/device/free_address.h"

#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::gige {

PlacedDevice device_on_free_address(boost::asio::io_context& context, Device::Settings settings,
                                    const std::string& network, const Expose& expose) {
  constexpr int kFirstHost = 1, kLastHost = 254;
  for (int host = kFirstHost;; ++host) {
    settings.address = fmt::format("{}.{}", network, host);
    try {
      return {settings.address, std::make_unique<Device>(context, settings, expose)};
    } catch (const std::runtime_error&) {
      if (host == kLastHost) throw;
    }
  }
}

std::string drawn_serial(std::uint64_t seed, const std::string& stream) {
  engine::RandomStream random(seed, stream);
  return fmt::format("{:08}", 10'000'000 + random.bits() % 90'000'000);
}

}  // namespace vbar::gige
