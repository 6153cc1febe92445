// Skydel's control frames against bytes written out from the table.

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/wire/skydel.h"
#include "tests/unit/hil_drivers/grand/generators/wire_test.h"

namespace vbar::grand::wire::test {

namespace {

using testing::HasSubstr;

Bytes text(std::string_view characters) {
  return {characters.begin(), characters.end()};
}

// 2011-07-19 16:00:00 GPS: 11517 days after 1980-01-06, 57600 s.
constexpr fsw::GpsTime kTime{(std::int64_t{11517} * 86400 + 57600) * fsw::kNanosecondsPerSecond};

TEST(SkydelControl, TheVersionIs49) {
  EXPECT_EQ(encode_api_version(kSkydelApiVersion), hex("05 00 02 31 00 00 00"));
}

TEST(SkydelControl, ACommandIsAFrameOfJsonWithANul) {
  const std::string json = R"({"CmdName":"Stop","CmdUuid":"{7}"})";  // 34 characters
  EXPECT_EQ(encode_command(skydel_command("Stop", "{7}")), hex("24 00 00") + text(json) + hex("00"));
}

TEST(SkydelControl, AResultHasItsLengthInsideTheFrame) {
  const std::string json =
      R"({"CmdName":"HilPortResult","CmdUuid":"{8}","Port":4821,"RelatedCommand":"{\"CmdName\":\"G\",\"CmdUuid\":\"{7}\"}"})";
  Json result = skydel_result("HilPortResult", skydel_command("G", "{7}"), {{"Port", 4821}});
  result["CmdUuid"] = "{8}";
  const Bytes bytes = encode_result(result);
  const auto length = static_cast<std::uint8_t>(json.size() + 1);
  EXPECT_EQ(bytes, Bytes({static_cast<std::uint8_t>(length + 5), 0, 1, length, 0, 0, 0}) + text(json) + hex("00"));
}

// CommandResult of the published clients: a uuid of its own, that of the command inside RelatedCommand.
TEST(SkydelControl, AResultBelongsToTheCommandInsideIt) {
  const Json command = skydel_command("GetHilPort", "{7}");
  const Json one = skydel_result("HilPortResult", command), other = skydel_failure(command, "busy");
  EXPECT_EQ(related_uuid(one), "{7}");
  EXPECT_NE(text_field(one, "CmdUuid"), "{7}");
  EXPECT_NE(text_field(one, "CmdUuid"), text_field(other, "CmdUuid"));
  EXPECT_EQ(name_of(other), "FailureResult");
  EXPECT_EQ(text_field(other, "ErrorMsg"), "busy");
  EXPECT_THROW(static_cast<void>(related_uuid(command)), WireError);
  EXPECT_THROW(static_cast<void>(related_uuid(skydel_command("R", "{1}", {{"RelatedCommand", "GetHilPort"}}))),
               WireError);
}

TEST(SkydelControl, AStreamIsCutIntoFramesWhereverItIsSplit) {
  const Bytes stream = encode_api_version(3) + encode_command(skydel_command("New", "{1}")) +
                       encode_result(skydel_result("SuccessResult", skydel_command("New", "{1}")));
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    SkydelFrames frames;
    std::vector<SkydelFrame> found;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      frames.append(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      while (auto frame = frames.next()) found.push_back(*frame);
    }
    ASSERT_EQ(found.size(), 3U) << piece;
    EXPECT_EQ(found[0].api_version, 3U);
    EXPECT_EQ(name_of(found[1].json), "New");
    EXPECT_EQ(found[2].kind, SkydelFrameKind::kResult);
    EXPECT_EQ(related_uuid(found[2].json), "{1}");
  }
}

std::string error_in(const Bytes& stream) {
  return error_of([&] {
    SkydelFrames frames;
    frames.append(stream);
    while (frames.next()) {
    }
  });
}

TEST(SkydelControl, MalformedFramesAreRefusedWithTheirPosition) {
  const Bytes good = encode_api_version(49);
  EXPECT_EQ(error_in(good + hex("01 00 07")),
            "Skydel frame at byte 7 of the connection: kind 7 is unknown; known are 0, "
            "1 and 2");
  EXPECT_THAT(error_in(hex("00 00")), HasSubstr("kind needs 1 bytes, 0 are left"));
  EXPECT_THAT(error_in(hex("04 00 02 31 00 00")), HasSubstr("API version needs 4 bytes, 3 are left"));
  EXPECT_THAT(error_in(hex("06 00 02 31 00 00 00 00")), HasSubstr("1 bytes too many"));
  EXPECT_THAT(error_in(hex("03 00 00 7b 00")), HasSubstr("not JSON at byte 2 of 1"));
  EXPECT_THAT(error_in(hex("04 00 00 5b 5d 00")), HasSubstr("not an object"));
  EXPECT_THAT(error_in(hex("08 00 01 ff ff ff ff 7b 7d 00")), HasSubstr("length of the result is -1, 3 bytes follow"));
}

