// Baseband samples of one of two spacecraft, 8 m apart, for gnss-sdr to receive, and the truth beside them.
//
//   vbar_gnss_sdr_tool servicer|target SECONDS SAMPLES TRUTH.csv
//   vbar_gnss_sdr_tool configuration SAMPLES DIRECTORY
//   vbar_gnss_sdr_tool receiver SECONDS DIRECTORY BYTES TRUTH.csv
//
// SAMPLES (a file or a FIFO) gets 8-bit I and Q at 2.6 Msps; TRUTH.csv at each whole second the range of every
// satellite's carrier and code (m), its C/N0 and the antenna (ECEF, m). The second form prints the configuration with
// which gnss-sdr receives SAMPLES and writes RINEX files into DIRECTORY. The third runs gnss-sdr itself, with its files
// in DIRECTORY, and writes what the serial line of the bench's receiver carries: RANGE once a second, RAWEPHEM, IONUTC.

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <Eigen/Dense>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/receiver/receiver.h"
#include "emulators/grand/samples/baseband.h"
#include "emulators/grand/samples/gnss_sdr_measurements.h"
#include "emulators/grand/samples/gnss_sdr_process.h"
#include "fsw/core/types.h"
#include "host_sim/io/file_descriptor.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/signal_path.h"
#include "host_sim/twins/gnss/tracking.h"
#include "tests/support/gnss_scene.h"

namespace vbar::test {
namespace {

// What the RF outputs of a generator radiate for antennas on the test orbit (tests/support/gnss_scene.h): the digital
// twin's path, ionosphere, clock errors and power of GPS L1, with quintics through six points of each 100 ms.

class SkyInOrbit {
 public:
  explicit SkyInOrbit(std::shared_ptr<const twins::gnss::Constellation> constellation,
                      const fsw::Vector3& offset_rtn_m);

  /// The block that begins number * 100 ms after kGnssStart.
  grand::bench::RfBlock block(int number);

  /// The antenna, ECEF.
  [[nodiscard]] fsw::Vector3 antenna_ecef(double t_s) const;

