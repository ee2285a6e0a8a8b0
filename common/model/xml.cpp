#include "common/model/xml.hpp"

#include <tinyxml2.h>

namespace prehend::model {
namespace {

struct Counter : tinyxml2::XMLVisitor {
  std::map<std::string, int> counts;
  bool VisitEnter(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute*) override {
    ++counts[element.Name()];
    return true;
  }
};

}  // namespace

Expected<std::map<std::string, int>> count_xml_elements(const std::string& text) {
  if (text.find('\0') != std::string::npos) return fail("holds a zero byte", {}, "XML is text");
  tinyxml2::XMLDocument document;
  document.Parse(text.data(), text.size());
  if (document.Error())
    return fail("is not XML", "line " + std::to_string(document.ErrorLineNum()),
                tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()));
  Counter counter;
  document.Accept(&counter);
  return std::move(counter.counts);
}

}  // namespace prehend::model
