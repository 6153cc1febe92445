#pragma once
// Server of a PacketSource of this program at the other end of the exchange: vbar's own twin as a sensor in another
// process.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "hil_drivers/external/exchange.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::external {

class ServedSource {
 public:
  /// Makes the source of a name and a seed. Throws std::runtime_error if there is none.
  using Make = std::function<std::unique_ptr<twins::PacketSource>(const Opening&)>;

  explicit ServedSource(Make make) : make_(std::move(make)) {}
  ~ServedSource();
  ServedSource(const ServedSource&) = delete;
  ServedSource& operator=(const ServedSource&) = delete;

  /// Returns the answer to a batch, pending packets included. Throws std::runtime_error for a batch without truth, and
  /// what the source throws.
  std::vector<twins::Packet> answer(const Batch& batch);

 private:
  void start(const Batch& batch);
  [[nodiscard]] Answer measure(const Batch& batch);

  Make make_;
  std::unique_ptr<twins::PacketSource> source_;
};

}  // namespace vbar::external
