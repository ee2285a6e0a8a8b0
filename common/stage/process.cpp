#include "common/stage/process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <thread>

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/stage/temporary_folder.hpp"

namespace prehend::stage {
namespace {

/// Runs in the child, between fork and exec: only calls that are safe there, no memory is taken.
[[noreturn]] void become(char* const* command, char* const* environment, const char* log,
                         const char* output, pid_t parent, int complaint) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) ::signal(number, SIG_DFL);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing >= 0) ::dup2(nothing, STDIN_FILENO);
  const auto redirect = [](const char* file, std::initializer_list<int> targets) {
    const int fd = ::open(file, O_WRONLY | O_CREAT | O_APPEND, 0644);
    for (const int target : targets)
      if (fd >= 0) ::dup2(fd, target);
  };
  if (*log) redirect(log, {STDOUT_FILENO, STDERR_FILENO});
  if (*output) redirect(output, {STDOUT_FILENO});
  ::execvpe(command[0], command, environment);
  const int reason = errno;
  if (::write(complaint, &reason, sizeof(reason)) < 0) ::_exit(126);
  ::_exit(127);
}

bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGILL ||
         signal == SIGFPE;
}

/// Behind the program's own last words, which say nothing of it.
void note_crash(const std::filesystem::path& log, int signal) {
  if (!log.empty())
    std::ofstream(log, std::ios::app)
        << "crashed: signal " << signal << " (" << ::strsignal(signal) << ")\n";
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

}  // namespace

Expected<Process> Process::start(const Options& options) {
  if (options.command.empty()) return fail("no program is named", "starting a process");
  std::vector<std::string> command = options.command;
  std::vector<std::string> environment;
  for (char** entry = environ; *entry; ++entry) {
    const std::string text = *entry;
    if (!options.environment.contains(text.substr(0, text.find('=')))) environment.push_back(text);
  }
  for (const auto& [name, value] : options.environment) environment.push_back(name + "=" + value);
  std::vector<char*> arguments = pointers(command), variables = pointers(environment);

  int complaint[2];
  if (::pipe2(complaint, O_CLOEXEC) != 0)
    return fail(std::strerror(errno), "starting " + command.front());
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0)
    become(arguments.data(), variables.data(), options.log.c_str(), options.output.c_str(), parent,
           complaint[1]);
  const int fork_error = errno;
  ::close(complaint[1]);
  if (child < 0) {
    ::close(complaint[0]);
    return fail(std::strerror(fork_error), "starting " + command.front());
  }
  ::setpgid(child,
            child);  // also here: whoever comes first, the group is there when start() returns
  int reason = 0;
  ssize_t got = 0;
  while ((got = ::read(complaint[0], &reason, sizeof(reason))) < 0 && errno == EINTR) {
  }
  ::close(complaint[0]);
  Process process(child, options.log);
  if (got == sizeof(reason)) {
    process.wait(seconds(1));
    return fail(std::strerror(reason), command.front(), "is it built and installed?");
  }
  return process;
}

Process::Process(Process&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), log_(std::move(other.log_)), exit_(other.exit_) {}

Process& Process::operator=(Process&& other) noexcept {
  if (this != &other) {
    kill_now();
    pid_ = std::exchange(other.pid_, -1);
    log_ = std::move(other.log_);
    exit_ = other.exit_;
  }
  return *this;
}

Process::~Process() {
  kill_now();
}

void Process::kill_now() {
  if (pid_ <= 0 || exit()) return;
  signal(SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  exit_ = Exit{128 + SIGKILL, SIGKILL};
}

std::optional<Process::Exit> Process::exit() {
  if (exit_ || pid_ <= 0) return exit_;
  siginfo_t ended{};
  if (::waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
      ended.si_pid != pid_)
    return std::nullopt;
  // What it started itself goes with it; before it is reaped, while its number is still its own.
  ::kill(-pid_, SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  exit_ = WIFSIGNALED(status) ? Exit{128 + WTERMSIG(status), WTERMSIG(status)}
                              : Exit{WEXITSTATUS(status), 0};
  if (is_crash(exit_->signal)) note_crash(log_, exit_->signal);
  return exit_;
}

std::optional<Process::Exit> Process::wait(Duration limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!exit()) {
    if (std::chrono::steady_clock::now() >= end) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return exit_;
}

void Process::signal(int number) {
  if (pid_ > 0 && !exit()) ::kill(-pid_, number);
}

Process::Exit Process::stop(Duration grace) {
  signal(SIGTERM);
  if (const auto ended = wait(grace)) return *ended;
  kill_now();
  return exit_.value_or(Exit{});
}

Expected<std::string> printed_by(const std::string& program,
                                 const std::vector<std::string>& arguments, Duration patience) {
  const auto folder = TemporaryFolder::create(false);
  if (!folder) return tl::unexpected(folder.error());
  Process::Options options;
  options.command = {(program_directory() / program).string()};
  options.command.insert(options.command.end(), arguments.begin(), arguments.end());
  options.log = folder->path() / "log";
  options.output = folder->path() / "output";
  auto process = Process::start(options);
  if (!process) return tl::unexpected(process.error());
  const auto exit = process->wait(patience);
  if (!exit) return fail("does not answer", program);
  if (exit->code != 0) return fail(last_lines(options.log, 5), program);
  return read_file(options.output);
}

std::string last_lines(const std::filesystem::path& file, int lines) {
  std::ifstream stream(file);
  std::deque<std::string> kept;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty()) continue;
    kept.push_back(line);
    if (static_cast<int>(kept.size()) > lines) kept.pop_front();
  }
  std::string text;
  for (const std::string& line : kept) text += (text.empty() ? "" : "\n") + line;
  return text;
}

}  // namespace prehend::stage
