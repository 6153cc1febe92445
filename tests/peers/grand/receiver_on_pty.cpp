// The emulated receiver behind a pseudo-terminal, for RTKLIB's str2str to configure and to record.
//
//   vbar_receiver_on_pty FOLDER SECONDS
//
// Prints the terminal's path, waits until commands have come and none for two seconds, then flies SECONDS of a
// synthetic sky as fast as the reader takes the bytes. FOLDER gets sent.csv: the time of week and the number of
// satellites of each epoch sent, as the flight decoder reads them.

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "emulators/grand/receiver/receiver.h"
#include "fsw/gnss/receiver_decoder.h"
#include "host_sim/io/byte_channel.h"
#include "tests/support/synthetic_sky.h"

namespace {

using namespace vbar;
using grand::bench::Receiver;
using Clock = std::chrono::steady_clock;

constexpr auto kQuiet = std::chrono::seconds(2);
constexpr auto kPatience = std::chrono::seconds(60);

std::vector<std::uint8_t> read_some(int file, int wait_ms) {
  pollfd poll_entry{file, POLLIN, 0};
  if (poll(&poll_entry, 1, wait_ms) <= 0 || (poll_entry.revents & POLLIN) == 0) return {};
  std::vector<std::uint8_t> bytes(4096);
  const ssize_t count = read(file, bytes.data(), bytes.size());
  bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return bytes;
}

void write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(file, bytes.data(), bytes.size());
    if (count < 0 && errno != EAGAIN && errno != EINTR) throw std::runtime_error("the pseudo-terminal is closed");
    if (count <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void take_commands(Receiver& receiver, int line) {
  const auto begin = Clock::now();
  auto last = begin;
  bool any = false;
  while (!any || Clock::now() - last < kQuiet) {
    if (Clock::now() - begin > kPatience) throw std::runtime_error("no command has come");
    const auto bytes = read_some(line, 10);
    if (!bytes.empty()) {
      any = true;
      last = Clock::now();
      receiver.listen(0, bytes, receiver.baud(0));
    }
    receiver.idle(fsw::Duration{10'000'000});
    write_all(line, receiver.speak(0));
  }
}

void write_epoch(std::ofstream& out, const fsw::gnss::ObservationEpoch& epoch) {
  std::set<fsw::gnss::SatelliteId> satellites;
  for (std::size_t k = 0; k < epoch.count; ++k) satellites.insert(epoch.observations[k].satellite);
  const auto time = twins::gnss::week_time(twins::gnss::System::kGps, epoch.receiver_time);
  out << fmt::format("{:.1f},{}\n", time.seconds_of_week(), satellites.size());
}

int run(const std::filesystem::path& folder, int seconds) {
  const auto constellation = test::constellation(1);
  test::SyntheticSky sky(constellation);
  Receiver receiver({}, constellation, 1, "servicer");
  receiver.power(true);
  while (receiver.busy()) receiver.idle(fsw::Duration{100'000'000});
  const io::Pty pty = io::make_pty();
  std::printf("%s\n", pty.slave_path.c_str());
  std::fflush(stdout);
  const int line = pty.master.get();
  take_commands(receiver, line);

  const auto decoder = std::make_unique<fsw::gnss::ReceiverDecoder>();
  std::ofstream out(folder / "sent.csv");
  out << "time_of_week_s,satellites\n";
  for (int block = 0; block < 10 * seconds; ++block) {
    receiver.advance(sky.block(block));
    const auto bytes = receiver.speak(0);
    write_all(line, bytes);
    for (const std::uint8_t byte : bytes)
      if (decoder->push(byte) == fsw::gnss::ReceiverUpdate::kObservations) write_epoch(out, decoder->observations());
  }
  out.close();
  std::this_thread::sleep_for(kQuiet);  // the reader takes what is left
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FOLDER SECONDS\n", argv[0]);
    return 2;
  }
  try {
    return run(argv[1], std::atoi(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
