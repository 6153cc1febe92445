#pragma once
// The life of a run's sources: started before it, stopped after it, however it ends.

#include <span>
#include <string>

#include "host_sim/app/simulation.h"

namespace vbar::app {

class StartedSources {
 public:
  /// Starts none yet. `sources` must outlive this.
  explicit StartedSources(std::span<const Source> sources) : sources_(sources) {}
  /// Stops what is still started.
  ~StartedSources() { stop(twins::StopReason::kInterrupted); }
  StartedSources(const StartedSources&) = delete;
  StartedSources& operator=(const StartedSources&) = delete;

  /// Starts those that are not, in order. If one refuses, all that were started, that one included, are stopped, and
  /// std::runtime_error says which and why.
  void start(fsw::GpsTime first_epoch);

  /// Stops those that were started, the last first, even if one of them throws: its name and reason are returned, empty
  /// if all went well.
  std::string stop(twins::StopReason reason);

 private:
  std::span<const Source> sources_;
  std::size_t started_ = 0;  ///< from the first
};

}  // namespace vbar::app
