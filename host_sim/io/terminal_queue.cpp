#include "host_sim/io/terminal_queue.h"

#include <fcntl.h>
#include <poll.h>

namespace vbar::io {

bool TerminalQueue::is_empty() {
  if (device_.empty()) return true;
  if (terminal_.get() < 0)
    terminal_ = FileDescriptor(::open(device_.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (terminal_.get() < 0) return true;
  // Not FIONREAD: poll also moves what the kernel has not yet passed on to the terminal's queue.
  pollfd request{.fd = terminal_.get(), .events = POLLIN, .revents = 0};
  if (::poll(&request, 1, 0) <= 0) return true;
  const bool is_hung_up = (request.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
  if (is_hung_up) terminal_.reset();
  return is_hung_up;
}

}  // namespace vbar::io
