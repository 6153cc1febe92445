#pragma once
// The header of an event in LCM's log format, in big-endian order: the channel's name and the data follow it.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbar::twins::lcm_log {

inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
inline constexpr std::size_t kSyncAt = 0;
inline constexpr std::size_t kNumberAt = 4;  ///< number of the event: 8 bytes
inline constexpr std::size_t kTimeAt = 12;   ///< us: 8 bytes
inline constexpr std::size_t kChannelBytesAt = 20;
inline constexpr std::size_t kDataBytesAt = 24;
inline constexpr std::size_t kHeaderBytes = 28;

}  // namespace vbar::twins::lcm_log

namespace vbar::twins {

// Events into a file in LCM's log format; lcm-logplayer and lcm_eventlog_read_next_event()
// read it.

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

// Events of a file in LCM's log format, read defensively: every size is checked against the file before memory is
// allocated for it.

/// Error: the file is not a log, or damaged; the message names file and byte offset.
class DamagedLog : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct LoggedEvent {
  std::uint64_t offset = 0;  ///< offset of its first byte in the file
  std::int64_t number = 0;
  std::int64_t timestamp = 0;  ///< us
  std::string channel;
  std::vector<std::uint8_t> data;
};

class LcmLogReader {
 public:
  /// Throws std::runtime_error that names a file that cannot be read.
  explicit LcmLogReader(const std::filesystem::path& file);

  /// Reads the next event; nothing at the end of the file, or where it ends within an event: then cut_short(). Throws
  /// DamagedLog.
  [[nodiscard]] std::optional<LoggedEvent> next();

  /// Returns whether another event may begin after the byte `offset`: whether a sync word follows.
  [[nodiscard]] bool has_event_after(std::uint64_t offset);

  [[nodiscard]] bool cut_short() const { return cut_short_; }
  /// Returns the offset of the first byte that was not read yet.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  [[noreturn]] void fail(std::uint64_t offset, const std::string& what) const;
  void take_rest_as_cut(std::uint64_t offset);

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0, offset_ = 0;
  bool cut_short_ = false;
};

}  // namespace vbar::twins
