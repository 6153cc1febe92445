// The whole receiver on a synthetic sky, read by the flight decoder.

#include "emulators/grand/receiver/receiver.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "fsw/gnss/oem_fields.h"
#include "tests/unit/emulators/grand/receiver_session.h"

namespace vbar::grand::bench::test {
namespace {

using fsw::gnss::Observation;
using fsw::gnss::ObservationEpoch;

double since_start_s(fsw::GpsTime time) {
  return fsw::seconds(time - vbar::test::kGnssStart);
}

const Observation* find(const ObservationEpoch& epoch, fsw::gnss::SatelliteId satellite, fsw::gnss::Signal signal) {
  for (std::size_t k = 0; k < epoch.count; ++k)
    if (epoch.observations[k].satellite == satellite && epoch.observations[k].signal == signal)
      return &epoch.observations[k];
  return nullptr;
}

/// Seconds until the first epoch that the flight decoder reads, and until the first own position.
struct StartTimes {
  double first_epoch_s = -1.0;
  double first_position_s = -1.0;
};
StartTimes start_times(ReceiverSession& session, double limit_s) {
  session.ask_for_logs(1.0, 0.0);
  session.fly(limit_s);
  const Decoded d = decode(session.heard[0]);
  StartTimes times;
  if (!d.epochs.empty()) times.first_epoch_s = since_start_s(d.epochs.front().receiver_time);
  if (!d.positions.empty()) times.first_position_s = since_start_s(d.positions.front().receiver_time);
  return times;
}

// A warm start: 2 to 8 s of search, then three subframes of 6 s out of 30 (18 to 36 s of lock). Every log is read by
// the flight decoder, and the receiver's own solution is within the errors of broadcast satellites (1 m a range).
TEST(GrandReceiver, WarmStart) {
  ReceiverSession session;
  session.warm_start();
  session.ask_for_logs(1.0, 0.0);
  session.fly(200.0);
  const Decoded d = decode(session.heard[0]);
  EXPECT_EQ(d.stream.bad_checksum, 0U);
  EXPECT_EQ(d.counters.refused, 0U);
  EXPECT_EQ(d.counters.unknown, 0U);
  EXPECT_EQ(d.counters.observations.implausible, 0U);
  EXPECT_EQ(d.counters.observations.duplicate, 0U);
  ASSERT_FALSE(d.positions.empty());
  const double first_s = since_start_s(d.positions.front().receiver_time);
  EXPECT_GE(first_s, 20.0);
  EXPECT_LE(first_s, 50.0);
  // From then on no second is missing.
  EXPECT_EQ(d.positions.size(), static_cast<std::size_t>(std::lround(199.0 - first_s) + 1));
  for (const fsw::gnss::ReceiverPosition& p : d.positions) {
    const double t = since_start_s(p.receiver_time);
    if (t < 100.0) continue;
    EXPECT_LT((p.position_ecef - session.sky.position_ecef(t)).norm(), 8.0) << t;
    EXPECT_LT((p.velocity_ecef - session.sky.velocity_ecef(t)).norm(), 0.1) << t;
  }
  EXPECT_GE(d.epochs.back().count, 25U);
  EXPECT_EQ(d.ephemerides, session.receiver.report().ephemerides);
}

// BESTPOS and BESTXYZ name one point; GPSEPHEM and RAWEPHEM one set. VERSION and RXSTATUSEVENT are messages the flight
// decoder passes over.
TEST(GrandReceiver, TheFlightDecoderReadsEveryLog) {
  ReceiverSession session;
  session.warm_start();
  for (const char* log : {"BESTPOSB ONTIME 1", "GPSEPHEMB ONCHANGED", "GALEPHEMERISB ONTIME 30", "BDSEPHEMERISB ONNEW",
                          "IONUTCB ONTIME 10", "VERSIONB ONTIME 10", "RXSTATUSEVENTB ONNEW"})
    EXPECT_EQ(session.command("LOG " + std::string(log)), "<OK\r\n[COM1]");
  session.fly(100.0);
  const Decoded d = decode(session.heard[0]);
  EXPECT_EQ(d.stream.bad_checksum, 0U);
  EXPECT_EQ(d.counters.refused, 0U);
  EXPECT_GE(d.counters.unknown, 10U);
  EXPECT_GE(d.ionospheres, 5);
  EXPECT_GE(d.ephemerides, 15);
  ASSERT_GT(d.positions.size(), 30U);
  const fsw::gnss::ReceiverPosition& last = d.positions.back();
  EXPECT_LT((last.position_ecef - session.sky.position_ecef(since_start_s(last.receiver_time))).norm(), 8.0);
}

// CLOCKADJUST ENABLE is the receiver's default: coarse, coarse steering, fine, fine steering; then within 30 ns.
TEST(GrandReceiver, SteersItsClock) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    ReceiverSession session({}, seed);
    session.warm_start();
    std::vector<int> statuses;
    for (double t = 1.0; t <= 600.0; t += 1.0) {
      session.fly(t);
      const ReceiverReport report = session.receiver.report();
      if (statuses.empty() || statuses.back() != report.time_status) statuses.push_back(report.time_status);
      if (t > 120.0) {
        EXPECT_LT(std::abs(report.clock_offset_s), 30e-9) << t << " s, seed " << seed;
      }
    }
    EXPECT_EQ(statuses, (std::vector<int>{60, 120, 160, 180}));
  }
}

