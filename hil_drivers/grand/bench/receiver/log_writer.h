#pragma once
// Content of each log at an instant.

#include <optional>
#include <string_view>
#include <vector>

#include "hil_drivers/grand/bench/receiver/log_list.h"
#include "hil_drivers/grand/bench/receiver/measurements.h"
#include "hil_drivers/grand/bench/receiver/serial_line.h"

namespace vbar::grand::bench {

class LogWriter {
 public:
  /// Faults: `week_shift` is added to every week that the receiver reports, `tag_shift` to the time of every header.
  /// All references must outlive the writer.
  LogWriter(const Measurements& engine, const twins::gnss::Constellation& constellation, fsw::Duration week_shift,
            fsw::Duration tag_shift)
      : engine_(engine), constellation_(constellation), week_shift_(week_shift), tag_shift_(tag_shift) {}

  /// Returns the header of a message at this reading.
  [[nodiscard]] twins::gnss::oem::Header header(int port, fsw::GpsTime reading, bool position_valid,
                                                std::uint32_t more_status_bits) const;

  /// Appends the log of an epoch.
  void append_epoch(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header,
                    const EpochData& epoch) const;
  /// Appends every message of the kind that has been received; with `satellite` that of this one only. Nothing for a
  /// satellite of another system.
  void append_messages(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header,
                       std::optional<std::size_t> satellite) const;
  void append_version(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header) const;
  void append_event(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header, unsigned bit,
                    bool set) const;

 private:
  void append_ephemeris(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header,
                        std::size_t satellite) const;

  const Measurements& engine_;
  const twins::gnss::Constellation& constellation_;
  fsw::Duration week_shift_;
  fsw::Duration tag_shift_;
};

}  // namespace vbar::grand::bench