 private:
  struct Ranges {
    double carrier_m = 0.0, code_m = 0.0, cn0_dbhz = 0.0;
    bool visible = false;
  };
  [[nodiscard]] Ranges ranges(std::size_t index, double t_s) const;

  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  fsw::Vector3 offset_rtn_m_;
  twins::gnss::GnssReceiverSettings settings_;
  twins::gnss::AntennaPattern pattern_;
};

using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;
using grand::bench::RangePolynomial;
using grand::bench::RfBlock;
using grand::bench::RfSignal;
using twins::gnss::Signal;
using twins::gnss::System;

constexpr int kNodes = 6;
constexpr double kBlock_s = 0.1;
constexpr double kSpacing_s = kBlock_s / (kNodes - 1);

using Nodes = Eigen::Matrix<double, kNodes, 1>;

// Through values at the nodes: the differences against the first value are interpolated, which keeps the digits.
RangePolynomial through(const Nodes& values) {
  static const Eigen::Matrix<double, kNodes, kNodes> kInverse = [] {
    Eigen::Matrix<double, kNodes, kNodes> powers;
    for (int row = 0; row < kNodes; ++row)
      for (int column = 0; column < kNodes; ++column) powers(row, column) = std::pow(row, column);
    return Eigen::Matrix<double, kNodes, kNodes>(powers.inverse());
  }();
  const Nodes scaled = kInverse * (values.array() - values[0]).matrix();
  RangePolynomial polynomial;
  double unit = 1.0;
  for (int k = 0; k < kNodes; ++k) {
    polynomial.coefficients[static_cast<std::size_t>(k)] = scaled[k] / unit;
    unit *= kSpacing_s;
  }
  polynomial.coefficients[0] += values[0];
  return polynomial;
}

SkyInOrbit::SkyInOrbit(std::shared_ptr<const twins::gnss::Constellation> constellation, const Vector3& offset_rtn_m)
    : constellation_(std::move(constellation)),
      offset_rtn_m_(offset_rtn_m),
      pattern_(twins::gnss::AntennaPattern::load(data_directory())) {}

Vector3 SkyInOrbit::antenna_ecef(double t_s) const {
  const BodyTruth body = in_orbit(t_s, offset_rtn_m_);
  return body.R_ecef_eci * body.position_eci;
}

SkyInOrbit::Ranges SkyInOrbit::ranges(std::size_t index, double t_s) const {
  const BodyTruth body = in_orbit(t_s, offset_rtn_m_);
  twins::gnss::AntennaState antenna;
  antenna.time = kGnssStart;
  antenna.offset_s = t_s;
  antenna.position_ecef = body.R_ecef_eci * body.position_eci;
  antenna.boresight_ecef = antenna.position_ecef.normalized();
  const auto path = visible_path(*constellation_, index, antenna, settings_.visibility);
  if (!path) return {};
  const double ionosphere_m =
      klobuchar_delay_in_orbit_m(constellation_->corrections().klobuchar, antenna.position_ecef, path->line_of_sight,
                                 week_time(System::kGps, kGnssStart).seconds_of_week() + t_s);
  const double common_m = path->range_m + path->shapiro_m - kSpeedOfLight * path->satellite_clock_s;
  const double attenuation_db = pattern_.attenuation_db(path->line_of_sight.dot(antenna.boresight_ecef));
  return {.carrier_m = common_m - ionosphere_m,
          .code_m = common_m + ionosphere_m + kSpeedOfLight * constellation_->group_delay_s(index),
          .cn0_dbhz = carrier_to_noise_dbhz(settings_.link_budget, Signal::kGpsL1, path->range_m, attenuation_db),
          .visible = true};
}

RfBlock SkyInOrbit::block(int number) {
  const double begin_s = kBlock_s * number;
  RfBlock block{.begin = kGnssStart + fsw::nearest_duration(begin_s), .snapped = false, .signals = {}};
  for (std::size_t index = 0; index < constellation_->size(); ++index) {
    if (constellation_->id(index).system != System::kGps) continue;
    Nodes carrier_m;
    Nodes code_m;
    Ranges at;
    for (int node = 0; node < kNodes; ++node) {
      at = ranges(index, begin_s + kSpacing_s * node);
      if (!at.visible) break;
      carrier_m[node] = at.carrier_m;
      code_m[node] = at.code_m;
    }
    if (!at.visible) continue;
    RfSignal& signal = block.signals.emplace_back();
    signal.satellite = constellation_->id(index);
    signal.carrier_m = through(carrier_m);
    signal.code_m = through(code_m);
    signal.cn0_dbhz = at.cn0_dbhz;
  }
  return block;
}

}  // namespace
}  // namespace vbar::test

