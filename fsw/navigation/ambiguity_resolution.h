#pragma once
// From float ambiguities to integers and back: offers the filter's double differences to the integer estimator, holds
// what passes its tests, watches what is held, and lets go of it all when the phases stop agreeing.

#include <array>
#include <cstdint>

#include "fsw/gnss/ambiguity_validation.h"
#include "fsw/navigation/relative_filter.h"

namespace vbar::fsw::navigation {

struct AmbiguitySettings {
  bool enabled = true;
  double min_success_rate = 0.999;  ///< of bootstrapping
  double min_ratio = 3.0;           ///< second-best to best squared norm, at least
  int least_epochs = 4;             ///< tracked without a break before an ambiguity is offered
  // What is held is let go when, in so many epochs in a row, the phases' normalised innovations average above this (1
  // is honest) or more than a third of them are refused; and at once when a third of the held ones contradict.
  int suspicious_epochs = 3;
  double suspicious_nis = 4.0;
  double release_sigma_m = 0.05;  ///< wrong integers are to be let go before they move the position further than this
};

struct AmbiguityReport {
  std::int32_t tracked = 0;  ///< channels with a carrier
  std::int32_t fixed = 0;    ///< of them, held to integers
  std::int32_t fixes = 0;    ///< decisions that held something
  std::int32_t releases = 0;
  gnss::Obstacle obstacle = gnss::Obstacle::kNone;  ///< of the last decision
  double success_rate = 0.0;                        ///< of the last decision
  double ratio = 0.0;
};

class AmbiguityResolution {
 public:
  /// Forgets what it watched; counters stay.
  void reset();

  /// After each epoch folded in.
  void update(RelativeFilter& filter, const RelativeUpdate& epoch, const AmbiguitySettings& settings);

  [[nodiscard]] const AmbiguityReport& report() const { return report_; }
  /// Integers of at least four channels are held: the relative position is that of fixed ambiguities.
  [[nodiscard]] bool is_fixed() const { return report_.fixed >= kLeastHeld + 1; }

  static constexpr std::int32_t kLeastHeld = 4;

 private:
  /// Double differences offered: a channel and its reference each.
  struct Offer {
    std::array<std::uint8_t, kPhaseChannels> place{};
    std::array<std::uint8_t, kPhaseChannels> reference{};
    std::size_t count = 0;
  };

  void gather(const RelativeFilter& filter, int least_epochs);
  void fill(const RelativeFilter& filter);
  void watch(RelativeFilter& filter, const RelativeUpdate& epoch, const AmbiguitySettings& settings);
  void decide(RelativeFilter& filter, const AmbiguitySettings& settings);
  void count(const RelativeFilter& filter);

  AmbiguityReport report_;
  int suspicious_in_a_row_ = 0;
  std::int32_t contradicted_ = 0;  ///< held channels of late, those of an epoch before counting half
  Offer offer_;
  std::array<double, kPhaseChannels> floats_{};                       ///< cycles
  std::array<double, kPhaseChannels * kPhaseChannels> covariance_{};  ///< cycles^2, column-major
  gnss::ValidationWorkspace workspace_;
};

}  // namespace vbar::fsw::navigation
