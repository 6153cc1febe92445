// Experiment 3 with the servicer's receiver wired to its flight computer: the bytes take another way, and the flight
// software says the same, bit for bit, also when the run is replayed into a flight computer of another kind.

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/io/byte_channels.h"
#include "host_sim/twins/packet_log.h"
#include "pil_bridge/make_flight_computer.h"
#include "tests/integration/experiment3/flight.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

namespace packets = fsw::packets;

constexpr std::chrono::seconds kPatience{20};

pil::FlightComputerOptions options_of(pil::Target target, pil::LinkKind link) {
  pil::FlightComputerOptions options;
  options.target = target;
  options.link = link;
  options.spacecraft = 1;  // missions/experiment3.toml
  options.article = pil::linked_test_article();
  if (target == pil::Target::kHostProcess) options.image = vbar::tests::build_path("vbar_flight");
  if (target == pil::Target::kZynqQemu) options.image = vbar::tests::source_path("build/zynq/vbar_zynq7000.elf");
  if (target == pil::Target::kZynqLinuxQemu) options.image = vbar::tests::source_path("build/zynq-linux/vbar_flight");
  return options;
}

bool is_gnss_bytes(const pil::Packet& packet) {
  return packets::parse_packet(packet).value().header.apid == packets::Apid::kGnssBytes;
}

/// Takes the bytes of the servicer's receiver out of the packets of a step and sends them on a line of the flight
/// computer; all other packets, among them those of the crosslink, take the link.
class RewiredComputer final : public pil::FlightComputer {
 public:
  explicit RewiredComputer(pil::FlightComputerOptions options) {
    io::Pty pty = io::make_pty();
    held_open_ = std::move(pty.slave);
    line_ = io::adopt_pty(std::move(pty.master), "the receiver's line");
    options.receiver =
        io::WiredReceiver{.device = pty.slave_path, .in_lock_step = true, .bytes_sent = [this] { return sent_; }};
    inner_ = pil::make_flight_computer(options);
  }

  pil::StepResult step(std::uint32_t step, std::span<const pil::Packet> given) override {
    std::vector<pil::Packet> others;
    for (const pil::Packet& packet : given) {
      if (!is_gnss_bytes(packet)) {
        others.push_back(packet);
        continue;
      }
      const auto message = packets::decode<gnss_bytes>(packets::parse_packet(packet).value()).value();
      const auto count = static_cast<std::size_t>(message.count);
      line_->write(std::span(message.data).first(count), io::Clock::now() + kPatience);
      sent_ += count;
    }
    return inner_->step(step, others);
  }
  [[nodiscard]] pil::LinkStatistics statistics() const override { return inner_->statistics(); }
  [[nodiscard]] std::string description() const override { return inner_->description(); }
  void close() override {
    EXPECT_GT(sent_, 0U);
    EXPECT_EQ(inner_->statistics().wired.bytes, sent_);
    EXPECT_EQ(inner_->statistics().wired.timeouts, 0U);
    inner_->close();
  }

 private:
  io::FileDescriptor held_open_;
  std::unique_ptr<io::ByteChannel> line_;
  std::uint64_t sent_ = 0;
  std::unique_ptr<pil::FlightComputer> inner_;
};

/// Writes packets.lcmlog as a run does whose sensor gives no packets of the servicer's receiver: of the inputs, those
/// that the simulation made are left out, and those that the flight computer returned are before the tick.
class LogKeeper final : public app::RunObserver {
 public:
  explicit LogKeeper(const std::filesystem::path& file) : writer_(file) {}
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override {
    const auto made = static_cast<std::size_t>(std::ranges::count_if(inputs, is_gnss_bytes)) / 2;
    std::size_t left_out = 0;
    for (const pil::Packet& packet : inputs) {
      const bool is_made = is_gnss_bytes(packet) && left_out < made;
      left_out += is_made ? 1U : 0U;
      if (!is_made) writer_.write({step, time, true, packet});
    }
    for (const pil::Packet& packet : outputs) writer_.write({step, time, false, packet});
  }
  void finish() { writer_.finish(); }

 private:
  twins::PacketLogWriter writer_;
};

struct Recorded {
  std::vector<pil::Packet> inputs;
  std::vector<pil::Packet> outputs;
};

std::map<std::uint32_t, Recorded> steps_in(const std::filesystem::path& file) {
  std::map<std::uint32_t, Recorded> steps;
  for (const twins::PacketRecord& record : twins::read_packet_log(file).records)
    (record.to_flight ? steps[record.step].inputs : steps[record.step].outputs).push_back(record.packet);
  return steps;
}

struct Computer {
  const char* name;
  pil::Target target;
  pil::LinkKind link;
  const char* duration;  ///< enough for the first fix; less on the emulated board, which is slower
};
class WiredReceiver : public testing::TestWithParam<Computer> {};

TEST_P(WiredReceiver, GivesTheSameBitsAsPacketsDoAndIsReplayed) {
  const auto options = options_of(GetParam().target, GetParam().link);
  if (!std::filesystem::exists(options.image)) GTEST_SKIP() << options.image << " is not built";
  const std::vector<std::string> overrides{std::string("mission.duration_h=") + GetParam().duration};
  const FlownMission by_packets = fly("experiment3.toml", overrides);

  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / (std::string("wired_") + GetParam().name + ".lcmlog");
  LogKeeper log(file);
  const auto rewire = [&](std::unique_ptr<pil::FlightComputer>) { return std::make_unique<RewiredComputer>(options); };
  const FlownMission wired = fly("experiment3.toml", overrides, rewire, &log);
  log.finish();
  ASSERT_TRUE(wired.complete);
  EXPECT_TRUE(wired.record.summary.first_fix_s.has_value());
  EXPECT_EQ(sha256(wired.commands), sha256(by_packets.commands));
  EXPECT_EQ(sha256(wired.telemetry), sha256(by_packets.telemetry));
  EXPECT_GT(wired.record.summary.link.wired_bytes, 0U);
  EXPECT_EQ(wired.record.summary.link.wired_timeouts, 0U);

  const auto in_process = pil::make_flight_computer(options_of(pil::Target::kInProcess, pil::LinkKind::kSerial));
  const auto same_again = pil::make_flight_computer(options);  // without the line: the bytes come as packets
  const auto steps = steps_in(file);
  EXPECT_EQ(steps.size(), wired.record.estimates.size());
  for (const auto& [number, step] : steps) {
    ASSERT_EQ(in_process->step(number, step.inputs).packets, step.outputs) << number;
    ASSERT_EQ(same_again->step(number, step.inputs).packets, step.outputs) << number;
  }
  same_again->close();
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(
    FlightComputers, WiredReceiver,
    testing::Values(Computer{"HostProcessSerial", pil::Target::kHostProcess, pil::LinkKind::kSerial, "0.5"},
                    Computer{"HostProcessUdp", pil::Target::kHostProcess, pil::LinkKind::kUdp, "0.1"},
                    Computer{"ArmLinux", pil::Target::kZynqLinuxQemu, pil::LinkKind::kSerial, "0.1"},
                    Computer{"Zynq", pil::Target::kZynqQemu, pil::LinkKind::kUdp, "0.05"}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace vbar::test
