// Run by hand: vbar_hostile_telecommands [NUMBER [SEED]]. Sends as many hostile telecommands of each kind to a flight
// software with a key, a genuine one after each hundred, and prints how many of them were accepted.

#include "tests/unit/fsw/messaging/hostile_telecommands.h"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "fsw/messaging/inbox.h"

int main(int argc, char** argv) {
  using namespace vbar::fsw::messaging;
  using vbar::fsw::Status;
  constexpr long kPerGenuine = 100;
  const long number = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 100'000;
  const auto seed = static_cast<std::uint32_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1);
  long hostile = 0, accepted = 0, genuine = 0, genuine_refused = 0;
  for (std::size_t kind = 0; kind < test::kHostilities.size(); ++kind) {
    test::TelecommandSender sender(seed + static_cast<std::uint32_t>(kind));
    const auto inbox = std::make_unique<Inbox>(test::TelecommandSender::kSpacecraft);
    inbox->authenticate(sender.security());
    long accepted_of_kind = 0;
    for (long k = 0; k < number; ++k) {
      if (k % kPerGenuine == 0) {
        ++genuine;
        if (inbox->receive(sender.genuine()) != Status::kOk) ++genuine_refused;
        inbox->clear({});
      }
      ++hostile;
      if (inbox->receive(sender.hostile(static_cast<test::Hostility>(kind))) == Status::kOk) ++accepted_of_kind;
    }
    std::printf("%-20s %ld sent, %ld accepted\n", test::kHostilities[kind], number, accepted_of_kind);
    accepted += accepted_of_kind;
  }
  std::printf("%ld hostile telecommands, %ld accepted; %ld genuine, %ld refused\n", hostile, accepted, genuine,
              genuine_refused);
  return accepted == 0 && genuine_refused == 0 ? 0 : 1;
}
