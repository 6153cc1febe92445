#pragma once
// Packets of a run, live on an LCM bus: lcm-spy, lcm-logger and any LCM program can listen. Same events as in the
// packet log (host_sim/twins/packet_log.h).

#include <cstdint>
#include <memory>
#include <string>

#include "host_sim/twins/packet_log.h"

namespace vbar::report {

class LcmMirror {
 public:
  /// Opens the bus. `url` is LCM's, e.g. udpm://239.255.76.67:7667?ttl=0; it alone decides how far packets travel, the
  /// environment (LCM_DEFAULT_URL) has no say. Throws std::runtime_error that names the URL, or
  /// the library if it cannot be loaded.
  explicit LcmMirror(const std::string& url);
  ~LcmMirror();
  LcmMirror(const LcmMirror&) = delete;
  LcmMirror& operator=(const LcmMirror&) = delete;

  /// Publishes a packet. It never fails a run: packets that the bus does not accept are counted.
  void publish(const twins::PacketRecord& record);

  [[nodiscard]] std::uint64_t events_not_sent() const { return events_not_sent_; }

 private:
  struct Bus;
  std::unique_ptr<Bus> bus_;
  std::uint64_t events_not_sent_ = 0;
};

}  // namespace vbar::report
