// The Skydel driver against a generator end written from the published remote API alone (public repository
// learn-safran-navigation-timing/skydel-remote-api, API 49: Documentation.txt for names and fields, the C++ client for
// frames, uuids and datagrams). It uses no codec of this project.

#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "emulators/common/sockets.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

/// Fields of each command that the driver may send, as documented; those with "?" are optional there (null).
const std::map<std::string, std::set<std::string>> kFields = {
    {"GetVersion", {}},
    {"GetHilPort", {}},
    {"GetEngineLatency", {}},
    {"GetStreamingBuffer", {}},
    {"New", {"DiscardCurrentConfig", "LoadDefaultConfig"}},
    {"SetModulationTarget", {"Type", "Path", "Address", "ClockIsExternal", "Id"}},
    {"ChangeModulationTargetSignals",
     {"Output", "MinRate", "MaxRate", "Band", "Signal", "Gain", "GaussianNoise", "Id", "CentralFrequency"}},
    {"SetGpsStartTime", {"Start"}},
    {"SetVehicleTrajectory", {"Type"}},
    {"SetHilTjoin", {"HilTjoin"}},
    {"SetSyncServer", {"Port"}},
    {"SetSyncClient", {"Host", "Port"}},
    {"EnableMainInstanceSync", {"Enabled"}},
    {"EnableWorkerInstanceSync", {"Enabled"}},
    {"ArmPPS", {}},
    {"WaitAndResetPPS", {}},
    {"StartPPS", {"Msec"}},
    {"GetComputerSystemTimeSinceEpochAtPps0", {}},
    {"BeginVehicleInfo", {}},
    {"GetSimulatorState", {}},
    {"GetHilExtrapolationState", {}},
    {"Stop", {}},
};

/// Results with fields; every other command is answered by SuccessResult.
json answer_fields(const std::string& command, int hil_port, bool is_streaming) {
  if (command == "GetVersion") return {{"CmdName", "VersionResult"}, {"Version", "25.6.0"}};
  if (command == "GetHilPort") return {{"CmdName", "HilPortResult"}, {"Port", hil_port}};
  if (command == "GetEngineLatency") return {{"CmdName", "GetEngineLatencyResult"}, {"Latency", 40}};
  if (command == "GetStreamingBuffer") return {{"CmdName", "GetStreamingBufferResult"}, {"Size", 200}};
  if (command == "GetComputerSystemTimeSinceEpochAtPps0")
    return {{"CmdName", "GetComputerSystemTimeSinceEpochAtPps0Result"}, {"Milliseconds", 0.0}};
  if (command == "GetHilExtrapolationState")
    return {{"CmdName", "GetHilExtrapolationStateResult"}, {"State", 0}, {"ElapsedTime", 0}};
  if (command == "GetSimulatorState")
    return {{"CmdName", "SimulatorStateResult"},
            {"State", is_streaming ? "Streaming RF" : "Ready"},
            {"Error", ""},
            {"StateId", is_streaming ? 2 : 1},
            {"SubStateId", is_streaming ? 5 : 2}};
  return {{"CmdName", "SuccessResult"}};
}

