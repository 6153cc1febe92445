#pragma once
// Events into a file in LCM's log format; lcm-logplayer and lcm_eventlog_read_next_event()
// read it.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace vbar::twins {

class LcmLogWriter {
 public:
  /// Creates or truncates `file`. All functions throw std::runtime_error that names it if it cannot be written.
  explicit LcmLogWriter(const std::filesystem::path& file);

  /// Writes an event; `timestamp` is in microseconds. Events are numbered from 0 on.
  void write(std::int64_t timestamp, const std::string& channel, std::span<const std::uint8_t> data);

  /// Hands all that was written to the operating system.
  void flush();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  void put(std::span<const std::uint8_t> bytes);

  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Closer> stream_;
  std::int64_t events_ = 0;
};

}  // namespace vbar::twins
