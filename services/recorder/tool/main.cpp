#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>
#include <prehend/base/log.hpp>

#include "tool.hpp"

namespace prehend::recorder {

int complain(const Error& error, int exit_code) {
  log::error("{}", error.message());
  return exit_code;
}

int complain_of(const std::filesystem::path& file, const Error& error) {
  return complain(error, ::access(file.c_str(), R_OK) == 0 ? exit_no : exit_broken);
}

bool matches(const std::vector<std::string>& patterns, const std::string& topic) {
  return patterns.empty() || std::ranges::any_of(patterns, [&](const std::string& pattern) {
           return ::fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
         });
}

}  // namespace prehend::recorder

int main(int argc, char** argv) {
  namespace recorder = prehend::recorder;
  CLI::App app("Recordings: what is in them, parts of them, and whether two say the same.",
               "prehend recording");
  app.require_subcommand(1);
  prehend::log::set_name("recording");
  int exit_code = recorder::exit_done;
  recorder::add_info(app, exit_code);
  recorder::add_cut(app, exit_code);
  recorder::add_merge(app, exit_code);
  recorder::add_recover(app, exit_code);
  recorder::add_verify(app, exit_code);
  recorder::add_diff(app, exit_code);
  recorder::add_export(app, exit_code);
  recorder::add_records(app, exit_code);
  recorder::add_write(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? recorder::exit_done : recorder::exit_wrong_use;
  }
  return exit_code;
}
