// Blocks of the object stream, byte by byte as Tracker's manual gives them, and what must not be read.

#include "hil_drivers/tron/protocols/vicon_stream.h"

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/core/types.h"
#include "hil_drivers/tron/protocols/vicon_receiver.h"

namespace vbar::tron::vicon {

namespace {

using ::testing::HasSubstr;

ObjectBlock two_objects() {
  return {0x01020304,
          {{"camera", {1.0, -2.0, 3.0}, {0.1, 0.2, -0.3}}, {"target", {-1000.5, 0.0, 2.0}, {3.1, -1.5, 0.0}}}};
}

std::string refusal_of(ByteSpan datagram) {
  try {
    (void)decode_block(datagram);
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
  return "accepted";
}

// Offsets of the protocol: header of 5, item header of 3, 24 for the name, six doubles.
TEST(ObjectStream, HasTheBytesOfTheProtocol) {
  const Bytes block = encode_frame(two_objects(), 0).at(0);
  ASSERT_EQ(block.size(), 5U + 2U * 75U);
  EXPECT_EQ(Bytes(block.begin(), block.begin() + 8), (Bytes{4, 3, 2, 1, 2, 0, 72, 0}));
  EXPECT_EQ(std::string(block.begin() + 8, block.begin() + 14), "camera");
  for (std::size_t k = 14; k < 32; ++k) EXPECT_EQ(block[k], 0);
  // 1.0 and -2.0 in IEEE 754, little-endian.
  EXPECT_EQ(Bytes(block.begin() + 32, block.begin() + 40), (Bytes{0, 0, 0, 0, 0, 0, 0xF0, 0x3F}));
  EXPECT_EQ(Bytes(block.begin() + 40, block.begin() + 48), (Bytes{0, 0, 0, 0, 0, 0, 0, 0xC0}));
  EXPECT_EQ(std::string(block.begin() + 83, block.begin() + 89), "target");
}

TEST(ObjectStream, IsReadAsItWasWrittenInBlocksOfEverySize) {
  for (const std::size_t bytes : kBlockBytes) {
    const auto blocks = encode_frame(two_objects(), bytes);
    ASSERT_EQ(blocks.size(), 1U);
    EXPECT_EQ(blocks[0].size(), bytes == 0 ? 155U : bytes);
    const ObjectBlock read = decode_block(blocks[0]);
    EXPECT_EQ(read.frame, 0x01020304U);
    ASSERT_EQ(read.objects.size(), 2U);
    for (const TrackedObject& object : two_objects().objects) {
      ASSERT_NE(read.find(object.name), nullptr);
      EXPECT_TRUE(read.find(object.name)->has_same_numbers(object));
    }
    EXPECT_EQ(read.find("other"), nullptr);
  }
}

// 256 bytes hold three objects: (256 - 5)/75.
TEST(ObjectStream, PutsObjectsThatDoNotFitIntoFurtherBlocks) {
  ObjectBlock frame{7, {}};
  for (int k = 0; k < 8; ++k) frame.objects.push_back({"object " + std::to_string(k)});
  const auto blocks = encode_frame(frame, 256);
  ASSERT_EQ(blocks.size(), 3U);
  std::size_t next = 0;
  for (const Bytes& bytes : blocks) {
    EXPECT_EQ(bytes.size(), 256U);
    const ObjectBlock block = decode_block(bytes);
    EXPECT_EQ(block.frame, 7U);
    for (const auto& object : block.objects) EXPECT_EQ(object.name, frame.objects[next++].name);
  }
  EXPECT_EQ(next, 8U);
}

TEST(ObjectStream, ReadsANameOf24BytesWithoutNul) {
  const std::string name(24, 'n');
  EXPECT_EQ(decode_block(encode_frame({1, {{name}}}, 256)[0]).objects.at(0).name, name);
}

TEST(ObjectStream, ReadsNegativeZeroAsOccluded) {
  TrackedObject object{"camera"};
  EXPECT_TRUE(object.is_occluded());
  object.translation_mm[1] = -0.0;
  EXPECT_TRUE(object.is_occluded());
  EXPECT_FALSE(object.has_same_numbers({"camera"}));
  object.rotation_rad[2] = std::numeric_limits<double>::denorm_min();
  EXPECT_FALSE(object.is_occluded());
}

TEST(ObjectStream, SkipsItemsOfOtherKinds) {
  Bytes block{1, 0, 0, 0, 2, 9, 3, 0, 0xAA, 0xBB, 0xCC};
  const Bytes object = encode_frame({1, {{"camera"}}}, 0)[0];
  block.insert(block.end(), object.begin() + 5, object.end());
  ASSERT_EQ(decode_block(block).objects.size(), 1U);
  EXPECT_EQ(decode_block(block).objects[0].name, "camera");
}

TEST(ObjectStream, DoesNotReadThePadding) {
  Bytes block = encode_frame(two_objects(), 256)[0];
  for (std::size_t k = 155; k < 256; ++k) block[k] = 0xFF;
  EXPECT_EQ(decode_block(block).objects.size(), 2U);
}

TEST(ObjectStream, RefusesEveryBlockThatEndsEarly) {
  const Bytes block = encode_frame(two_objects(), 0)[0];
  for (std::size_t size = 0; size < block.size(); ++size)
    EXPECT_THAT(refusal_of(ByteSpan(block).first(size)), HasSubstr("Vicon block, byte ")) << size;
}

TEST(ObjectStream, NamesThePlaceOfWhatItRefuses) {
  const Bytes good = encode_frame(two_objects(), 0)[0];
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    Bytes block = good;
    block[at] = value;
    return block;
  };
  EXPECT_THAT(refusal_of(changed(6, 73)), HasSubstr("byte 6: an object of 73 bytes instead of 72"));
  EXPECT_THAT(refusal_of(changed(4, 3)), HasSubstr("byte 155: the block ends before item 3"));
  EXPECT_THAT(refusal_of(changed(8, 0)), HasSubstr("byte 8: an object without a name"));
  EXPECT_THAT(refusal_of(changed(9, 7)), HasSubstr("byte 8: the name of an object is not printable ASCII"));
  EXPECT_THAT(refusal_of(changed(9, 0xC3)), HasSubstr("not printable ASCII"));
  Bytes twice = encode_frame({1, {{"camera"}, {"kamera"}}}, 0)[0];
  twice[83] = 'c';
  EXPECT_THAT(refusal_of(twice), HasSubstr("byte 83: object 'camera' is given twice"));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ObjectBlock frame = two_objects();
    frame.objects[0].rotation_rad[1] = bad;
    EXPECT_THAT(refusal_of(encode_frame(frame, 0)[0]), HasSubstr("byte 64: a number of an object is not finite"));
  }
}

TEST(ObjectStream, DoesNotWriteWhatTheProtocolHasNoPlaceFor) {
  for (const std::string& name : {std::string(), std::string(25, 'n'), std::string("a\0b", 3)})
    EXPECT_THROW((void)encode_frame({1, {{name}}}, 0), std::invalid_argument);
  EXPECT_THROW((void)encode_frame(two_objects(), 100), std::invalid_argument);
  EXPECT_THROW((void)encode_frame({1, std::vector<TrackedObject>(256, {"n"})}, 0), std::invalid_argument);
}

TEST(ObjectStream, SurvivesAnyBytes) {
  std::mt19937 random(1);
  const Bytes good = encode_frame(two_objects(), 256)[0];
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes block(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(random() % (good.size() + 1)));
    for (int change = 0; change < 4 && !block.empty(); ++change)
      block[random() % block.size()] = static_cast<std::uint8_t>(random());
    try {
      for (const auto& object : decode_block(block).objects)
        for (const double number : object.translation_mm) ASSERT_TRUE(std::isfinite(number));
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace

// Mean and scatter of poses.

namespace {

using fsw::Vector3;

Eigen::Isometry3d pose(const Vector3& translation, const Vector3& axis, double angle) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

TEST(ObjectAverage, OfNoPosesIsSilent) {
  EXPECT_EQ(average_of({}).state, ObjectState::kSilent);
  EXPECT_EQ(average_of({}).frames, 0);
}

// About one axis the mean rotation is the mean angle, also across 180 deg, where angles jump.
TEST(ObjectAverage, AboutOneAxisIsTheMeanAngle) {
  const Vector3 axis(1.0, 2.0, -0.5);
  std::vector<Eigen::Isometry3d> poses;
  for (const double angle : {3.0, 3.1, 3.2, 3.5}) poses.push_back(pose({angle, 0.0, 1.0}, axis, angle));
  const ObjectAverage average = average_of(poses);
  EXPECT_EQ(average.state, ObjectState::kTracked);
  EXPECT_EQ(average.frames, 4);
  EXPECT_TRUE(average.T_V_object.isApprox(pose({3.2, 0.0, 1.0}, axis, 3.2), 1e-14));
  // Squares about the mean: 0.04 + 0.01 + 0 + 0.09; three degrees of freedom, three axes.
  EXPECT_NEAR(average.translation_scatter_m, std::sqrt(0.14 / 9.0), 1e-14);
  EXPECT_NEAR(average.rotation_scatter_rad, std::sqrt(0.14 / 9.0), 1e-14);
}

TEST(ObjectAverage, OfOnePoseIsThatPose) {
  const auto one = pose({1.0, 2.0, 3.0}, {0.0, 1.0, 1.0}, 2.5);
  const ObjectAverage average = average_of({one, one, one});
  EXPECT_TRUE(average.T_V_object.isApprox(one, 1e-15));
  EXPECT_LT(average.rotation_scatter_rad, 1e-7);  // angle of a rotation matrix near the identity: root of rounding
}

// Normal errors: the mean of 400 is 20 times closer than one, and the scatter is that of one, within 10 %.
TEST(ObjectAverage, ScatterIsThatOfOneFrame) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto truth = pose({0.5, -2.0, 1.0}, {1.0, 1.0, 1.0}, 1.0);
  const double sigma_m = 5e-5, sigma_rad = 3.5e-4;
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 400; ++k) {
    const Vector3 turn = sigma_rad * Vector3(normal(random), normal(random), normal(random));
    Eigen::Isometry3d noisy = truth;
    noisy.linear() = truth.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    noisy.translation() += sigma_m * Vector3(normal(random), normal(random), normal(random));
    poses.push_back(noisy);
  }
  const ObjectAverage average = average_of(poses);
  EXPECT_NEAR(average.translation_scatter_m, sigma_m, 0.1 * sigma_m);
  EXPECT_NEAR(average.rotation_scatter_rad, sigma_rad, 0.1 * sigma_rad);
  EXPECT_LT((average.T_V_object.translation() - truth.translation()).norm(), 4.0 * std::sqrt(3.0) * sigma_m / 20.0);
  EXPECT_LT(Eigen::AngleAxisd(average.T_V_object.linear().transpose() * truth.linear()).angle(),
            4.0 * std::sqrt(3.0) * sigma_rad / 20.0);
}

}  // namespace

// Orders of angles against rotations about fixed axes, written out as matrices.

namespace {

using fsw::Matrix3;

Matrix3 about(char axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3 rotation;
  switch (axis) {
    case 'x':
      rotation << 1, 0, 0, 0, c, -s, 0, s, c;
      break;
    case 'y':
      rotation << c, 0, s, 0, 1, 0, -s, 0, c;
      break;
    default:
      rotation << c, -s, 0, s, c, 0, 0, 0, 1;
      break;
  }
  return rotation;
}

TEST(RotationOrder, IsTheOrderOfTheMatrices) {
  const std::array<double, 3> angles{0.3, -0.8, 1.9};
  for (const auto order : kRotationOrders) {
    Matrix3 expected = Matrix3::Identity();
    for (const char axis : order) expected = expected * about(axis, angles[static_cast<std::size_t>(axis - 'x')]);
    EXPECT_LT((rotation_of(angles, order) - expected).norm(), 1e-15) << order;
  }
}

// A rounding of an angle near the singular attitude is as large as the square root of the machine's; the matrices are
// compared, which it does not change.
TEST(RotationOrder, IsInvertedForEveryAttitude) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  for (const auto order : kRotationOrders)
    for (int trial = 0; trial < 1000; ++trial) {
      std::array<double, 3> angles{angle(random), angle(random), angle(random)};
      if (trial % 10 == 0) angles[static_cast<std::size_t>(order[1] - 'x')] = std::numbers::pi / 2;  // singular
      const Matrix3 rotation = rotation_of(angles, order);
      EXPECT_LT((rotation_of(angles_of(rotation, order), order) - rotation).norm(), 1e-12) << order;
    }
}

TEST(RotationOrder, OtherOrdersAreRefused) {
  for (const char* order : {"", "xy", "xyx", "XYZ", "xyzz"})
    EXPECT_THROW((void)rotation_of({}, order), std::invalid_argument);
}

}  // namespace

