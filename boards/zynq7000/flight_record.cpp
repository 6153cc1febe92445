#include "boards/zynq7000/flight_record.h"

#include <algorithm>
#include <cstring>

namespace vbar::boards::zynq7000 {
namespace {

/// Appends to a zero-terminated text; what does not fit is left out.
class Text {
 public:
  explicit Text(std::span<char> out) : out_(out) { out_[0] = '\0'; }

  void append(const char* text) { append({text, std::strlen(text)}); }
  void append(std::span<const char> text) {
    const std::size_t count = std::min(text.size(), out_.size() - 1U - size_);
    std::copy_n(text.begin(), count, out_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    out_[size_] = '\0';
  }
  void append(std::uint32_t number) {
    std::array<char, 10> digits{};
    std::size_t first = digits.size();
    do {
      digits[--first] = static_cast<char>('0' + static_cast<char>(number % 10U));
      number /= 10U;
    } while (number != 0U);
    append(std::span<const char>(digits).subspan(first));
  }

 private:
  std::span<char> out_;
  std::size_t size_ = 0;
};

}  // namespace

void set_peer(FlightRecord& record, const Sender& sender) {
  record.is_ethernet = sender.interface == Interface::kEthernet ? 1U : 0U;
  record.port = sender.peer.port;
  record.address = sender.peer.address;
  std::copy(sender.peer.mac.begin(), sender.peer.mac.end(), record.mac.begin());
}

Sender peer_of(const FlightRecord& record) {
  Sender sender;
  sender.interface = record.is_ethernet == 1U ? Interface::kEthernet : Interface::kSerial;
  sender.peer.port = static_cast<std::uint16_t>(record.port);
  sender.peer.address = record.address;
  std::copy_n(record.mac.begin(), sender.peer.mac.size(), sender.peer.mac.begin());
  return sender;
}

void describe_reset(const FlightRecord& record, std::span<char, 120> text) {
  Text out(text);
  out.append("error: its watchdog reset it ");
  out.append(record.in_step == 1U ? "in step " : "after step ");
  out.append(record.step);
  if (record.in_step == 1U) {
    out.append(", which did not end within twice the budget of a step");
  }
}

}  // namespace vbar::boards::zynq7000
