#pragma once
// Command interpreter of one port: cuts arbitrary bytes into commands, has them executed, and words the answers. Three
// forms: abbreviated ASCII ("LOG RANGEB ONTIME 1" and a line end), ASCII ("#LOGA,...;...*crc"), binary. For any input,
// memory is bounded by kMaxLine and kMaxBinary.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "emulators/grand/receiver/commands.h"
#include "host_sim/twins/gnss/oem_encoder.h"

namespace vbar::grand::bench {

class Console {
 public:
  static constexpr std::size_t kMaxLine = 512;
  static constexpr std::size_t kMaxBinary = 512;

  struct Receiver {
    std::function<Response(int port, const Command&)> execute;
    std::function<twins::gnss::oem::Header(int port)> header;
    /// Sends an answer, complete.
    std::function<void(int port, std::span<const std::uint8_t>)> answer;
  };
  Console(int port, Receiver receiver) : port_(port), receiver_(std::move(receiver)) {}

  /// Processes bytes that arrived at `now_ns` (local time). An unfinished binary command is given up after a second of
  /// silence.
  void listen(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  void restart();
  /// Returns "[COM1]".
  [[nodiscard]] std::string prompt() const;

  [[nodiscard]] std::uint64_t commands() const { return commands_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  void take(std::uint8_t byte);
  void take_binary(std::uint8_t byte);
  void end_line();
  void take_abbreviated(std::string_view line);
  void take_ascii(std::string_view line);
  void finish_binary();
  Response execute(const ReadCommand& read);
  void answer_text(const std::string& text);

  int port_;
  Receiver receiver_;
  std::string line_;
  bool line_spoilt_ = false;  ///< the line is too long, or has bytes that are not text
  bool after_carriage_return_ = false;
  std::vector<std::uint8_t> binary_;
  std::int64_t last_byte_ns_ = 0;
  std::uint64_t commands_ = 0;
  std::uint64_t refused_ = 0;
};

/// Returns "#NAMEA,COM1,...;" and CRC around the fields of a log or an answer, with line end.
std::string ascii_message(std::string_view name, int port, const twins::gnss::oem::Header& header,
                          std::string_view fields);

}  // namespace vbar::grand::bench
