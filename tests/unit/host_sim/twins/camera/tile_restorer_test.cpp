// A log without tiles, and its tiles restored: from recipes by rendering, from recordings by decoding.

#include <algorithm>
#include <csignal>
#include <stdexcept>

#include <sys/resource.h>

#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/logged_image.h"
#include "host_sim/twins/lcm_log.h"
#include "host_sim/twins/packet_log.h"
#include "tests/unit/host_sim/twins/log_file.h"

namespace vbar::twins::camera {
namespace {

using test::packet_of;

constexpr fsw::GpsTime kEpoch{995'000'000LL * 1'000'000'000LL};

class TilesOfALog : public test::LogFile {
 protected:
  TilesOfALog() {
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

  static LoggedImage logged(std::int64_t number) {
    return {{1, 4, static_cast<std::int32_t>(number)}, bytes_of(recipe(number))};
  }

  std::vector<Packet> image(std::int64_t number) { return maker_->packets_of(recipe(number).exposure); }

  static Packet tick_packet(std::uint32_t step) {
    vbar::tick message{};
    message.step = step;
    return packet_of(message, kEpoch, 1, static_cast<std::uint16_t>(step));
  }

  /// Writes these packets as the inputs of one step, with recipes of images 0 and 1.
  void write(const std::vector<Packet>& packets) {
    ImageLogWriter writer(file_, ImageLogWriter::Tiles::kAsRuns);
    for (std::int64_t number = 0; number < 2; ++number) writer.write_recipe(kEpoch, logged(number));
    for (const Packet& packet : packets) writer.write({9, kEpoch, true, packet});
    writer.end_step();
  }

  /// The packets of the log as a replay has them.
  std::vector<Packet> restored(const PacketLog& log) {
    TileRestorer restorer(ImagesOfLog(log), [this](const ImageRecipe& of) { return maker_->packets_of(of.exposure); });
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

TEST_F(TilesOfALog, HoldsAnImageInOneRecord) {
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

TEST_F(TilesOfALog, TilesComeBackAsTheyArrived) {
  // A link that loses and swaps, two images in one step, other packets between.
  const std::vector<Packet> first = image(0), second = image(1);
  std::vector<Packet> packets{first[0],  first[1], first[3],  first[2],  first[6], tick_packet(1),
                              second[0], first[4], second[1], second[2], second[2]};
  write(packets);
  const PacketLog log = read_packet_log(file_);
  EXPECT_EQ(log.records.size(), 9U) << "[0 1] [3] [2] [6] tick [0] [4] [1 2] [2]";
  EXPECT_EQ(restored(log), packets);
}

TEST_F(TilesOfALog, RunEndsWithItsStep) {
  const std::vector<Packet> packets = image(0);
  {
    ImageLogWriter writer(file_, ImageLogWriter::Tiles::kAsRuns);
    writer.write_recipe(kEpoch, logged(0));
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

TEST_F(TilesOfALog, TilesWithoutARecipeStay) {
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

TEST_F(TilesOfALog, ImageThatComesOutOtherwiseIsNoticed) {
  write(image(0));
  const PacketLog log = read_packet_log(file_);
  TileRestorer restorer(ImagesOfLog(log), [this](const ImageRecipe& of) {
    std::vector<Packet> packets = maker_->packets_of(of.exposure);
    vbar::image_tile tile{};
    packets[5] = packet_of(tile, kEpoch, 1, 0);
    return packets;
  });
  try {
    static_cast<void>(restorer.packets_of(*log.records[0].tiles));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what())
                  .rfind(file_.string() + ": image 0, tiles from 0 on: made again it is not the image", 0),
              0U)
        << error.what();
  }
}

TEST_F(TilesOfALog, WhatCannotBeRestoredIsSaid) {
  write(image(0));
  const PacketLog log = read_packet_log(file_);
  const auto make = [this](const ImageRecipe& of) { return maker_->packets_of(of.exposure); };
  TileRestorer restorer(ImagesOfLog(log), make);
  TileRun run = *log.records[0].tiles;
  run.first_tile = 1;
  EXPECT_THROW(static_cast<void>(restorer.packets_of(run)), std::runtime_error) << "past the last tile";
  run = *log.records[0].tiles;
  run.unit = 0;
  EXPECT_THROW(static_cast<void>(restorer.packets_of(run)), std::runtime_error) << "another camera";
  ImagesOfLog damaged = log;
  damaged.recipes[0].pop_back();
  EXPECT_THROW(TileRestorer(std::move(damaged), make), DamagedLog);
}

/// Pixels that no recipe makes.
std::vector<std::uint16_t> pixels(std::int64_t number) {
  std::vector<std::uint16_t> dn(6000);
  for (std::size_t k = 0; k < dn.size(); ++k) dn[k] = static_cast<std::uint16_t>((97 * k + 5 * k * k + number) % 4096);
  return dn;
}

class RecordedTilesOfALog : public TilesOfALog {
 protected:
  static ImageHeader header(std::int64_t number) {
    return {{recipe(number).exposure.time, number, 1, 4}, {0, 0, 100, 60}, 12};
  }
  static LoggedImage recording(std::int64_t number) {
    return {header(number).key(), recorded_image_of(header(number), pixels(number))};
  }
  static std::vector<Packet> tiles(std::int64_t number) {
    return image_tiles(header(number).label, header(number).region, 12, pixels(number));
  }
  void write_recorded(ImageLogWriter::Tiles form = ImageLogWriter::Tiles::kAsRuns) {
    ImageLogWriter writer(file_, form);
    writer.write_recipe(kEpoch, logged(0));
    writer.write_recording(kEpoch, recording(0));
    for (const Packet& packet : tiles(0)) writer.write({9, kEpoch, true, packet});
    writer.end_step();
  }
  /// What restoring the only run of the log throws.
  [[nodiscard]] static std::string error_of(PacketLog log) {
    const TileRun run = log.records.at(0).tiles.value();
    try {
      TileRestorer restorer(std::move(log), {});
      static_cast<void>(restorer.packets_of(run));
    } catch (const DamagedLog& error) {
      return error.what();
    } catch (const std::runtime_error& error) {
      return std::string("not damaged: ") + error.what();
    }
    return "no error";
  }
};

TEST_F(RecordedTilesOfALog, ArePreferredToTheRecipe) {
  write_recorded();
  const PacketLog log = read_packet_log(file_);
  ASSERT_EQ(log.records.size(), 1U);
  EXPECT_EQ(log.recordings.size(), 1U);
  EXPECT_EQ(log.recipes.size(), 1U) << "for the digital twin's image of the same exposure";
  EXPECT_EQ(restored(log), tiles(0));
  EXPECT_NE(restored(log), image(0));
  const TileRestorer restorer(ImagesOfLog(log), {});
  const fsw::GpsTime exposure = recipe(0).exposure.time;
  EXPECT_EQ(restorer.exposures(), std::vector{exposure});
  EXPECT_EQ(restorer.recording_at(exposure), recording(0));
  EXPECT_EQ(restorer.recipe_at(exposure), logged(0));
  EXPECT_FALSE(restorer.recording_at(kEpoch + fsw::Duration{1}));
}

TEST_F(RecordedTilesOfALog, AreKeptBesideWholeTiles) {
  write_recorded(ImageLogWriter::Tiles::kWhole);
  const PacketLog log = read_packet_log(file_);
  EXPECT_EQ(log.records.size(), 7U);
  EXPECT_EQ(log.recordings.size(), 1U) << "an image is in the log before it is used";
  EXPECT_TRUE(log.recipes.empty());
}

TEST_F(RecordedTilesOfALog, DamageIsOneErrorThatNamesFileAndImage) {
  write_recorded();
  const PacketLog log = read_packet_log(file_);
  const std::string place = file_.string() + ": image 0, at byte " + std::to_string(log.recordings[0].offset) + ", ";

  PacketLog damaged = log;
  damaged.recordings[0].bytes.pop_back();
  EXPECT_EQ(error_of(std::move(damaged)),
            file_.string() + ": byte " + std::to_string(log.recordings[0].offset) + ": a damaged record of an image");
  damaged = log;
  for (std::size_t k = 200; k < 260; ++k) damaged.recordings[0].bytes[k] = 0xFF;
  const std::string error = error_of(std::move(damaged));
  EXPECT_EQ(error.rfind(place + "holds damaged JPEG-LS data: ", 0), 0U) << error;
  damaged = log;
  damaged.recordings[0].bytes = recorded_image_of(header(0), pixels(1));
  EXPECT_EQ(error_of(std::move(damaged)), "not damaged: " + file_.string() +
                                              ": image 0, tiles from 0 on: the recorded image is not the image that "
                                              "was flown");
}

// RLIMIT_FSIZE stands for a full disk: write() gives EFBIG in place of ENOSPC.
TEST_F(RecordedTilesOfALog, RecordingThatTheDiskDoesNotTakeIsAnErrorAtOnce) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit limit{20000, before.rlim_max};
  ImageLogWriter writer(file_, ImageLogWriter::Tiles::kAsRuns);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::string error;
  std::int64_t number = 0;
  try {
    for (; number < 10; ++number) writer.write_recording(kEpoch, recording(number));
  } catch (const std::runtime_error& thrown) {
    error = thrown.what();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(error, file_.string() + ": cannot be written: File too large");
  const PacketLog log = read_packet_log(file_);
  EXPECT_EQ(static_cast<std::int64_t>(log.recordings.size()), number) << "all images before it are in the file";
  EXPECT_GT(number, 0);
}

TEST_F(TilesOfALog, DamagedRunIsNamed) {
  write(image(0));
  std::string bytes = content();
  const std::size_t event = bytes.find("VBAR_IMAGE_TILES") + 16;
  bytes[event] = static_cast<char>(bytes[event] ^ 1);
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THROW(static_cast<void>(read_packet_log(file_)), std::runtime_error);
}

}  // namespace
}  // namespace vbar::twins::camera
