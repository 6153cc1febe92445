// Datagrams of a template against bytes written by hand, in both byte orders, with every type and its limits.

#include "hil_drivers/grand/wire/template_format.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/wire/calendar.h"
#include "hil_drivers/grand/wire/text_pattern.h"
#include "tests/unit/hil_drivers/grand/generators/wire_test.h"

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

// Patterns write texts as std::format does and read them back.

namespace {

const std::vector<std::string_view> kKnown = {"a", "b"};

TEST(TextPattern, WritesAndReads) {
  const TextPattern pattern("T{a:.3f};{{{b:08.2f}}}\\r\\n", kKnown);
  const std::string text = pattern.format({{"a", 1.0 / 3.0}, {"b", -12.345}});
  EXPECT_EQ(text, "T0.333;{-0012.35}\r\n");
  const NamedValues values = pattern.parse(text);
  EXPECT_EQ(values.at("a"), 0.333);
  EXPECT_EQ(values.at("b"), -12.35);
}

TEST(TextPattern, WithoutAFormatNumbersReadBackExactly) {
  const TextPattern pattern("{a},{b}", kKnown);
  for (const double value : {1.0 / 3.0, 6378137.123456789, -5e-324, 1e300}) {
    const NamedValues values = pattern.parse(pattern.format({{"a", value}, {"b", -value}}));
    EXPECT_EQ(values.at("a"), value);
    EXPECT_EQ(values.at("b"), -value);
  }
}

TEST(TextPattern, IntegersAreRounded) {
  EXPECT_EQ(TextPattern("{a:d} {b:04d}", kKnown).format({{"a", 2.6}, {"b", 7.0}}), "3 0007");
  EXPECT_THAT(error_of([] {
                static_cast<void>(TextPattern("{a:d}", kKnown).format({{"a", 1e18}}));
              }),
              HasSubstr("too large"));
}

TEST(TextPattern, BadPatternsAreRefusedWithTheirPosition) {
  const auto error = [](std::string_view pattern) { return error_of([&] { TextPattern(pattern, kKnown); }); };
  EXPECT_EQ(error("x{c}"), "pattern \"x{c}\", character 2: unknown name \"c\"; known are a, b");
  EXPECT_THAT(error("x{a"), HasSubstr("character 2: '{' without '}'"));
  EXPECT_THAT(error("x}"), HasSubstr("character 2: '}' without '{'"));
  EXPECT_THAT(error("{a:s}"), HasSubstr("format \"s\""));
  EXPECT_THAT(error("{a:{}}"), HasSubstr("format \"{\""));
  EXPECT_THAT(error("{a:9999f}"), HasSubstr("format"));
  EXPECT_THAT(error("{a:.2d}"), HasSubstr("no precision"));
  EXPECT_THAT(error("{a}{b}"), HasSubstr("no text between \"a\" and \"b\""));
  EXPECT_THAT(error("\\q"), HasSubstr("after a backslash"));
  EXPECT_THAT(error("\\"), HasSubstr("after a backslash"));
}

TEST(TextPattern, TextsOfAnotherFormAreRefusedWithTheirPosition) {
  const TextPattern pattern("T{a},{b}!", kKnown);
  const auto error = [&](std::string_view text) { return error_of([&] { static_cast<void>(pattern.parse(text)); }); };
  EXPECT_EQ(error("T1;2!"), "text \"T1;2!\", character 3: \",\" is expected");
  EXPECT_THAT(error("T1,x!"), HasSubstr("character 4: a finite number is expected (b)"));
  EXPECT_THAT(error("T1,2!!"), HasSubstr("longer than expected"));
  EXPECT_THAT(error("Tnan,2!"), HasSubstr("finite"));
  EXPECT_THAT(error("Tinf,2!"), HasSubstr("finite"));
  EXPECT_THAT(error(""), HasSubstr("\"T\" is expected"));
  EXPECT_FALSE(pattern.matches("T1"));
  EXPECT_TRUE(pattern.matches("T 1,+2!"));
  EXPECT_FALSE(pattern.matches("T+-1,2!"));
}

TEST(TextPattern, ValuesThatAreMissingOrNotFiniteAreNotWritten) {
  const TextPattern pattern("{a}", kKnown);
  EXPECT_NE(error_of([&] { static_cast<void>(pattern.format({})); }), "");
  EXPECT_NE(error_of([&] { static_cast<void>(pattern.format({{"a", std::nan("")}})); }), "");
}

}  // namespace

// Dates of GPS time against weeks and seconds of known instants.

namespace {

fsw::GpsTime week(std::int64_t number, std::int64_t seconds) {
  return fsw::GpsTime{} + fsw::duration_of_seconds(number * 604800 + seconds);
}

// IS-GPS-200: week 0 begins on 1980-01-06, week 1024 on 1999-08-22, week 2048 on 2019-04-07.
TEST(Calendar, BeginsOfWeeks) {
  EXPECT_EQ(calendar_of(week(0, 0)), (Calendar{1980, 1, 6, 0, 0, 0}));
  EXPECT_EQ(calendar_of(week(1024, 0)), (Calendar{1999, 8, 22, 0, 0, 0}));
  EXPECT_EQ(calendar_of(week(2048, 0)), (Calendar{2019, 4, 7, 0, 0, 0}));
  // A Tuesday, in week 1645.
  EXPECT_EQ(calendar_of(week(1645, 2 * 86400 + 57600) + fsw::Duration{999'999'999}), (Calendar{2011, 7, 19, 16, 0, 0}));
}

TEST(Calendar, ReadsBack) {
  for (const fsw::GpsTime time : {week(0, 0), week(1642, 345599), week(2100, 86400)})
    EXPECT_EQ(time_of(calendar_of(time)), time);
}

TEST(Calendar, DatesThatDoNotExistAreRefused) {
  for (const Calendar& date :
       {Calendar{2011, 2, 29, 0, 0, 0}, Calendar{1980, 1, 5, 0, 0, 0}, Calendar{2200, 1, 1, 0, 0, 0},
        Calendar{2011, 13, 1, 0, 0, 0}, Calendar{2011, 1, 1, 24, 0, 0}, Calendar{2011, 1, 1, 0, 60, 0},
        Calendar{2011, 1, 1, 0, 0, 60}})
    EXPECT_NE(error_of([&] { time_of(date); }), "") << text_of(date);
}

}  // namespace

}  // namespace vbar::grand::wire::test
