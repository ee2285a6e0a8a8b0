#include "services/planner/tools/hand_import/xacro.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <tinyxml2.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

extern char** environ;

namespace prehend::planner {
namespace {

using tinyxml2::XMLElement;

constexpr const char* expand_it = "expand it first: xacro FILE > FILE.urdf, and give FILE.urdf";

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using Scratch = std::unique_ptr<std::FILE, Close>;  // gone when it is closed

bool has_xacro(const XMLElement& element, int depth) {
  if (std::string_view(element.Name()).starts_with("xacro:")) return true;
  for (const auto* each = element.FirstChildElement(); each && depth < 100;
       each = each->NextSiblingElement())
    if (has_xacro(*each, depth + 1)) return true;
  return false;
}

std::string content(std::FILE* file) {
  std::string text;
  char piece[4096];
  std::rewind(file);
  for (std::size_t size; (size = std::fread(piece, 1, sizeof piece, file)) > 0;)
    text.append(piece, size);
  return text;
}

std::string last_line(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  return text.substr(text.rfind('\n') + 1);  // npos + 1 is 0
}

/// Runs xacro and waits. Its exit code; none, with errno, when it cannot be started. Not by
/// stage::Process: that comes with DDS, which nothing here needs.
std::optional<int> run_xacro(const std::vector<std::string>& words, std::FILE* out,
                             std::FILE* complaints) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawn_file_actions_addopen(&streams, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&streams, ::fileno(out), 1);
  ::posix_spawn_file_actions_adddup2(&streams, ::fileno(complaints), 2);
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, "xacro", &streams, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&streams);
  errno = failed;
  if (failed != 0) return std::nullopt;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

bool is_xacro(const std::string& text) {
  tinyxml2::XMLDocument document;
  document.Parse(text.data(), text.size());
  const XMLElement* root = document.Error() ? nullptr : document.RootElement();
  if (!root) return false;
  // Expanded files often keep the name space.
  return has_xacro(*root, 0) ||
         (root->Attribute("xmlns:xacro") && text.find("=\"${") != std::string::npos);
}

Expected<std::string> expand_xacro(const std::filesystem::path& file,
                                   const std::vector<std::string>& arguments) {
  const Scratch out(std::tmpfile()), complaints(std::tmpfile());
  if (!out || !complaints) return fail(std::strerror(errno), "a file for what xacro says");
  // An absolute name is never taken for an option.
  std::vector<std::string> words{"xacro", std::filesystem::absolute(file).string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto code = run_xacro(words, out.get(), complaints.get());
  if (!code && errno == ENOENT)
    return fail("is xacro, and there is no program xacro here", file.string(), expand_it, exit_no);
  if (!code)
    return fail(std::string("xacro cannot be run: ") + std::strerror(errno), file.string(),
                expand_it);
  if (*code != 0)
    return fail("xacro cannot expand it: " + last_line(content(complaints.get())), file.string(),
                "--xacro NAME:=VALUE gives an argument", exit_no);
  return content(out.get());
}

}  // namespace prehend::planner
