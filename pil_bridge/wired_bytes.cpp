#include "pil_bridge/wired_bytes.h"

#include <algorithm>
#include <string>
#include <thread>
#include <utility>

#include "fsw/packets/messages.h"

namespace vbar::pil {
namespace {

/// Time after which an unanswered question is repeated: question or answer was lost on the link.
constexpr std::chrono::milliseconds kAnswerLimit{100};
/// Between two questions: an emulated board needs the time to receive.
constexpr std::chrono::microseconds kBetweenQuestions{500};

/// A flight computer that is slow, because the computer it runs on is busy, is waited for: bytes are missing if it has
/// answered that often since the last ones arrived.
constexpr int kMinAnswers = 20;
/// One that does not answer is not waited for longer than this number of limits.
constexpr int kSilenceLimits = 5;

}  // namespace

WiredBytes::WiredBytes(io::WiredReceiver receiver, std::chrono::milliseconds limit)
    : receiver_(std::move(receiver)),
      under_way_(receiver_.in_lock_step ? receiver_.device : std::string()),
      limit_(limit),
      sent_before_(receiver_.bytes_sent ? receiver_.bytes_sent() : std::uint64_t{0}) {}

void WiredBytes::wait(const AskCount& ask) {
  if (!receiver_.in_lock_step) return;
  Clock::time_point last_answer = Clock::now();
  Clock::time_point last_progress = last_answer;
  for (int answers = 0;;) {
    // Before the question: what had left the terminal by then is included in the answer.
    const bool is_empty = under_way_.is_empty();
    if (const auto count = ask(Clock::now() + kAnswerLimit)) {
      last_answer = Clock::now();
      ++answers;
      if (*count != arrived_) {
        arrived_ = *count;
        last_progress = last_answer;
        answers = 0;
      }
      if (is_empty && difference() <= missing_) break;
    }
    const Clock::time_point now = Clock::now();
    const bool is_stuck = now - last_progress >= limit_ && answers >= kMinAnswers;
    if (is_stuck || now - last_answer >= kSilenceLimits * limit_) {
      ++statistics_.timeouts;
      statistics_.missing += static_cast<std::uint64_t>(std::max<std::int64_t>(difference() - missing_, 0));
      break;
    }
    std::this_thread::sleep_for(kBetweenQuestions);
  }
  missing_ = difference();
}

std::int64_t WiredBytes::difference() const {
  if (!receiver_.bytes_sent) return 0;
  return static_cast<std::int64_t>(receiver_.bytes_sent() - sent_before_) - static_cast<std::int64_t>(arrived_);
}

std::optional<Packet> WiredBytes::take(const Packet& packet) {
  const auto view = fsw::packets::parse_packet(packet);
  if (!view.ok() || view.value().header.apid != fsw::packets::Apid::kWiredBytes) return std::nullopt;
  const auto wired = fsw::packets::decode<vbar::wired_bytes>(view.value());
  if (!wired.ok()) throw LinkError("the flight computer sent a wired_bytes that is not one of this version");
  const vbar::wired_bytes& mirror = wired.value();
  if (mirror.count < 1 || mirror.count > static_cast<std::int32_t>(sizeof mirror.data) || mirror.dropped < 0) {
    throw LinkError("the flight computer sent a wired_bytes with " + std::to_string(mirror.count) + " bytes, " +
                    std::to_string(mirror.dropped) + " dropped");
  }
  statistics_.bytes += static_cast<std::uint64_t>(mirror.count);
  statistics_.dropped = static_cast<std::uint64_t>(mirror.dropped);
  vbar::gnss_bytes input{};
  static_assert(sizeof input.data == sizeof mirror.data);
  input.count = mirror.count;
  std::copy_n(mirror.data, sizeof mirror.data, input.data);
  Packet bytes(fsw::packets::kMaxPacketBytes);
  bytes.resize(fsw::packets::encode(view.value().header, input, bytes).value());  // integers only: cannot fail
  return bytes;
}

}  // namespace vbar::pil
