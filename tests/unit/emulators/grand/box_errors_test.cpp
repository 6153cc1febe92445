// Statistics of the imperfections against their definition: normal constants and a first-order Gauss-Markov process.

#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include "emulators/common/host_line.h"
#include "emulators/grand/radio_field/sky.h"
#include "tests/support/figures.h"
#include "tests/unit/emulators/grand/bench_directory.h"

namespace vbar::grand::bench {

namespace {

using twins::gnss::Signal;
using twins::gnss::System;

TEST(ChannelErrors, AlignmentsHaveTheirSigmaAndAreConstantsOfTheChannel) {
  double carrier = 0.0, code = 0.0;
  constexpr int kChannels = 400;
  for (int k = 0; k < kChannels; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    const ChannelErrors errors({}, seed, "servicer", {System::kGps, 7}, Signal::kGpsL1);
    const ChannelErrors again({}, seed, "servicer", {System::kGps, 7}, Signal::kGpsL1);
    const ChannelErrors other({}, seed, "target", {System::kGps, 7}, Signal::kGpsL1);
    EXPECT_EQ(errors.carrier_alignment_m(), again.carrier_alignment_m());
    EXPECT_NE(errors.carrier_alignment_m(), other.carrier_alignment_m());
    carrier += std::pow(errors.carrier_alignment_m(), 2);
    code += std::pow(errors.code_alignment_m(), 2);
  }
  // Standard error of a sigma from 400 draws: 3.5 %; three of them.
  EXPECT_NEAR(std::sqrt(carrier / kChannels), 0.27e-3, 0.11 * 0.27e-3);
  EXPECT_NEAR(std::sqrt(code / kChannels), 20e-3, 0.11 * 20e-3);
}

TEST(ChannelErrors, WanderHasItsSigmaAndCorrelationTime) {
  double variance = 0.0, covariance_60s = 0.0;
  accuracy::Largest largest_step;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    ChannelErrors errors({}, seed, "servicer", {System::kGps, 7}, Signal::kGpsL1);
    std::vector<double> phase_mm;
    for (int k = 0; k < 36000; ++k) {
      const auto wander = errors.wander(k);
      if (k > 0) {
        EXPECT_EQ(wander.begin_m * 1e3, phase_mm.back());
      } else {
        phase_mm.push_back(wander.begin_m * 1e3);
      }
      largest_step.add(std::abs(wander.end_m - wander.begin_m) * 1e3);
      phase_mm.push_back(wander.end_m * 1e3);
    }
    for (std::size_t k = 0; k + 600 < phase_mm.size(); k += 10, ++count) {
      variance += phase_mm[k] * phase_mm[k];
      covariance_60s += phase_mm[k] * phase_mm[k + 600];
    }
  }
  // 40 h in time constants of 60 s: 2400 / 2 independent values; standard error of the variance 4 %.
  EXPECT_NEAR(variance / count, 0.25, 0.03);
  EXPECT_NEAR(covariance_60s / count, 0.25 * std::exp(-1.0), 0.03);
  // Innovation of one block: 0.5 mm sqrt(2 * 0.1 / 60) = 0.029 mm; 1.4 million of them stay below 6 sigma.
  EXPECT_LT(largest_step, 6.0 * 0.0289);
}

// A satellite that was away: correlation decays over the blocks left out.
TEST(ChannelErrors, WanderRunsOnOverOmittedBlocks) {
  double product = 0.0;
  constexpr int kSeeds = 4000;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    ChannelErrors errors({}, seed, "target", {System::kGalileo, 3}, Signal::kGalileoE1);
    const double before = errors.wander(0).end_m;
    product += before * errors.wander(301).begin_m;
  }
  // 30 s later: exp(-1/2); standard error 1.6 % of the variance.
  EXPECT_NEAR(product / kSeeds, 0.25e-6 * std::exp(-0.5), 0.05 * 0.25e-6);
}

TEST(ChannelErrors, ZeroSigmaIsAnIdealBox) {
  ChannelErrors errors({0.0, 0.0, 0.0, 60.0}, 1, "target", {System::kGalileo, 3}, Signal::kGalileoE1);
  EXPECT_EQ(errors.wander(5).end_m, 0.0);
  EXPECT_EQ(errors.carrier_alignment_m(), 0.0);
  EXPECT_EQ(errors.code_alignment_m(), 0.0);
}

}  // namespace

// A serial line of the bench as the host sees it: a terminal of Linux.

