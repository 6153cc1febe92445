// Blocks of the object stream, byte by byte as Tracker's manual gives them, and what must not be read.

#include "hil_drivers/tron/protocols/vicon_stream.h"

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

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

}  // namespace vbar::tron::vicon
