#include "common/robot/kept_stop.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "common/audit/record.hpp"
#include "common/base/clock.hpp"
#include "common/base/paths.hpp"

namespace prehend::robot {
namespace {

/// Different names stay different, and no name leads to another folder.
std::string spelt(const std::string& name) {
  std::string text;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      text += c;
    else
      text += fmt::format("%{:02x}", static_cast<unsigned char>(c));
  return text;
}

constexpr std::size_t max_line = 4096;

/// The first line of a file of ours. A folder, a link, a pipe or a device is none, and nobody waits
/// for it.
Expected<std::string> read_line(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return fail(std::strerror(errno), file.string());
  struct stat status {};
  std::string text(max_line, '\0');
  const bool sound = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const ssize_t size = sound ? ::read(descriptor, text.data(), text.size()) : -1;
  ::close(descriptor);
  if (size < 0) return fail("is no file that can be read", file.string());
  text.resize(static_cast<std::size_t>(size));
  const std::size_t end = text.find('\n');
  if (end == std::string::npos) return fail("has no whole line", file.string());
  return text.substr(0, end);
}

/// Beside the file and then in its place, which may be anything. Never into what is there already:
/// that may be a pipe on which one waits, or a link to another file.
Expected<void> replace(const std::filesystem::path& file, const std::string& text) {
  const std::string beside = file.string() + "." + std::to_string(::getpid());
  ::unlink(beside.c_str());
  const int descriptor =
      ::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640);
  if (descriptor < 0) return fail(std::strerror(errno), beside);
  const bool whole =
      ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (::close(descriptor) == 0 && whole && ::rename(beside.c_str(), file.c_str()) == 0) return {};
  const int number = errno;
  ::unlink(beside.c_str());
  return fail(std::strerror(number), file.string());
}

}  // namespace

Expected<KeptStop> KeptStop::create(const service::Config& config, const std::string& hand) {
  std::filesystem::path folder = config.path("safety.state");
  if (folder.empty()) folder = state_directory();
  if (folder.empty())
    return fail("names no folder, and there is no home", "safety.state", "name one");
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return fail(code.message(), folder.string());
  if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return fail(std::strerror(errno), folder.string());
  return KeptStop(folder / fmt::format("stop_{}_{}_{}.json", config.integer("lab.domain"),
                                       spelt(config.text("lab.rig")), spelt(hand)),
                  hand);
}

std::optional<gate::CommandGate::Stop> KeptStop::recall() const {
  struct stat status {};
  if (::lstat(file_.c_str(), &status) != 0 && errno == ENOENT) return std::nullopt;
  const auto record =
      read_line(file_).and_then([](const auto& line) { return audit::parse(line); });
  if (record) return gate::CommandGate::Stop{record->who, record->what, record->time};
  return gate::CommandGate::Stop{"a stop that was kept",
                                 "its file cannot be read, " + file_.string(), process_now()};
}

Expected<void> KeptStop::keep(const gate::CommandGate::Stop& stop) const {
  return replace(
      file_, audit::to_line({stop.since, hand_, audit::Event::stop, stop.by, stop.reason}) + "\n");
}

Expected<void> KeptStop::forget() const {
  std::error_code code;
  std::filesystem::remove(file_, code);
  if (code) return fail(code.message(), file_.string());
  return {};
}

}  // namespace prehend::robot
