#include "host_sim/check/junit_xml.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

namespace vbar::check {
namespace {

long long failures_of(const JunitSuite& suite) {
  return std::ranges::count_if(suite.cases, [](const JunitCase& one) { return !one.failure.empty(); });
}

void add(pugi::xml_node& parent, const JunitCase& one, const std::string& suite) {
  pugi::xml_node node = parent.append_child("testcase");
  node.append_attribute("classname") = suite.c_str();
  node.append_attribute("name") = one.name.c_str();
  if (!one.failure.empty()) node.append_child("failure").append_attribute("message") = one.failure.c_str();
}

void add(pugi::xml_node& parent, const JunitSuite& suite) {
  pugi::xml_node node = parent.append_child("testsuite");
  node.append_attribute("name") = suite.name.c_str();
  node.append_attribute("tests") = static_cast<unsigned long long>(suite.cases.size());
  node.append_attribute("failures") = failures_of(suite);
  node.append_attribute("errors") = 0;
  node.append_attribute("time") = fmt::format("{:.3f}", suite.duration_s).c_str();
  for (const JunitCase& one : suite.cases) add(node, one, suite.name);
}

}  // namespace

std::string junit_xml(const std::vector<JunitSuite>& suites) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "utf-8";
  pugi::xml_node all = document.append_child("testsuites");
  for (const JunitSuite& suite : suites) add(all, suite);
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace vbar::check
