// The two ends of sACN for peers:
//   send ADDRESS UNIVERSE START_SLOT   values of lines of standard input, again every 100 ms; ends the source at its
//   end receive ADDRESS UNIVERSE START_SLOT   its port, then the powers of the emulated lights whenever they change

#include <chrono>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <poll.h>
#include <unistd.h>

#include "emulators/tron/lights.h"
#include "hil_drivers/tron/protocols/sacn.h"

namespace {

using namespace vbar::tron;

bool has_input(int patience_ms) {
  pollfd waiting{STDIN_FILENO, POLLIN, 0};
  return ::poll(&waiting, 1, patience_ms) == 1;
}

int send(const SacnSettings& settings) {
  sacn::Sender sender(settings, "tron");
  for (;;) {
    if (!has_input(100)) {
      sender.keep_alive();
      continue;
    }
    std::string line;
    if (!std::getline(std::cin, line)) return 0;
    std::istringstream words(line);
    std::vector<std::uint16_t> values;
    for (unsigned value = 0; words >> value;) values.push_back(static_cast<std::uint16_t>(value));
    sender.send(values);
  }
}

void print(const bench::TrueLights& lights) {
  std::cout << lights.lamp_power;
  for (const double power : lights.box_power) std::cout << ' ' << power;
  std::cout << std::endl;
}

int receive(const SacnSettings& settings) {
  using Clock = std::chrono::steady_clock;
  boost::asio::io_context context;
  bench::LightRig rig(Lamp{}, bench::LightErrorSizes::none(), 1);
  bench::LightReceiver receiver(context, settings, 0, rig);
  std::cout << receiver.port() << std::endl;
  const auto begin = Clock::now();
  for (bench::TrueLights before; !has_input(4);) {
    receiver.begin_cycle(std::chrono::duration<double>(Clock::now() - begin).count());
    const bench::TrueLights now = rig.lights();
    if (now.lamp_power == before.lamp_power && now.box_power == before.box_power) continue;
    print(now);
    before = now;
  }
  std::cout << "terminations " << receiver.counts().terminations << " unreadable " << receiver.counts().unreadable
            << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  SacnSettings settings;
  settings.address = argv[2];
  settings.universe = static_cast<std::uint16_t>(std::stoi(argv[3]));
  settings.start_slot = std::stoi(argv[4]);
  std::ios::sync_with_stdio(true);
  std::cin.rdbuf()->pubsetbuf(nullptr, 0);
  std::cout.precision(9);
  return std::string(argv[1]) == "send" ? send(settings) : receive(settings);
}