TEST(SkydelControl, AFrameThatIsTooLongIsNotSent) {
  EXPECT_THAT(error_of([] { encode_command(skydel_command(std::string(70000, 'x'), "{}")); }),
              HasSubstr("do not fit into a frame of 65535"));
}

TEST(SkydelControl, FieldsOfTheWrongTypeAreRefusedWithTheirName) {
  const Json json = skydel_command("Set", "{1}", {{"B", 1}, {"I", 2.5}, {"T", true}, {"N", "x"}, {"Big", ~0ULL}});
  EXPECT_EQ(error_of([&] { bool_field(json, "B"); }), "Set: field B is 1; true or false is expected");
  EXPECT_EQ(error_of([&] { integer_field(json, "I", 0, 9); }),
            "Set: field I is 2.5; an integer from 0 to 9 is expected");
  EXPECT_EQ(error_of([&] { integer_field(json, "B", 2, 9); }), "Set: field B is 1; an integer from 2 to 9 is expected");
  EXPECT_THAT(error_of([&] { integer_field(json, "Big", 0, INT64_MAX); }),
              HasSubstr("field Big is 18446744073709551615"));
  EXPECT_EQ(error_of([&] { text_field(json, "T"); }), "Set: field T is true; a text is expected");
  EXPECT_EQ(error_of([&] { number_field(json, "N"); }), "Set: field N is \"x\"; a finite number is expected");
  EXPECT_EQ(error_of([&] { number_field(json, "M"); }), "Set: field M is missing; a number is expected");
  EXPECT_NE(error_of([&] { name_of(Json::object()); }), "");
}

TEST(SkydelControl, TheDateIsThatOfGpsTime) {
  const Json expected = {{"Spec", "UTC"}, {"Year", 2011}, {"Month", 7}, {"Day", 19},
                         {"Hour", 16},    {"Minute", 0},  {"Second", 0}};
  EXPECT_EQ(skydel_date(kTime), expected);
  EXPECT_EQ(skydel_date_field(skydel_command("S", "{1}", {{"Start", expected}}), "Start"), kTime);
  Json bad = expected;
  bad["Day"] = 31;
  bad["Month"] = 6;
  EXPECT_THAT(error_of([&] {
                skydel_date_field(skydel_command("S", "{1}", {{"Start", bad}}), "Start");
              }),
              HasSubstr("2011-06-31 16:00:00 is not a date"));
  bad.erase("Hour");
  EXPECT_THAT(error_of([&] {
                skydel_date_field(skydel_command("S", "{1}", {{"Start", bad}}), "Start");
              }),
              HasSubstr("S, Start: field Hour is missing"));
}

}  // namespace

// Skydel's datagrams against bytes written out from the table: little-endian, packed; Hello 1, Bye 1, VehicleInfo 81,
// 05 37, 06 61, 07 62/86/110, 08 110/158/206 bytes.

