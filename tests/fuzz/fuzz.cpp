#include "tests/fuzz/fuzz.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

/// Read by AddressSanitizer: long stacks of each allocation take most of the time.
extern "C" const char* __asan_default_options();
const char* __asan_default_options() {
  return "malloc_context_size=3";
}

namespace prehend::fuzz {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t max_bytes = 1 << 20;    // of an input
constexpr unsigned max_try = 20;              // s
constexpr std::uint64_t enough_tries = 1000;  // to see one accepted and one refused
constexpr int failure = 9;                    // exit code of a child that saw one

/// Where child and parent both see what is being tried, so that the parent can tell it when the
/// child is dead.
struct Shared {
  std::uint64_t number;
  std::uint64_t tried, accepted;
  std::size_t size;
  char bytes[max_bytes];
};

void attempt(const Fuzzer& fuzzer, Shared& shared, std::string input) {
  input.resize(std::min(input.size(), max_bytes));
  shared.size = input.size();
  std::memcpy(shared.bytes, input.data(), input.size());
  alarm(max_try);  // nobody catches it: an endless loop ends the child
  shared.accepted += fuzzer.target(input);
  ++shared.tried;
  alarm(0);
}

/// Until the time is over and `least` were tried; on a machine so busy that few were tried until
/// then, until there was one of each kind.
void search(const Fuzzer& fuzzer, Shared& shared, Clock::time_point end, std::uint64_t least) {
  const auto too_few = [&] {
    return shared.tried < least || ((shared.accepted == 0 || shared.accepted == shared.tried) &&
                                    shared.tried < enough_tries);
  };
  for (; Clock::now() < end || too_few(); ++shared.number) {
    alarm(max_try);
    Random random(shared.number);
    const std::string& seed = fuzzer.seeds[random.index(fuzzer.seeds.size())];
    attempt(fuzzer, shared, fuzzer.mutate(random, seed));
  }
}

/// Runs `body` in a child process; false if that did not end well, and says so.
bool guarded(Shared& shared, const std::function<void()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      body();
      _exit(0);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
    _exit(failure);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  const std::string file =
      (std::filesystem::temp_directory_path() /
       ("fuzz-input-" + std::to_string(getpid()) + "-" + std::to_string(shared.number)))
          .string();
  std::ofstream(file, std::ios::binary)
      .write(shared.bytes, static_cast<std::streamsize>(shared.size));
  const bool hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  std::fprintf(stderr, "try %llu %s; its input is in %s\n",
               static_cast<unsigned long long>(shared.number), hung ? "took too long" : "failed",
               file.c_str());
  return false;
}

}  // namespace

void require(bool condition, const std::string& what) {
  if (!condition) throw std::logic_error(what);
}

std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

int run(const Fuzzer& fuzzer, int argc, char** argv) {
  void* memory =
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return 3;
  Shared& shared = *static_cast<Shared*>(memory);

  long seconds = std::getenv("PREHEND_LONG") ? 60 : 3;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--seconds" && i + 1 < argc)
      seconds = std::atol(argv[++i]);
    else if (argument == "--first" && i + 1 < argc)
      shared.number = std::strtoull(argv[++i], nullptr, 10);
    else
      files.push_back(argument);
  }

  const bool good = guarded(shared, [&] {
    for (const std::string& file : files) attempt(fuzzer, shared, read_file(file));
    if (!files.empty()) return;
    for (const std::string& seed : fuzzer.seeds) {
      attempt(fuzzer, shared, seed);
      require(shared.accepted == shared.tried, "a good input is refused");
    }
    shared.tried = shared.accepted = 0;
    search(fuzzer, shared, Clock::now() + std::chrono::seconds(seconds),
           std::getenv("PREHEND_LONG") ? fuzzer.long_round : 0);
    require(shared.accepted > 0, "no mutated input was accepted");
    require(shared.accepted < shared.tried, "no mutated input was refused");
  });
  std::printf("%llu inputs tried, %llu of them accepted\n",
              static_cast<unsigned long long>(shared.tried),
              static_cast<unsigned long long>(shared.accepted));
  return good ? 0 : 1;
}

}  // namespace prehend::fuzz
