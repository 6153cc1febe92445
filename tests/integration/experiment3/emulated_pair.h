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

#include "fsw/gnss/lambda.h"
#include "fsw/messaging/inbox.h"
#include "fsw/navigation/navigation.h"
#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/simulation/simulation.h"
#include "host_sim/truth/truth_model.h"
#include "host_sim/twins/gnss/gnss_sensor.h"
#include "pil_bridge/flight_computer.h"
#include "tests/integration/rendezvous/run_mission.h"
#include "tests/support/figures.h"

namespace vbar::test {

/// Truth of the pair at each of the receivers' epochs, without burns.
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

  [[nodiscard]] const fsw::navigation::NavigationSolution& navigation() const { return *navigation_; }
  [[nodiscard]] const fsw::filter::RelativeNavigationFilter& filter() const { return measurements_->filter(); }
  [[nodiscard]] const fsw::measurements::CdgnssAiding& carrier() const {
    return measurements_->source<fsw::measurements::CdgnssSource>().aiding();
  }
  /// Whether there is a relative orbit from measurements.
  [[nodiscard]] bool valid() const { return measurements_->valid(); }
  [[nodiscard]] bool is_fixed() const { return valid() && carrier().is_fixed(); }
  [[nodiscard]] double elapsed_s() const;

  /// Estimated minus true relative state in the servicer's RTN at the filter's epoch, m and m/s.
  [[nodiscard]] fsw::Vector6 error() const;
  [[nodiscard]] double position_error_m() const { return error().head<3>().norm(); }
  /// Normalised estimation error squared: chi-square with six degrees of freedom if the filter is consistent.
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
  /// The flight code's filter and filter, to be tampered with.
  void hold(std::size_t place, std::size_t reference, double cycles);

  void measure(const twins::TruthSnapshot& truth);
  void remember_integers(fsw::GpsTime time);
  [[nodiscard]] const twins::TruthSnapshot& truth_of_filter() const;

  const CoastingPair& coast_;
  mission::Mission mission_;
  std::vector<app::Source> sensors_;  ///< servicer's, then target's
  std::vector<Arrival> under_way_;
  std::map<fsw::GpsTime, Integers> integers_;  ///< target minus servicer
  fsw::messaging::Inbox inbox_;
  fsw::messaging::Telecommands telecommands_;
  std::unique_ptr<fsw::navigation::MeasurementScheduler> measurements_;
  std::unique_ptr<fsw::navigation::NavigationSolution> navigation_;
  Tamper tamper_;
  std::size_t next_ = 0;
};

// Whole flights of missions/experiment3.toml and what is asked of them.

/// Errors of one flight from its first fix on.
struct Flight {
  FlownMission flown;
  std::optional<double> first_fix_s;  ///< after the start
  double mean_position_m = 0.0;
  double mean_velocity_mps = 0.0;
  accuracy::Largest largest_position_m;
};

/// Flies it from this seed. Fails the test if it does not come to its end.
Flight fly_experiment3(std::uint64_t seed, std::vector<std::string> overrides = {}, const Wrap& wrap = {});

/// Telemetry of one kind, decoded, in order.
template <class Message>
std::vector<Message> telemetry_of(const FlownMission& flown);

// The bytes of a receiver on their way to the flight software, for tests that spoil them: taken out of the packets of a
// step, changed, and put back into packets.

using Bytes = std::vector<std::uint8_t>;

/// Both receivers' bytes of one step; either may be empty.
struct ReceiverBytes {
  Bytes servicer;
  Bytes target;
};

/// Changes the bytes of steps `first` to `last`.
Wrap spoil_steps(std::uint32_t first, std::uint32_t last, const std::function<void(ReceiverBytes&)>& spoil);

/// Calls `edit(id, message)` for each message of NovAtel's binary format in `bytes`, which holds whole ones; `message`
/// is header and body, which may change in content and length. Length field and check sum are then made right again.
void edit_messages(Bytes& bytes, const std::function<void(int id, Bytes& message)>& edit);

/// Bytes of a message's header, and its numbers (OM-20000129).
inline constexpr std::size_t kOemHeaderBytes = 28;
inline constexpr int kRange = 43, kRawEphem = 41, kGalEphemeris = 1122, kBdsEphemeris = 1696;

/// RANGE: a count, and records of that many bytes, which begin with the satellite's number (16 bits), GLONASS frequency
/// (16 bits), and pseudorange (double).
inline constexpr std::size_t kRangeRecordBytes = 44;

}  // namespace vbar::test
