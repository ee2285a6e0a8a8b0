#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/tool/program.hpp"

namespace prehend::recorder {

/// Each adds its subcommand, which answers with the exit code.
void add_info(tool::Program& program);
void add_cut(tool::Program& program);
void add_merge(tool::Program& program);
void add_recover(tool::Program& program);
void add_verify(tool::Program& program);
void add_diff(tool::Program& program);
void add_export(tool::Program& program);
void add_records(tool::Program& program);
void add_write(tool::Program& program);

using tool::complain;
/// The same for a file: broken where it cannot be read, else «no».
int complain_of(const std::filesystem::path& file, const Error& error);

/// Which topics are meant: a shell pattern (* and ?) matches whole names; none at all: every topic.
bool matches(const std::vector<std::string>& patterns, const std::string& topic);
/// Topics of a recording that are meant, each once.
std::set<std::string> matching(const std::vector<std::string>& patterns,
                               const recording::mcap::Contents& contents);
/// What to say where there is none of them.
Error no_such_topic(const std::vector<std::string>& patterns, const std::string& file);

}  // namespace prehend::recorder
