#include "host_sim/files/data_stream.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/files/output_file.h"
#include "tests/support/paths.h"

namespace vbar::files {

namespace {

namespace fs = std::filesystem;

class DataStreamTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(file_.parent_path());
    std::ofstream(file_) << "1 2\n3";
  }
  void TearDown() override { fs::remove_all(data_); }

  fs::path data_ = fs::path(testing::TempDir()) / ("vbar_data_" + std::to_string(::getpid()));
  fs::path file_ = data_ / "gravity" / "field.txt";
};

TEST_F(DataStreamTest, IsTheFileAndIsRecorded) {
  DataStream stream(file_);
  std::string first, second, third;
  std::getline(stream, first);
  std::getline(stream, second);
  EXPECT_EQ(first + second, "1 23");
  EXPECT_TRUE(stream.eof());
  const auto read = files_read();
  const auto found = std::ranges::find(read, file_, &FileRead::file);
  ASSERT_NE(found, read.end());
  EXPECT_EQ(found->bytes, 5U);
  EXPECT_EQ(found->sha256, sha256_of("1 2\n3"));
}

TEST_F(DataStreamTest, WhatIsOnlyLookedAtIsNotRecorded) {
  const fs::path other = data_ / "gravity" / "looked_at.txt";
  std::ofstream(other) << "4";
  const auto is_recorded = [&] {
    const auto read = files_read();
    return std::ranges::find(read, other, &FileRead::file) != read.end();
  };
  {
    const UnrecordedReads looked_at;
    EXPECT_TRUE(DataStream(other));
  }
  EXPECT_FALSE(is_recorded());
  EXPECT_TRUE(DataStream(other));
  EXPECT_TRUE(is_recorded());
}

TEST_F(DataStreamTest, IsBadWhereThereIsNoFile) {
  EXPECT_FALSE(DataStream(data_ / "gravity" / "none.txt"));
  EXPECT_FALSE(DataStream(data_));
}

TEST_F(DataStreamTest, AFileThatDiffersFromItsListIsRefused) {
  const fs::path list = data_ / "SHA256SUMS";
  std::ofstream(list) << sha256_of("1 2\n3") << "  gravity/field.txt\n";
  EXPECT_TRUE(DataStream(file_));
  std::ofstream(file_) << "1 2\n";
  EXPECT_THAT([&] { DataStream stream(file_); },
              testing::ThrowsMessage<std::runtime_error>(
                  testing::AllOf(testing::StartsWith(file_.string()), testing::HasSubstr(list.string()))));
  std::ofstream(list) << sha256_of("1 2\n3") << "  gravity/another.txt\n";
  EXPECT_TRUE(DataStream(file_)) << "a file of the user's own";
}

// Every data file of the project stands in the list with the contents it has.
TEST(DataChecksums, AreThoseOfTheFiles) {
  const fs::path data = vbar::tests::source_path("data");
  std::ifstream lines(data / "SHA256SUMS");
  std::size_t listed = 0;
  for (std::string line; std::getline(lines, line); ++listed)
    EXPECT_EQ(sha256_of_file(data / line.substr(66)), line.substr(0, 64)) << line << "\nci/data_checksums.sh";
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    const fs::path extension = entry.path().extension();
    files += entry.is_regular_file() && extension != ".md" && extension != ".py" && !extension.empty() ? 1 : 0;
  }
  EXPECT_EQ(listed, files);
}

}  // namespace

namespace {

// FIPS 180-4, examples of one block and of none.
constexpr const char* kOfAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr const char* kOfNothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

TEST(Sha256, AgreesWithTheStandardsExamples) {
  EXPECT_EQ(sha256_of("abc"), kOfAbc);
  EXPECT_EQ(sha256_of(""), kOfNothing);
  Sha256 parts;
  parts.add(std::string_view("a"));
  static_cast<void>(parts.hexadecimal());
  parts.add(std::string_view("bc"));
  EXPECT_EQ(parts.hexadecimal(), kOfAbc);
}

TEST(Sha256, OfAFile) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "vbar_sha256_test";
  std::ofstream(file) << "abc";
  EXPECT_EQ(sha256_of_file(file), kOfAbc);
  std::filesystem::remove(file);
  EXPECT_FALSE(sha256_of_file(file));
  EXPECT_FALSE(sha256_of_file(testing::TempDir()));
}

}  // namespace

// A link in a folder never directs a removal to its target.

namespace {

class RemoveLink : public testing::Test {
 protected:
  RemoveLink() : folder_(fs::path(testing::TempDir()) / ("vbar_link_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_ / "target");
    std::ofstream(folder_ / "target/file") << "content";
  }
  ~RemoveLink() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(RemoveLink, TakesTheLinkAndLeavesItsTarget) {
  fs::create_directory_symlink("target", folder_ / "to_folder");
  fs::create_symlink("target/file", folder_ / "to_file");
  fs::create_symlink("nothing", folder_ / "dangling");
  for (const char* link : {"to_folder", "to_file", "dangling"}) {
    remove_link(folder_ / link);
    EXPECT_FALSE(fs::exists(fs::symlink_status(folder_ / link))) << link;
  }
  EXPECT_EQ(fs::file_size(folder_ / "target/file"), 7U);
}

TEST_F(RemoveLink, LeavesWhatIsNoLink) {
  remove_link(folder_ / "target");
  remove_link(folder_ / "target/file");
  remove_link(folder_ / "nothing");
  EXPECT_TRUE(fs::exists(folder_ / "target/file"));
}

}  // namespace

}  // namespace vbar::files