// Without steering the offset grows at the oscillator's rate and is set back by a whole millisecond: code and phase by
// the same 299792.458 m, so that their difference does not change.
TEST(GrandReceiver, JumpsByMillisecondsWithoutSteering) {
  ReceiverSettings settings;
  settings.clock.initial_drift_sigma_ns_per_s = 10000.0;
  ReceiverSession session(settings, 5);
  session.warm_start();
  EXPECT_EQ(session.command("CLOCKADJUST DISABLE"), "<OK\r\n[COM1]");
  session.ask_for_logs(1.0, 0.0);
  session.fly(300.0);
  EXPECT_EQ(session.receiver.report().time_status, 160);
  const Decoded d = decode(session.heard[0]);
  int jumps = 0;
  for (std::size_t e = 1; e < d.epochs.size(); ++e) {
    for (std::size_t k = 0; k < d.epochs[e].count; ++k) {
      const Observation& now = d.epochs[e].observations[k];
      const Observation* const before = find(d.epochs[e - 1], now.satellite, now.signal);
      if (before == nullptr || since_start_s(d.epochs[e].receiver_time) < 60.0 || !now.phase_usable ||
          !before->phase_usable)
        continue;
      const double lambda = fsw::gnss::wavelength(now.signal);
      const double predicted_m = -0.5 * (now.doppler_hz + before->doppler_hz) * lambda;
      const double moved_m = lambda * (now.carrier_phase_cycles - before->carrier_phase_cycles) - predicted_m;
      const double jumped_ms = std::round(moved_m / 299792.458);
      // A clock that has been set back by a millisecond shows its next second one millisecond later.
      const double later_m = jumped_ms * 1e-3 * now.doppler_hz * lambda;
      EXPECT_NEAR(moved_m, jumped_ms * 299792.458 + later_m, 1.0);
      if (jumped_ms != 0.0) ++jumps;
      EXPECT_NEAR(now.pseudorange_m - before->pseudorange_m, moved_m + predicted_m, 3.0);
    }
  }
  EXPECT_GT(jumps, 10);
}

/// Single differences target minus servicer of the phases minus the true ones, cycles, at the last common epoch.
struct Pair {
  explicit Pair(double duration_s, std::uint64_t seed = 1) : servicer({}, seed), target({}, seed + 100, kOffset) {
    for (ReceiverSession* session : {&servicer, &target}) {
      session->warm_start();
      session->ask_for_logs(10.0, 9.0);
      session->fly(duration_s);
    }
  }
  ReceiverSession servicer, target;
  static inline const fsw::Vector3 kOffset{1.2, -7.9, 0.5};
};

