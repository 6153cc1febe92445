// A truth in another process: what it is asked for and when, and which of its answers are not accepted. The program of
// these tests flies circular orbits about a point mass, whose motion is known in closed form.

#include "hil_drivers/external/external_truth.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/rtn.h"
#include "fsw/packets/messages.h"
#include "hil_drivers/external/source_server.h"

namespace vbar::external {
namespace {

using testing::HasSubstr;

constexpr fsw::GpsTime kStart{1'000'000'000'000'000'000};
constexpr double kRadius = 7e6;

fsw::GpsTime after(double s) {
  return kStart + fsw::nearest_duration(s);
}

/// A circular orbit in the plane of the equator.
twins::SpacecraftTruth circular(const std::string& name, double phase, fsw::GpsTime time) {
  const double rate = std::sqrt(fsw::orbit::kMu / (kRadius * kRadius * kRadius));
  const double angle = phase + rate * fsw::seconds(time - kStart);
  twins::SpacecraftTruth truth;
  truth.name = name;
  truth.orbit.position_eci = kRadius * fsw::Vector3(std::cos(angle), std::sin(angle), 0.0);
  truth.orbit.velocity_eci = rate * kRadius * fsw::Vector3(-std::sin(angle), std::cos(angle), 0.0);
  truth.acceleration_eci = -rate * rate * truth.orbit.position_eci;
  return truth;
}

/// The body turns by a thousandth of a radian in a second about its z axis.
truth::AttitudeState turning(fsw::GpsTime time) {
  constexpr double kRate = 1e-3;
  const Eigen::Quaterniond at_start(Eigen::AngleAxisd(1.0, fsw::Vector3(1.0, 2.0, 3.0).normalized()));
  return {Eigen::AngleAxisd(-kRate * fsw::seconds(time - kStart), fsw::Vector3::UnitZ()) * at_start, {0.0, 0.0, kRate}};
}

/// Both spacecraft on their circles; the impulses change the velocity of the servicer from then on, and nothing else,
/// which is enough for what is asked in the second after one.
class Circles final : public twins::TrueWorld {
 public:
  void advance_to(fsw::GpsTime time) override {
    time_ = time;
    asked.push_back(time);
  }
  twins::TruthSnapshot snapshot(twins::TruthDetail /*detail*/) override {
    twins::TruthSnapshot truth;
    truth.time = time_;
    truth.spacecraft = {circular("target", 1e-5, time_), circular("servicer", 0.0, time_)};
    twins::SpacecraftTruth& servicer = truth.spacecraft[1];
    servicer.orbit = fsw::orbit::apply_impulse_rtn(servicer.orbit, dv_rtn);
    servicer.attitude = turning(time_);
    servicer.angular_acceleration_body = fsw::Vector3::Zero();
    return truth;
  }
  void apply_impulse_rtn(const fsw::Vector3& dv) override {
    dv_rtn += dv;
    impulses.push_back(time_);
  }
  void point(fsw::GpsTime time, const fsw::Vector3& boresight, const fsw::Vector3& /*rate*/) override {
    pointed.push_back({time, boresight});
  }
  double wall_s() const override { return 0.0; }

  std::vector<fsw::GpsTime> asked, impulses;
  std::vector<std::pair<fsw::GpsTime, fsw::Vector3>> pointed;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();

 private:
  fsw::GpsTime time_ = kStart;
};

/// The program, in this process; `change` is made to each of its answers.
class Program final : public pil::FlightComputer {
 public:
  using Change = std::function<void(twins::TruthSnapshot&)>;
  Program(Circles*& world, SpacecraftNumbers numbers, Change change)
      : numbers_(std::move(numbers)),
        change_(std::move(change)),
        served_(
            [&world] {
              auto made = std::make_unique<Circles>();
              world = made.get();
              return made;
            },
            numbers_) {}

  pil::StepResult step(std::uint32_t /*step*/, std::span<const pil::Packet> packets) override {
    const Batch batch = batch_of(packets, numbers_);
    std::vector<twins::Packet> answer = served_.answer(batch);
    if (!batch.opening && change_) {
      Answer changed = answer_of(std::move(answer));
      twins::TruthSnapshot truth = truth_of(changed.packets, batch.time, numbers_).truth;
      change_(truth);
      changed.packets = packets_of(truth, numbers_);
      answer = packets_of(std::move(changed), batch.time);
    }
    return {.packets = std::move(answer), .wired = {}, .report = {}, .compute_wall_s = 0.0};
  }
  pil::LinkStatistics statistics() const override { return {}; }
  std::string description() const override { return "circles"; }
  void close() override {}

