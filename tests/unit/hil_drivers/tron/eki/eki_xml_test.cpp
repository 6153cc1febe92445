// The controller's configuration of Ethernet KRL has the elements of the documents, and no others.

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/tron/eki/wire/documents.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "hil_drivers/tron/xml/file.h"

namespace vbar::tron::eki {
namespace {

using Paths = std::set<std::string>;

/// "State/@Seq" of every attribute in the document.
void add_paths(const pugi::xml_node& element, const std::string& prefix, Paths& paths) {
  const std::string path = prefix + element.name() + "/";
  for (const pugi::xml_attribute attribute : element.attributes()) paths.insert(path + "@" + attribute.name());
  for (const pugi::xml_node child : element.children()) add_paths(child, path, paths);
}

Paths paths_of(const std::vector<std::string>& documents) {
  Paths paths;
  for (const std::string& text : documents) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(text.c_str()));
    add_paths(document.document_element(), "", paths);
  }
  return paths;
}

Paths configured(const char* direction) {
  const xml::File file(robot_directory() / "vbar_tron_eki.xml", "ETHERNETKRL");
  Paths paths;
  for (const pugi::xml_node element : file.child(file.child(file.root(), direction), "XML").children("ELEMENT")) {
    const std::string tag = file.attribute(element, "Tag");
    if (tag.find('@') != std::string::npos) paths.insert(tag);
  }
  return paths;
}

TEST(EkiXml, HasTheElementsOfTheDocuments) {
  EXPECT_EQ(paths_of({encode(State{}), encode(RobotState{})}), configured("SEND"));
  EXPECT_EQ(paths_of({encode(Command{})}), configured("RECEIVE"));
}

}  // namespace
}  // namespace vbar::tron::eki
