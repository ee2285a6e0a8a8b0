#pragma once

#include <string>
#include <vector>

namespace prehend::recorder {

/// Which topics are meant. Patterns are those of a shell: *, ? and [...]; * also spans slashes.
struct TopicFilter {
  std::vector<std::string> include;  // empty: all
  std::vector<std::string> exclude;  // goes before include

  bool wants(const std::string& topic) const;
};

}  // namespace prehend::recorder
