// Skydel's control frames against bytes written out from the table.

#include "hil_drivers/grand/wire/skydel_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/wire/wire_test.h"

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
      R"({"CmdName":"HilPortResult","CmdUuid":"{7}","Port":4821,"RelatedCommand":"{\"CmdName\":\"G\",\"CmdUuid\":\"{7}\"}"})";
  const Bytes bytes = encode_result(skydel_result("HilPortResult", skydel_command("G", "{7}"), {{"Port", 4821}}));
  const auto length = static_cast<std::uint8_t>(json.size() + 1);
  EXPECT_EQ(bytes, Bytes({static_cast<std::uint8_t>(length + 5), 0, 1, length, 0, 0, 0}) + text(json) + hex("00"));
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
    EXPECT_EQ(text_field(found[2].json, "CmdUuid"), "{1}");
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
}  // namespace vbar::grand::wire::test
