#pragma once
// Watch on the parent: an emulator does not outlive the program that started it.

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

namespace vbar::bench_lines {

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

}  // namespace vbar::bench_lines
