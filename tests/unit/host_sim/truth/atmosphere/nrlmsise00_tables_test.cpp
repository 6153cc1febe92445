#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/paths.h"

namespace vbar::truth {
namespace {

using testing::HasSubstr;

class Nrlmsise00TablesFile : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream in(std::filesystem::path(vbar::tests::source_path("data/atmosphere/nrlmsise00.csv")));
    std::stringstream text;
    text << in.rdbuf();
    whole_ = text.str();
  }

  void TearDown() override { std::filesystem::remove(file_); }

  std::string message_for(const std::string& text) {
    std::ofstream(file_) << text;
    try {
      load_nrlmsise00_tables(file_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::string with(const std::string& what, const std::string& instead) const {
    std::string text = whole_;
    return text.replace(text.find(what), what.size(), instead);
  }

  std::string whole_;
  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("vbar_nrlmsise00_" + std::to_string(getpid()) + ".csv");
};

TEST_F(Nrlmsise00TablesFile, IsReadWhenWhole) {
  EXPECT_EQ(message_for(whole_), "");
  const Nrlmsise00Tables tables = load_nrlmsise00_tables(file_);
  // First and last numbers of arrays, as published.
  EXPECT_EQ(tables.pt[0], 0.986573);
  EXPECT_EQ(tables.ptm[0], 1041.3);
  EXPECT_EQ(tables.pdm[7][9], 4000.0);
  EXPECT_EQ(tables.pdl[1][24], 0.949154);
  EXPECT_EQ(tables.pavgm[0], 261.0);
}

TEST_F(Nrlmsise00TablesFile, DamageIsNamedByLine) {
  EXPECT_THAT(message_for(whole_.substr(0, whole_.size() / 2)), HasSubstr("numbers of array"));
  EXPECT_THAT(message_for(with("\nend\n", "\n")), HasSubstr("the file ends here, expected end"));
  EXPECT_THAT(message_for(with("array,pd,9,150", "array,pd,8,150")),
              HasSubstr(":9: found \"array,pd,8,150\", expected array,pd,9,150"));
  EXPECT_THAT(message_for(with("0.986573,", "0.986573x,")), HasSubstr(":8: found \"0.986573x,"));
  EXPECT_THAT(message_for(with("0.986573,", "nan,")), HasSubstr("expected 150 numbers of array pt"));
  EXPECT_THAT(message_for(with("0.986573,", "")), HasSubstr("expected 150 numbers of array pt"));
  EXPECT_THAT(message_for(with("0.986573,", "0.986573,1,")), HasSubstr("expected 150 numbers of array pt"));
  EXPECT_THROW(load_nrlmsise00_tables("/nonexistent/nrlmsise00.csv"), std::runtime_error);
}

}  // namespace
}  // namespace vbar::truth
