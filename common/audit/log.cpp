#include "common/audit/log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace prehend::audit {
namespace {

constexpr std::size_t max_kinds = 256;  // of refusals; whoever makes up names must not fill memory

}  // namespace

Expected<Log> Log::open(const LogOptions& options) {
  std::error_code code;
  std::filesystem::create_directories(options.folder, code);
  if (code) return fail(code.message(), options.folder.string());
  Log log(options);
  if (auto opened = log.open_file(); !opened) return tl::unexpected(opened.error());
  return log;
}

Log::Log(Log&& other) noexcept
    : options_(std::move(other.options_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      bytes_(other.bytes_),
      torn_(other.torn_),
      refusals_(std::move(other.refusals_)) {}

Log::~Log() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::filesystem::path Log::file(int number) const {
  const std::string middle = number == 0 ? "" : "." + std::to_string(number);
  return options_.folder / (options_.name + middle + ".jsonl");
}

std::filesystem::path Log::file() const {
  return file(0);
}

Expected<void> Log::open_file() {
  // Not to wait for who reads a pipe, and not to write through a link into another file.
  descriptor_ = ::open(file(0).c_str(),
                       O_RDWR | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0640);
  struct stat status {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0)
    return fail(std::strerror(errno), file(0).string());
  if (!S_ISREG(status.st_mode)) {
    ::close(std::exchange(descriptor_, -1));
    return fail("is no file", file(0).string(), "take it away, or name another safety.audit");
  }
  bytes_ = static_cast<std::uintmax_t>(status.st_size);
  char last = '\n';
  torn_ = bytes_ > 0 && (::pread(descriptor_, &last, 1, status.st_size - 1) != 1 || last != '\n');
  return {};
}

void Log::rotate() {
  std::error_code none;
  std::filesystem::remove(file(options_.max_files - 1), none);
  for (int number = options_.max_files - 1; number > 0; --number)
    std::filesystem::rename(file(number - 1), file(number), none);
  if (descriptor_ >= 0) ::close(descriptor_);
  (void)open_file();
}

bool Log::write(const Record& record) {
  std::string line = to_line(record) + "\n";
  if (bytes_ > 0 && bytes_ + line.size() > options_.max_bytes) rotate();
  if (descriptor_ < 0 && !open_file()) return false;
  // Half a line, of a disk that was full or a loss of power, must not take this one with it.
  if (torn_) line.insert(line.begin(), '\n');
  const ssize_t written = ::write(descriptor_, line.data(), line.size());
  if (written > 0) bytes_ += static_cast<std::uintmax_t>(written);
  if (written > 0) torn_ = written != static_cast<ssize_t>(line.size());
  return written == static_cast<ssize_t>(line.size());
}

bool Log::refuse(const Record& record) {
  const std::string kind = record.what + '\n' + record.who;
  const auto known = refusals_.find(kind);
  if (known == refusals_.end()) {
    if (refusals_.size() >= max_kinds) return true;
    refusals_[kind] = {record, record.time, 0};
    return write(record);
  }
  known->second.last = record;
  ++known->second.since;
  return true;
}

bool Log::flush(Time now, bool all) {
  bool done = true;
  for (auto at = refusals_.begin(); at != refusals_.end();) {
    Counted& counted = at->second;
    if (!all && now - counted.written < options_.refusals) {
      ++at;
      continue;
    }
    if (counted.since == 0) {  // silent since; the next one is a first one again
      at = refusals_.erase(at);
      continue;
    }
    Record record = counted.last;
    record.count = counted.since;
    done = write(record) && done;
    counted.written = now;
    counted.since = 0;
    ++at;
  }
  return done;
}

}  // namespace prehend::audit