// The receiver on a socket: what it counts, and when an object counts as missing, occluded or frozen.

namespace {

using boost::asio::ip::udp;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};  // of what must come

class ReceiverTest : public ::testing::Test {
 protected:
  static ViconSettings settings() {
    ViconSettings settings;
    settings.port = 0;
    return settings;
  }

  void send_bytes(const Bytes& bytes) {
    socket_.send_to(boost::asio::buffer(bytes), {boost::asio::ip::address_v4::loopback(), receiver_.port()});
  }
  void send(const ObjectBlock& frame, std::size_t block_bytes = 1024) {
    for (const Bytes& block : encode_frame(frame, block_bytes)) send_bytes(block);
  }
  /// Frames with both objects from the number `first`, x of the camera `x_mm`.
  void send_frames(std::uint32_t first, int count, double x_mm) {
    for (int k = 0; k < count; ++k)
      send({first + static_cast<std::uint32_t>(k),
            {{"target", {5.0, x_mm, 0.0}, {0.0, 0.0, 0.5}}, {"camera", {x_mm + k, 2.0, 3.0}, {0.1, 0.0, 0.0}}}});
  }
  int received(int frames) { return receiver_.wait_for(frames, kPatience); }

  Receiver receiver_{settings(), "", "127.0.0.1"};
  boost::asio::io_context context_;
  udp::socket socket_{context_, udp::v4()};
};

