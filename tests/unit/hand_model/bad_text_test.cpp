// Texts that the fuzzers of tests/fuzz broke the loading of hands with.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/model/hand_model.hpp"
#include "common/model/xml.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;

std::string text_of(const std::string& file) {
  std::ifstream stream(test::in_sources("common/models/hands/barrett/") + file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The Barrett hand with something put in behind a text of its URDF.
Expected<model::HandModel> with(const std::string& behind, const std::string& added) {
  std::string urdf = text_of("hand.urdf");
  const std::size_t at = urdf.find(behind);
  if (at == std::string::npos) throw std::runtime_error("the URDF has no " + behind);
  urdf.insert(at + behind.size(), added);
  return model::HandModel::parse(urdf, text_of("hand.toml"));
}

// TinyXML 1 in urdfdom recurses once an element and overflowed the stack.
TEST(HandModel, RefusesElementsNestedWithoutEnd) {
  std::string nested;
  for (int i = 0; i < 200000; ++i) nested += "<a>";
  const auto hand = with("<link name=\"palm\">", nested);
  ASSERT_FALSE(hand);
  EXPECT_NE(hand.error().message().find("hand.urdf: line "), std::string::npos)
      << hand.error().message();
}

// urdfdom reads up to the zero byte and would take the rest of the hand for absent.
TEST(HandModel, RefusesZeroBytes) {
  EXPECT_FALSE(with("</robot>", std::string("\0", 1)));
  EXPECT_FALSE(model::HandModel::parse("", ""));
}

// Each number was finite, but masses, inertias and positions made of them were not.
TEST(HandModel, RefusesSizesThatOverflow) {
  for (const auto& [from, to] : std::initializer_list<std::pair<const char*, const char*>>{
           {"<origin xyz=\"0.025 0 0\"/>", "<origin xyz=\"0.025 -1e308 0\"/>"},
           {"<origin xyz=\"0.05 0 0\"", "<origin xyz=\"1e200 0 0\""},
           {"<mass value=\"0.2\"/>", "<mass value=\"1e308\"/>"},
           {"ixx=\"2.1e-05\"", "ixx=\"1e308\""},
           {"upper=\"2.5132741228718345\"", "upper=\"1e308\""},
           {"multiplier=\"0.3333333333333333\"", "multiplier=\"1e308\""}}) {
    std::string urdf = text_of("hand.urdf");
    const std::size_t at = urdf.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    EXPECT_FALSE(model::HandModel::parse(urdf.replace(at, std::string(from).size(), to),
                                         text_of("hand.toml")))
        << to;
  }
}

// What a comment says is not part of the hand; what is not a comment is.
TEST(HandModel, CountsElementsAsXmlDoes) {
  EXPECT_TRUE(with("<link name=\"palm\">", "<!-- <collision> \"-- > </collision> -->"));
  EXPECT_TRUE(with("<robot name=\"barrett\">", "<collisions_checked/>"));
  const auto counts = model::count_xml_elements("<r><a/><!-- <a/> --><b><a x=\"<a/>\"/></b></r>");
  ASSERT_TRUE(counts) << counts.error().message();
  EXPECT_EQ(counts->at("a"), 2);
  const auto broken = model::count_xml_elements("<r>\n<a>\n</b></r>");
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().where.find("line "), std::string::npos);
}

}  // namespace
