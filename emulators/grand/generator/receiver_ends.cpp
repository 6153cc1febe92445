#include "emulators/grand/generator/receiver_ends.h"

#include <stdexcept>
#include <utility>

#include "emulators/grand/samples/gnss_sdr_measurements.h"

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

ReceiverFactory gnss_sdr_receivers(const Scenario& scenario, const std::filesystem::path& directory) {
  if (scenario.pace != Pace::kRealTime)
    throw std::invalid_argument("gnss-sdr receives in real time only: pace is lock_step; accepted is real_time");
  return [vehicles = scenario.vehicles, seed = scenario.seed, directory](
             std::size_t index, std::shared_ptr<const twins::gnss::Constellation> constellation) {
    const VehicleScenario& vehicle = vehicles[index];
    GnssSdrSettings settings;
    settings.directory = directory / (vehicle.name + ".gnss_sdr");
    auto measurements = std::make_unique<GnssSdrMeasurements>(settings, constellation, seed, vehicle.name);
    return receiver_end(Receiver(vehicle.receiver, constellation, seed, vehicle.name, std::move(measurements)));
  };
}

}  // namespace vbar::grand::bench
