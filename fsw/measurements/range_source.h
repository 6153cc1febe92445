#pragma once
// Source: ranges of a laser range finder to the target.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/measurements/aid.h"
#include "fsw/measurements/source.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::measurements {

// Ranges of a laser range finder as an aid of the filter: one row each, with the bias of the instrument as a state.
//
// A range alone initialises nothing: it is used once the relative orbit is estimated. Ranges that contradict the orbit
// never change it: the source is suspended until several agree again.

struct RangeSettings {
  double noise_sigma_m = 0.01;  ///< of each measurement
  double bias_sigma_m = 0.02;   ///< constant
  double gate = 16.0;           ///< of the normalised innovation squared
};

enum class RangeEditStatus : std::uint8_t {
  kNone,      ///< no relative orbit yet
  kRejected,  ///< beyond the gate, or while the source is suspended
  kUsed,
};

struct RangeCounters {
  std::int32_t used = 0;
  std::int32_t rejected = 0;
};

/// Fills the batch with the distance of the centres of mass, plus the bias. Any status of the orbit conversions.
Status range_rows(const filter::RelativeNavigationFilter& filter, double range_m, double noise_sigma_m,
                  filter::MeasurementBatch& batch);

class RangeAiding {
 public:
  static constexpr filter::MeasurementSource kSource{.bit = navigation_configuration::kUseRangeFinder};

  void configure(const RangeSettings& settings) { settings_ = settings; }

  /// Processes a range in m; the filter stands at its time.
  RangeEditStatus process(double range_m, filter::RelativeNavigationFilter& filter);
  /// Suspends the source when nothing was measured for a time until `now`.
  void check_age(GpsTime now);
  /// Deactivates the bias: the source is not selected any more.
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter);

  [[nodiscard]] const Aid& aid() const { return aid_; }
  [[nodiscard]] Aid& aid() { return aid_; }
  [[nodiscard]] const RangeCounters& counters() const { return counters_; }
  [[nodiscard]] GpsTime last_accepted() const { return last_accepted_; }
  /// Innovation of the last measurement, m, and its normalised square.
  [[nodiscard]] double prefit_m() const { return prefit_m_; }
  [[nodiscard]] double nis() const { return nis_; }

 private:
  RangeEditStatus reject(GpsTime time);

  RangeSettings settings_;
  Aid aid_;
  RangeCounters counters_;
  GpsTime last_accepted_;
  int rejected_in_excess_ = 0;  ///< rejections minus acceptances, not below zero
  int agreeing_in_a_row_ = 0;   ///< while suspended
  double prefit_m_ = 0.0;
  double nis_ = 0.0;
};

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

}  // namespace vbar::fsw::measurements
