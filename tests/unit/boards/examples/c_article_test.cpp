// The test article in C writes and reads its packets by hand. Here vbar's own packet library is the other side, and a
// two-body integration what it flies in.

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/messages.h"

namespace vbar {
namespace {

namespace packets = fsw::packets;

constexpr std::int64_t kStartNs = 1'000'000'000'000'000'000;
constexpr std::int64_t kPeriodNs = 10'000'000'000;
constexpr double kMu = 3.986004415e14;  // m^3/s^2, GGM05S
constexpr std::uint8_t kSpacecraft = 3;

using Vector = std::array<double, 3>;
struct State {
  Vector r{};
  Vector v{};
};

Vector axpy(const Vector& x, double a, const Vector& y) {
  return {x[0] + a * y[0], x[1] + a * y[1], x[2] + a * y[2]};
}
double norm(const Vector& x) {
  return std::hypot(x[0], x[1], x[2]);
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Classical Runge-Kutta, 1 s steps: its error is about (n h)^5 r / 120 = 6e-11 m a step, under a micrometre in an hour.
State propagated(State s, int seconds) {
  const auto rate = [](const State& x) { return State{x.v, axpy({}, -kMu / std::pow(norm(x.r), 3), x.r)}; };
  const auto plus = [](const State& x, double h, const State& d) {
    return State{axpy(x.r, h, d.r), axpy(x.v, h, d.v)};
  };
  for (int i = 0; i < seconds; ++i) {
    const State k1 = rate(s);
    const State k2 = rate(plus(s, 0.5, k1));
    const State k3 = rate(plus(s, 0.5, k2));
    const State k4 = rate(plus(s, 1.0, k3));
    s = plus(plus(plus(plus(s, 1.0 / 6, k1), 1.0 / 3, k2), 1.0 / 3, k3), 1.0 / 6, k4);
  }
  return s;
}

struct Axes {
  Vector r, t, n;
};
Axes rtn(const State& s) {
  const Vector r = axpy({}, 1.0 / norm(s.r), s.r);
  const Vector h = cross(s.r, s.v);
  const Vector n = axpy({}, 1.0 / norm(h), h);
  return {r, cross(n, r), n};
}
double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

State circular(double radius, double angle) {
  const double speed = std::sqrt(kMu / radius);
  return {{radius * std::cos(angle), radius * std::sin(angle), 0},
          {-speed * std::sin(angle), speed * std::cos(angle), 0}};
}

class CArticleTest : public testing::Test {
 protected:
  void SetUp() override {
    memory_.resize(vbar_gnc_state_size() / sizeof(std::max_align_t) + 1);
    ASSERT_EQ(alignof(std::max_align_t) % vbar_gnc_state_alignment(), 0U);
    ASSERT_EQ(vbar_gnc_init(memory_.data(), kSpacecraft, &CArticleTest::sink, this), 0);
  }

  static void sink(void* self, const std::uint8_t* packet, std::size_t size) {
    static_cast<CArticleTest*>(self)->sent_.emplace_back(packet, packet + size);
  }

  template <class Message>
  static std::vector<std::uint8_t> packet(std::int64_t time_ns, const Message& message, std::uint8_t to = kSpacecraft) {
    packets::PacketHeader header;
    header.time.ns = time_ns;
    header.spacecraft = to;
    std::array<std::uint8_t, packets::kMaxPacketBytes> bytes{};
    const auto size = packets::encode(header, message, bytes);
    EXPECT_TRUE(size.ok());
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value())};
  }
  vbar_status receive(const std::vector<std::uint8_t>& bytes) {
    return vbar_gnc_receive(memory_.data(), bytes.data(), bytes.size());
  }

  // Gives the step its inputs and runs it; what it sent is in sent_.
  void step(std::int64_t number, const State& servicer, const State& target) {
    const std::int64_t now = kStartNs + number * kPeriodNs;
    vbar::ideal_navigation navigation{};
    for (std::size_t i = 0; i < 3; ++i) {
      navigation.servicer_position_eci[i] = servicer.r[i];
      navigation.servicer_velocity_eci[i] = servicer.v[i];
      navigation.target_position_eci[i] = target.r[i];
      navigation.target_velocity_eci[i] = target.v[i];
    }
    vbar::tick tick{};
    tick.step = number;
    tick.period_ns = kPeriodNs;
    sent_.clear();
    ASSERT_EQ(receive(packet(now, navigation)), 0);
    ASSERT_EQ(receive(packet(now, tick)), 0);
    ASSERT_EQ(vbar_gnc_step(memory_.data(), now), 0);
  }

