#include "hil_drivers/bench_lines/parent_watch.h"

#include <csignal>

#include <boost/asio/buffer.hpp>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace vbar::bench_lines {

ParentWatch::ParentWatch(boost::asio::io_context& context) : context_(context), input_(context) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  struct stat status {};
  if (::fstat(STDIN_FILENO, &status) != 0 || !S_ISFIFO(status.st_mode)) return;
  input_.assign(::dup(STDIN_FILENO));
  read();
}

void ParentWatch::read() {
  input_.async_read_some(boost::asio::buffer(&byte_, 1), [this](const boost::system::error_code& error, std::size_t) {
    if (error) return context_.stop();
    read();
  });
}

}  // namespace vbar::bench_lines
