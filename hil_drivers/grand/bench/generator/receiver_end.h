#pragma once
// Interface of a receiver at an RF output of the generator: a receiver with serial ports. The emulated OEM628
// (../receiver) is one; gnss-sdr behind baseband samples is another.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "hil_drivers/grand/bench/rf_block.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

class ReceiverEnd {
 public:
  ReceiverEnd() = default;
  ReceiverEnd(const ReceiverEnd&) = delete;
  ReceiverEnd& operator=(const ReceiverEnd&) = delete;
  virtual ~ReceiverEnd() = default;

  /// Advances the receiver by the 100 ms of the block.
  virtual void advance(const RfBlock& block) = 0;
  /// Advances the receiver by `span` without a generator.
  virtual void idle(fsw::Duration span) = 0;
  /// Returns true while an answer or a restart is under way.
  [[nodiscard]] virtual bool busy() const = 0;
  virtual void listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud) = 0;
  /// Returns the bytes that have left the port by now, as a host at `host_baud` receives them.
  [[nodiscard]] virtual std::vector<std::uint8_t> speak(std::size_t port, unsigned host_baud) = 0;
  [[nodiscard]] virtual unsigned baud(std::size_t port) const = 0;
  virtual void power(bool on) = 0;
  virtual void set_cn0_offset_db(double offset_db) = 0;
};

/// Makes the receiver of the vehicle with this index. The constellation is that of the run's start time from the first
/// block on.
using ReceiverFactory = std::function<std::unique_ptr<ReceiverEnd>(
    std::size_t vehicle, std::shared_ptr<const twins::gnss::Constellation> constellation)>;

}  // namespace vbar::grand::bench
