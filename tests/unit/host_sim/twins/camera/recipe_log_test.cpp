// A log without pixels, and its tiles made again.

#include "host_sim/twins/camera/recipe_log.h"

#include <algorithm>
#include <stdexcept>

#include "host_sim/twins/camera/image_maker.h"
#include "tests/unit/host_sim/twins/log_file.h"

namespace vbar::twins::camera {
namespace {

using test::packet_of;

constexpr fsw::GpsTime kEpoch{995'000'000LL * 1'000'000'000LL};

class RecipeLog : public test::LogFile {
 protected:
  RecipeLog() {
    ImageMaker::Settings settings;
    settings.camera.region = {0, 0, 100, 60};  // 7 tiles
    settings.name = "servicer/camera";
    settings.spacecraft = 1;
    settings.unit = 4;
    maker_.emplace(settings, [](const Exposure& exposure, PhotonImage& image) {
      image.at(10, 10) = static_cast<float>(100.0 * exposure.years_since_j2000);
    });
  }

  [[nodiscard]] static ImageRecipe recipe(std::int64_t number) {
    ImageRecipe recipe;
    recipe.spacecraft = 1;
    recipe.unit = 4;
    recipe.exposure.number = number;
    recipe.exposure.time = kEpoch + fsw::duration_of_seconds(60 * static_cast<double>(number));
    recipe.exposure.years_since_j2000 = 11.5 + static_cast<double>(number);
    return recipe;
  }

  std::vector<Packet> image(std::int64_t number) { return maker_->packets_of(recipe(number).exposure); }

  static Packet tick_packet(std::uint32_t step) {
    vbar::tick message{};
    message.step = step;
    return packet_of(message, kEpoch, 1, static_cast<std::uint16_t>(step));
  }

  /// Writes these packets as the inputs of one step, with recipes of images 0 and 1.
  void write(const std::vector<Packet>& packets) {
    RecipeLogWriter writer(file_);
    for (std::int64_t number = 0; number < 2; ++number) writer.write_recipe(kEpoch, bytes_of(recipe(number)));
    for (const Packet& packet : packets) writer.write({9, kEpoch, true, packet});
    writer.end_step();
  }

  /// The packets of the log as a replay has them.
  std::vector<Packet> restored(const PacketLog& log) {
    TileRestorer restorer(log.recipes, [this](const ImageRecipe& of) { return maker_->packets_of(of.exposure); });
    std::vector<Packet> packets;
    for (const PacketRecord& record : log.records) {
      if (!record.tiles) {
        packets.push_back(record.packet);
        continue;
      }
      for (Packet& tile : restorer.packets_of(*record.tiles)) packets.push_back(std::move(tile));
    }
    return packets;
  }

  std::optional<ImageMaker> maker_;
};

TEST_F(RecipeLog, HoldsAnImageInOneRecord) {
  std::vector<Packet> packets = image(0);
  ASSERT_EQ(packets.size(), 7U);
  packets.push_back(tick_packet(9));
  write(packets);
  const PacketLog log = read_packet_log(file_);
  ASSERT_EQ(log.records.size(), 2U);
  ASSERT_TRUE(log.records[0].tiles);
  EXPECT_EQ(log.records[0].step, 9U);
  EXPECT_EQ(log.records[0].time, kEpoch);
  EXPECT_TRUE(log.records[0].to_flight);
  EXPECT_EQ(log.records[0].tiles->spacecraft, 1);
  EXPECT_EQ(log.records[0].tiles->unit, 4);
  EXPECT_EQ(log.records[0].tiles->image, 0);
  EXPECT_EQ(log.records[0].tiles->first_tile, 0);
  EXPECT_EQ(log.records[0].tiles->tiles, 7);
  EXPECT_FALSE(log.records[1].tiles);
  EXPECT_EQ(log.recipes.size(), 2U);
  EXPECT_EQ(content().find("vbar/image_tile"), std::string::npos);
  EXPECT_EQ(restored(log), packets);
}

TEST_F(RecipeLog, TilesComeBackAsTheyArrived) {
  // A link that loses and swaps, two images in one step, other packets between.
  const std::vector<Packet> first = image(0), second = image(1);
  std::vector<Packet> packets{first[0],  first[1], first[3],  first[2],  first[6], tick_packet(1),
                              second[0], first[4], second[1], second[2], second[2]};
  write(packets);
  const PacketLog log = read_packet_log(file_);
  EXPECT_EQ(log.records.size(), 9U) << "[0 1] [3] [2] [6] tick [0] [4] [1 2] [2]";
  EXPECT_EQ(restored(log), packets);
}

TEST_F(RecipeLog, RunEndsWithItsStep) {
  const std::vector<Packet> packets = image(0);
  {
    RecipeLogWriter writer(file_);
    writer.write_recipe(kEpoch, bytes_of(recipe(0)));
    for (std::size_t k = 0; k < packets.size(); ++k) {
      writer.write({static_cast<std::uint32_t>(k / 4), kEpoch, true, packets[k]});
      if (k == 3) writer.end_step();
    }
    writer.end_step();
  }
  const PacketLog log = read_packet_log(file_);
  ASSERT_EQ(log.records.size(), 2U);
  EXPECT_EQ(log.records[0].tiles->tiles, 4);
  EXPECT_EQ(log.records[1].step, 1U);
  EXPECT_EQ(log.records[1].tiles->first_tile, 4);
  EXPECT_EQ(restored(log), packets);
}

TEST_F(RecipeLog, TilesWithoutARecipeStay) {
  std::vector<Packet> packets = image(2);  // of which no recipe was given
  Packet damaged = image(0)[3];
  damaged[100] ^= 1U;
  packets.push_back(damaged);  // no tile any more
  write(packets);
  const PacketLog log = read_packet_log(file_);
  ASSERT_EQ(log.records.size(), 8U);
  for (const PacketRecord& record : log.records) EXPECT_FALSE(record.tiles);
  EXPECT_EQ(restored(log), packets);
}

TEST_F(RecipeLog, ImageThatComesOutOtherwiseIsNoticed) {
  write(image(0));
  const PacketLog log = read_packet_log(file_);
  TileRestorer restorer(log.recipes, [this](const ImageRecipe& of) {
    std::vector<Packet> packets = maker_->packets_of(of.exposure);
    vbar::image_tile tile{};
    packets[5] = packet_of(tile, kEpoch, 1, 0);
    return packets;
  });
  try {
    static_cast<void>(restorer.packets_of(*log.records[0].tiles));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("image 0, tiles from 0 on: made again it is not the image", 0), 0U)
        << error.what();
  }
}

TEST_F(RecipeLog, WhatCannotBeRestoredIsSaid) {
  write(image(0));
  const PacketLog log = read_packet_log(file_);
  const auto make = [this](const ImageRecipe& of) { return maker_->packets_of(of.exposure); };
  TileRestorer restorer(log.recipes, make);
  TileRun run = *log.records[0].tiles;
  run.first_tile = 1;
  EXPECT_THROW(static_cast<void>(restorer.packets_of(run)), std::runtime_error) << "past the last tile";
  run = *log.records[0].tiles;
  run.unit = 0;
  EXPECT_THROW(static_cast<void>(restorer.packets_of(run)), std::runtime_error) << "another camera";
  std::vector<std::vector<std::uint8_t>> damaged = log.recipes;
  damaged[0].pop_back();
  EXPECT_THROW(TileRestorer(damaged, make), std::runtime_error);
  EXPECT_THROW(RecipeLogWriter(file_).write_recipe(kEpoch, damaged[0]), std::runtime_error);
}

TEST_F(RecipeLog, DamagedRunIsNamed) {
  write(image(0));
  std::string bytes = content();
  const std::size_t event = bytes.find("VBAR_IMAGE_TILES") + 16;
  bytes[event] = static_cast<char>(bytes[event] ^ 1);
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THROW(static_cast<void>(read_packet_log(file_)), std::runtime_error);
}

}  // namespace
}  // namespace vbar::twins::camera
