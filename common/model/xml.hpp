#pragma once

#include <map>
#include <string>

#include "common/base/error.hpp"

namespace prehend::model {

/// How many elements of each name an XML text holds, comments not counted. Fails, naming the line,
/// on what is no XML, and on elements nested so deep that a recursive reader would run out of
/// stack.
Expected<std::map<std::string, int>> count_xml_elements(const std::string& text);

}  // namespace prehend::model
