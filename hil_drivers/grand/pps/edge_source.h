#pragma once
// Sources of the edges of a 1PPS. A kind of source is a class of its own and one line in the list of
// edge_source_kinds().

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/clock.h"

namespace vbar::grand {

struct Edge {
  std::optional<fsw::GpsTime> gps = std::nullopt;  ///< label, if the source labels its edges; a whole second
  engine::WallClock::Span monotonic{0};            ///< CLOCK_MONOTONIC (std::chrono::steady_clock) at the edge
  std::uint32_t count = 0;                         ///< number given by the source
};

class EdgeSource {
 public:
  EdgeSource() = default;
  EdgeSource(const EdgeSource&) = delete;
  EdgeSource& operator=(const EdgeSource&) = delete;
  virtual ~EdgeSource() = default;

  /// Returns the next edge; empty if there is none by `deadline`. With a deadline that has passed, returns at once an
  /// edge that has been waiting, or nothing. Throws std::runtime_error, one sentence with the device, if the source has
  /// failed.
  virtual std::optional<Edge> next(std::chrono::steady_clock::time_point deadline) = 0;

  /// Returns "socket:/run/bench/pps.sock".
  [[nodiscard]] virtual std::string description() const = 0;
  /// Number of datagrams that were not edges.
  [[nodiscard]] virtual std::uint64_t malformed() const { return 0; }
};

struct EdgeSourceKind {
  std::string_view name;  ///< text before the colon in a mission
  std::string_view form;  ///< as shown to users: "kernel:DEVICE"
  bool has_device = false;
  /// Opens a source. `device` is the text after the colon. Throws std::runtime_error.
  std::unique_ptr<EdgeSource> (*make)(const std::string& device);
};

/// Returns all kinds of this program.
[[nodiscard]] std::span<const EdgeSourceKind* const> edge_source_kinds();

/// Returns the kind of "kernel:/dev/pps0"; null if the name is unknown, or the device is missing or superfluous.
[[nodiscard]] const EdgeSourceKind* find_edge_source(std::string_view text);

/// Opens the source. Throws std::runtime_error; for an unknown source with the list of the known ones.
[[nodiscard]] std::unique_ptr<EdgeSource> make_edge_source(std::string_view text);

/// Returns "kernel:DEVICE", "socket:PATH", "timer".
[[nodiscard]] std::string edge_source_forms();

// Edges that the kernel has time-stamped at a PPS device (RFC 2783).

extern const EdgeSourceKind kKernelEdges;  ///< "kernel:/dev/pps0"

// Edges that the emulator announces on a Unix datagram socket (../wire/pps_datagram.h).

extern const EdgeSourceKind kSocketEdges;  ///< "socket:/run/bench/pps.sock"

// Edges every second of the host's own clock, for a testbed without a PPS line.

extern const EdgeSourceKind kTimerEdges;  ///< "timer"

}  // namespace vbar::grand
