// The whole bench in one event loop: addresses, edges on their socket, faults by scenario and by control line.

#include "hil_drivers/grand/bench/generator/bench.h"

#include <fstream>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/grand/pps/socket_edges.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"
#include "tests/unit/hil_drivers/grand/bench/generator/bench_directory.h"
#include "tests/unit/hil_drivers/grand/bench/generator/fake_receiver.h"

namespace vbar::grand::bench {
namespace {

using namespace std::chrono_literals;
using fsw::Duration;
using test::read_available;
using test::sample_in_orbit;
using ::testing::HasSubstr;

class BenchTest : public ::testing::Test {
 protected:
  void make(std::vector<Fault> faults = {}) {
    Scenario scenario;
    scenario.vehicles = {{"servicer", 2, {}}, {"target", 1, {}}};
    scenario.faults = std::move(faults);
    bench =
        std::make_unique<Bench>(context, scenario, test::data_directory(), directory.path(), test::fake_receivers());
    host = io::FileDescriptor(::open((directory.path() / "servicer.com1").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  }
  void start() {
    BenchEngine& engine = bench->engine();
    ASSERT_EQ(engine.set_start_time(test::kGnssStart), "");
    for (std::size_t k = 0; k < 2; ++k) engine.sample(k, sample_in_orbit(0.0));
    ASSERT_EQ(engine.arm(), "");
    ASSERT_EQ(engine.start(Duration{}), "");
  }
  /// Both vehicles, block by block, up to `time_s`; bytes of the servicer's first port.
  std::string fly(double time_s) {
    std::string bytes;
    for (; 0.1 * next < time_s + 1e-9; ++next) {
      for (std::size_t k = 0; k < 2; ++k) bench->engine().sample(k, sample_in_orbit(0.1 * next));
      bytes += read_available(host.get());
    }
    return bytes;
  }
  std::vector<nlohmann::json> acknowledged() const {
    std::vector<nlohmann::json> lines;
    std::ifstream in(directory.path() / "faults.jsonl");
    for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
    return lines;
  }
  static Fault fault(FaultKind kind, double time_s, double duration_s = 0.0, double value = 0.0) {
    Fault fault;
    fault.kind = kind;
    fault.time = fsw::nearest_duration(time_s);
    fault.duration = fsw::nearest_duration(duration_s);
    fault.value = value;
    return fault;
  }

  test::BenchDirectory directory;
  boost::asio::io_context context;
  std::unique_ptr<Bench> bench;
  io::FileDescriptor host;
  int next = 1;
};

TEST_F(BenchTest, AddressesNameEverythingThatListens) {
  make();
  const auto addresses = nlohmann::json::parse(std::ifstream(directory.path() / "addresses.json"));
  EXPECT_EQ(addresses["control_ports"].size(), 2U);
  for (const auto& port : addresses["control_ports"]) EXPECT_GT(port.get<int>(), 0);
  EXPECT_EQ(addresses["pps"], (directory.path() / "pps.sock").string());
  EXPECT_EQ(addresses["receivers"]["servicer"]["com2"], (directory.path() / "servicer.com2").string());
  EXPECT_FALSE(addresses["receivers"]["target"].contains("com2"));
  for (const char* name : {"pps.sock", "faults.sock", "servicer.com1"})
    EXPECT_TRUE(std::filesystem::exists(directory.path() / name)) << name;
  bench.reset();
  for (const char* name : {"pps.sock", "faults.sock", "servicer.com1", "addresses.json"})
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(directory.path() / name))) << name;
}

TEST_F(BenchTest, LinesHangUpAndComeBack) {
  make({fault(FaultKind::kLineHangUp, 1.0, 2.0)});
  start();
  EXPECT_FALSE(fly(0.9).empty());
  fly(1.1);
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(directory.path() / "servicer.com1")));
  ASSERT_EQ(acknowledged().size(), 1U);
  EXPECT_EQ(acknowledged()[0]["kind"], "line_hang_up");
  EXPECT_NEAR(acknowledged()[0]["time_s"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(fly(2.9), "");
  fly(3.1);
  host = io::FileDescriptor(::open((directory.path() / "servicer.com1").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  EXPECT_FALSE(fly(3.5).empty());
}

TEST_F(BenchTest, OutageHasAnEffectBeforeItIsAcknowledged) {
  make({fault(FaultKind::kRfOutage, 1.0, 1.0)});
  start();
  fly(1.0);
  EXPECT_TRUE(acknowledged().empty());  // injected, but no block without signals has been flown
  fly(1.1);
  ASSERT_EQ(acknowledged().size(), 1U);
  EXPECT_TRUE(bench->engine().vehicle(0).last_block().signals.empty());
  EXPECT_FALSE(bench->engine().vehicle(1).last_block().signals.empty());
  fly(2.2);
  EXPECT_FALSE(bench->engine().vehicle(0).last_block().signals.empty());
}

TEST_F(BenchTest, BytesOfALineAreDamaged) {
  make({fault(FaultKind::kLineGarbage, 1.0, 1.0), fault(FaultKind::kLineHalfMessages, 3.0, 1.0),
        fault(FaultKind::kLineFlood, 5.0, 0.5)});
  start();
  const std::size_t clean = fly(1.0).size();
  EXPECT_GT(fly(2.0).size(), clean + 300);  // 40 bytes every 100 ms
  const std::size_t undamaged = fly(3.0).size();
  EXPECT_NEAR(static_cast<double>(undamaged), static_cast<double>(clean), 80.0);
  const std::size_t half = fly(4.0).size();
  EXPECT_LT(half, 0.75 * static_cast<double>(clean));
  fly(5.0);
  EXPECT_GT(fly(5.5).size(), 50'000U);
  EXPECT_EQ(acknowledged().size(), 3U);
}

TEST_F(BenchTest, CommandsOfTheHostAreLostOrSpoiled) {
  Fault silent = fault(FaultKind::kReceiverUnanswered, 0.0);
  silent.time.reset();
  make({silent});
  ASSERT_EQ(::write(host.get(), "version\n", 8), 8);
  context.run_for(50ms);
  EXPECT_EQ(read_available(host.get()), "");
  bench->faults().advance();
  EXPECT_EQ(acknowledged().size(), 1U);
  bench.reset();
  Fault refuses = fault(FaultKind::kReceiverRefuses, 0.0);
  refuses.time.reset();
  make({refuses});
  ASSERT_EQ(::write(host.get(), "version\n", 8), 8);
  context.restart();
  context.run_for(50ms);
  EXPECT_THAT(read_available(host.get()), ::testing::Not(HasSubstr("version")));
}

TEST_F(BenchTest, BaudRatesChangeAtEitherEnd) {
  make({fault(FaultKind::kReceiverBaud, 0.5, 0.0, 57600.0), fault(FaultKind::kHostBaud, 1.0, 0.0, 9600.0)});
  start();
  fly(0.4);
  EXPECT_EQ(bench->engine().vehicle(0).receiver().baud(0), 115200U);
  fly(1.2);
  EXPECT_EQ(bench->engine().vehicle(0).receiver().baud(0), 57600U);
  EXPECT_EQ(bench->engine().vehicle(0).ports()[0].line->host_baud(), 9600U);
  EXPECT_EQ(acknowledged().size(), 2U);
}

TEST_F(BenchTest, EdgesAreMissingAndDoubled) {
  make({fault(FaultKind::kPpsMissing, 1.5, 0.0, 1.0), fault(FaultKind::kPpsDoubled, 3.5, 0.0, 1.0)});
  const auto edges = kSocketEdges.make((directory.path() / "pps.sock").string());
  EXPECT_FALSE(edges->next(io::Clock::now()));  // subscribes
  start();
  fly(5.0);
  std::vector<std::uint32_t> counts;
  while (const auto edge = edges->next(io::Clock::now() + 100ms)) counts.push_back(edge->count);
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{0, 1, 3, 4, 4, 5}));
  EXPECT_EQ(acknowledged().size(), 2U);
}

TEST_F(BenchTest, GeneratorDiesAndComesBack) {
  make({fault(FaultKind::kGeneratorDies, 1.0, 0.2)});
  start();
  fly(1.0);
  EXPECT_EQ(bench->engine().state(), EngineState::kStopped);
  EXPECT_EQ(acknowledged().size(), 1U);
  context.run_for(400ms);
  bench->faults().advance();
  EXPECT_EQ(bench->engine().state(), EngineState::kIdle);
}

TEST_F(BenchTest, GeneratorReportsAnError) {
  Fault error = fault(FaultKind::kGeneratorError, 1.0);
  error.text = "The signal processor has stopped.";
  make({error});
  start();
  fly(1.0);
  EXPECT_EQ(bench->engine().state(), EngineState::kError);
  EXPECT_EQ(bench->engine().error(), "The signal processor has stopped.");
}

TEST_F(BenchTest, ControlLineInjectsAndAcknowledges) {
  make();
  start();
  boost::asio::local::stream_protocol::socket client(context);
  client.connect((directory.path() / "faults.sock").string());
  client.non_blocking(true);
  const auto say = [&](const std::string& line) {
    boost::asio::write(client, boost::asio::buffer(line + "\n"));
    context.restart();
    context.run_for(50ms);
    return read_available(client.native_handle());
  };
  EXPECT_THAT(say("nonsense"), HasSubstr("\"error\""));
  EXPECT_THAT(say(R"({"kind":"rf_outage","vehicle":"moon"})"), HasSubstr("servicer or target"));
  EXPECT_EQ(say(R"({"kind":"cn0_drop","vehicle":"servicer","db":15,"duration_s":60})"), "");  // no effect yet
  fly(0.1);
  const auto answer = nlohmann::json::parse(read_available(client.native_handle()));
  EXPECT_EQ(answer["injected"]["kind"], "cn0_drop");
  EXPECT_EQ(answer["injected"]["db"], 15.0);
  EXPECT_EQ(acknowledged().size(), 1U);
}

}  // namespace
}  // namespace vbar::grand::bench
