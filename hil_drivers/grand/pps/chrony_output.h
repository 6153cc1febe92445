#pragma once
// Output of PPS edges to chronyd's reference clock SOCK, so that an independent program can judge them. The datagram is
// chrony's struct sock_sample in the byte order and type sizes of this computer, 40 bytes.

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

inline constexpr std::size_t kChronySampleBytes = 40;

/// Returns a sample that states: at `realtime` of the system's clock, a whole second of the reference began (the
/// nearest one).
[[nodiscard]] std::array<std::uint8_t, kChronySampleBytes> chrony_sample(engine::WallClock::Span realtime);

class ChronyOutput {
 public:
  /// `path` is the socket of chronyd's `refclock SOCK`. Throws std::runtime_error for a path that cannot be a socket's.
  explicit ChronyOutput(const std::string& path);
  ~ChronyOutput();
  ChronyOutput(const ChronyOutput&) = delete;
  ChronyOutput& operator=(const ChronyOutput&) = delete;

  /// Sends the edge. Does not wait, and does not fail if no chronyd is listening.
  void forward(const Edge& edge);

  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::uint64_t sent_ = 0;
};

}  // namespace vbar::grand
