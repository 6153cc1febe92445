#include "hil_drivers/grand/bench/generator/oem628_end.h"

#include <utility>

namespace vbar::grand::bench {
namespace {

class Oem628End final : public ReceiverEnd {
 public:
  explicit Oem628End(Receiver receiver) : receiver_(std::move(receiver)) {}

  void advance(const RfBlock& block) override { receiver_.advance(block); }
  void idle(fsw::Duration span) override { receiver_.idle(span); }
  [[nodiscard]] bool busy() const override { return receiver_.busy(); }
  void listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud) override {
    receiver_.listen(static_cast<int>(port), bytes, host_baud);
  }
  [[nodiscard]] std::vector<std::uint8_t> speak(std::size_t port, unsigned host_baud) override {
    return receiver_.speak(static_cast<int>(port), host_baud);
  }
  [[nodiscard]] unsigned baud(std::size_t port) const override { return receiver_.baud(static_cast<int>(port)); }
  void power(bool on) override { receiver_.power(on); }
  void set_cn0_offset_db(double offset_db) override { receiver_.set_cn0_offset_db(offset_db); }

 private:
  Receiver receiver_;
};

}  // namespace

std::unique_ptr<ReceiverEnd> receiver_end(Receiver receiver) {
  return std::make_unique<Oem628End>(std::move(receiver));
}

ReceiverFactory oem628_receivers(const Scenario& scenario) {
  return [vehicles = scenario.vehicles, seed = scenario.seed](
             std::size_t index, std::shared_ptr<const twins::gnss::Constellation> constellation) {
    const VehicleScenario& vehicle = vehicles[index];
    return receiver_end(Receiver(vehicle.receiver, std::move(constellation), seed, vehicle.name));
  };
}

}  // namespace vbar::grand::bench
