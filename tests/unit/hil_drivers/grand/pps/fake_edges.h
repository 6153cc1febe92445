#pragma once
// A host's clock on which time passes only when somebody sleeps, and edges beside it.

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

using Span = engine::WallClock::Span;

class FakeHost final : public engine::WallClock {
 public:
  explicit FakeHost(Span& time) : time_(time) {}
  Span now() override { return time_; }
  void sleep_until(Span wake) override {
    if (wake > now()) time_ = wake;
  }

 private:
  Span& time_;
};

/// Edges become visible when the host's time has reached them.
class FakeEdges final : public EdgeSource {
 public:
  FakeEdges(const Span& time, std::deque<Edge>& edges) : time_(time), edges_(edges) {}
  std::optional<Edge> next(std::chrono::steady_clock::time_point /*deadline*/) override {
    if (edges_.empty() || (edges_.front().monotonic > time_ && !future_)) return std::nullopt;
    const Edge edge = edges_.front();
    edges_.pop_front();
    return edge;
  }
  [[nodiscard]] std::string description() const override { return "fake edges"; }
  bool future_ = false;

 private:
  const Span& time_;
  std::deque<Edge>& edges_;
};

}  // namespace vbar::grand
