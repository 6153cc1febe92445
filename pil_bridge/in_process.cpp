#include "pil_bridge/in_process.h"

#include <chrono>
#include <cstring>
#include <new>
#include <utility>

#include "boards/common/outbox.h"
#include "fsw/packets/messages.h"

namespace vbar::pil {
namespace {

/// Memory for the state of a test article, zeroed as a board zeroes it.
class StateMemory {
 public:
  StateMemory(std::size_t size, std::size_t alignment)
      : alignment_(alignment), bytes_(::operator new(size, std::align_val_t(alignment))) {
    std::memset(bytes_, 0, size);
  }
  ~StateMemory() { ::operator delete(bytes_, std::align_val_t(alignment_)); }
  StateMemory(const StateMemory&) = delete;
  StateMemory& operator=(const StateMemory&) = delete;
  [[nodiscard]] void* get() const { return bytes_; }

 private:
  std::size_t alignment_;
  void* bytes_;
};

class InProcess final : public FlightComputer {
 public:
  InProcess(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft)
      : article_(std::move(article)), state_(article_->state_size(), article_->state_alignment()) {
    const vbar_status status = article_->init(state_.get(), spacecraft, &InProcess::sink, this);
    if (status != 0) {
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' refused to start: status " + std::to_string(status));
    }
  }

  StepResult step(std::uint32_t /*step*/, std::span<const Packet> packets) override {
    if (packets.empty()) throw FlightComputerError("a step needs at least its tick");
    const auto start = std::chrono::steady_clock::now();
    for (const Packet& packet : packets) {
      // Packets refused by the flight software are in its own counters.
      (void)article_->receive(state_.get(), packet.data(), packet.size());
    }
    StepResult result;
    const auto last = fsw::packets::parse_packet(packets.back());
    if (last.ok() && fsw::packets::decode<vbar::tick>(last.value()).ok()) {
      result.status = article_->step(state_.get(), last.value().header.time.ns);
    }
    for (std::uint16_t i = 0; i < outbox_.count(); ++i) {
      const auto packet = outbox_.packet(i);
      result.packets.emplace_back(packet.begin(), packet.end());
    }
    outbox_.clear();
    result.compute_wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  [[nodiscard]] std::vector<std::uint8_t> snapshot() override {
    if (article_->save == nullptr) return {};
    std::vector<std::uint8_t> bytes(article_->snapshot_size());
    if (article_->save(state_.get(), bytes.data(), bytes.size()) != 0) return {};
    return bytes;
  }

  void restore(std::span<const std::uint8_t> snapshot) override {
    if (article_->restore == nullptr) return FlightComputer::restore(snapshot);
    const vbar_status status = article_->restore(state_.get(), snapshot.data(), snapshot.size());
    if (status != 0) {
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' refused the snapshot: status " + std::to_string(status));
    }
  }

  [[nodiscard]] LinkStatistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return std::string("in process: ") + article_->name(); }
  void close() override {}

 private:
  static void sink(void* context, const std::uint8_t* packet, std::size_t size) {
    // Packets that do not fit are dropped, as on a board.
    (void)static_cast<InProcess*>(context)->outbox_.append({packet, size});
  }

  std::shared_ptr<const TestArticle> article_;
  StateMemory state_;
  boards::Outbox outbox_;
};

}  // namespace

std::unique_ptr<FlightComputer> make_in_process(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft) {
  return std::make_unique<InProcess>(std::move(article), spacecraft);
}

}  // namespace vbar::pil