class PublishedEnd {
 public:
  /// `refused`: command that fails, with ErrorMsg `reason`. `sends_foreign_results`: a result to another client's
  /// command precedes each answer.
  explicit PublishedEnd(std::string refused = {}, std::string reason = {}, bool sends_foreign_results = false)
      : refused_(std::move(refused)),
        reason_(std::move(reason)),
        sends_foreign_results_(sends_foreign_results),
        control_(std::make_shared<emulators::Listener>(context_, std::uint16_t{0})),
        hil_(std::make_shared<emulators::DatagramPort>(context_, std::uint16_t{0})) {
    control_->start([this]() -> emulators::Connection::Receive {
      return [this, stream = std::make_shared<Bytes>()](emulators::Connection& connection, auto bytes) {
        stream->insert(stream->end(), bytes.begin(), bytes.end());
        serve(connection, *stream);
      };
    });
    hil_->start([this](auto datagram, const auto& sender) { fly(datagram, sender); });
    port = control_->port();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~PublishedEnd() {
    finish();
    control_->close();
    hil_->close();
  }
  PublishedEnd(const PublishedEnd&) = delete;
  PublishedEnd& operator=(const PublishedEnd&) = delete;

  /// Ends the thread; what was recorded may be read afterwards.
  void finish() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  std::uint16_t port = 0;
  std::vector<std::string> commands, complaints;
  int samples = 0;
  double last_ms = -1.0;

 private:
  void serve(emulators::Connection& connection, Bytes& stream) {
    while (stream.size() >= 2) {
      const std::size_t length = stream[0] + 256U * stream[1];
      if (stream.size() < 2 + length) return;
      const Bytes message(stream.begin() + 2, stream.begin() + 2 + static_cast<std::ptrdiff_t>(length));
      stream.erase(stream.begin(), stream.begin() + 2 + static_cast<std::ptrdiff_t>(length));
      if (message.at(0) == 2) {
        connection.send(Bytes{5, 0, 2, 49, 0, 0, 0});
        continue;
      }
      const std::string text(message.begin() + 1, message.end() - 1);
      if (message.back() != 0) complaints.push_back("a command does not end with NUL");
      const json command = json::parse(text);
      check(command);
      if (sends_foreign_results_) {
        json foreign = command;
        foreign["CmdUuid"] = "00000000-1111-2222-3333-444444444444";
        send(connection, {{"CmdName", "FailureResult"}, {"ErrorMsg", "of another client"}}, foreign.dump());
      }
      const std::string name = command.at("CmdName");
      if (name == refused_) {
        send(connection, {{"CmdName", "FailureResult"}, {"ErrorMsg", reason_}}, text);
      } else {
        is_streaming_ = (is_streaming_ || name == "StartPPS") && name != "Stop";
        send(connection, answer_fields(name, hil_->port(), is_streaming_), text);
      }
    }
  }

  void check(const json& command) {
    const std::string name = command.at("CmdName");
    commands.push_back(name);
    const auto known = kFields.find(name);
    if (known == kFields.end()) return complaints.push_back("unknown command " + name);
    std::set<std::string> expected = known->second, found;
    expected.insert({"CmdName", "CmdUuid"});
    for (const auto& [field, value] : command.items()) found.insert(field);
    if (found != expected) complaints.push_back("fields of " + command.dump());
  }

  void send(emulators::Connection& connection, json result, const std::string& related) {
    result["CmdUuid"] = "aaaaaaaa-bbbb-4ccc-8ddd-" + std::to_string(100'000'000'000 + ++results_);
    result["RelatedCommand"] = related;
    const std::string text = result.dump();
    const auto inner = static_cast<std::uint32_t>(text.size() + 1);
    const std::uint32_t outer = inner + 5;
    Bytes bytes{static_cast<std::uint8_t>(outer), static_cast<std::uint8_t>(outer >> 8U), 1};
    for (unsigned k = 0; k < 4; ++k) bytes.push_back(static_cast<std::uint8_t>(inner >> (8 * k)));
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back(0);
    connection.send(bytes);
  }

  // Sample with attitude and three derivatives: id, order, time; vehicle information back: id, u64 ms, 9 doubles.
  void fly(std::span<const std::uint8_t> datagram, const emulators::DatagramPort::Endpoint& sender) {
    if (datagram.size() == 1) return;  // Hello, Bye
    if (datagram.size() != 206 || datagram[0] != 8 || datagram[1] != 2)
      return complaints.push_back("datagram of " + std::to_string(datagram.size()) + " bytes");
    std::memcpy(&last_ms, &datagram[2], sizeof last_ms);
    ++samples;
    Bytes info(81, 0);
    info[0] = 3;
    const auto time_ms = static_cast<std::uint64_t>(last_ms);
    std::memcpy(&info[1], &time_ms, sizeof time_ms);
    std::memcpy(&info[9], &datagram[10], 48);  // position and attitude
    hil_->send(info, sender);
  }

  std::string refused_, reason_;
  bool sends_foreign_results_ = false;
  boost::asio::io_context context_;
  std::shared_ptr<emulators::Listener> control_;
  std::shared_ptr<emulators::DatagramPort> hil_;
  bool is_streaming_ = false;
  std::uint64_t results_ = 0;
  std::thread thread_;
};

std::unique_ptr<Generator> driver(const PublishedEnd& end) {
  GeneratorPlan plan;
  plan.start = kStart;
  plan.vehicles = {"servicer"};
  plan.sample_period = kTenth;
  plan.join = fsw::Duration{165'000'000};
  plan.host = "127.0.0.1";
  plan.control_ports = {end.port};
  return kSkydelKind.make(plan, *kSkydelKind.read(mission::TableReader(toml::table{}, "t.toml")));
}

TEST(SkydelPublishedApi, StartsFliesTwoMinutesAndStops) {
  PublishedEnd end("", "", true);
  {
    const auto generator = driver(end);
    prepare(*generator, 1);
    EXPECT_EQ(generator->start(), std::nullopt);
    for (int n = 1; n <= 1200; ++n) {
      generator->send(0, sample_at(tenths(n)));
      ASSERT_EQ(generator->wait_for(0, tenths(n), soon()), tenths(n));
    }
    EXPECT_EQ(generator->state(0).text, "Streaming RF");
    EXPECT_FALSE(generator->is_emulated());
    generator->stop();
    EXPECT_EQ(generator->state(0).text, "Ready");
  }
  end.finish();
  EXPECT_THAT(end.complaints, testing::IsEmpty());
  EXPECT_GE(end.samples, 1201);  // on a busy computer some are sent again
  EXPECT_EQ(end.last_ms, 120'000.0);
  EXPECT_THAT(end.commands, testing::Contains("Stop"));
}

TEST(SkydelPublishedApi, EveryRefusalEndsWithTheGeneratorsOwnReason) {
  for (const auto& [command, fields] : kFields) {
    if (command == "Stop" || command.starts_with("SetSync") || command == "EnableWorkerInstanceSync")
      continue;  // no answer is needed, or not sent for one vehicle
    PublishedEnd end(command, "The license does not include hardware in the loop");
    const auto generator = driver(end);
    const std::string error = error_of([&] {
      prepare(*generator, 1);
      generator->start();
      static_cast<void>(generator->state(0));
    });
    EXPECT_THAT(error, HasSubstr(command + ": answered FailureResult: The license does not include hardware in the"))
        << command;
  }
}

}  // namespace
}  // namespace vbar::grand::test
