#include "host_sim/check/junit_xml.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <fmt/format.h>

namespace vbar::check {
namespace {

using Tree = boost::property_tree::ptree;

std::size_t failures_of(const JunitSuite& suite) {
  return static_cast<std::size_t>(
      std::ranges::count_if(suite.cases, [](const JunitCase& one) { return !one.failure.empty(); }));
}

Tree tree_of(const JunitCase& one, const std::string& suite) {
  Tree tree;
  tree.put("<xmlattr>.classname", suite);
  tree.put("<xmlattr>.name", one.name);
  if (!one.failure.empty()) tree.put("failure.<xmlattr>.message", one.failure);
  return tree;
}

Tree tree_of(const JunitSuite& suite) {
  Tree tree;
  tree.put("<xmlattr>.name", suite.name);
  tree.put("<xmlattr>.tests", suite.cases.size());
  tree.put("<xmlattr>.failures", failures_of(suite));
  tree.put("<xmlattr>.errors", 0);
  tree.put("<xmlattr>.time", fmt::format("{:.3f}", suite.duration_s));
  for (const JunitCase& one : suite.cases) tree.add_child("testcase", tree_of(one, suite.name));
  return tree;
}

}  // namespace

std::string junit_xml(const std::vector<JunitSuite>& suites) {
  Tree all;
  for (const JunitSuite& suite : suites) all.add_child("testsuite", tree_of(suite));
  Tree document;
  document.add_child("testsuites", all);
  std::ostringstream text;
  boost::property_tree::write_xml(text, document, boost::property_tree::xml_writer_make_settings<std::string>(' ', 2));
  return text.str();
}

}  // namespace vbar::check
