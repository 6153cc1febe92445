// Runs flight code's keypoint network over crops: vbar_network_tool WEIGHTS < crops > logits. All single precision,
// little endian, rows from the top; a crop after the other, each answered by its maps, keypoint by keypoint.

#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include "fsw/vision/pose/keypoint_network.h"

int main(int argc, char** argv) {
  using namespace vbar::fsw::pose;
  if (argc != 2) {
    std::fprintf(stderr, "usage: vbar_network_tool WEIGHTS < crops > logits\n");
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<char> file(std::istreambuf_iterator<char>(in), {});
  const auto network = std::make_unique<KeypointNetwork>();
  if (network->load(std::as_bytes(std::span(file))) != vbar::fsw::Status::kOk) {
    std::fprintf(stderr, "%s: not a weights file that flight code takes\n", argv[1]);
    return 1;
  }
  std::array<float, kInputSamples> crop;
  while (std::fread(crop.data(), sizeof(float), crop.size(), stdin) == crop.size()) {
    if (network->run(crop) != vbar::fsw::Status::kOk) {
      std::fprintf(stderr, "a crop was refused\n");
      return 1;
    }
    for (int k = 0; k < kKeypoints; ++k) {
      const auto logits = network->logits(k);
      if (std::fwrite(logits.data(), sizeof(float), logits.size(), stdout) != logits.size()) return 1;
    }
  }
  return 0;
}
