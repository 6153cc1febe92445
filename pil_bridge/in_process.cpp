#include "pil_bridge/in_process.h"

#include <bit>
#include <chrono>
#include <cstring>
#include <new>
#include <utility>

#include "boards/common/outbox.h"
#include "fsw/packets/messages.h"

namespace vbar::pil {
namespace {

constexpr std::size_t kStateBytesMax = std::size_t{1} << 30;
constexpr std::size_t kStateAlignmentMax = 4096;

/// The article; throws FlightComputerError unless it asks for a state that there can be.
std::shared_ptr<const TestArticle> checked(std::shared_ptr<const TestArticle> article) {
  const std::size_t size = article->state_size(), alignment = article->state_alignment();
  const std::string name = "the flight software '" + std::string(article->name()) + "' asks for a state ";
  if (size > kStateBytesMax)
    throw FlightComputerError(name + "of " + std::to_string(size) + " bytes (vbar_gnc_state_size); accepted: up to " +
                              std::to_string(kStateBytesMax));
  if (!std::has_single_bit(alignment) || alignment > kStateAlignmentMax)
    throw FlightComputerError(name + "that is aligned to " + std::to_string(alignment) +
                              " bytes (vbar_gnc_state_alignment); accepted: powers of two from 1 to " +
                              std::to_string(kStateAlignmentMax));
  return article;
}

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
      : article_(checked(std::move(article))), state_(article_->state_size(), article_->state_alignment()) {
    const vbar_status status = article_->init(state_.get(), spacecraft, &InProcess::sink, this);
    if (status != 0) {
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' refused to start: status " + std::to_string(status));
    }
  }

  StepResult step(std::uint32_t /*step*/, std::span<const Packet> packets) override {
    if (packets.empty()) throw FlightComputerError("a step needs at least its tick");
    const auto start = std::chrono::steady_clock::now();
    StepResult result;
    for (const Packet& packet : packets) {
      if (article_->receive(state_.get(), packet.data(), packet.size()) != 0) ++result.trouble.inputs_refused;
    }
    const auto last = fsw::packets::parse_packet(packets.back());
    if (last.ok() && fsw::packets::decode<vbar::tick>(last.value()).ok())
      result.trouble.status = article_->step(state_.get(), last.value().header.time.ns);
    for (std::uint16_t i = 0; i < outbox_.count(); ++i) {
      const auto packet = outbox_.packet(i);
      result.packets.emplace_back(packet.begin(), packet.end());
    }
    outbox_.clear();
    result.trouble.packets_dropped = std::exchange(dropped_, 0);
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
    auto* const computer = static_cast<InProcess*>(context);
    if (!computer->outbox_.append({packet, size})) ++computer->dropped_;
  }

  std::shared_ptr<const TestArticle> article_;
  StateMemory state_;
  boards::Outbox outbox_;
  std::uint32_t dropped_ = 0;  ///< packets, since the last answer
};

}  // namespace

std::unique_ptr<FlightComputer> make_in_process(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft) {
  return std::make_unique<InProcess>(std::move(article), spacecraft);
}

}  // namespace vbar::pil
