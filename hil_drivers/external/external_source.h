#pragma once
// Sensor of a user in another process, in lock-step: at each of its epochs it is sent the truth, and simulated time
// waits for its packets.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "hil_drivers/external/exchange.h"
#include "host_sim/sensors/testbed.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::external {

class ExternalSource final : public twins::PacketSource {
 public:
  /// Connects to the program at the other end of the link, which answers batches in the place of steps.
  using Connect = std::function<std::unique_ptr<pil::FlightComputer>()>;

  ExternalSource(testbeds::PacketPlan plan, std::int64_t seed, SpacecraftNumbers numbers, Connect connect)
      : plan_(std::move(plan)), seed_(seed), numbers_(std::move(numbers)), connect_(std::move(connect)) {}

  void start(fsw::GpsTime first_epoch) override;
  void stop(twins::StopReason reason) override;

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Returns the packets of an epoch. Throws std::runtime_error, one sentence that names the source, if the program has
  /// ended, does not answer in time or answers with anything but packets of its sensor: no further answer can be
  /// expected. A packet of the sensor whose time or value is impossible is rejected, noted and counted.
  twins::Measurement measure(const twins::TruthSnapshot& truth) override;
  void command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) override;
  [[nodiscard]] twins::TruthDetail truth_detail() const override { return twins::TruthDetail::kAccelerations; }
  [[nodiscard]] std::vector<twins::Note> statistics() const override;
  [[nodiscard]] bool truth_is_compared() const override { return plan_.truth_is_compared; }

 private:
  Answer exchange(const Batch& batch);
  void check(const Answer& answer, fsw::GpsTime now) const;
  /// Removes packets whose time or content cannot be that of a measurement, and those beyond the limit of an epoch.
  [[nodiscard]] std::vector<twins::Note> reject(std::vector<twins::Packet>& packets, fsw::GpsTime available);
  [[nodiscard]] std::string fault_of_measurement(const fsw::packets::PacketView& packet, fsw::GpsTime available) const;

  testbeds::PacketPlan plan_;
  std::int64_t seed_;
  SpacecraftNumbers numbers_;
  Connect connect_;
  std::unique_ptr<pil::FlightComputer> program_;
  std::uint32_t step_ = 0;
  std::optional<fsw::GpsTime> next_epoch_;
  fsw::GpsTime last_epoch_;             ///< previous epoch; time of the start before the first
  std::uint64_t packets_rejected_ = 0;  ///< so far
  std::vector<Command> commands_;       ///< since the last exchange
};

}  // namespace vbar::external
