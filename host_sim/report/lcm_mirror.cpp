#include "host_sim/report/lcm_mirror.h"

#include <stdexcept>

#include <lcm/lcm.h>

namespace vbar::report {

struct LcmMirror::Bus {
  struct Closer {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  std::unique_ptr<lcm_t, Closer> handle;
};

LcmMirror::LcmMirror(const std::string& url) : bus_(std::make_unique<Bus>()) {
  // LCM takes an empty URL to mean that of the environment, which may lead anywhere.
  if (url.empty()) throw std::runtime_error("the LCM bus needs a URL (lcm.url)");
  bus_->handle.reset(lcm_create(url.c_str()));
  if (bus_->handle == nullptr) {
    throw std::runtime_error("the LCM bus \"" + url +
                             "\" cannot be opened (lcm.url); a udpm bus needs a multicast route, e.g. "
                             "ip route add 224.0.0.0/4 dev lo");
  }
}

LcmMirror::~LcmMirror() = default;

void LcmMirror::publish(const twins::PacketRecord& record) {
  for (const twins::LcmEvent& event : twins::lcm_events_of(record)) {
    const auto size = static_cast<unsigned int>(event.data.size());
    if (lcm_publish(bus_->handle.get(), event.channel.c_str(), event.data.data(), size) != 0) {
      ++events_not_sent_;
    }
  }
}

}  // namespace vbar::report
