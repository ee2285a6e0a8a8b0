#include "services/recorder/tools/recording/commands.hpp"

#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>

namespace prehend::recorder {

int complain_of(const std::filesystem::path& file, const Error& error) {
  return complain(error, ::access(file.c_str(), R_OK) == 0 ? exit_no : exit_broken);
}

bool matches(const std::vector<std::string>& patterns, const std::string& topic) {
  return patterns.empty() || std::ranges::any_of(patterns, [&](const std::string& pattern) {
           return ::fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
         });
}

}  // namespace prehend::recorder