TEST_F(ReceiverTest, AveragesTheLastFramesByTheNamesOfTheObjects) {
  send_frames(1, 20, 1000.0);
  ASSERT_EQ(received(20), 20);
  const CaptureAverage average = receiver_.average(10, {});
  ASSERT_TRUE(average.is_tracked());
  EXPECT_EQ(average.camera.frames, 10);
  EXPECT_NEAR(average.camera.T_V_object.translation().x(), 1.0145, 1e-12);  // mean of 1010 to 1019 mm
  EXPECT_NEAR(average.camera.T_V_object.translation().y(), 0.002, 1e-15);
  EXPECT_NEAR(average.target.T_V_object.translation().y(), 1.0, 1e-12);
  EXPECT_NEAR(average.target.T_V_object.linear()(1, 0), std::sin(0.5), 1e-14);
  EXPECT_EQ(receiver_.counts().frames, 20U);
  EXPECT_EQ(receiver_.counts().frames_lost, 0U);
}

TEST_F(ReceiverTest, FramesBeforeClearAreForgotten) {
  send_frames(1, 5, 0.0);
  ASSERT_EQ(received(5), 5);
  receiver_.clear();
  EXPECT_EQ(receiver_.drain(), 0);
  EXPECT_EQ(receiver_.average(5, {}).camera.state, ObjectState::kSilent);
  send_frames(6, 5, 100.0);
  ASSERT_EQ(received(5), 5);
  EXPECT_EQ(receiver_.average(20, {}).camera.state, ObjectState::kSilent);  // 5 of 20 are too few
  EXPECT_TRUE(receiver_.average(5, {}).is_tracked());
}

