// Datagrams of a template against bytes written by hand, in both byte orders, with every type and its limits.

#include "hil_drivers/grand/wire/template_format.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/wire/wire_test.h"

namespace vbar::grand::wire::test {
namespace {

using fsw::Vector3;
using testing::HasSubstr;

/// Time, vehicle and position, and what a test adds.
TemplateFormat format_with(std::vector<TemplateField> more) {
  TemplateFormat format;
  format.start_lines = {"GO"};
  format.fields = {{"time_ms", 0.0, FieldType::kU32, 1.0},
                   {"vehicle", 0.0, FieldType::kU8, 1.0},
                   {"position_ecef_x", 0.0, FieldType::kI32, 1e3},
                   {"position_ecef_y", 0.0, FieldType::kF32, 1.0},
                   {"position_ecef_z", 0.0, FieldType::kF64, 1.0}};
  for (TemplateField& field : more) format.fields.push_back(std::move(field));
  return format;
}

TrajectorySample sample() {
  TrajectorySample s;
  s.time = fsw::Duration{1'500'000'000};
  s.position_ecef_m = {-1.25, 1.5, 2.0};
  s.yaw_pitch_roll = {1.0, 2.0, 3.0};
  return s;
}

// 1500 = 05dc; vehicle 2; -1250 = fffffb1e; 1.5f = 3fc00000; 2.0 = 4000000000000000; constant 0x1234.
TEST(TemplateFormat, BothByteOrders) {
  TemplateFormat format = format_with({{"", 0x1234, FieldType::kU16, 1.0}});
  const Bytes little = hex("dc 05 00 00  02  1e fb ff ff  00 00 c0 3f  00 00 00 00 00 00 00 40  34 12");
  EXPECT_EQ(TemplateCodec(format).encode(1, sample()), little);
  format.byte_order = ByteOrder::kMsbFirst;
  const Bytes big = hex("00 00 05 dc  02  ff ff fb 1e  3f c0 00 00  40 00 00 00 00 00 00 00  12 34");
  const TemplateCodec codec(format);
  EXPECT_EQ(codec.encode(1, sample()), big);
  const auto received = codec.decode(big);
  EXPECT_EQ(received.vehicle, 1U);
  EXPECT_EQ(received.sample.time, sample().time);
  EXPECT_EQ(received.sample.position_ecef_m, sample().position_ecef_m);
  EXPECT_EQ(received.sample.yaw_pitch_roll, Vector3(0, 0, 0));  // not carried
}

TEST(TemplateFormat, EveryTypeHoldsItsLimitsAndRefusesTheNextNumber) {
  struct Limit {
    FieldType type;
    double low, high;
  };
  const Limit limits[] = {{FieldType::kU8, 0, 255},           {FieldType::kI8, -128, 127},
                          {FieldType::kU16, 0, 65535},        {FieldType::kI16, -32768, 32767},
                          {FieldType::kU32, 0, 4294967295.0}, {FieldType::kI32, -2147483648.0, 2147483647.0}};
  for (const Limit& limit : limits) {
    const TemplateCodec codec(format_with({{"yaw", 0.0, limit.type, 1.0}}));
    TrajectorySample s = sample();
    for (const double value : {limit.low, limit.high}) {
      s.yaw_pitch_roll.x() = value;
      EXPECT_EQ(codec.decode(codec.encode(0, s)).sample.yaw_pitch_roll.x(), value);
    }
    for (const double value : {limit.low - 1.0, limit.high + 1.0}) {
      s.yaw_pitch_roll.x() = value;
      EXPECT_THAT(error_of([&] { static_cast<void>(codec.encode(0, s)); }), HasSubstr("field 6 (yaw): ")) << value;
    }
  }
  // 2^63 does not fit into i64, the number of f64 below it does; 2^64 likewise into u64.
  for (const auto& [type, limit] :
       {std::pair(FieldType::kI64, std::ldexp(1.0, 63)), std::pair(FieldType::kU64, std::ldexp(1.0, 64))}) {
    const TemplateCodec codec(format_with({{"yaw", 0.0, type, 1.0}}));
    TrajectorySample s = sample();
    s.yaw_pitch_roll.x() = std::nextafter(limit, 0.0);
    EXPECT_EQ(codec.decode(codec.encode(0, s)).sample.yaw_pitch_roll.x(), std::nextafter(limit, 0.0));
    s.yaw_pitch_roll.x() = limit;
    EXPECT_NE(error_of([&] { static_cast<void>(codec.encode(0, s)); }), "");
  }
}

TEST(TemplateFormat, AFormatThatCannotFlyIsRefused) {
  const auto error = [](const std::function<void(TemplateFormat&)>& change) {
    TemplateFormat format = format_with({});
    change(format);
    return error_of([&] { TemplateCodec codec(format); });
  };
  EXPECT_EQ(error([](TemplateFormat&) {}), "");
  EXPECT_THAT(error([](TemplateFormat& f) { f.fields[0].value = "clock"; }),
              HasSubstr("field 1 (clock): unknown value; known are vehicle, time_s, time_ms, position_ecef_x"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.fields.erase(f.fields.begin()); }), HasSubstr("no time_s or time_ms"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.fields.erase(f.fields.begin() + 1); }), HasSubstr("no vehicle"));
  EXPECT_EQ(error([](TemplateFormat& f) {
              f.fields.erase(f.fields.begin() + 1);
              f.vehicle_by = VehicleBy::kPort;
            }),
            "");
  EXPECT_THAT(error([](TemplateFormat& f) { f.fields.pop_back(); }), HasSubstr("no position_ecef_z"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.text = "{time_s}"; }), HasSubstr("either fields or a text"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.fields.clear(); }), HasSubstr("0 fields"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.fields[2].scale = std::nan(""); }), HasSubstr("scale"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.start_lines.clear(); }), HasSubstr("no start_lines"));
  EXPECT_THAT(error([](TemplateFormat& f) { f.start_lines = {"{tomorrow}"}; }), HasSubstr("unknown name"));
  EXPECT_THAT(error([](TemplateFormat& f) {
                f.progress_line = "?";
                f.progress_answer = "{vehicle}";
              }),
              HasSubstr("no {time_s}"));
}

