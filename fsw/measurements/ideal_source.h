#pragma once
// Source: ideal navigation, the true states of both spacecraft in a packet.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/measurements/source.h"

namespace vbar::fsw::measurements {

class IdealSource {
 public:
  static constexpr std::int32_t kUse = navigation_configuration::kUseIdeal;
  [[nodiscard]] bool configure(const Configuration& /*configuration*/) { return true; }
  void collect(Context& context, RecordFiler records);
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime /*now*/, filter::RelativeNavigationFilter& /*filter*/) {}
  void stop(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aid_.go_to(AidState::kOff, now); }
  void report(const Telemetry& /*telemetry*/) const {}
  [[nodiscard]] Aid& aid() { return aid_; }
  [[nodiscard]] const Aid& aid() const { return aid_; }
  [[nodiscard]] GpsTime last_measurement() const { return last_measurement_; }

 private:
  struct States {
    orbit::CartesianState servicer;
    orbit::CartesianState target;
  };

  Aid aid_{AidState::kWaiting};  ///< until a telecommand selects other sources
  std::array<States, messaging::Inbox::kCapacity<ideal_navigation>> waiting_{};  ///< of the records filed last
  std::uint32_t filed_ = 0;
  GpsTime last_measurement_;
};

}  // namespace vbar::fsw::measurements