TEST_F(ReceiverTest, CountsFramesThatAreLostLateOrBegunAgain) {
  for (const std::uint32_t number : {10U, 11U, 14U, 12U, 13U, 15U}) send({number, {{"camera", {1.0}}}});
  ASSERT_EQ(received(4), 4);
  send({1, {{"camera", {1.0}}}});  // 14 before the last one: late
  send({1015, {{"camera", {1.0}}}});
  send({3, {{"camera", {1.0}}}});  // restarted
  ASSERT_EQ(received(6), 6);
  EXPECT_EQ(receiver_.counts().frames_lost, 2U + 999U);
  EXPECT_EQ(receiver_.counts().late_blocks, 3U);
  EXPECT_EQ(receiver_.counts().restarts, 1U);
}

TEST_F(ReceiverTest, FrameNumbersPassTheirLargestValue) {
  for (const std::uint32_t number : {0xFFFFFFFEU, 0xFFFFFFFFU, 0U, 1U}) send({number, {{"camera", {1.0}}}});
  ASSERT_EQ(received(4), 4);
  EXPECT_EQ(receiver_.counts().frames_lost, 0U);
  EXPECT_EQ(receiver_.counts().restarts, 0U);
}

TEST_F(ReceiverTest, PutsTheBlocksOfAFrameTogether) {
  for (std::uint32_t number = 1; number <= 5; ++number)
    send({number, {{"a"}, {"camera", {1.0}}, {"b"}, {"c"}, {"target", {2.0}}}}, 256);
  ASSERT_EQ(received(5), 5);
  // The second block of the last frame may still be on its way.
  EXPECT_GE(receiver_.average(5, {}).target.frames, 4);
  EXPECT_EQ(receiver_.counts().frames, 5U);
}

