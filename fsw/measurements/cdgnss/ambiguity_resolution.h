#pragma once
// From float ambiguities to integers and back: passes double differences of the filter to the integer estimator, holds
// those that pass its tests, monitors them, and releases all when the phases no longer agree.

#include <array>
#include <cstdint>

#include "fsw/gnss/ambiguity_validation.h"
#include "fsw/measurements/cdgnss/carrier_filter.h"

namespace vbar::fsw::measurements {

struct AmbiguitySettings {
  bool enabled = true;
  double min_success_rate = 0.999;  ///< success rate of bootstrapping
  double min_ratio = 3.0;           ///< minimum ratio of second-best to best squared norm
  int min_epochs = 4;               ///< number of epochs tracked without a break before an ambiguity is considered
  // The integers are released when, in this number of consecutive epochs, the mean normalised innovation squared of the
  // phases exceeds this (1 if consistent) or more than a third are rejected; at once when a third of those contradict.
  int suspicious_epochs = 3;
  double suspicious_nis = 4.0;
  double release_sigma_m = 0.05;  ///< wrong integers must be released before they shift the position by more than this
};

struct AmbiguityReport {
  std::int32_t tracked = 0;  ///< channels with a carrier
  std::int32_t fixed = 0;    ///< ambiguities held to integers
  std::int32_t fixes = 0;    ///< number of decisions that held at least one integer
  std::int32_t releases = 0;
  gnss::RejectionReason rejection_reason = gnss::RejectionReason::kNone;  ///< of the last decision
  double success_rate = 0.0;                                              ///< of the last decision
  double ratio = 0.0;
};

class AmbiguityResolution {
 public:
  /// Resets the monitoring; counters stay.
  void reset();

  /// Releases all integers (CarrierFilter::release).
  void release(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter, double position_sigma_m);

  /// Decides on the integers after each epoch processed.
  void update(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter, const CarrierUpdate& epoch,
              const AmbiguitySettings& settings);

  [[nodiscard]] const AmbiguityReport& report() const { return report_; }
  /// Integers of at least four channels are held: the relative position is an ambiguity-fixed one.
  [[nodiscard]] bool is_fixed() const { return report_.fixed >= kMinHeld + 1; }

  static constexpr std::int32_t kMinHeld = 4;

 private:
  /// Double differences considered: a channel and its reference each.
  struct Offer {
    std::array<std::uint8_t, kPhaseChannels> place{};
    std::array<std::uint8_t, kPhaseChannels> reference{};
    std::size_t count = 0;
  };

  void gather(const CarrierFilter& carrier, int min_epochs);
  void fill(const CarrierFilter& carrier, const filter::RelativeNavigationFilter& filter);
  void watch(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter, const CarrierUpdate& epoch,
             const AmbiguitySettings& settings);
  void decide(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter, const AmbiguitySettings& settings);
  void count(const CarrierFilter& carrier);

  AmbiguityReport report_;
  int suspicious_in_a_row_ = 0;
  std::int32_t contradicted_ = 0;  ///< recent contradictions among held channels, with a weight halved at each epoch
  Offer offer_;
  std::array<double, kPhaseChannels> floats_{};                       ///< cycles
  std::array<double, kPhaseChannels * kPhaseChannels> covariance_{};  ///< cycles^2, column-major
  gnss::ValidationWorkspace workspace_;
};

}  // namespace vbar::fsw::measurements
