#pragma once
// The far end of a serial line, played by a thread: answers commands as the OEM6 manual describes, at one baud rate.
// Bytes at another rate reach neither side readably.

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "host_sim/io/byte_channel.h"

namespace vbar::grand {

class FakeReceiver {
 public:
  struct Behaviour {
    unsigned baud = 9600;
    /// What it answers to a command that begins so; by default "<OK". "": nothing.
    std::map<std::string, std::string> answers;
    /// Sent on its own after the answer to a command that begins so.
    std::map<std::string, std::vector<std::uint8_t>> logs;
    bool sends_garbage_before_answers = false;
    unsigned baud_after_reset = 9600;
  };

  explicit FakeReceiver(Behaviour behaviour);
  ~FakeReceiver();

  [[nodiscard]] const std::string& device() const { return device_; }
  /// Commands understood so far, without those that ask for the version.
  [[nodiscard]] std::vector<std::string> commands();
  [[nodiscard]] unsigned baud() const { return baud_; }
  void send(const std::vector<std::uint8_t>& bytes);
  void hang_up();
  /// After hang_up(): on another terminal, by the same name.
  void come_back();

 private:
  void serve();
  void hear(std::uint8_t byte);
  void execute(const std::string& command);
  void answer(const std::string& text);
  [[nodiscard]] bool rates_agree() const;

  Behaviour behaviour_;
  std::string directory_, device_;
  io::Pty pty_;
  std::atomic<unsigned> baud_;
  std::atomic<bool> ends_ = false;
  std::mutex mutex_;
  std::string line_;
  std::vector<std::string> commands_;
  std::thread thread_;
};

}  // namespace vbar::grand
