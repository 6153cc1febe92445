#pragma once
// A made-up run of the paper's waypoints, plausible to look at, with something in every column: a report must cope with
// noise, refused burns, solvers that failed and steps without a valid estimate.

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fsw/packets/packet.h"
#include "host_sim/report/run_record.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/gnss/gnss_rows.h"

namespace vbar::report::test {

[[nodiscard]] RunRecord synthetic_run();

// A folder that goes away with the test.

class ScratchFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    scratch_ =
        std::filesystem::path(testing::TempDir()) / ("vbar_report_" + std::to_string(::getpid()) + "_" + info->name());
    std::filesystem::create_directories(scratch_);
  }
  void TearDown() override { std::filesystem::remove_all(scratch_); }

  static std::string content(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  static void write(const std::filesystem::path& file, std::string_view text) {
    std::ofstream(file, std::ios::binary) << text;
  }

  std::filesystem::path scratch_;
};

// What another program says.

struct ProgramOutput {
  int status = -1;  ///< 0 if it ended well
  std::string text;
};

inline ProgramOutput output_of(const std::string& command) {
  ProgramOutput output;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.text.append(buffer.data(), size);
  }
  output.status = ::pclose(pipe);
  return output;
}

// Packets of every kind, with a payload that differs from one to the next.

using Bytes = std::vector<std::uint8_t>;

inline Bytes packet_of(fsw::packets::Apid apid, std::uint16_t count) {
  fsw::packets::PacketHeader header;
  header.apid = apid;
  header.sequence_count = count;
  header.time = {60'000'000'000LL * count};
  const std::array<std::uint8_t, 3> payload{0x00, 0xFF, static_cast<std::uint8_t>(count)};
  Bytes packet(fsw::packets::kMaxPacketBytes);
  const auto size = fsw::packets::write_packet(header, payload, packet);
  EXPECT_TRUE(size.ok());
  packet.resize(size.value());
  return packet;
}

/// What passes the flight computer's border in a few steps, in order.
inline std::vector<Bytes> some_packets() {
  using fsw::packets::Apid;
  std::vector<Bytes> packets;
  for (std::uint16_t count = 0; count < 5; ++count) {
    for (const Apid apid : {Apid::kIdealNavigation, Apid::kTick, Apid::kManeuverCommand, Apid::kTelemetryNavigation,
                            Apid::kTelemetryControl, Apid::kTelemetryHealth, Apid::kStepReport}) {
      packets.push_back(packet_of(apid, count));
    }
  }
  return packets;
}

// Rows of a record with a given relative state, for tests of navigation errors.

using Vector6 = Eigen::Matrix<double, 6, 1>;

inline constexpr double kRadius_m = 7.0e6;
inline constexpr double kRate_radps = 1.0780007612e-3;  // sqrt(mu / r^3), mu = 3.986004418e14 m^3/s^2

/// A circular orbit at its node.
inline TruthRow truth_at(double time_s, const Vector6& relative) {
  TruthRow row;
  row.time_s = time_s;
  row.servicer_position_eci = {kRadius_m, 0.0, 0.0};
  row.servicer_velocity_eci = {0.0, kRadius_m * kRate_radps, 0.0};
  row.relative_position_rtn = {relative(0), relative(1), relative(2)};
  row.relative_velocity_rtn = {relative(3), relative(4), relative(5)};
  return row;
}

inline EstimateRow estimate_at(double time_s, const Vector6& relative, int source) {
  EstimateRow row;
  row.time_s = time_s;
  row.navigation_valid = 1;
  row.navigation_source = source;
  row.relative_position_rtn = {relative(0), relative(1), relative(2)};
  row.relative_velocity_rtn = {relative(3), relative(4), relative(5)};
  return row;
}

}  // namespace vbar::report::test
