#pragma once
// Navigation alone, fed with the bytes of emulated receivers: the pair of experiment 3 coasts as all forces of the
// truth make it, one truth serves receivers of any seed, and a test may look into the filter and at what it cannot see.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fsw/gnc/inbox.h"
#include "fsw/gnc/navigation.h"
#include "fsw/gnss/lambda.h"
#include "host_sim/app/simulation.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/truth_model.h"
#include "host_sim/twins/gnss_sensor.h"

namespace vbar::test {

/// Truth of the pair at each of the receivers' epochs, nobody burning.
class CoastingPair {
 public:
  /// missions/experiment3.toml with `overrides`, for `duration_s`.
  explicit CoastingPair(int duration_s, const std::vector<std::string>& overrides = {});

  [[nodiscard]] const std::vector<std::string>& overrides() const { return overrides_; }
  [[nodiscard]] const std::vector<twins::TruthSnapshot>& epochs() const { return epochs_; }
  [[nodiscard]] const truth::EarthOrientationSeries& earth_orientation() const {
    return *truth_.data().earth_orientation;
  }

 private:
  std::vector<std::string> overrides_;
  mission::Mission mission_;
  truth::TruthModel truth_;
  std::vector<twins::TruthSnapshot> epochs_;
};

/// Receivers and flight navigation on top of it.
class EmulatedPair {
 public:
  /// `overrides` as on the command line, beside those of `coast`, which must outlive this.
  EmulatedPair(const CoastingPair& coast, std::uint64_t seed, const std::vector<std::string>& overrides = {});

  /// What reaches the flight software at a step, for a test to change.
  using Tamper = std::function<void(int epoch, std::vector<twins::Packet>& packets)>;
  void set_tamper(Tamper tamper) { tamper_ = std::move(tamper); }

  /// The next `epochs` epochs: receivers measure, and navigation steps with what has arrived.
  void fly(int epochs = 1);
  [[nodiscard]] bool done() const { return next_ >= coast_.epochs().size(); }

  [[nodiscard]] const fsw::gnc::NavigationSolution& navigation() const { return *navigation_; }
  [[nodiscard]] const fsw::filter::RelativeNavigationFilter& trunk() const { return measurements_->trunk(); }
  [[nodiscard]] const fsw::sources::CarrierAiding& carrier() const {
    return measurements_->source<fsw::sources::CarrierSource>().aiding();
  }
  /// Whether there is a relative orbit from measurements.
  [[nodiscard]] bool valid() const { return measurements_->valid(); }
  [[nodiscard]] bool is_fixed() const { return valid() && carrier().is_fixed(); }
  [[nodiscard]] double elapsed_s() const;

  /// Estimated minus true relative state in the servicer's RTN at the filter's epoch, m and m/s.
  [[nodiscard]] fsw::Vector6 error() const;
  [[nodiscard]] double position_error_m() const { return error().head<3>().norm(); }
  /// Normalised estimation error squared: chi-square with six degrees of freedom if the filter is honest.
  [[nodiscard]] double nees() const;

  /// Held integers that are not those of the emulator.
  [[nodiscard]] int wrong_integers() const;

  /// Mistakes made on purpose in the filter's memory. The integers that fit second best are held; or those that fit
  /// best after `cycles` were added to every other satellite's. False if there are too few ambiguities to hold.
  bool hold_second_best();
  bool hold_shifted(double cycles);

 private:
  using Integers = std::map<std::pair<int, int>, std::int64_t>;  // of signal and satellite number
  struct Arrival {
    fsw::GpsTime time;
    twins::Packet packet;
  };

  struct Offer {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< channels: one and its signal's reference
    fsw::gnss::IntegerSolution integers;
  };
  [[nodiscard]] std::optional<Offer> offer() const;
  /// The flight code's filter and trunk, to be tampered with.
  void hold(std::size_t place, std::size_t reference, double cycles);

  void measure(const twins::TruthSnapshot& truth);
  void remember_integers(fsw::GpsTime time);
  [[nodiscard]] const twins::TruthSnapshot& truth_of_filter() const;

  const CoastingPair& coast_;
  mission::Mission mission_;
  std::vector<app::Source> sensors_;  ///< servicer's, then target's
  std::vector<Arrival> under_way_;
  std::map<fsw::GpsTime, Integers> integers_;  ///< target minus servicer
  fsw::gnc::Inbox inbox_;
  fsw::gnc::Telecommands telecommands_;
  std::unique_ptr<fsw::gnc::TrunkNavigation> measurements_;
  std::unique_ptr<fsw::gnc::NavigationSolution> navigation_;
  Tamper tamper_;
  std::size_t next_ = 0;
};

}  // namespace vbar::test