TEST(TemplateFormat, MalformedDatagramsAreRefused) {
  const TemplateCodec codec(format_with({{"", 7, FieldType::kU8, 1.0}}));
  const Bytes good = codec.encode(0, sample());
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_NE(error_of([&] { static_cast<void>(codec.decode(std::span(good).first(size))); }), "") << size;
  EXPECT_NE(error_of([&] { static_cast<void>(codec.decode(good + hex("00"))); }), "");
  Bytes bytes = good;
  bytes.back() = 8;
  EXPECT_THAT(error_of([&] { static_cast<void>(codec.decode(bytes)); }), HasSubstr("field 6 (constant) is 8, not 7"));
  bytes = good;
  bytes[4] = 0;
  EXPECT_THAT(error_of([&] { static_cast<void>(codec.decode(bytes)); }), HasSubstr("vehicle 0 is not from 1"));
  bytes = good;
  bytes[12] = 0x7f;  // NaN as f32
  bytes[11] = 0xc0;
  EXPECT_THAT(error_of([&] { static_cast<void>(codec.decode(bytes)); }), HasSubstr("field 4 (position_ecef_y) is not"));
}

TEST(TemplateFormat, ATextDatagram) {
  TemplateFormat format;
  format.start_lines = {"GO"};
  format.text = "{vehicle:d} {time_s:.1f} {position_ecef_x:.2f} {position_ecef_y:.2f} {position_ecef_z:.2f}\\n";
  const TemplateCodec codec(format);
  const Bytes bytes = codec.encode(0, sample());
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "1 1.5 -1.25 1.50 2.00\n");
  const auto received = codec.decode(bytes);
  EXPECT_EQ(received.vehicle, 0U);
  EXPECT_EQ(received.sample.position_ecef_m, sample().position_ecef_m);
  EXPECT_NE(error_of([&] { static_cast<void>(codec.decode(hex("31 20"))); }), "");
}

// IS-GPS-200: 1999-08-22 begins week 1024.
TEST(TemplateFormat, AStartTimeByDateOrByWeek) {
  const fsw::GpsTime start = fsw::GpsTime{} + fsw::duration_of_seconds(std::int64_t{1024} * 604800 + 3661);
  const NamedValues values = control_values_of(start, 2);
  for (const auto& [name, value] : NamedValues{{"year", 1999},
                                               {"month", 8},
                                               {"day", 22},
                                               {"hour", 1},
                                               {"minute", 1},
                                               {"second", 1},
                                               {"gps_week", 1024},
                                               {"gps_tow_s", 3661},
                                               {"vehicles", 2}})
    EXPECT_EQ(values.at(name), value) << name;
  EXPECT_EQ(start_time_of(values), start);
  EXPECT_EQ(start_time_of({{"gps_week", 1024.0}, {"gps_tow_s", 3661.0}}), start);
  EXPECT_EQ(start_time_of({{"vehicle", 1.0}}), std::nullopt);
  EXPECT_NE(error_of([] { static_cast<void>(start_time_of({{"gps_week", 1024.0}})); }), "");
  EXPECT_NE(error_of([] { static_cast<void>(start_time_of({{"gps_week", 1e9}, {"gps_tow_s", 0.0}})); }), "");
  EXPECT_NE(error_of([] { static_cast<void>(start_time_of({{"gps_week", 0.5}, {"gps_tow_s", 0.0}})); }), "");
}

}  // namespace
}  // namespace vbar::grand::wire::test