namespace {

using namespace vbar;

constexpr std::uint64_t kSeed = 11;
constexpr int kBlocksPerSecond = 10;
constexpr const char* kTruthHeader =
    "time_of_week_s,satellite,carrier_m,code_m,cn0_dbhz,antenna_x,antenna_y,antenna_z\n";
// The arc begins here on the test orbit: eight satellites above 41 dB-Hz, seven with Dopplers within 20 kHz.
constexpr int kBegin_s = 2160;

void write_all(int descriptor, std::span<const std::int8_t> samples) {
  std::size_t written = 0;
  while (written < samples.size()) {
    const ssize_t count = ::write(descriptor, samples.data() + written, samples.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::runtime_error(fmt::format("samples cannot be written: {}", std::strerror(errno)));
    written += static_cast<std::size_t>(count);
  }
}

void write_truth(std::ofstream& truth, int second, const grand::bench::RfBlock& block, const fsw::Vector3& antenna) {
  const double seconds_of_week =
      twins::gnss::week_time(twins::gnss::System::kGps, test::kGnssStart).seconds_of_week() + kBegin_s + second;
  for (const grand::bench::RfSignal& signal : block.signals)
    truth << fmt::format("{:.0f},{},{:.6f},{:.6f},{:.3f},{:.6f},{:.6f},{:.6f}\n", seconds_of_week,
                         name_of(signal.satellite), signal.carrier_m.at(0.0), signal.code_m.at(0.0), signal.cn0_dbhz,
                         antenna.x(), antenna.y(), antenna.z());
}

int run(const std::string& name, int seconds, const char* samples_file, const char* truth_file) {
  const auto constellation = test::constellation(kSeed);
  const fsw::Vector3 offset_rtn_m = name == "target" ? fsw::Vector3(1.2, -7.9, 0.5) : fsw::Vector3::Zero();
  test::SkyInOrbit sky(constellation, offset_rtn_m);
  grand::bench::Baseband baseband({}, constellation, kSeed, name);
  std::ofstream truth(truth_file);
  truth << kTruthHeader;
  const io::FileDescriptor output(::open(samples_file, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (output.get() < 0) throw std::runtime_error(fmt::format("{}: {}", samples_file, std::strerror(errno)));
  for (int number = 0; number < kBlocksPerSecond * seconds; ++number) {
    const grand::bench::RfBlock block = sky.block(kBlocksPerSecond * kBegin_s + number);
    const int second = number / kBlocksPerSecond;
    if (number % kBlocksPerSecond == 0) write_truth(truth, second, block, sky.antenna_ecef(kBegin_s + second));
    write_all(output.get(), baseband.samples(block));
  }
  if (!truth.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", truth_file));
  return 0;
}

void listen(grand::bench::Receiver& receiver, const std::string& line) {
  const std::string command = line + "\r\n";
  receiver.listen(0, {reinterpret_cast<const std::uint8_t*>(command.data()), command.size()}, receiver.baud(0));
}

// As fast as gnss-sdr takes the samples.
int run_receiver(int seconds, const char* directory, const char* bytes_file, const char* truth_file) {
  const auto constellation = test::constellation(kSeed);
  test::SkyInOrbit sky(constellation, fsw::Vector3::Zero());
  grand::bench::GnssSdrSettings settings;
  settings.directory = directory;
  auto made = std::make_unique<grand::bench::GnssSdrMeasurements>(settings, constellation, kSeed, "servicer");
  grand::bench::GnssSdrMeasurements& measurements = *made;
  grand::bench::Receiver receiver({}, constellation, kSeed, "servicer", std::move(made));
  std::ofstream truth(truth_file);
  truth << kTruthHeader;
  std::ofstream bytes(bytes_file, std::ios::binary);
  receiver.power(true);
  while (receiver.busy()) {
    receiver.idle(grand::bench::RfBlock::kLength);
    for (int port = 0; port < grand::bench::kReceiverPorts; ++port) static_cast<void>(receiver.speak(port));  // prompts
  }
  for (const char* log : {"LOG COM1 RANGEB ONTIME 1", "LOG COM1 RAWEPHEMB ONCHANGED", "LOG COM1 IONUTCB ONCHANGED"})
    listen(receiver, log);
  for (int number = 0; number < kBlocksPerSecond * seconds; ++number) {
    while (measurements.seconds_behind() > 1.0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const grand::bench::RfBlock block = sky.block(kBlocksPerSecond * kBegin_s + number);
    const int second = number / kBlocksPerSecond;
    if (number % kBlocksPerSecond == 0) write_truth(truth, second, block, sky.antenna_ecef(kBegin_s + second));
    receiver.advance(block);
    for (const std::uint8_t byte : receiver.speak(0)) bytes.put(static_cast<char>(byte));
  }
  if (!truth.flush() || !bytes.flush()) throw std::runtime_error("the receiver's files cannot be written");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "configuration") {
    std::fputs(grand::bench::text_of({.samples = argv[2], .output = argv[3], .rinex = true}).c_str(), stdout);
    return 0;
  }
  const bool is_receiver = argc == 6 && std::string(argv[1]) == "receiver";
  if (argc != 5 && !is_receiver) {
    std::fputs(
        "usage: vbar_gnss_sdr_tool servicer|target SECONDS SAMPLES TRUTH.csv | configuration SAMPLES DIRECTORY | "
        "receiver SECONDS DIRECTORY BYTES TRUTH.csv\n",
        stderr);
    return 2;
  }
  std::signal(SIGPIPE, SIG_IGN);  // the receiver may end first; write() then reports it
  try {
    if (is_receiver) return run_receiver(std::atoi(argv[2]), argv[3], argv[4], argv[5]);
    return run(argv[1], std::atoi(argv[2]), argv[3], argv[4]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