 private:
  SpacecraftNumbers numbers_;
  Change change_;
  ServedTruth served_;
};

class ExternalTruthTest : public testing::Test {
 protected:
  ExternalTruthTest() {
    mission_.epoch = kStart;
    mission_.spacecraft.resize(2);
    mission_.spacecraft[0].name = "servicer";
    mission_.spacecraft[0].number = 1;
    mission_.spacecraft[0].attitude = mission::Commanded{};
    mission_.spacecraft[1].name = "target";
    mission_.spacecraft[1].number = 2;
  }

  [[nodiscard]] std::unique_ptr<ExternalTruth> make(Program::Change change = {}) {
    twins::TruthSnapshot start;
    start.time = kStart;
    start.spacecraft = {circular("servicer", 0.0, kStart), circular("target", 1e-5, kStart)};
    start.spacecraft[0].attitude = turning(kStart);
    const auto orientation =
        std::make_shared<const truth::EarthOrientationSeries>(truth::EarthOrientationSeries::unknown(kStart));
    return std::make_unique<ExternalTruth>(
        testbeds::TruthPlan{mission_, mission_.spacecraft[0], {}, start, orientation},
        [this, change] { return std::make_unique<Program>(world_, numbers_of(mission_), change); });
  }

  /// What a run says of a program that changes its answers from 10 s on; of one that changes them at the start.
  [[nodiscard]] std::string fault_later(const Program::Change& change) {
    auto truth = make([&](twins::TruthSnapshot& stated) {
      if (stated.time >= after(10.0)) change(stated);
    });
    truth->start();
    return error_of([&] { truth->advance_to(after(10.0)); });
  }
  [[nodiscard]] std::string fault_at_start(const Program::Change& change) {
    auto truth = make(change);
    return error_of([&] { truth->start(); });
  }
  static std::string error_of(const std::function<void()>& call) {
    try {
      call();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }

  mission::Mission mission_;
  Circles* world_ = nullptr;
};

twins::SpacecraftTruth& servicer_in(twins::TruthSnapshot& truth) {
  return truth.spacecraft[1];
}

TEST_F(ExternalTruthTest, StatesArriveBitForBitInTheOrderOfTheMission) {
  auto truth = make();
  truth->start();
  truth->advance_to(after(60.0));
  const twins::TruthSnapshot stated = truth->snapshot(twins::TruthDetail::kAccelerations);
  EXPECT_EQ(stated.time, after(60.0));
  ASSERT_EQ(stated.spacecraft.size(), 2u);
  EXPECT_EQ(stated.spacecraft[0].name, "servicer");
  EXPECT_EQ(stated.spacecraft[1].name, "target");
  EXPECT_EQ(stated.spacecraft[1].orbit.position_eci, circular("target", 1e-5, after(60.0)).orbit.position_eci);
  EXPECT_EQ(*stated.spacecraft[1].acceleration_eci, *circular("target", 1e-5, after(60.0)).acceleration_eci);
  EXPECT_EQ(stated.spacecraft[0].attitude->q_body_eci.coeffs(), turning(after(60.0)).q_body_eci.coeffs());
  EXPECT_FALSE(truth->snapshot(twins::TruthDetail::kStates).spacecraft[0].acceleration_eci.has_value());
}

TEST_F(ExternalTruthTest, EqualTimesCostNothing) {
  auto truth = make();
  truth->start();
  EXPECT_EQ(truth->exchanges(), 1);  // the states at the start
  truth->start();
  truth->advance_to(kStart);
  static_cast<void>(truth->snapshot(twins::TruthDetail::kStates));
  EXPECT_EQ(truth->exchanges(), 1);
  for (int k = 0; k < 3; ++k) {
    truth->advance_to(after(60.0));
    static_cast<void>(truth->snapshot(twins::TruthDetail::kAccelerations));
    static_cast<void>(truth->at(after(60.5)));
  }
  EXPECT_EQ(truth->exchanges(), 2);
  EXPECT_THROW(truth->advance_to(after(59.0)), std::invalid_argument);
}

TEST_F(ExternalTruthTest, ImpulseActsAtItsTimeAfterTheStates) {
  auto truth = make();
  truth->start();
  truth->advance_to(after(30.0));
  const fsw::Vector3 before = truth->snapshot(twins::TruthDetail::kStates).spacecraft[0].orbit.velocity_eci;
  const fsw::Vector3 dv_rtn(0.0, 0.5, 0.0);
  truth->apply_impulse_rtn(dv_rtn);
  EXPECT_EQ(truth->exchanges(), 2);
  // A snapshot at the same time has it.
  const fsw::Vector3 change = truth->snapshot(twins::TruthDetail::kStates).spacecraft[0].orbit.velocity_eci - before;
  EXPECT_NEAR(change.norm(), 0.5, 1e-12);
  EXPECT_NEAR(change.dot(before.normalized()), 0.5, 1e-12);
  EXPECT_EQ(truth->exchanges(), 3);
  EXPECT_THAT(world_->impulses, testing::ElementsAre(after(30.0)));
  truth->advance_to(after(31.0));
  EXPECT_EQ(world_->impulses.size(), 1u) << "an impulse is sent once";
}

TEST_F(ExternalTruthTest, PointingIsSentWhereTheAttitudeIsCommanded) {
  auto truth = make();
  truth->start();
  truth->point(after(1.0), fsw::Vector3::UnitY(), fsw::Vector3::Zero());
  truth->advance_to(after(10.0));
  ASSERT_EQ(world_->pointed.size(), 1u);
  EXPECT_EQ(world_->pointed[0].first, after(1.0));
  EXPECT_EQ(world_->pointed[0].second, fsw::Vector3::UnitY());
  mission_.spacecraft[0].attitude = mission::Inertial{};
  truth = make();
  truth->start();
  truth->point(after(1.0), fsw::Vector3::UnitY(), fsw::Vector3::Zero());
  truth->advance_to(after(10.0));
  EXPECT_TRUE(world_->pointed.empty());
}

TEST_F(ExternalTruthTest, OutlookIsWhatTheTruthBecomes) {
  auto truth = make();
  truth->start();
  const twins::TruthSnapshot ahead = truth->at(after(1.0));
  const twins::SpacecraftTruth becomes = circular("servicer", 0.0, after(1.0));
  EXPECT_EQ(ahead.time, after(1.0));
  // 1e-9 m is the resolution of a double at 7e6 m.
  EXPECT_LT((ahead.spacecraft[0].orbit.position_eci - becomes.orbit.position_eci).norm(), 3e-9);
  EXPECT_LT((ahead.spacecraft[0].orbit.velocity_eci - becomes.orbit.velocity_eci).norm(), 1e-11);
  EXPECT_LT((*ahead.spacecraft[0].acceleration_eci - *becomes.acceleration_eci).norm(), 1e-13);
  EXPECT_LT(truth::angle_between(ahead.spacecraft[0].attitude->q_body_eci, turning(after(1.0)).q_body_eci), 1e-15);
  EXPECT_THROW(static_cast<void>(truth->at(after(1.1))), std::out_of_range);
}

TEST_F(ExternalTruthTest, EarthOfTheProgramIsTaken) {
  const fsw::Matrix3 R = Eigen::AngleAxisd(0.3, fsw::Vector3::UnitZ()).toRotationMatrix();
  auto truth = make([&](twins::TruthSnapshot& stated) { stated.R_itrf_gcrf = R; });
  truth->start();
  EXPECT_EQ(truth->snapshot(twins::TruthDetail::kStates).R_itrf_gcrf, R);
  // In half a second it turns by 15.04 arcsec/s about the pole.
  const fsw::Matrix3 turn = truth->at(after(0.5)).R_itrf_gcrf * R.transpose();
  EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), 0.5 * 7.292115e-5, 1e-9);
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) { stated.R_itrf_gcrf *= 1.001; }),
              HasSubstr("its answer holds a true_earth that is not a rotation"));
}

