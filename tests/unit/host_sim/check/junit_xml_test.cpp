#include "host_sim/check/junit_xml.h"

#include <sstream>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <gtest/gtest.h>

namespace vbar::check {
namespace {

TEST(JunitXml, CountsCasesAndFailuresOfEachSuite) {
  const std::string text =
      junit_xml({{.name = "runs/a", .duration_s = 12.3456, .cases = {{"complete", ""}, {"dv_mps", "too large"}}},
                 {.name = "runs/b", .duration_s = 0.0, .cases = {{"complete", ""}}}});
  std::istringstream input(text);
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(input, tree);
  const auto& suites = tree.get_child("testsuites");
  ASSERT_EQ(suites.count("testsuite"), 2U);
  const auto& first = suites.front().second;
  EXPECT_EQ(first.get<std::string>("<xmlattr>.name"), "runs/a");
  EXPECT_EQ(first.get<int>("<xmlattr>.tests"), 2);
  EXPECT_EQ(first.get<int>("<xmlattr>.failures"), 1);
  EXPECT_EQ(first.get<std::string>("<xmlattr>.time"), "12.346");
  const auto& second = suites.back().second;
  EXPECT_EQ(second.get<int>("<xmlattr>.failures"), 0);
  EXPECT_EQ(second.get<std::string>("testcase.<xmlattr>.name"), "complete");
}

TEST(JunitXml, CarriesEveryCharacterOfANameAndAMessage) {
  const std::string name = "a <\"b\"> & 'c'";
  std::istringstream input(junit_xml({{.name = name, .duration_s = 0.0, .cases = {{name, name}}}}));
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(input, tree);
  EXPECT_EQ(tree.get<std::string>("testsuites.testsuite.<xmlattr>.name"), name);
  EXPECT_EQ(tree.get<std::string>("testsuites.testsuite.testcase.failure.<xmlattr>.message"), name);
}

}  // namespace
}  // namespace vbar::check