namespace {

using fsw::Vector3;

// IEEE 754: 1 = 3ff0..., 2 = 4000..., 3 = 4008..., 4 = 4010..., 5 = 4014..., 6 = 4018..., 0.5 = 3fe0..., -1 = bff0...
const char* const kOne = "00 00 00 00 00 00 f0 3f";
const char* const kTwo = "00 00 00 00 00 00 00 40";
const char* const kThree = "00 00 00 00 00 00 08 40";
const char* const kFour = "00 00 00 00 00 00 10 40";
const char* const kFive = "00 00 00 00 00 00 14 40";
const char* const kSix = "00 00 00 00 00 00 18 40";
const char* const kHalf = "00 00 00 00 00 00 e0 3f";
const char* const kMinusOne = "00 00 00 00 00 00 f0 bf";
const char* const kZero = "00 00 00 00 00 00 00 00";
const char* const k1500 = "00 00 00 00 00 70 97 40";  // 1500 = 0x4097700000000000
const char* const kNoName = "00 00 00 00";

Bytes joined(std::initializer_list<const char*> parts) {
  Bytes bytes;
  for (const char* part : parts) bytes = bytes + hex(part);
  return bytes;
}

TrajectorySample sample() {
  TrajectorySample s;
  s.time = fsw::Duration{1'500'000'000};
  s.position_ecef_m = {1, 2, 3};
  s.yaw_pitch_roll = {4, 5, 6};
  s.velocity_ecef_mps = {0.5, -1, 0};
  s.angular_rate = {1, 2, 3};
  s.acceleration_ecef_mps2 = {4, 4, 5};
  s.angular_acceleration = {6, 5, 4};
  s.jerk_ecef_mps3 = {0.5, 0.5, -1};
  return s;
}

/// 08, order 2: the angular vectors come as yaw, pitch, roll, that is about z, y, x.
Bytes sample_bytes() {
  return joined({"08 02", k1500,                                     //
                 kOne,    kTwo,      kThree,    kFour, kFive, kSix,  // position, attitude
                 kHalf,   kMinusOne, kZero,                          // velocity
                 kThree,  kTwo,      kOne,                           // angular velocity
                 kFour,   kFour,     kFive,                          // acceleration
                 kFour,   kFive,     kSix,                           // angular acceleration
                 kHalf,   kHalf,     kMinusOne,                      // jerk
                 kZero,   kZero,     kZero,                          // angular jerk
                 kNoName});
}

TEST(SkydelHil, TheSampleOfTheDriverIsThatOfTheTable) {
  EXPECT_EQ(encode_sample(sample()), sample_bytes());
  EXPECT_EQ(sample_bytes().size(), 206U);
  EXPECT_EQ(encode_hello(), hex("01"));
  EXPECT_EQ(encode_bye(), hex("02"));
}

TEST(SkydelHil, TheSampleReadsBack) {
  const auto message = std::get<SkydelSample>(decode_hil(sample_bytes()));
  EXPECT_EQ(message.derivatives, 3);
  EXPECT_TRUE(message.has_attitude);
  EXPECT_TRUE(message.name.empty());
  const TrajectorySample s = sample();
  EXPECT_EQ(message.sample.time, s.time);
  EXPECT_EQ(message.sample.position_ecef_m, s.position_ecef_m);
  EXPECT_EQ(message.sample.yaw_pitch_roll, s.yaw_pitch_roll);
  EXPECT_EQ(message.sample.velocity_ecef_mps, s.velocity_ecef_mps);
  EXPECT_EQ(message.sample.angular_rate, s.angular_rate);
  EXPECT_EQ(message.sample.acceleration_ecef_mps2, s.acceleration_ecef_mps2);
  EXPECT_EQ(message.sample.angular_acceleration, s.angular_acceleration);
  EXPECT_EQ(message.sample.jerk_ecef_mps3, s.jerk_ecef_mps3);
}

TEST(SkydelHil, EveryOtherFormHasItsSize) {
  const Bytes position = joined({kOne, kTwo, kThree});
  const Bytes end = hex(kNoName);
  struct Form {
    Bytes bytes;
    std::size_t size;
    int derivatives;
    bool has_attitude;
  };
  const Form forms[] = {
      {hex("05") + hex(k1500) + position + end, 37, 0, false},
      {hex("06") + hex(k1500) + position + position + end, 61, 0, true},
      {hex("07 00") + hex(k1500) + position + position + end, 62, 1, false},
      {hex("07 01") + hex(k1500) + position + position + position + end, 86, 2, false},
      {hex("07 02") + hex(k1500) + position + position + position + position + end, 110, 3, false},
      {hex("08 00") + hex(k1500) + position + position + position + position + end, 110, 1, true},
      {hex("08 01") + hex(k1500) + position + position + position + position + position + position + end, 158, 2, true},
  };
  for (const Form& form : forms) {
    ASSERT_EQ(form.bytes.size(), form.size);
    const auto message = std::get<SkydelSample>(decode_hil(form.bytes));
    EXPECT_EQ(message.derivatives, form.derivatives);
    EXPECT_EQ(message.has_attitude, form.has_attitude);
    EXPECT_EQ(message.sample.time, fsw::Duration{1'500'000'000});
    EXPECT_EQ(message.sample.position_ecef_m, Vector3(1, 2, 3));
    EXPECT_EQ(message.sample.velocity_ecef_mps, form.derivatives > 0 ? Vector3(1, 2, 3) : Vector3(0, 0, 0));
  }
}

TEST(SkydelHil, AJammerHasAName) {
  const Bytes bytes = hex("05") + hex(k1500) + joined({kOne, kTwo, kThree}) + hex("03 00 00 00 6a 61 6d");
  EXPECT_EQ(std::get<SkydelSample>(decode_hil(bytes)).name, "jam");
}

TEST(SkydelHil, VehicleInformationIsThatOfTheTable) {
  const Bytes bytes =
      joined({"03", "dc 05 00 00 00 00 00 00", kOne, kTwo, kThree, kFour, kFive, kSix, kHalf, kMinusOne, kTwo});
  EXPECT_EQ(bytes.size(), 81U);
  const SkydelVehicleInfo info{1500, {1, 2, 3}, {4, 5, 6}, 0.5, -1.0, 2.0};
  EXPECT_EQ(encode_vehicle_info(info), bytes);
  const auto decoded = std::get<SkydelVehicleInfo>(decode_hil(bytes));
  EXPECT_EQ(decoded.time_ms, 1500U);
  EXPECT_EQ(decoded.position_ecef_m, Vector3(1, 2, 3));
  EXPECT_EQ(decoded.yaw_pitch_roll, Vector3(4, 5, 6));
  EXPECT_EQ(decoded.speed_mps, 0.5);
  EXPECT_EQ(decoded.heading, -1.0);
  EXPECT_EQ(decoded.odometer_m, 2.0);
}

TEST(SkydelHil, EveryPrefixAndEveryLongerDatagramIsRefused) {
  const Bytes whole = sample_bytes();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(error_of([&] { decode_hil(std::span(whole).first(size)); }), "") << size;
  EXPECT_THAT(error_of([&] { decode_hil(whole + hex("00")); }),
              HasSubstr("byte 206: the message has 1 bytes too many"));
  EXPECT_THAT(error_of([&] { decode_hil(hex("01 00")); }), HasSubstr("1 bytes too many"));
}

TEST(SkydelHil, NumbersThatAreNotFiniteAreRefusedInEveryPlace) {
  const Bytes whole = sample_bytes();
  for (const char* bad : {"00 00 00 00 00 00 f8 7f", "00 00 00 00 00 00 f0 7f", "00 00 00 00 00 00 f0 ff"}) {
    for (std::size_t place = 2; place + 8 <= 202; place += 8) {
      Bytes bytes = whole;
      const Bytes number = hex(bad);
      std::copy(number.begin(), number.end(), bytes.begin() + static_cast<std::ptrdiff_t>(place));
      EXPECT_THAT(error_of([&] { decode_hil(bytes); }), HasSubstr("byte " + std::to_string(place) + ":")) << place;
    }
  }
}

TEST(SkydelHil, UnknownIdsOrdersTimesAndNamesAreRefused) {
  EXPECT_THAT(error_of([] { decode_hil(hex("04")); }), HasSubstr("id 4 is unknown"));
  Bytes bytes = sample_bytes();
  bytes[1] = 3;
  EXPECT_THAT(error_of([&] { decode_hil(bytes); }), HasSubstr("order is 3; known are 0, 1 and 2"));
  const Bytes end = joined({kOne, kTwo, kThree, kNoName});
  EXPECT_THAT(error_of([&] { decode_hil(hex("05") + hex(kMinusOne) + end); }), HasSubstr("time of -1 ms"));
  EXPECT_THAT(error_of([&] { decode_hil(hex("05 00 00 00 00 00 00 00 43") + end); }), HasSubstr("100 days"));
  EXPECT_THAT(error_of([&] {
                decode_hil(hex("05") + hex(k1500) + joined({kOne, kTwo, kThree}) + hex("ff ff ff ff"));
              }),
              HasSubstr("name needs 4294967295 bytes, 0 are left"));
}

TEST(SkydelHil, ASampleThatIsNotFiniteIsNotSent) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TrajectorySample s = sample();
    s.jerk_ecef_mps3.z() = bad;
    EXPECT_EQ(error_of([&] { encode_sample(s); }), "Skydel sample: jerk is not finite");
  }
  TrajectorySample s = sample();
  s.time.ns = -1;
  EXPECT_THAT(error_of([&] { encode_sample(s); }), HasSubstr("time"));
}

}  // namespace

}  // namespace vbar::grand::wire::test
