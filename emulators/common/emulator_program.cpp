#include "emulators/common/emulator_program.h"

#include <csignal>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <boost/asio/buffer.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hil_drivers/wire/emulator_files.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::emulators {

namespace {

std::filesystem::path existing(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory))
    throw std::runtime_error(fmt::format("{}: this directory cannot be made: {}", directory.string(), error.message()));
  return std::filesystem::absolute(directory);
}

}  // namespace

EmulatorDirectory::EmulatorDirectory(const std::filesystem::path& directory) : path_(existing(directory)) {}

EmulatorDirectory::~EmulatorDirectory() {
  std::error_code ignored;
  std::filesystem::remove(path_ / wire::kAddressesFile, ignored);
}

void EmulatorDirectory::write_addresses(const std::string& json) const {
  const std::filesystem::path file = path_ / wire::kAddressesFile;
  const std::filesystem::path partial = file.string() + ".partial";
  std::ofstream out(partial);
  out << json << "\n";
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", partial.string()));
  std::filesystem::rename(partial, file);
}

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

namespace {

enum ExitCode { kDone = 0, kFailed = 1, kRefused = 2, kFaultExit = 3 };

int complain(std::string_view program, const std::exception& error, ExitCode code) {
  files::print_error(program, error.what());
  return code;
}

}  // namespace

int run_emulator(std::string_view program,
                 const std::function<std::shared_ptr<void>(boost::asio::io_context& context)>& make) {
  try {
    boost::asio::io_context context(1);
    boost::asio::signal_set signals(context, SIGINT, SIGTERM, SIGHUP);
    signals.async_wait([&](const boost::system::error_code&, int) { context.stop(); });
    std::signal(SIGPIPE, SIG_IGN);
    const ParentWatch watch(context);
    const std::shared_ptr<void> emulator = make(context);
    context.run();
    return kDone;
  } catch (const mission::MissionError& error) {
    return complain(program, error, kRefused);
  } catch (const std::exception& error) {
    return complain(program, error, kFailed);
  }
}

void exit_by_fault() {
  std::_Exit(kFaultExit);
}

}  // namespace vbar::emulators