// Double differences of phases between two receivers are integers plus the difference of the ranges: here the offset of
// the two clocks (30 ns, 10 m of code) and their motion at different true times are removed with the receivers' own
// estimate.
TEST(GrandReceiver, DoubleDifferencesAreIntegers) {
  const Pair pair(300.0);
  const Decoded a = decode(pair.servicer.heard.at(0));
  const Decoded b = decode(pair.target.heard.at(0));
  ASSERT_FALSE(a.epochs.empty());
  ASSERT_FALSE(b.epochs.empty());
  const ObservationEpoch& servicer = a.epochs.back();
  const ObservationEpoch& target = b.epochs.back();
  ASSERT_EQ(servicer.receiver_time, target.receiver_time);
  const auto number = static_cast<std::int64_t>(std::llround(since_start_s(servicer.receiver_time) * 10.0));
  vbar::test::SyntheticSky sky_a(ReceiverSession::constellation());
  vbar::test::SyntheticSky sky_b(ReceiverSession::constellation(), Pair::kOffset);
  const RfBlock field_a = sky_a.block(number);
  const RfBlock field_b = sky_b.block(number);
  ASSERT_EQ(field_a.signals.size(), field_b.signals.size());
  std::map<fsw::gnss::Signal, double> reference;
  int compared = 0;
  for (std::size_t k = 0; k < field_a.signals.size(); ++k) {
    const RfSignal& rf = field_a.signals[k];
    const fsw::gnss::SatelliteId satellite{static_cast<fsw::gnss::Constellation>(rf.satellite.system),
                                           static_cast<std::uint8_t>(rf.satellite.prn)};
    const auto signal = static_cast<fsw::gnss::Signal>(rf.signal);
    const Observation* const oa = find(servicer, satellite, signal);
    const Observation* const ob = find(target, satellite, signal);
    if (oa == nullptr || ob == nullptr || !oa->phase_usable || !ob->phase_usable) continue;
    const double lambda = fsw::gnss::wavelength(signal);
    // A range rate of 7 km/s moves 0.2 mm in 30 ns.
    const double truth = (field_b.signals[k].carrier_m.at(0.0) - rf.carrier_m.at(0.0)) / lambda;
    const double single = ob->carrier_phase_cycles - oa->carrier_phase_cycles - truth;
    if (!reference.contains(signal)) {
      reference[signal] = single;
      continue;
    }
    const double doubled = single - reference[signal];
    // Four carriers of 0.7 mm noise are 1.4 mm, 0.008 cycles.
    EXPECT_NEAR(doubled, std::round(doubled), 0.035)
        << twins::gnss::name_of(rf.satellite) << " signal " << int(rf.signal);
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

// What is known decides: with ephemerides stored a position takes the search and one time of week; with an almanac the
// messages; with nothing the search is blind as well.
TEST(GrandReceiver, ColdWarmAndHotStartsDiffer) {
  ReceiverSettings hot_settings;
  hot_settings.stored = StoredData::kEphemerides;
  ReceiverSession hot(hot_settings);
  hot.warm_start();
  ReceiverSession warm;
  warm.warm_start();
  ReceiverSettings cold_settings;
  cold_settings.stored = StoredData::kNothing;
  ReceiverSession cold(cold_settings);
  const double hot_s = start_times(hot, 40.0).first_position_s;
  const double warm_s = start_times(warm, 90.0).first_position_s;
  const double cold_s = start_times(cold, 120.0).first_position_s;
  EXPECT_GT(hot_s, 3.0);
  EXPECT_LT(hot_s, 20.0);
  EXPECT_GT(warm_s, hot_s + 10.0);
  EXPECT_LT(warm_s, 60.0);
  EXPECT_GE(cold_s, warm_s);
  EXPECT_LT(cold_s, 100.0);
  // Ionosphere and UTC come once in 12.5 minutes; a receiver with an almanac has them from before.
  EXPECT_EQ(decode(hot.heard[0]).ionospheres, 1);
  EXPECT_EQ(decode(warm.heard[0]).ionospheres, 1);
  EXPECT_EQ(decode(cold.heard[0]).ionospheres, 0);
}

TEST(GrandReceiver, IonosphereArrivesWithPageEighteen) {
  ReceiverSettings settings;
  settings.stored = StoredData::kNothing;
  ReceiverSession session(settings);
  session.command("LOG IONUTCB ONCHANGED");
  // The start is 230400 s of the week, 150 s after the beginning of a cycle of 750 s: page 18 begins 528 s after it.
  session.fly(375.0);
  EXPECT_EQ(decode(session.heard[0]).ionospheres, 0);
  session.fly(390.0);
  EXPECT_EQ(decode(session.heard[0]).ionospheres, 1);
}

// An outage of 30 s: phases and codes are lost, found again within seconds, with new integers.
TEST(GrandReceiver, ReacquiresAfterAnOutage) {
  ReceiverSession session;
  session.warm_start();
  session.ask_for_logs(1.0, 0.0);
  session.fly(100.0);
  const int before = session.receiver.report().signals_tracked;
  session.rf = false;
  session.fly(130.0);
  EXPECT_EQ(session.receiver.report().signals_tracked, 0);
  EXPECT_EQ(session.receiver.report().time_status, 130);  // freewheeling
  session.rf = true;
  session.fly(150.0);
  EXPECT_GE(session.receiver.report().signals_tracked, before - 3);
  const Decoded d = decode(session.heard[0]);
  const ObservationEpoch& last = d.epochs.back();
  for (std::size_t k = 0; k < last.count; ++k) EXPECT_LT(last.observations[k].lock_time_s, 20.0);
  EXPECT_GT(last.count, 20U);
}

// 15 dB less for a minute: nothing false is reported as usable, and most come back. Lock time restarts where lock was
// lost.
TEST(GrandReceiver, SurvivesWeakSignals) {
  ReceiverSession session;
  session.warm_start();
  session.ask_for_logs(1.0, 0.0);
  session.fly(100.0);
  session.receiver.set_cn0_offset_db(-15.0);
  session.fly(160.0);
  const ReceiverReport weak = session.receiver.report();
  session.receiver.set_cn0_offset_db(0.0);
  session.fly(200.0);
  EXPECT_GT(weak.phase_locks_lost, 0U);
  EXPECT_GE(session.receiver.report().signals_phase_locked, 25);
  const Decoded d = decode(session.heard[0]);
  EXPECT_EQ(d.counters.observations.implausible, 0U);
}

TEST(GrandReceiver, ASnapLosesEveryLock) {
  ReceiverSession session;
  session.warm_start();
  session.fly(60.0);
  EXPECT_GT(session.receiver.report().signals_phase_locked, 20);
  RfBlock block = session.sky.block(session.blocks++);
  block.snapped = true;
  session.receiver.advance(block);
  EXPECT_EQ(session.receiver.report().signals_phase_locked, 0);
}

// Same seed, same bytes; another seed, other bytes. What was said before the start does not matter to the measurements.
TEST(GrandReceiver, IsReproducible) {
  std::vector<std::vector<std::uint8_t>> runs;
  for (const std::uint64_t seed : {1, 1, 2}) {
    ReceiverSession session({}, seed);
    if (runs.size() == 1) session.command("LOG VERSIONB ONCE");
    session.warm_start();
    session.ask_for_logs(1.0, 0.0);
    session.fly(80.0);
    runs.push_back(session.heard[0]);
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_NE(runs[0], runs[2]);
}

// Logs leave 40 +- 10 ms after their epoch.
TEST(GrandReceiver, ComputesForFortyMilliseconds) {
  ReceiverSession session;
  session.warm_start();
  session.fly(60.0);
  session.heard[0].clear();
  session.command("LOG TIMEB ONTIME 1");
  session.fly(61.0);  // the block that begins at 61 s is not flown
  session.heard[0].clear();
  session.receiver.advance(session.sky.block(session.blocks++));
  // 76 bytes take 6.6 ms: by 100 ms after the epoch everything is there.
  EXPECT_EQ(session.receiver.speak(0).size(), 76U);
}

TEST(GrandReceiver, AnOverrunIsReportedInTheStatus) {
  ReceiverSettings settings;
  settings.line.baud = 2400;
  settings.line.buffer_bytes = 4096;
  ReceiverSession session(settings);
  session.warm_start();
  session.command("LOG RANGEB ONTIME 1");
  session.command("LOG COM2 TIMEB ONTIME 1");
  session.fly(120.0);
  EXPECT_GT(session.receiver.report().logs_dropped, 10U);
  // On the other port the logs carry the bit of COM1.
  const std::vector<std::uint8_t>& other = session.heard[1];
  bool overrun = false;
  for (std::size_t k = 0; k + 28 < other.size(); ++k)
    if (other[k] == 0xAA && other[k + 1] == 0x44 && other[k + 2] == 0x12)
      overrun = overrun || (fsw::gnss::read_u32(other, k + 20) & (1U << 8U)) != 0;
  EXPECT_TRUE(overrun);
  // What did leave is whole.
  EXPECT_EQ(decode(session.heard[0]).stream.bad_checksum, 0U);
  EXPECT_GT(decode(session.heard[0]).epochs.size(), 5U);
}

// The faults of a receiver that takes the week for another, or is off by a second.
TEST(GrandReceiver, WeekAndTimeFaultsShiftEveryTag) {
  for (const auto& [week_shift, time_shift_s] : {std::pair{1024, 0}, std::pair{0, 1}}) {
    ReceiverSettings settings;
    settings.week_shift = week_shift;
    settings.time_shift_s = time_shift_s;
    ReceiverSession session(settings);
    session.warm_start();
    session.ask_for_logs(1.0, 0.0);
    session.fly(80.0);
    const Decoded d = decode(session.heard[0]);
    ASSERT_FALSE(d.epochs.empty());
    const double expected_s = week_shift * 604800.0 + time_shift_s;
    const double off_s = since_start_s(d.epochs.back().receiver_time) - 79.0;
    EXPECT_NEAR(off_s, expected_s, 1.0 - 1e-6);
    EXPECT_GT(d.ephemerides, 10);
  }
}

TEST(GrandReceiver, SwitchedOffItIsSilentAndForgets) {
  ReceiverSession session;
  session.warm_start();
  session.ask_for_logs(1.0, 0.0);
  session.fly(60.0);
  session.receiver.power(false);
  session.heard[0].clear();
  session.fly(62.0);
  EXPECT_TRUE(session.heard[0].empty());
  EXPECT_FALSE(session.receiver.busy());
  session.receiver.power(true);
  session.fly(70.0);
  EXPECT_EQ(std::string(session.heard[0].begin(), session.heard[0].end()), "\r\n[COM1]");
  EXPECT_EQ(session.receiver.report().time_status, 20);
}

// With a cut-off of 10 deg no satellite below it is tracked.
TEST(GrandReceiver, ElevationCutoff) {
  ReceiverSession session;
  session.warm_start();
  session.ask_for_logs(1.0, 0.0);
  session.fly(60.0);
  const int all = session.receiver.report().signals_tracked;
  session.command("ECUTOFF 20");
  session.fly(90.0);
  const int above = session.receiver.report().signals_tracked;
  EXPECT_LT(above, all - 3);
  EXPECT_GT(above, 5);
}

}  // namespace
}  // namespace vbar::grand::bench::test
