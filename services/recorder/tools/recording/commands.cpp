#include "services/recorder/tools/recording/commands.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>

#include "common/recording/compare/recorded_topic.hpp"

namespace prehend::recorder {

int complain_of(const std::filesystem::path& file, const Error& error) {
  return complain(error, ::access(file.c_str(), R_OK) == 0 ? exit_no : exit_broken);
}

bool matches(const std::vector<std::string>& patterns, const std::string& topic) {
  return patterns.empty() || std::ranges::any_of(patterns, [&](const std::string& pattern) {
           return ::fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
         });
}

std::set<std::string> matching(const std::vector<std::string>& patterns,
                               const recording::mcap::Contents& contents) {
  std::set<std::string> topics;
  for (const auto& [id, channel] : contents.channels) {
    const auto topic = recording::recorded_topic(channel, contents);
    if (topic.end.empty() && matches(patterns, topic.name)) topics.insert(topic.name);
  }
  return topics;
}

Error no_such_topic(const std::vector<std::string>& patterns, const std::string& file) {
  return {patterns.empty() ? "no topic at all"
                           : fmt::format("no such topic as {}", fmt::join(patterns, ", ")),
          file, "prehend recording info FILE says what it holds"};
}

}  // namespace prehend::recorder
