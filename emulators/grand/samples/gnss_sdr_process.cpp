#include "emulators/grand/samples/gnss_sdr_process.h"

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

// Search: +-45 kHz of Doppler in steps of 500 Hz. Tracking: third order, 35 Hz on 1 ms until bits are synchronised,
// then 15 Hz on 10 ms. Position: ranges are used as they are, from satellites at every elevation.
constexpr const char* kConstant = R"(SignalConditioner.implementation=Pass_Through
Channels.in_acquisition=1
Channel.signal=1C
Acquisition_1C.implementation=GPS_L1_CA_PCPS_Acquisition
Acquisition_1C.item_type=gr_complex
Acquisition_1C.coherent_integration_time_ms=1
Acquisition_1C.pfa=0.01
Acquisition_1C.doppler_max=45000
Acquisition_1C.doppler_step=500
Acquisition_1C.blocking=true
Acquisition_1C.max_dwells=2
Tracking_1C.implementation=GPS_L1_CA_DLL_PLL_Tracking
Tracking_1C.item_type=gr_complex
Tracking_1C.order=3
Tracking_1C.pll_bw_hz=35
Tracking_1C.dll_bw_hz=2
Tracking_1C.extend_correlation_symbols=10
Tracking_1C.pll_bw_narrow_hz=15
Tracking_1C.dll_bw_narrow_hz=0.5
Tracking_1C.carrier_aiding=true
TelemetryDecoder_1C.implementation=GPS_L1_CA_Telemetry_Decoder
Observables.implementation=Hybrid_Observables
PVT.implementation=RTKLIB_PVT
PVT.positioning_mode=Single
PVT.output_rate_ms=1000
PVT.display_rate_ms=10000
PVT.rinexobs_rate_ms=1000
PVT.rinex_version=3
PVT.iono_model=OFF
PVT.trop_model=OFF
PVT.elevation_mask=0
PVT.gpx_output_enabled=false
PVT.kml_output_enabled=false
PVT.geojson_output_enabled=false
PVT.xml_output_enabled=false
PVT.nmea_output_file_enabled=false
PVT.rtcm_output_file_enabled=false
)";

}  // namespace

std::string text_of(const GnssSdrConfiguration& configuration) {
  std::string text = "[GNSS-SDR]\n";
  text += fmt::format("GNSS-SDR.internal_fs_sps={}\n", configuration.rate_hz);
  text += fmt::format("GNSS-SDR.observable_interval_ms={}\n", configuration.observable_interval_ms);
  text += "SignalSource.implementation=Fifo_Signal_Source\nSignalSource.sample_type=ibyte\n";
  text += fmt::format("SignalSource.filename={}\n", configuration.samples.string());
  text += fmt::format("Channels_1C.count={}\n", configuration.channels);
  text += kConstant;
  text += fmt::format("PVT.output_path={}\nPVT.rinex_output_enabled={}\n", configuration.output.string(),
                      configuration.rinex);
  if (configuration.monitor_port != 0)
    text += fmt::format(
        "Monitor.enable_monitor=true\nMonitor.decimation_factor=1\nMonitor.client_addresses=127.0.0.1\n"
        "Monitor.udp_port={}\n",
        configuration.monitor_port);
  if (configuration.navigation_port != 0)
    text += fmt::format(
        "NavDataMonitor.enable_monitor=true\nNavDataMonitor.client_addresses=127.0.0.1\nNavDataMonitor.port={}\n",
        configuration.navigation_port);
  return text;
}

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