namespace {

using namespace std::chrono_literals;
using emulators::HostLine;
using test::EmulatorDirectory;
using test::read_available;

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

class HostLineTest : public ::testing::Test {
 protected:
  io::FileDescriptor open_host() const {
    io::FileDescriptor host(::open(line.path().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    EXPECT_GE(host.get(), 0);
    return host;
  }

  EmulatorDirectory directory;
  boost::asio::io_context context;
  std::string heard;
  unsigned heard_baud = 0;
  HostLine line{context, directory.path() / "servicer.com1", [this](auto bytes, unsigned baud) {
                  heard.append(bytes.begin(), bytes.end());
                  heard_baud = baud;
                }};
};

TEST_F(HostLineTest, BytesPassInBothDirections) {
  const io::FileDescriptor host = open_host();
  line.write(bytes_of("hello\r\n"));
  EXPECT_EQ(read_available(host.get()), "hello\r\n");
  ASSERT_EQ(::write(host.get(), "log\r\n", 5), 5);
  line.poll();
  EXPECT_EQ(heard, "log\r\n");
  ASSERT_EQ(::write(host.get(), "x", 1), 1);
  context.run_for(100ms);  // the event loop hears it too
  EXPECT_EQ(heard, "log\r\nx");
}

// A terminal takes some ten kilobytes: the rest is kept and follows in order.
TEST_F(HostLineTest, NothingIsLostWhenTheHostReadsLate) {
  const io::FileDescriptor host = open_host();
  std::string sent;
  for (int k = 0; k < 40'000; ++k) sent += fmt::format("{:06d}\n", k);
  line.write(bytes_of(sent));
  EXPECT_GT(line.waiting(), 100'000U);
  std::string received;
  for (int round = 0; round < 10'000 && received.size() < sent.size(); ++round) {
    received += read_available(host.get());
    context.run_for(1ms);
  }
  EXPECT_EQ(received, sent);
  EXPECT_EQ(line.waiting(), 0U);
  EXPECT_EQ(line.bytes_lost(), 0U);
}

TEST_F(HostLineTest, BaudRateIsThatOfTheHostsEnd) {
  const io::FileDescriptor host = open_host();
  termios settings{};
  ASSERT_EQ(::tcgetattr(host.get(), &settings), 0);
  ::cfsetspeed(&settings, B57600);
  ASSERT_EQ(::tcsetattr(host.get(), TCSANOW, &settings), 0);
  EXPECT_EQ(line.host_baud(), 57600U);
  ASSERT_EQ(::write(host.get(), "a", 1), 1);
  line.poll();
  EXPECT_EQ(heard_baud, 57600U);
  EXPECT_TRUE(line.set_host_baud(9600));
  ASSERT_EQ(::tcgetattr(host.get(), &settings), 0);
  EXPECT_EQ(::cfgetospeed(&settings), static_cast<speed_t>(B9600));
  EXPECT_FALSE(line.set_host_baud(12345));
}

TEST_F(HostLineTest, HangUpEndsTheHostsEndAndPluggingInMakesANewOne) {
  const io::FileDescriptor host = open_host();
  line.hang_up();
  EXPECT_FALSE(line.is_plugged_in());
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(line.path())));
  char byte = 0;
  EXPECT_LE(::read(host.get(), &byte, 1), 0);
  EXPECT_NE(errno, EAGAIN);
  EXPECT_LT(::write(host.get(), "x", 1), 0);
  line.write(bytes_of("lost"));
  EXPECT_EQ(line.bytes_lost(), 4U);
  EXPECT_EQ(line.host_baud(), 0U);

  line.plug_in();
  const io::FileDescriptor again = open_host();
  line.write(bytes_of("back"));
  EXPECT_EQ(read_available(again.get()), "back");
  ASSERT_EQ(::write(again.get(), "y", 1), 1);
  context.run_for(100ms);
  EXPECT_EQ(heard, "y");
}

TEST_F(HostLineTest, LinkOfAnEndedProgramIsReplacedAndAFileIsNot) {
  std::filesystem::create_symlink("/dev/pts/nowhere", directory.path() / "old.com1");
  { const HostLine replaced(context, directory.path() / "old.com1", {}); }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(directory.path() / "old.com1")));
  std::ofstream(directory.path() / "file.com1") << "text";
  EXPECT_THROW(HostLine(context, directory.path() / "file.com1", {}), std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(directory.path() / "file.com1"));
}

}  // namespace

}  // namespace vbar::grand::bench
