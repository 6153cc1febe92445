#pragma once
// gnss-sdr as a child process: samples are written to a FIFO, datagrams are received on the loopback interface.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil_drivers/grand/bench/samples/gnss_sdr/configuration.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::grand::bench {

class GnssSdrProcess {
 public:
  /// Starts `program` in `directory`, which is made, and removed with the object. Throws std::system_error.
  GnssSdrProcess(const std::string& program, const std::filesystem::path& directory,
                 GnssSdrConfiguration configuration);
  ~GnssSdrProcess();
  GnssSdrProcess(const GnssSdrProcess&) = delete;
  GnssSdrProcess& operator=(const GnssSdrProcess&) = delete;

  /// Queues the samples and writes what the FIFO accepts now. Throws std::runtime_error, one sentence, if the program
  /// has ended or is more than ten seconds behind.
  void write(std::span<const std::int8_t> samples);

  /// Writes what the FIFO accepts now.
  void flush();
  /// Duration of the samples that wait for the FIFO.
  [[nodiscard]] double seconds_behind() const;

  /// Returns the next datagram of either kind, or nothing; valid until the next call.
  std::optional<std::span<const std::uint8_t>> observables();
  std::optional<std::span<const std::uint8_t>> navigation();

 private:
  std::optional<std::span<const std::uint8_t>> receive(const io::FileDescriptor& socket);

  std::string program_;
  std::filesystem::path directory_;
  io::FileDescriptor observables_;
  io::FileDescriptor navigation_;
  io::FileDescriptor fifo_;
  std::int64_t rate_hz_;
  std::deque<std::vector<std::int8_t>> backlog_;
  std::size_t backlog_bytes_ = 0;
  std::size_t front_written_ = 0;
  std::vector<std::uint8_t> datagram_;
  std::optional<io::ChildProcess> process_;
};

}  // namespace vbar::grand::bench
