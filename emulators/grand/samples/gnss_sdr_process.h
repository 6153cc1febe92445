#pragma once
// Configuration of gnss-sdr (0.0.17) for a receiver in a low orbit on the samples of ../baseband.h.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/io/child_process.h"
#include "host_sim/io/file_descriptor.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::grand::bench {

struct GnssSdrConfiguration {
  std::filesystem::path samples{};   ///< FIFO
  std::filesystem::path output{};    ///< directory of its files
  std::int64_t rate_hz = 2'600'000;  ///< rate of the samples
  int channels = 10;
  int observable_interval_ms = 20;
  bool rinex = false;                 ///< observations once a second
  std::uint16_t monitor_port = 0;     ///< UDP on 127.0.0.1, observables; 0: none
  std::uint16_t navigation_port = 0;  ///< UDP on 127.0.0.1, subframes; 0: none
};

/// Returns the text of the file.
std::string text_of(const GnssSdrConfiguration& configuration);

/// Loops of that configuration once bits are synchronised, for the formulas of signal_noise. gnss-sdr's correlators are
/// a quarter of a chip apart, 2.5 times the spacing that those formulas assume for L1: the bandwidth is larger by this
/// factor.
inline constexpr twins::gnss::TrackingSettings kGnssSdrTracking{
    .code_loop_bandwidth_hz = 0.5 * 2.5, .carrier_loop_bandwidth_hz = 15.0, .integration_s = 0.010};

// gnss-sdr as a child process: samples are written to a FIFO, datagrams are received on the loopback interface.

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
