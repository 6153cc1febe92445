// A link in a folder never directs a removal to its target.

#include "host_sim/files/remove_link.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace vbar::files {
namespace {

namespace fs = std::filesystem;

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
