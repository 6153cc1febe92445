#pragma once
// Directory in which an emulator makes its lines, and the file that lists their addresses.

#include <filesystem>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

namespace vbar::emulators {

inline constexpr const char* kAddressesFile = "addresses.json";

class EmulatorDirectory {
 public:
  /// Makes the directory if it does not exist. Throws std::runtime_error.
  explicit EmulatorDirectory(const std::filesystem::path& directory);
  /// Removes the list of addresses.
  ~EmulatorDirectory();
  EmulatorDirectory(const EmulatorDirectory&) = delete;
  EmulatorDirectory& operator=(const EmulatorDirectory&) = delete;

  /// Absolute path of the directory.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Writes addresses.json, which appears only when it is complete: a program that waits for the file may read it at
  /// once. Throws std::runtime_error.
  void write_addresses(const std::string& json) const;

 private:
  std::filesystem::path path_;
};

// Watch on the parent: an emulator does not outlive the program that started it.

/// Ends the event loop when the parent process has ended, and when a pipe on standard input is closed by its other end.
class ParentWatch {
 public:
  explicit ParentWatch(boost::asio::io_context& context);
  ParentWatch(const ParentWatch&) = delete;
  ParentWatch& operator=(const ParentWatch&) = delete;

 private:
  void read();

  boost::asio::io_context& context_;
  boost::asio::posix::stream_descriptor input_;
  char byte_ = 0;
};

}  // namespace vbar::emulators
