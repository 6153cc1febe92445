#pragma once
// A receiver of few words: every 100 ms one line with time and number of signals on COM1; every line that it hears is
// answered 20 ms of its time later.

#include <string>

#include <fmt/format.h>

#include "emulators/grand/generator/vehicle.h"

namespace vbar::test {

class FakeReceiver final : public grand::bench::ReceiverEnd {
 public:
  void advance(const grand::bench::RfBlock& block) override {
    pass(grand::bench::RfBlock::kLength);
    if (!on_) return;
    double checksum = 0.0;
    for (const auto& signal : block.signals) checksum += signal.carrier_m.at(0.05);
    out_[0] += fmt::format("{} {} {:.6f}{}\n", block.begin.ns, block.signals.size(), checksum,
                           block.snapped ? " snapped" : "");
  }
  void idle(fsw::Duration span) override { pass(span); }
  [[nodiscard]] bool busy() const override { return !answer_.empty(); }
  void listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud) override {
    for (const std::uint8_t byte : bytes) {
      if (byte != '\n') {
        line_ += static_cast<char>(byte);
        continue;
      }
      if (line_.starts_with("SERIALCONFIG COM1 ")) baud_ = static_cast<unsigned>(std::stoul(line_.substr(18)));
      answer_ += fmt::format("{} at {} on {}\n", line_, host_baud, port);
      line_.clear();
      remaining_ns_ = 20'000'000;
    }
  }
  [[nodiscard]] std::vector<std::uint8_t> speak(std::size_t port, unsigned /*host_baud*/) override {
    const std::string text = std::exchange(out_[port], {});
    return {text.begin(), text.end()};
  }
  [[nodiscard]] unsigned baud(std::size_t /*port*/) const override { return baud_; }
  void power(bool on) override { on_ = on; }
  void set_cn0_offset_db(double offset_db) override { offset_db_ = offset_db; }

  double offset_db_ = 0.0;

 private:
  void pass(fsw::Duration span) {
    remaining_ns_ -= span.ns;
    if (remaining_ns_ > 0) return;
    out_[0] += std::exchange(answer_, {});
  }

  bool on_ = false;
  unsigned baud_ = 115200;
  std::string line_, answer_;
  std::int64_t remaining_ns_ = 0;
  std::array<std::string, 2> out_;
};

inline grand::bench::ReceiverFactory fake_receivers() {
  return
      [](std::size_t, std::shared_ptr<const twins::gnss::Constellation>) { return std::make_unique<FakeReceiver>(); };
}

}  // namespace vbar::test
