#pragma once
// Command port of one NovAtel receiver: finds its rate, configures it with every answer checked, and reads its bytes
// from then on. The port is opened again after a loss.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil_drivers/grand/receiver_port/command_answer.h"
#include "hil_drivers/grand/receiver_port/configuration.h"
#include "host_sim/io/serial_line.h"

namespace vbar::grand {

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
  std::unique_ptr<io::SerialLine> line_;
  Bytes inbox_;            ///< bytes since the last command, or since the first log
  std::size_t asked_ = 0;  ///< begin of the answers to the last command, in inbox_
};

}  // namespace vbar::grand
