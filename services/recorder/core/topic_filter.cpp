#include "services/recorder/core/topic_filter.hpp"

#include <fnmatch.h>

#include <algorithm>

namespace prehend::recorder {

bool TopicFilter::wants(const std::string& topic) const {
  const auto matches = [&](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
  };
  if (std::any_of(exclude.begin(), exclude.end(), matches)) return false;
  return include.empty() || std::any_of(include.begin(), include.end(), matches);
}

}  // namespace prehend::recorder
