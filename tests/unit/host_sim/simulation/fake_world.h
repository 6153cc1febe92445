#pragma once
// A world without physics around a Simulation: sources that do as a test says, a flight computer that keeps what it
// got, a wall on which time passes only when somebody sleeps.

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/simulation/simulation.h"

namespace vbar::app {

inline constexpr fsw::GpsTime kFakeStart{1'000'000'000'000'000'000};

/// `s` after the start of the run.
inline fsw::GpsTime at(double s) {
  return kFakeStart + fsw::nearest_duration(s);
}

class FakeTruth final : public twins::TrueWorld {
 public:
  void advance_to(fsw::GpsTime time) override { now_ = time; }
  twins::TruthSnapshot snapshot(twins::TruthDetail detail) override {
    twins::TruthSnapshot truth;
    truth.time = now_;
    truth.spacecraft.resize(1);
    if (detail == twins::TruthDetail::kAccelerations) truth.spacecraft[0].acceleration_eci = fsw::Vector3::Zero();
    return truth;
  }
  void apply_impulse_rtn(const fsw::Vector3& dv_rtn) override { impulses.push_back({now_, dv_rtn}); }
  void point(fsw::GpsTime, const fsw::Vector3&, const fsw::Vector3&) override {}
  double wall_s() const override { return 1000.0; }  // spent before the run

  std::vector<std::pair<fsw::GpsTime, fsw::Vector3>> impulses;

 private:
  fsw::GpsTime now_ = kFakeStart;
};

/// Measures every `period_s` from the start on.
class FakeSource final : public twins::PacketSource {
 public:
  using Measure = std::function<twins::Measurement(const twins::TruthSnapshot&)>;
  FakeSource(double period_s, Measure measure)
      : period_(fsw::nearest_duration(period_s)), measure_(std::move(measure)) {}
  std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override {
    return twins::next_periodic_epoch(kFakeStart, period_, from);
  }
  twins::Measurement measure(const twins::TruthSnapshot& truth) override { return measure_(truth); }
  std::chrono::milliseconds wait_limit() const override { return limit; }
  bool truth_is_compared() const override { return compared; }

  std::chrono::milliseconds limit = std::chrono::milliseconds(200);
  bool compared = false;

 private:
  fsw::Duration period_;
  Measure measure_;
};

/// A packet that is one byte long: nobody looks into it on its way.
inline twins::Packet byte(std::uint8_t value) {
  return {value};
}

inline twins::Measurement ready(fsw::GpsTime available, std::vector<twins::Packet> packets) {
  twins::Measurement measurement;
  measurement.status = twins::MeasurementStatus::kReady;
  measurement.available = available;
  measurement.packets = std::move(packets);
  return measurement;
}

/// Keeps the inputs of each step without the tick.
class FakeComputer final : public pil::FlightComputer {
 public:
  pil::StepResult step(std::uint32_t, std::span<const pil::Packet> packets) override {
    steps.emplace_back(packets.begin(), packets.end() - 1);
    pil::StepResult result;
    if (answer) result.packets = answer(steps.size() - 1);
    if (wired) result.wired = wired(steps.size() - 1);
    return result;
  }
  pil::LinkStatistics statistics() const override { return {}; }
  std::string description() const override { return "fake"; }
  void close() override {}

  std::vector<std::vector<pil::Packet>> steps;
  std::function<std::vector<pil::Packet>(std::size_t)> answer;
  std::function<std::vector<pil::Packet>(std::size_t)> wired;
};

class FakeThruster final : public twins::Actuator {
 public:
  twins::Execution execute(const maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override {
    twins::Execution execution;
    execution.time = burn_time;
    execution.maneuver.accepted = burn_time >= now ? 1 : 0;
    if (burn_time >= now) std::copy_n(command.dv_rtn, 3, execution.maneuver.dv_rtn);
    execution.packet = byte(0xEE);
    execution.notes = {{"magnitude_error", 0.01}};
    return execution;
  }
};

/// Time passes when somebody sleeps or the test says so.
class TestWall final : public engine::WallClock {
 public:
  Span now() override { return now_; }
  void sleep_until(Span wake) override { pass(std::max(Span{0}, wake - now_)); }
  void pass(Span span) { now_ += span; }

 private:
  Span now_{0};
};

/// Writes down what it sees.
class Diary final : public RunObserver {
 public:
  void on_measured(std::string_view, const twins::TruthSnapshot& truth) override { measured.push_back(truth.time); }
  void on_note(fsw::GpsTime time, std::string_view source, const twins::Note& note) override {
    notes.push_back({time, std::string(source) + ":" + note.name});
  }
  void on_failure(fsw::GpsTime time, std::string_view source, std::string_view reason) override {
    failures.push_back({time, std::string(source) + ":" + std::string(reason)});
  }
  void on_waypoint(std::size_t waypoint, const twins::TruthSnapshot& truth) override {
    waypoints.push_back({truth.time, std::to_string(waypoint)});
  }
  void on_step(std::uint32_t, fsw::GpsTime time, std::span<const pil::Packet> packets,
               std::span<const pil::Packet>) override {
    steps.push_back(time);
    inputs.emplace_back(packets.begin(), packets.end());
  }

  using Line = std::pair<fsw::GpsTime, std::string>;
  std::vector<fsw::GpsTime> measured, steps;
  std::vector<std::vector<pil::Packet>> inputs;  ///< of each step, the tick included
  std::vector<Line> notes, failures, waypoints;
};

/// All of it. A run of 60 s in steps of 10 s unless the test says otherwise.
struct FakeWorld {
  FakeWorld() {
    timetable.start = kFakeStart;
    timetable.end = at(60.0);
    timetable.step = {kFakeStart, fsw::duration_of_seconds(10)};
    timetable.spacecraft = 1;
  }
  FakeSource& add(const std::string& name, double period_s, FakeSource::Measure measure) {
    auto source = std::make_unique<FakeSource>(period_s, std::move(measure));
    FakeSource& reference = *source;
    sources.push_back({name, "fake", std::move(source)});
    return reference;
  }
  [[nodiscard]] Simulation simulation() {
    return Simulation({truth, sources, thruster, computer, link, wall, observers, progress, stop_requested}, timetable);
  }
  /// What run() throws; empty if it does not.
  [[nodiscard]] static std::string error_of(Simulation& simulation) {
    try {
      simulation.run();
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  }

  FakeTruth truth;
  std::vector<Source> sources;
  FakeThruster thruster;
  FakeComputer computer;
  engine::LinkModel link{{}, engine::RandomStream(1, "link")};
  TestWall wall;
  Diary diary;
  std::vector<RunObserver*> observers{&diary};
  std::function<void(fsw::Duration)> progress;
  std::function<bool()> stop_requested;
  Timetable timetable;
};

}  // namespace vbar::app
