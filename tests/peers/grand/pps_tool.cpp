// vbar_pps_tool SOCKET CHRONY_SOCKET EDGES OFFSET_US: edges OFFSET_US after every whole second of the system's clock,
// sent by the bench's broadcaster, received by the driver's source, forwarded to chronyd.

#include <chrono>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <thread>

#include "emulators/grand/generator/edge_broadcaster.h"
#include "hil_drivers/grand/pps/time_base.h"

namespace {

using namespace vbar::grand;
using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;
using System = std::chrono::system_clock;

void forward_edges(const std::string& path, ChronyOutput& output, int edges, std::chrono::microseconds offset) {
  EdgeBroadcaster broadcaster(path);
  const auto source = make_edge_source("socket:" + path);
  (void)source->next({});
  for (int k = 0; k < edges; ++k) {
    const System::time_point second = std::chrono::ceil<std::chrono::seconds>(System::now());
    const Steady::time_point edge = Steady::now() + (second + offset - System::now());
    std::this_thread::sleep_until(edge);
    broadcaster.send({vbar::fsw::GpsTime{} + vbar::fsw::duration_of_seconds(1'000'000'000 + k),
                      edge.time_since_epoch().count(), static_cast<std::uint32_t>(k)});
    if (const auto received = source->next(Steady::now() + 500ms)) output.forward(*received);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: " << argv[0] << " SOCKET CHRONY_SOCKET EDGES OFFSET_US\n";
    return 2;
  }
  try {
    ChronyOutput output(argv[2]);
    forward_edges(argv[1], output, std::atoi(argv[3]), std::chrono::microseconds(std::atoi(argv[4])));
    std::cout << output.sent() << "\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
