#pragma once
// The computer's end of Ethernet KRL for one robot: status, start and stop of RSI, reset, achieved pose. One thread.
// Unsolicited states are kept when they arrive.

#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "hil_drivers/tron/eki/wire/documents.h"
#include "host_sim/io/byte_channel.h"

namespace vbar::tron::eki {

struct ClientSettings {
  std::string name;  ///< name of the device in messages: "camera robot"
  std::string host;
  std::uint16_t port = 54600;
  std::chrono::milliseconds connect_limit{5000};
  std::chrono::milliseconds answer_limit{5000};  ///< wall clock, of what never comes
};

/// States device, address and what was expected, in one sentence.
class EkiError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Client {
 public:
  /// Connects and asks for the state. Throws EkiError.
  explicit Client(const ClientSettings& settings);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  // Sends a command; every command returns the state after it, also if the controller has rejected it (then `message`
  // states why). All throw EkiError: the line is closed, no answer, or a document that cannot be read.

  State status() { return command(Action::kStatus); }
  /// Starts RSI: its datagrams begin at once, so the RSI client must listen.
  State start() { return command(Action::kStart); }
  State stop() { return command(Action::kStop); }
  /// Acknowledges messages and switches the drives on.
  State reset() { return command(Action::kReset); }
  RobotState pose();

  /// Reads unsolicited states that have arrived; never waits.
  void poll();
  /// Returns the last state received, solicited or not.
  [[nodiscard]] const State& last_state() const { return last_; }
  /// Returns the number of unsolicited states received.
  [[nodiscard]] std::uint64_t unsolicited() const { return unsolicited_; }
  [[nodiscard]] const std::string& description() const { return description_; }

 private:
  State command(Action action);
  void send(Action action);
  Reply wait_for_reply(Action action);
  std::optional<Reply> take();
  void read(io::Clock::time_point deadline);
  [[noreturn]] void fail(const std::string& problem) const;

  ClientSettings settings_;
  std::string description_;
  std::unique_ptr<io::ByteChannel> channel_;
  DocumentBuffer documents_;
  State last_;
  std::uint32_t seq_ = 0;
  std::uint64_t unsolicited_ = 0;
};

}  // namespace vbar::tron::eki
