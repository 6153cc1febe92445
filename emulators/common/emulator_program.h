#pragma once
// What the programs of all emulated testbeds share: their directory with the list of addresses, their event loop, their
// end.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

namespace vbar::emulators {

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

/// Watches the parent, which an emulator does not outlive: ends the event loop when that process has ended, and when a
/// pipe on standard input is closed by its other end.
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

/// Runs the emulator that `make` returns until a signal or the end of the parent stops its event loop. Returns the exit
/// code of the program: 2 for an invalid file or assignment, 1 for another error, with one line on standard error.
[[nodiscard]] int run_emulator(std::string_view program,
                               const std::function<std::shared_ptr<void>(boost::asio::io_context& context)>& make);

/// Ends the program at once, as a fault of the emulated testbed does.
[[noreturn]] void exit_by_fault();

}  // namespace vbar::emulators
