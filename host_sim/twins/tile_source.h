#pragma once
// Image tiles that a log holds in another form.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/twins/packet_log.h"

namespace vbar::twins {

/// Restores the tiles. A camera provides it (camera/logged_image.h).
class TileSource {
 public:
  TileSource() = default;
  TileSource(const TileSource&) = delete;
  TileSource& operator=(const TileSource&) = delete;
  virtual ~TileSource() = default;

  /// Returns the packets of a run. Throws DamagedLog for a damaged recording and std::runtime_error for a run that
  /// cannot be restored; the message names file and image.
  virtual std::vector<Packet> packets_of(const TileRun& run) = 0;

  /// Returns the times of all exposures of which the log holds recipe or recording.
  [[nodiscard]] virtual std::vector<fsw::GpsTime> exposures() const = 0;
  /// Return what the log holds of the exposure.
  [[nodiscard]] virtual std::optional<LoggedImage> recipe_at(fsw::GpsTime exposure) const = 0;
  [[nodiscard]] virtual std::optional<LoggedImage> recording_at(fsw::GpsTime exposure) const = 0;
};

/// Makes a TileSource from the images of a log. Throws DamagedLog.
using MakeTileSource = std::function<std::unique_ptr<TileSource>(ImagesOfLog&&)>;

}  // namespace vbar::twins