TEST_F(ExternalTruthTest, UnitsAndFramesAreRecognised) {
  EXPECT_THAT(
      fault_at_start([](twins::TruthSnapshot& stated) { servicer_in(stated).orbit.position_eci *= 1e-3; }),
      HasSubstr("source truth: at 0 s of the run its answer holds a position of the spacecraft servicer below the "
                "Earth's surface, 7000 m from its centre; accepted: m"));
  EXPECT_THAT(fault_at_start([](twins::TruthSnapshot& stated) { servicer_in(stated).orbit.velocity_eci *= 1e-3; }),
              HasSubstr("a velocity of the spacecraft servicer that is 7538.51 m/s from where its state of 0 s before "
                        "leads, more than the 0.01 m/s"));
  // The mean equator and equinox of date in place of GCRF: 0.15 deg of precession in 11 years.
  EXPECT_THAT(fault_at_start([](twins::TruthSnapshot& stated) {
                fsw::orbit::CartesianState& orbit = servicer_in(stated).orbit;
                const auto turn = Eigen::AngleAxisd(2.7e-3, fsw::Vector3::UnitZ());
                orbit = {turn * orbit.position_eci, turn * orbit.velocity_eci};
              }),
              HasSubstr("a position of the spacecraft servicer that is 18900 m from where"));
  EXPECT_THAT(
      fault_later([](twins::TruthSnapshot& stated) { servicer_in(stated).acceleration_eci = fsw::Vector3::Zero(); }),
      HasSubstr("an acceleration of the spacecraft servicer that is 8.13"));
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) {
                servicer_in(stated) = circular("servicer", 0.0, after(9.9));
                servicer_in(stated).attitude = turning(after(10.0));
              }),
              HasSubstr("at 10 s of the run its answer holds a position of the spacecraft servicer that is 754.6"));
}

