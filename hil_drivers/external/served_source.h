#pragma once
// A PacketSource of this program at the other end of the exchange: vbar's own twin as a sensor in another process.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hil_drivers/external/exchange.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::external {

class ServedSource {
 public:
  /// The source of a name and a seed. Throws std::runtime_error if there is none.
  using Make = std::function<std::unique_ptr<twins::PacketSource>(const Opening&)>;

  ServedSource(Make make, SpacecraftNumbers numbers) : make_(std::move(make)), numbers_(std::move(numbers)) {}
  ~ServedSource();
  ServedSource(const ServedSource&) = delete;
  ServedSource& operator=(const ServedSource&) = delete;

  /// The answer to a batch, pending packets included. Throws std::runtime_error for one that is no batch, or that has
  /// no truth, and what the source throws.
  std::vector<twins::Packet> answer(std::span<const twins::Packet> batch);

 private:
  void start(const Batch& batch);
  [[nodiscard]] Answer measure(const Batch& batch);

  Make make_;
  SpacecraftNumbers numbers_;
  std::unique_ptr<twins::PacketSource> source_;
};

}  // namespace vbar::external