TEST_F(ReceiverTest, AnObjectIsMissingOrOccludedByMostOfTheFrames) {
  for (std::uint32_t number = 1; number <= 10; ++number) {
    ObjectBlock frame{number, {{"camera", {number < 6 ? 1.0 : 0.0}}}};
    if (number < 5) frame.objects.push_back({"target", {1.0}});
    send(frame);
  }
  ASSERT_EQ(received(10), 10);
  const CaptureAverage average = receiver_.average(10, {});
  EXPECT_EQ(average.camera.state, ObjectState::kTracked);  // 5 of 10
  EXPECT_EQ(average.camera.frames, 5);
  EXPECT_EQ(average.target.state, ObjectState::kMissing);
  EXPECT_EQ(receiver_.average(4, {}).camera.state, ObjectState::kOccluded);
  EXPECT_EQ(receiver_.counts().missing, 2U);
  EXPECT_EQ(receiver_.counts().occluded, 1U);
}

TEST_F(ReceiverTest, AnObjectThatKeepsItsBitsAfterAMoveIsFrozen) {
  const auto rest = [&](std::uint32_t first, double camera_mm, double target_mm) {
    receiver_.clear();
    for (std::uint32_t k = 0; k < 4; ++k) send({first + k, {{"camera", {camera_mm}}, {"target", {target_mm}}}});
    ASSERT_EQ(received(4), 4);
  };
  rest(1, 100.0, 200.0);
  EXPECT_TRUE(receiver_.average(4, {}).is_tracked());
  rest(5, 100.0, 200.0);
  EXPECT_TRUE(receiver_.average(4, {false, false}).is_tracked());  // neither has moved
  rest(9, 100.0, 201.0);
  const CaptureAverage average = receiver_.average(4, {true, true});
  EXPECT_EQ(average.camera.state, ObjectState::kFrozen);
  EXPECT_EQ(average.target.state, ObjectState::kTracked);
  rest(13, 100.0, 202.0);
  EXPECT_EQ(receiver_.average(4, {true, true}).camera.state, ObjectState::kFrozen);  // still
  rest(17, 101.0, 203.0);
  EXPECT_TRUE(receiver_.average(4, {true, true}).is_tracked());
  EXPECT_EQ(receiver_.counts().frozen, 2U);
}

TEST_F(ReceiverTest, HostileDatagramsAreCountedAndExplained) {
  send_bytes({});
  send_bytes({1, 2, 3});
  send_bytes(Bytes(60000, 0xFF));
  send_frames(1, 1, 0.0);
  ASSERT_EQ(received(1), 1);
  EXPECT_EQ(receiver_.counts().unreadable, 3U);
  EXPECT_THAT(receiver_.counts().last_unreadable, HasSubstr("Vicon block, byte "));
}

TEST_F(ReceiverTest, WaitsNoLongerThanAsked) {
  EXPECT_EQ(receiver_.wait_for(1, std::chrono::milliseconds(10)), 0);
}

TEST(Receiver, NamesAPortThatIsTaken) {
  ViconSettings settings;
  settings.port = 0;
  const Receiver first(settings, "", "127.0.0.1");
  settings.port = first.port();
  try {
    const Receiver second(settings, "", "127.0.0.1");
    FAIL() << "both have the port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("Vicon: UDP port " + std::to_string(first.port())));
  }
  EXPECT_THROW(Receiver(settings, "xxx", "127.0.0.2"), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::tron::vicon
