#include "host_sim/files/data_stream.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "host_sim/files/sha256.h"
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
}  // namespace vbar::files