TEST_F(ExternalTruthTest, EverySpacecraftIsStatedOnce) {
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) { stated.spacecraft.resize(1); }),
              HasSubstr("source truth: at 10 s of the run its answer holds no true_state of the spacecraft servicer"));
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) { stated.spacecraft.push_back(stated.spacecraft[0]); }),
              HasSubstr("a second true_state of the spacecraft target"));
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) { stated.time = after(11.0); }),
              HasSubstr("a packet of GPS time 1000000011000000000 ns, and 1000000010000000000 ns was asked for"));
}

TEST_F(ExternalTruthTest, AttitudesFollowTheConvention) {
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) { servicer_in(stated).attitude.reset(); }),
              HasSubstr("no attitude of the spacecraft servicer, which has one in the mission"));
  EXPECT_THAT(fault_later([](twins::TruthSnapshot& stated) {
                servicer_in(stated).attitude->q_body_eci.coeffs() *= 1.0 + 1e-6;
              }),
              HasSubstr("a quaternion of the spacecraft servicer whose norm is 1.000001"));
  // To ECI from body: the angle of 1 rad doubles.
  EXPECT_THAT(fault_at_start([](twins::TruthSnapshot& stated) {
                servicer_in(stated).attitude->q_body_eci = servicer_in(stated).attitude->q_body_eci.conjugate();
              }),
              HasSubstr("an attitude of the spacecraft servicer that is 114.592 deg from that at the start"));
  // One that the mission does not have is taken.
  auto truth = make([](twins::TruthSnapshot& stated) { stated.spacecraft[0].attitude = turning(stated.time); });
  truth->start();
  EXPECT_TRUE(truth->snapshot(twins::TruthDetail::kStates).spacecraft[1].attitude.has_value());
}

TEST(ServedTruth, RefusesAnotherStart) {
  SpacecraftNumbers numbers;
  numbers.add("servicer", 1);
  numbers.add("target", 2);
  ServedTruth served([] { return std::make_unique<Circles>(); }, numbers);
  Batch batch;
  batch.time = kStart;
  EXPECT_THROW(static_cast<void>(served.answer(batch)), std::runtime_error);
  batch.opening = Opening{"truth", 1, 1, 0};
  batch.truth.emplace();
  batch.truth->spacecraft = {circular("servicer", 0.0, kStart), circular("target", 2e-5, kStart)};
  try {
    static_cast<void>(served.answer(batch));
    FAIL() << "another start was accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("starts the spacecraft target elsewhere"));
  }
}

}  // namespace
}  // namespace vbar::external
