#include "common/base/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

extern char** environ;

namespace prehend {
namespace {

/// Runs `gnuplot script` and waits. Its exit code, or -1 with errno when it cannot be started.
int run_gnuplot(const std::string& script) {
  const char* const arguments[] = {"gnuplot", script.c_str(), nullptr};
  pid_t child = 0;
  errno = ::posix_spawnp(&child, "gnuplot", nullptr, nullptr, const_cast<char* const*>(arguments),
                         environ);
  if (errno != 0) return -1;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

Expected<void> draw_by_gnuplot(const std::string& commands, const std::filesystem::path& png,
                               int width, int height) {
  // gnuplot draws where the name needs no quoting; a picture that fails leaves nothing behind.
  std::string folder = (std::filesystem::temp_directory_path() / "prehend-XXXXXX").string();
  if (!::mkdtemp(folder.data())) return fail(std::strerror(errno), folder);
  const std::filesystem::path script = folder + "/script", drawn = folder + "/drawn.png";
  std::ofstream(script) << fmt::format(
      "set encoding utf8\nset terminal pngcairo size {},{} font 'Sans,11'\nset output '{}'\n{}",
      width, height, drawn.string(), commands);
  const int code = run_gnuplot(script.string());
  const std::string reason = std::strerror(errno);
  Expected<void> done;
  std::error_code error;
  if (code == -1) {
    done = fail("gnuplot cannot be run: " + reason, {}, "apt-get install gnuplot-nox");
  } else if (code != 0 || !std::filesystem::exists(drawn, error)) {
    done =
        fail("gnuplot did not draw the picture", png.string(), "what it says of it stands above");
  } else if (!std::filesystem::copy_file(
                 drawn, png, std::filesystem::copy_options::overwrite_existing, error)) {
    done = fail("cannot be written: " + error.message(), png.string());
  }
  std::filesystem::remove_all(folder, error);
  return done;
}

}  // namespace prehend
