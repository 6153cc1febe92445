// The ionospheric model, the receiver's clock and its position out of its messages.

#include "fsw/gnss/oem_solution.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "fsw/gnss/gps_week.h"
#include "tests/support/paths.h"
#include "tests/unit/fsw/gnss/oem_messages.h"

namespace vbar::fsw::gnss {
namespace {

using test::Body;
using test::Bytes;
using test::overwrite;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

OemMessage log_of(std::uint16_t id, const Bytes& body) {
  return test::log_of(id, body, start_of_week(1643) + Duration{100'000'500'000'000});
}

TEST(Ionutc, ReadsTheManufacturersVector) {
  const test::AsciiLog log = test::ascii_log("ASCII_LOG_ROUNDTRIP_IONUTC", "IONUTCA");
  Body body;
  for (std::size_t k = 0; k < 8; ++k) body.f64(std::stod(log.body[k]));
  body.zeros(108 - 64);
  const Result<KlobucharCoefficients> result = read_ionosphere(log_of(kOemIonosphere, body.bytes));
  ASSERT_EQ(result.status(), Status::kOk);
  // As the satellites send them: whole numbers of eight bits in the units of IS-GPS-200N, table 20-X,
  // printed with sixteen digits.
  const std::array<double, 4> alpha{std::ldexp(43, -30), std::ldexp(2, -27), std::ldexp(-2, -24), std::ldexp(1, -24)};
  const std::array<double, 4> beta{std::ldexp(74, 11), std::ldexp(-3, 14), std::ldexp(-2, 16), std::ldexp(-3, 16)};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_DOUBLE_EQ(result.value().alpha[k], alpha[k]);
    EXPECT_DOUBLE_EQ(result.value().beta[k], beta[k]);
  }
}

TEST(Ionutc, RefusesWhatCannotBe) {
  Bytes body(108, 0);
  EXPECT_EQ(read_ionosphere(log_of(kOemIonosphere, body)).status(), Status::kOk);
  overwrite(body, 24, Body().f64(kNaN).bytes);
  EXPECT_EQ(read_ionosphere(log_of(kOemIonosphere, body)).status(), Status::kNotFinite);
  overwrite(body, 24, Body().f64(1.0).bytes);
  EXPECT_EQ(read_ionosphere(log_of(kOemIonosphere, body)).status(), Status::kOutOfRange);
  body.pop_back();
  EXPECT_EQ(read_ionosphere(log_of(kOemIonosphere, body)).status(), Status::kTooShort);
  EXPECT_EQ(read_ionosphere(log_of(kOemTime, body)).status(), Status::kWrongType);
}

Bytes time_body(std::uint32_t status, double offset_s, double sigma_s) {
  return Body().u32(status).f64(offset_s).f64(sigma_s).f64(-15.0).zeros(16).bytes;
}

TEST(Time, GivesTheClocksOffset) {
  const Bytes body = time_body(0, -1.480222e-3, 5e-9);
  const Result<ReceiverClock> result = read_time(log_of(kOemTime, body));
  ASSERT_EQ(result.status(), Status::kOk);
  EXPECT_EQ(result.value().offset_s, -1.480222e-3);
  EXPECT_EQ(result.value().sigma_s, 5e-9);
  EXPECT_EQ(result.value().receiver_time, start_of_week(1643) + Duration{100'000'500'000'000});
}

TEST(Time, RefusesAClockThatIsNotKnown) {
  const auto status = [](const Bytes& body) { return read_time(log_of(kOemTime, body)).status(); };
  for (const std::uint32_t not_valid : {1U, 2U, 3U}) EXPECT_EQ(status(time_body(not_valid, 0, 0)), Status::kNotReady);
  EXPECT_EQ(status(time_body(0, kNaN, 0.0)), Status::kOutOfRange);
  EXPECT_EQ(status(time_body(0, 2.0, 0.0)), Status::kOutOfRange);
  EXPECT_EQ(status(time_body(0, 0.0, kNaN)), Status::kOutOfRange);
  EXPECT_EQ(status(Bytes(43, 0)), Status::kTooShort);
}

Bytes best_xyz_body() {
  Body body;
  body.u32(0).u32(16).f64(6.9e6).f64(-1.2e6).f64(3.4e5).f32(1.5F).f32(2.5F).f32(3.5F);
  body.u32(0).u32(8).f64(100.0).f64(-7400.0).f64(1500.5).f32(0.1F).f32(0.2F).f32(0.3F);
  body.zeros(4).f32(0.25F).f32(0.0F).f32(0.0F).u8(14).u8(12).u8(12).u8(12).zeros(4);
  return body.bytes;
}

TEST(BestXyz, ReadsEveryField) {
  const Bytes body = best_xyz_body();
  ASSERT_EQ(body.size(), 112U);
  const Result<ReceiverPosition> result = read_best_xyz(log_of(kOemBestXyz, body));
  ASSERT_EQ(result.status(), Status::kOk);
  const ReceiverPosition& p = result.value();
  EXPECT_EQ(p.position_ecef, Vector3(6.9e6, -1.2e6, 3.4e5));
  EXPECT_EQ(p.position_sigma_m, Vector3(1.5, 2.5, 3.5));
  EXPECT_TRUE(p.has_velocity);
  EXPECT_EQ(p.velocity_ecef, Vector3(100.0, -7400.0, 1500.5));
  EXPECT_EQ(p.velocity_sigma_mps, Vector3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(p.velocity_latency_s, 0.25);
  EXPECT_EQ(p.satellites_used, 12);
}

TEST(BestXyz, WithoutVelocityOrPosition) {
  Bytes body = best_xyz_body();
  overwrite(body, 44, Body().u32(1).bytes);
  overwrite(body, 52, Body().f64(kNaN).bytes);
  const Result<ReceiverPosition> result = read_best_xyz(log_of(kOemBestXyz, body));
  ASSERT_EQ(result.status(), Status::kOk);
  EXPECT_FALSE(result.value().has_velocity);
  EXPECT_EQ(result.value().velocity_ecef, Vector3::Zero());
  overwrite(body, 0, Body().u32(1).bytes);  // INSUFFICIENT_OBS
  EXPECT_EQ(read_best_xyz(log_of(kOemBestXyz, body)).status(), Status::kNotReady);
}

TEST(BestXyz, RefusesWhatCannotBe) {
  const auto status_with = [](std::size_t offset, const Bytes& field) {
    Bytes body = best_xyz_body();
    overwrite(body, offset, field);
    return read_best_xyz(log_of(kOemBestXyz, body)).status();
  };
  for (const std::size_t offset : {8, 16, 24, 52, 60, 68}) {
    EXPECT_EQ(status_with(offset, Body().f64(kNaN).bytes), Status::kOutOfRange);
    EXPECT_EQ(status_with(offset, Body().f64(-1e12).bytes), Status::kOutOfRange);
  }
  for (const std::size_t offset : {32, 36, 40, 76, 80, 84, 92}) {
    EXPECT_EQ(status_with(offset, Body().f32(std::numeric_limits<float>::quiet_NaN()).bytes), Status::kOutOfRange);
  }
}

/// NovAtel's binary log of this test, and what its own decoder printed of it.
TEST(BestPosition, IsWhereTheManufacturersDecoderPutsIt) {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/novatel_binary_logs.hex"));
  const auto stream = std::make_unique<OemStream>();
  std::string line;
  bool whole = false;
  while (std::getline(file, line) && line != "# id=42 CONVERSION_BIN_TO_ASC_BESTPOS") {
  }
  std::getline(file, line);
  for (std::size_t k = 0; k + 1 < line.size(); k += 2) {
    whole = stream->push(static_cast<std::uint8_t>(std::stoi(line.substr(k, 2), nullptr, 16)));
  }
  ASSERT_TRUE(whole);
  const Result<ReceiverPosition> result = read_best_position(stream->message());
  ASSERT_EQ(result.status(), Status::kOk);
  const test::AsciiLog log = test::ascii_log("CONVERSION_BIN_TO_ASC_BESTPOS", "BESTPOSA");
  EXPECT_EQ(result.value().receiver_time.ns,
            log.week * kNanosecondsPerWeek + std::llround(log.time_of_week_s * 1000.0) * 1'000'000);

  // The latitude of a point is where the ellipsoid's normal through it meets the equator's plane: no formula of the
  // decoder's. e^2 of WGS 84.
  constexpr double kE2 = 6.69437999014e-3;
  constexpr double kA = 6378137.0;
  const double latitude = std::stod(log.body[2]) * M_PI / 180.0;
  const double longitude = std::stod(log.body[3]) * M_PI / 180.0;
  const double height = std::stod(log.body[4]) + std::stod(log.body[5]);
  const Vector3 p = result.value().position_ecef;
  const Vector3 normal(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                       std::sin(latitude));
  const Vector3 foot = p - height * normal;  // on the ellipsoid x^2 + y^2 + z^2/(1 - e^2) = a^2, where the gradient is
  const Vector3 gradient = Vector3(foot.x(), foot.y(), foot.z() / (1.0 - kE2)).normalized();
  // Eleven decimals of a degree printed (6e-7 m), four of the height.
  EXPECT_LT((gradient - normal).norm() * kA, 2e-6);
  EXPECT_NEAR(std::hypot(foot.x(), foot.y(), foot.z() / std::sqrt(1.0 - kE2)), kA, 1e-4);
}

TEST(BestPosition, RefusesWhatCannotBe) {
  Body good;
  good.u32(0).u32(16).f64(51.0).f64(-114.0).f64(1000.0).f32(-17.0F).u32(61).f32(1.0F).f32(1.0F).f32(2.0F).zeros(20);
  ASSERT_EQ(good.bytes.size(), 72U);
  const auto status_with = [&good](std::size_t offset, const Bytes& field) {
    Bytes body = good.bytes;
    overwrite(body, offset, field);
    return read_best_position(log_of(kOemBestPosition, body)).status();
  };
  EXPECT_EQ(status_with(0, Body().u32(0).bytes), Status::kOk);
  EXPECT_EQ(status_with(0, Body().u32(1).bytes), Status::kNotReady);
  EXPECT_EQ(status_with(8, Body().f64(91.0).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(16, Body().f64(kNaN).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(24, Body().f64(1e300).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(36, Body().u32(63).bytes), Status::kOutOfRange);  // a datum of the user's own
  EXPECT_EQ(status_with(40, Body().f32(-1.0F).bytes), Status::kOutOfRange);
}

}  // namespace
}  // namespace vbar::fsw::gnss
