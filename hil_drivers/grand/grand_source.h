#pragma once
// Receiver of the testbed as the sensor of its spacecraft calls it: a trajectory sample is sent, bytes are returned.

#include <cstddef>
#include <memory>

#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::grand {

class GrandBench;

class GrandSource final : public twins::gnss::ReceiverBytes {
 public:
  GrandSource(std::shared_ptr<GrandBench> bench, std::size_t vehicle);

  void start(fsw::GpsTime first_epoch) override;
  void stop(twins::StopReason reason) override;
  [[nodiscard]] twins::TruthDetail truth_detail() const override { return twins::TruthDetail::kAccelerations; }
  [[nodiscard]] std::optional<fsw::Duration> call_period() const override;
  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver() const override;
  twins::gnss::ReceiverOutput output_at(const twins::gnss::BodyTruth& truth) override;

 private:
  std::shared_ptr<GrandBench> bench_;
  std::size_t vehicle_;
};

}  // namespace vbar::grand
