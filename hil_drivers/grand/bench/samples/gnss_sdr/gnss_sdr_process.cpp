#include "hil_drivers/grand/bench/samples/gnss_sdr/gnss_sdr_process.h"

#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host_sim/io/udp_socket.h"

namespace vbar::grand::bench {
namespace {

constexpr int kPipeBytes = 1 << 20;  // 0.2 s of samples
constexpr std::size_t kMaxDatagram = 65536;
constexpr double kMaxBehind_s = 10.0;
constexpr int kReceiveBuffer_bytes = 1 << 20;

io::FileDescriptor new_fifo(const std::filesystem::path& file) {
  if (::mkfifo(file.c_str(), 0600) != 0) throw std::system_error(errno, std::generic_category(), file.string());
  // Opened for reading too: opening does not wait for the reader, and writing does not fail before it is there.
  io::FileDescriptor fifo(::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (fifo.get() < 0) throw std::system_error(errno, std::generic_category(), file.string());
  ::fcntl(fifo.get(), F_SETPIPE_SZ, kPipeBytes);  // less is allowed: then it is written in smaller parts
  return fifo;
}

io::FileDescriptor bound(std::uint16_t& port) {
  io::BoundUdpSocket socket = io::bind_udp_loopback();
  port = socket.port;
  ::setsockopt(socket.socket.get(), SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer_bytes, sizeof kReceiveBuffer_bytes);
  return std::move(socket.socket);
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace

GnssSdrProcess::GnssSdrProcess(const std::string& program, const std::filesystem::path& directory,
                               GnssSdrConfiguration configuration)
    : directory_(directory), rate_hz_(configuration.rate_hz), datagram_(kMaxDatagram) {
  std::filesystem::remove_all(directory);
  std::filesystem::create_directories(directory);
  configuration.samples = directory / "samples";
  configuration.output = directory;
  observables_ = bound(configuration.monitor_port);
  navigation_ = bound(configuration.navigation_port);
  fifo_ = new_fifo(configuration.samples);
  const std::filesystem::path file = directory / "gnss-sdr.conf";
  write_file(file, text_of(configuration));
  process_.emplace(
      std::vector<std::string>{program, "--config_file=" + file.string(), "--log_dir=" + directory.string()},
      std::vector<io::FileDescriptor>{});
}

GnssSdrProcess::~GnssSdrProcess() {
  process_.reset();
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

void GnssSdrProcess::write(std::span<const std::int8_t> samples) {
  if (process_->has_ended())
    throw std::runtime_error(fmt::format("{} ended ({}); its last words: {}", program_, process_->status_text(),
                                         process_->output_tail(300)));
  if (seconds_behind() > kMaxBehind_s)
    throw std::runtime_error(
        fmt::format("{} is more than {} s behind: this computer is too slow for it", program_, kMaxBehind_s));
  backlog_.emplace_back(samples.begin(), samples.end());
  backlog_bytes_ += samples.size();
  flush();
}

double GnssSdrProcess::seconds_behind() const {
  return static_cast<double>(backlog_bytes_) / static_cast<double>(2 * rate_hz_);
}

void GnssSdrProcess::flush() {
  while (!backlog_.empty()) {
    const std::vector<std::int8_t>& front = backlog_.front();
    const ssize_t count = ::write(fifo_.get(), front.data() + front_written_, front.size() - front_written_);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;  // full
    front_written_ += static_cast<std::size_t>(count);
    backlog_bytes_ -= static_cast<std::size_t>(count);
    if (front_written_ < front.size()) return;
    backlog_.pop_front();
    front_written_ = 0;
  }
}

std::optional<std::span<const std::uint8_t>> GnssSdrProcess::receive(const io::FileDescriptor& socket) {
  const ssize_t count = ::recv(socket.get(), datagram_.data(), datagram_.size(), MSG_DONTWAIT);
  if (count < 0) return std::nullopt;
  return std::span<const std::uint8_t>(datagram_).first(static_cast<std::size_t>(count));
}

std::optional<std::span<const std::uint8_t>> GnssSdrProcess::observables() {
  return receive(observables_);
}
std::optional<std::span<const std::uint8_t>> GnssSdrProcess::navigation() {
  return receive(navigation_);
}

}  // namespace vbar::grand::bench
