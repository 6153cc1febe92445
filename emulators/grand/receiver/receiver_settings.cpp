#include "emulators/grand/receiver/receiver_settings.h"

#include <array>

#include "emulators/grand/receiver/serial_line.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::grand::bench {
namespace {

using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::TableReader;

constexpr std::array<std::pair<std::string_view, StoredData>, 3> kStoredData{
    {{"nothing", StoredData::kNothing}, {"almanac", StoredData::kAlmanac}, {"ephemerides", StoredData::kEphemerides}}};

void read_loops(const TableReader& section, LoopSettings& loops) {
  read(section, "carrier_order", 2, 3, loops.carrier_order);
  // Above 20 Hz an update of 10 ms makes the third-order loop unstable.
  read(section, "carrier_bandwidth_hz", from_to(1.0, 20.0), loops.carrier_bandwidth_hz);
  read(section, "code_bandwidth_hz", from_to(0.001, 5.0), loops.code_bandwidth_hz);
  read(section, "code_bandwidth_l2_hz", from_to(0.001, 5.0), loops.code_bandwidth_l2_hz);
  read(section, "smoothing_s", from_to(0.0, 2000.0), loops.smoothing_s);
  read(section, "phase_lock_threshold", from_to(0.0, 0.95), loops.phase_lock_threshold);
  read(section, "code_lock_threshold_dbhz", from_to(0.0, 60.0), loops.code_lock_threshold_dbhz);
  read(section, "code_bias_sigma_m", from_to(0.0, 100.0), loops.code_bias_sigma_m);
}

void read_search(const TableReader& section, SearchSettings& search) {
  read(section, "threshold_dbhz", from_to(0.0, 60.0), search.threshold_dbhz);
  read(section, "engines", 1, 64, search.engines);
  read(section, "sweep_hz_per_s", from_to(1e3, 1e8), search.sweep_hz_per_s);
  read(section, "blind_window_hz", from_to(100.0, 1e5), search.blind_window_hz);
  read(section, "known_window_hz", from_to(100.0, 1e5), search.known_window_hz);
  read(section, "reacquisition_window_hz", from_to(50.0, 1e5), search.reacquisition_window_hz);
}

void read_line(const TableReader& section, LineSettings& line) {
  const std::int64_t baud = section.integer("baud", kBaudRates.front(), kBaudRates.back(), line.baud);
  line.baud = static_cast<unsigned>(baud);
  if (!is_baud_rate(line.baud))
    section.refuse_value("baud",
                         "one of the receiver's rates: 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, "
                         "460800");
  read(section, "buffer_bytes", 1024, 1 << 20, line.buffer_bytes);
  read(section, "computing_ms", from_to(0.0, 1000.0), line.computing_ms);
  read(section, "computing_spread_ms", from_to(0.0, 1000.0), line.computing_spread_ms);
  read(section, "boot_s", from_to(0.0, 60.0), line.boot_s);
  if (line.computing_spread_ms > line.computing_ms)
    section.refuse_value("computing_spread_ms", "at most computing_ms: a log does not precede its epoch");
}

void read_clock(const TableReader& section, twins::gnss::ClockSettings& clock) {
  read(section, "initial_offset_ms", from_to(0.0, 0.5), clock.initial_offset_ms);
  read(section, "initial_drift_sigma_ns_per_s", from_to(0.0, 1e4), clock.initial_drift_sigma_ns_per_s);
  read(section, "h0_s", from_to(0.0, 1e-15), clock.h0_s);
  read(section, "h_minus2_per_s", from_to(0.0, 1e-15), clock.h_minus2_per_s);
  read(section, "jump_threshold_ms", from_to(0.5, 100.0), clock.jump_threshold_ms);
}

}  // namespace

ReceiverSettings read_receiver_settings(const TableReader& section) {
  ReceiverSettings settings;
  read_loops(section.table("loops"), settings.loops);
  read_search(section.table("search"), settings.search);
  read_line(section.table("line"), settings.line);
  read_clock(section.table("clock"), settings.clock);
  read(section, "steering_bandwidth_hz", above_to(0.0, 0.1), settings.steering_bandwidth_hz);
  settings.stored = section.choice<StoredData>("stored", kStoredData, settings.stored);
  read(section, "week_shift", -1024, 2048, settings.week_shift);
  read(section, "time_shift_s", -3600, 3600, settings.time_shift_s);
  return settings;
}

}  // namespace vbar::grand::bench