  template <class Message>
  std::optional<Message> sent() const {
    for (const auto& bytes : sent_) {
      const auto view = packets::parse_packet(bytes);
      if (!view.ok()) {
        ADD_FAILURE() << "not a packet";
        continue;
      }
      EXPECT_EQ(view.value().header.spacecraft, kSpacecraft);
      const auto message = packets::decode<Message>(view.value());
      if (message.ok()) return message.value();
    }
    return std::nullopt;
  }

  std::vector<std::max_align_t> memory_;
  std::vector<std::vector<std::uint8_t>> sent_;
};

// Two spacecraft on one circular orbit, the target an angle ahead: in the servicer's RTN it stands at
// a (cos(angle) - 1, sin(angle), 0), and in that rotating frame it does not move.
TEST_F(CArticleTest, ReportsTheRelativeStateInVbarsPackets) {
  const double radius = 7.0e6;
  const double angle = 1e-4;
  const double at = 0.7;
  step(5, circular(radius, at), circular(radius, at + angle));
  const auto report = sent<vbar::telemetry_navigation>();
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->step, 5);
  EXPECT_EQ(report->source, 2);
  EXPECT_EQ(report->age_s, 0.0);
  // Positions of 7e6 m carry 1e-9 m of rounding, differences of them and the rotation a few times that.
  EXPECT_NEAR(report->relative_position_rtn[0], radius * (std::cos(angle) - 1.0), 1e-8);
  EXPECT_NEAR(report->relative_position_rtn[1], radius * std::sin(angle), 1e-8);
  EXPECT_NEAR(report->relative_position_rtn[2], 0.0, 1e-8);
  for (const double v : report->relative_velocity_rtn) EXPECT_NEAR(v, 0.0, 1e-11);
}

// From 500 m behind and 60 m below, commands executed as they ask, the servicer arrives 100 m behind the target and
// stays. The law is critically damped with w = 0.01 rad/s: an hour is 36 / w. It rests where its command falls below 1
// mm/s, that is within 1 mm/s / (T w^2) = 1 m for T = 10 s; 2 m leaves room for the tides.
TEST_F(CArticleTest, ClosesInOnThePointBehindTheTarget) {
  State target = circular(7.0e6, 0.0);
  State servicer = circular(7.0e6 - 60.0, -500.0 / 7.0e6);
  double dv_sum = 0;
  std::int32_t commands = 0;
  for (std::int64_t number = 0; number < 360; ++number) {
    step(number, servicer, target);
    servicer = propagated(servicer, 10);
    target = propagated(target, 10);
    if (const auto command = sent<vbar::maneuver_command>()) {
      EXPECT_EQ(command->maneuver_id, ++commands);
      const Axes axes = rtn(servicer);
      const Vector dv{command->dv_rtn[0], command->dv_rtn[1], command->dv_rtn[2]};
      ASSERT_LE(norm(dv), 0.050 * (1 + 1e-12));
      dv_sum += norm(dv);
      servicer.v = axpy(axpy(axpy(servicer.v, dv[0], axes.r), dv[1], axes.t), dv[2], axes.n);
    }
  }
  const Axes axes = rtn(servicer);
  const Vector offset = axpy(target.r, -1.0, servicer.r);
  EXPECT_NEAR(dot(offset, axes.r), 0.0, 2.0);
  EXPECT_NEAR(dot(offset, axes.t), 100.0, 2.0);
  EXPECT_NEAR(dot(offset, axes.n), 0.0, 2.0);
  EXPECT_GT(commands, 0);
  EXPECT_LT(dv_sum, 10.0) << "a law that hunts";
}

TEST_F(CArticleTest, RefusesWhatIsBroken) {
  vbar::tick tick{};
  tick.period_ns = kPeriodNs;
  const auto good = packet(kStartNs, tick);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_NE(receive(bad), 0) << "bit " << bit;
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(receive({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}), 0) << size << " bytes";
  }
  EXPECT_NE(receive(packet(kStartNs, tick, kSpacecraft + 1)), 0);
  tick.period_ns = 0;
  EXPECT_NE(receive(packet(kStartNs, tick)), 0);
  EXPECT_EQ(receive(good), 0);
}

// An orbit without a plane, and states without a step to act in.
TEST_F(CArticleTest, SaysNothingWithoutSenseInItsInputs) {
  EXPECT_EQ(vbar_gnc_step(memory_.data(), kStartNs), 0);
  EXPECT_TRUE(sent_.empty());
  step(0, State{{7.0e6, 0, 0}, {100, 0, 0}}, circular(7.0e6, 0.0));
  EXPECT_TRUE(sent_.empty());
}

}  // namespace
}  // namespace vbar
