// vbar_training_crops: labelled crops for the keypoint network, in shards of a folder. Existing shards
// are kept, so an interrupted run continues, and several processes can share the work.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/training/crop_maker.h"
#include "host_sim/training/shard_file.h"

namespace {

using vbar::training::CropKind;

struct Order {
  std::uint64_t seed = 1;
  std::int64_t count = 1000;
  std::int64_t shard_size = 1000;
  CropKind kind = CropKind::kTraining;
  int part = 0, parts = 1;
  std::string target = "tango";
  std::filesystem::path out;
};

void make_shards(const Order& order) {
  using Clock = std::chrono::steady_clock;
  std::filesystem::create_directories(order.out);
  vbar::training::CropMaker maker(vbar::mission::data_directory(), order.target, order.kind, order.seed);
  vbar::training::LabelledCrop crop;
  for (std::int64_t shard = order.part; shard * order.shard_size < order.count; shard += order.parts) {
    const std::int64_t first = shard * order.shard_size;
    const std::int64_t count = std::min(order.shard_size, order.count - first);
    const auto file = order.out / fmt::format("{}_{}_{:07}.crops", name_of(order.kind), order.seed, first);
    if (std::filesystem::exists(file)) continue;
    const auto start = Clock::now();
    std::string bytes;
    for (std::int64_t index = first; index < first + count; ++index) {
      maker.make(index, crop);
      vbar::training::append_crop(crop, maker.camera(), bytes);
    }
    vbar::training::write_shard(file, order.seed, first, static_cast<std::uint32_t>(count), bytes);
    const double took_s = std::chrono::duration<double>(Clock::now() - start).count();
    fmt::print("{}: {} crops, {:.1f} ms each\n", file.string(), count, 1e3 * took_s / static_cast<double>(count));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Order order;
  CLI::App app("Labelled crops for the keypoint network");
  const std::map<std::string, CropKind> kinds{
      {"training", CropKind::kTraining}, {"calibration", CropKind::kCalibration}, {"held_out", CropKind::kHeldOut}};
  app.add_option("--target", order.target, "the target: a body file of data/bodies")->capture_default_str();
  app.add_option("--seed", order.seed, "seed of the draws")->capture_default_str();
  app.add_option("--count", order.count, "crops in total")->check(CLI::Range(1, 10'000'000))->capture_default_str();
  app.add_option("--shard-size", order.shard_size, "crops a file")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--kind", order.kind, "training, calibration or held_out")->transform(CLI::CheckedTransformer(kinds));
  app.add_option("--part", order.part, "part of the work, from 0")->check(CLI::Range(0, 63))->capture_default_str();
  app.add_option("--parts", order.parts, "number of parts")->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--out", order.out, "folder of the shards")->required();
  vbar::files::print_parse_errors_by_line(app);
  CLI11_PARSE(app, argc, argv);
  // Mesa's own threads cost more than they gain on small images; processes share the work.
  setenv("LP_NUM_THREADS", "0", 0);
  try {
    make_shards(order);
  } catch (const std::exception& error) {
    vbar::files::print_error("vbar_training_crops", error.what());
    return 1;
  }
  return 0;
}
