#pragma once
// Server of a true world of this program at the other end of the exchange: vbar's own truth model as the truth in
// another process.

#include <functional>
#include <memory>
#include <vector>

#include "hil_drivers/external/exchange.h"
#include "host_sim/twins/true_world.h"

namespace vbar::external {

class ServedTruth {
 public:
  /// Makes the world at the start of the mission.
  using Make = std::function<std::unique_ptr<twins::TrueWorld>()>;

  ServedTruth(Make make, SpacecraftNumbers numbers) : make_(std::move(make)), numbers_(std::move(numbers)) {}

  /// Returns the answer to a batch. Throws std::runtime_error for a batch out of order, and for a start that is not
  /// that of the world, and what the world throws.
  std::vector<twins::Packet> answer(const Batch& batch);

 private:
  void start(const Batch& batch);
  void apply(const Command& command);

  Make make_;
  SpacecraftNumbers numbers_;
  std::unique_ptr<twins::TrueWorld> world_;
};

}  // namespace vbar::external
