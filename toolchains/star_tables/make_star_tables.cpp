// Generates the star tables of flight software from the star file. Runs on the build computer for every target, so
// that all targets have the same bytes.
//
//   make_star_tables STAR_FILE EPOCH TABLES SIZES
//
// EPOCH is a Julian year; TABLES is the binary file included by fsw/vision/stars/star_tables.S (little-endian, the
// order of struct StarTables); SIZES is a header with the lengths of its arrays.

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>

#include "fsw/vision/stars/table_layout.h"
#include "sky_tables.h"
#include "star_file.h"

namespace {

using namespace vbar::star_tables;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kArcsecond = kDegree / 3600.0;

/// Two pixels of a camera of 35 arcsec per pixel: closer stars are not resolved.
constexpr double kSeparation = 70.0 * kArcsecond;

// The guides: about nine in the smallest field of view, 4.8 by 7.7 degrees.
constexpr double kFaintestGuide = 7.5;
constexpr double kGuideRadius = 2.5 * kDegree;
constexpr int kGuideNeighbours = 5;

class Bytes {
 public:
  template <class Integer>
  void put(Integer value) {
    const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
    for (std::size_t k = 0; k < sizeof(Integer); ++k) bytes_.push_back(static_cast<char>(bits >> (8 * k) & 0xFF));
  }
  void pad_to_word() {
    while (bytes_.size() % 4 != 0) bytes_.push_back(0);
  }
  [[nodiscard]] const std::string& text() const { return bytes_; }

 private:
  std::string bytes_;
};

void write(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

void make(const std::string& star_file, double epoch, const std::string& tables_path, const std::string& sizes_path) {
  std::vector<Star> stars = merge_unresolved(read_star_file(star_file, epoch), kSeparation);
  if (stars.size() > 65535)
    throw std::runtime_error(star_file + ": more than 65,535 stars, which the tables cannot number");
  const std::vector<std::uint16_t> coarse = sort_by_cell(stars);
  const CellTable cells = make_cell_table(stars);
  const std::vector<std::uint16_t> guides = choose_guides(stars, kFaintestGuide, kGuideRadius, kGuideNeighbours);
  const PairTable pairs = make_pair_table(stars, guides);

  Bytes bytes;
  for (const Star& star : stars) {
    for (const double component : {star.direction.x, star.direction.y, star.direction.z}) {
      bytes.put(static_cast<std::int32_t>(std::lround(component / vbar::fsw::stars::kDirectionUnit)));
    }
  }
  for (const Star& star : stars) bytes.put(static_cast<std::int32_t>(star.hipparcos));
  for (const std::uint32_t first : cells.first) bytes.put(first);
  for (const std::uint32_t word : make_occupancy(stars)) bytes.put(word);
  for (const std::uint32_t first : pairs.first) bytes.put(first);
  for (const auto& [a, b] : pairs.pairs) {
    bytes.put(a);
    bytes.put(b);
  }
  for (const Star& star : stars) bytes.put(static_cast<std::int16_t>(std::lround(1000.0 * star.magnitude)));
  for (const std::uint16_t first : coarse) bytes.put(first);
  for (const std::uint16_t star : cells.stars) bytes.put(star);
  bytes.pad_to_word();

  char epoch_text[32];
  std::snprintf(epoch_text, sizeof epoch_text, "%.4f", epoch);
  std::string sizes =
      "#pragma once\n// Made by toolchains/star_tables from data/stars.\n\nnamespace vbar::fsw::stars {\n\n";
  const auto constant = [&](const char* type, const char* name, const std::string& value) {
    sizes += std::string("inline constexpr ") + type + " " + name + " = " + value + ";\n";
  };
  constant("double", "kTableEpoch", epoch_text);
  constant("int", "kTableStars", std::to_string(stars.size()));
  constant("int", "kTablePairs", std::to_string(pairs.pairs.size()));
  constant("int", "kTableCellEntries", std::to_string(cells.stars.size()));
  constant("int", "kTableGuides", std::to_string(guides.size()));
  constant("unsigned", "kTableBytes", std::to_string(bytes.text().size()));
  sizes += "\n}  // namespace vbar::fsw::stars\n";
  write(tables_path, bytes.text());
  write(sizes_path, sizes);
}

double read_epoch(std::string_view text) {
  double epoch = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), epoch);
  if (error != std::errc{} || end != text.data() + text.size() || !(epoch >= 1950.0 && epoch <= 2100.0)) {
    throw std::runtime_error("the epoch of the star tables is '" + std::string(text) +
                             "', a Julian year from 1950 to 2100 is accepted");
  }
  return epoch;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) {
    std::fputs("usage: make_star_tables STAR_FILE EPOCH TABLES SIZES\n", stderr);
    return 2;
  }
  try {
    make(arguments[1], read_epoch(arguments[2]), arguments[3], arguments[4]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_star_tables: %s\n", error.what());
    return 1;
  }
  return 0;
}
