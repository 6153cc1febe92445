#pragma once
// Answer of a NovAtel receiver to an abbreviated ASCII command: <OK or <ERROR:text, then its prompt [COM1]. Logs and
// garbage may stand before and between (OEM6 Family Firmware Reference Manual, 1.4 "Responses").

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/io/serial_line.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::grand {

struct CommandAnswer {
  bool is_accepted = false;
  std::string text;  ///< as received, printable: "<OK", "<ERROR:Invalid Message ID"
};

/// Returns the first answer that is complete in `bytes`; nothing if there is none yet.
[[nodiscard]] std::optional<CommandAnswer> find_answer(std::span<const std::uint8_t> bytes);

/// Returns the name of the port in the last prompt: "COM1"; nothing if there is none.
[[nodiscard]] std::optional<std::string> find_prompt(std::span<const std::uint8_t> bytes);

/// Returns at most `limit` bytes in printable form, other bytes as \xNN, for messages.
[[nodiscard]] std::string printable(std::span<const std::uint8_t> bytes, std::size_t limit = 60);

// Commands that configure a NovAtel OEM628 for a run (OEM6 Family Firmware Reference Manual).

struct ReceiverConfiguration {
  unsigned baud = 115200;
  twins::gnss::StartMode start = twins::gnss::StartMode::kWarm;
  fsw::GpsTime approximate_time;  ///< time of the first epoch
  fsw::Vector3 approximate_position_ecef_m = fsw::Vector3::Zero();
  bool clock_adjust = true;
  double period_s = 10.0;     ///< period of RANGE, BESTXYZ and TIME
  double log_offset_s = 0.0;  ///< offset of these logs in GPS time, below the period
  /// Receiver's second port to which the logs go, "COM2"; empty: none.
  std::string board_port = {};
};

/// Returns the rates of a port in the order of search: the configured one, the factory's, the others.
[[nodiscard]] std::vector<unsigned> rates_to_ask(unsigned configured);

/// Returns the command that changes the rate; the answer may come at the old or the new rate.
[[nodiscard]] std::string rate_command(unsigned baud);

/// Returns the commands after a cold start and the change of the rate, in this order.
[[nodiscard]] std::vector<std::string> configuration_commands(const ReceiverConfiguration& configuration);

// Command port of one NovAtel receiver: finds its rate, configures it with every answer checked, and reads its bytes
// from then on. The port is opened again after a loss.

/// Error of a receiver: one sentence with port, command and answer.
class ReceiverRefusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Limits of the time for answers.
struct Patience {
  std::chrono::milliseconds probe{1000};  ///< limit of the question at one rate
  std::chrono::milliseconds answer{2000};
  std::chrono::milliseconds restart{15000};  ///< from RESET until a receiver answers again
  int attempts = 3;                          ///< attempts of a command without answer, and rounds of all rates
};

/// Time in which answers are awaited: by default the host's. In lock-step a receiver answers only as simulated time
/// advances.
struct PortTime {
  using Point = io::Clock::time_point;
  std::function<Point()> now = {};
  /// Waits; returns at `deadline` or earlier.
  std::function<void(Point deadline)> wait = {};
  /// Called often: true ends the search with ReceiverRefusal.
  std::function<bool()> abandoned = {};
};

class ReceiverPort {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// Records every byte received, as it came. May be empty.
  using Keep = std::function<void(std::span<const std::uint8_t>)>;

  ReceiverPort(std::string spacecraft, std::string device, ReceiverConfiguration configuration, Keep keep,
               Patience patience = {});

  /// Opens the device, finds the rate and configures. `with_restart`: the receiver is restarted (RESET) if the run
  /// begins with a cold start; a receiver that is connected again is not restarted. Afterwards logs come. Throws
  /// ReceiverRefusal, and io::ChannelError if the device cannot be opened or hangs up.
  void open(bool with_restart, const PortTime& time = {});

  void close() { line_.reset(); }
  void set_patience(const Patience& patience) { patience_ = patience; }
  [[nodiscard]] bool is_open() const { return line_ != nullptr; }

  /// Appends the bytes that have arrived since the last call, from the first log on. Throws io::ChannelError if the
  /// line hangs up, after appending the bytes before; the port is closed then.
  void read(Bytes& bytes);

  [[nodiscard]] const std::string& device() const { return device_; }
  [[nodiscard]] const std::string& spacecraft() const { return spacecraft_; }
  /// Returns true once the receiver has named itself an emulation, in the VERSION log that open() asks for.
  [[nodiscard]] bool is_emulated() const { return is_emulated_; }
  /// Receiver's own name of the port ("COM1"), once it has prompted; until then empty.
  [[nodiscard]] const std::string& port_name() const { return port_name_; }

 private:
  using Deadline = io::Clock::time_point;

  [[nodiscard]] Deadline now() const { return time_.now ? time_.now() : io::Clock::now(); }

  void find_rate();
  [[nodiscard]] bool answers_at(unsigned baud);
  void restart();
  void set_rate();
  void command(const std::string& text);
  [[nodiscard]] std::optional<CommandAnswer> ask(const std::string& text, std::chrono::milliseconds limit);
  void receive(Deadline deadline);
  void take_available();
  void write(const std::string& text);
  void wait_until_quiet();
  [[noreturn]] void refuse(const std::string& what) const;

  std::string spacecraft_, device_, port_name_;
  ReceiverConfiguration configuration_;
  Keep keep_;
  Patience patience_;
  PortTime time_;
  bool is_emulated_ = false;
  std::unique_ptr<io::SerialLine> line_;
  Bytes inbox_;            ///< bytes since the last command, or since the first log
  std::size_t asked_ = 0;  ///< begin of the answers to the last command, in inbox_
};

}  // namespace vbar::grand
