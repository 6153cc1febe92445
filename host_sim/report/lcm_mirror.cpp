#include "host_sim/report/lcm_mirror.h"

#include <stdexcept>

#include <lcm/lcm.h>

#include "host_sim/io/shared_library.h"

namespace vbar::report {
namespace {

/// The library is loaded for the runs that have a bus: it needs GLib.
struct LcmFunctions {
  LcmFunctions() {
    const io::SharedLibrary library("liblcm.so.1", "the LCM bus of a mission (lcm.url)", "liblcm1");
    library.find("lcm_create", create);
    library.find("lcm_publish", publish);
    library.find("lcm_destroy", destroy);
  }
  decltype(&lcm_create) create = nullptr;
  decltype(&lcm_publish) publish = nullptr;
  decltype(&lcm_destroy) destroy = nullptr;
};

const LcmFunctions& lcm() {
  static const LcmFunctions kFunctions;
  return kFunctions;
}

}  // namespace

struct LcmMirror::Bus {
  struct Closer {
    void operator()(lcm_t* bus) const { lcm().destroy(bus); }
  };
  std::unique_ptr<lcm_t, Closer> handle;
};

LcmMirror::LcmMirror(const std::string& url) : bus_(std::make_unique<Bus>()) {
  // LCM takes an empty URL to mean that of the environment, which may lead anywhere.
  if (url.empty()) throw std::runtime_error("the LCM bus needs a URL (lcm.url)");
  bus_->handle.reset(lcm().create(url.c_str()));
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
    if (lcm().publish(bus_->handle.get(), event.channel.c_str(), event.data.data(), size) != 0) {
      ++events_not_sent_;
    }
  }
}

}  // namespace vbar::report
