#pragma once
// Source: ranges of a laser range finder to the target.

#include <array>
#include <optional>

#include "fsw/sources/range_finder/range_aiding.h"
#include "fsw/sources/source.h"

namespace vbar::fsw::sources {

/// Noise and bias of up to a kilometre.
[[nodiscard]] bool is_valid(const range_configuration& configuration);

class RangeSource {
 public:
  static constexpr std::int32_t kUse = RangeAiding::kSource.bit;
  bool configure(const Configuration& configuration);
  void collect(Context& context, RecordFiler records);
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aiding_.check_age(now); }
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter) { aiding_.stop(now, filter); }
  /// Telemetry of the last range of the step, if there was one.
  void report(const Telemetry& telemetry) const;

  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  [[nodiscard]] GpsTime last_measurement() const { return aiding_.last_accepted(); }
  [[nodiscard]] const RangeAiding& aiding() const { return aiding_; }

 private:
  /// Most records that wait to be processed.
  static constexpr std::size_t kMaxWaiting = 64;

  RangeAiding aiding_;
  std::array<double, kMaxWaiting> ranges_m_{};  ///< by number of the record, modulo the size
  std::uint32_t next_number_ = 0;
  std::optional<GpsTime> processed_;  ///< of the step
  double range_m_ = 0.0;
  RangeEditStatus edit_status_ = RangeEditStatus::kNone;
};

}  // namespace vbar::fsw::sources
