#include "tests/integration/rig.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>

#include "common/base/file_text.hpp"
#include "common/base/time.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

/// Empty where it cannot be read, as a file of /proc whose process ends meanwhile.
std::string file_text(const std::filesystem::path& file) {
  return read_file(file).value_or("");
}

}  // namespace

bool eventually(double limit_s, const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + seconds(limit_s);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

std::int64_t now_ns() {
  return to_ns(std::chrono::system_clock::now());
}

Rig::Rig(dds::Network network) : network_(std::move(network)) {
  name_ = "test-" + std::to_string(::getpid()) + "-" + std::to_string(now_ns());
  folder_ = std::filesystem::temp_directory_path() / ("prehend-" + name_);
  std::filesystem::create_directories(folder_);
  join();
}

void Rig::join(const std::string& role) {
  participant_.reset();
  auto made = dds::Participant::create({.name = "test",
                                        .domain = domain_,
                                        .rig = name_,
                                        .network = network_,
                                        .role = role.empty() ? "operator" : role});
  if (!made) throw std::runtime_error(made.error().message());
  participant_.emplace(std::move(*made));
}

Rig::~Rig() {
  if (HasFailure())
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      if (entry.path().extension() == ".log")
        std::cout << "--- " << entry.path().filename().string() << "\n"
                  << stage::last_lines(entry.path(), 15) << "\n";
  std::filesystem::remove_all(folder_);
}

std::string Rig::program(const std::string& name) {
  return test::in_programs(name);
}

std::string Rig::address(int number) const {
  return fmt::format("127.0.0.1:{}", lease_.port(number));
}

Strings Rig::lab_arguments(const Strings& sets) const {
  Strings arguments{"--set", "lab.rig=" + name_,
                    "--set", "lab.domain=" + std::to_string(domain_),
                    "--set", "lab.network=" + network_.profile,
                    "--set", "safety.state=" + (folder_ / "state").string()};
  if (!network_.servers.empty())
    arguments.insert(
        arguments.end(),
        {"--set", fmt::format("lab.server=[\"{}\"]", fmt::join(network_.servers, "\", \""))});
  if (!network_.keys.empty())
    arguments.insert(arguments.end(), {"--set", "lab.keys=" + network_.keys.string()});
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
  return arguments;
}

Strings Rig::with_lab(Strings arguments) const {
  const Strings lab = lab_arguments();
  arguments.insert(arguments.end(), lab.begin(), lab.end());
  return arguments;
}

stage::Process Rig::start_program(const std::string& name, const Strings& arguments) {
  stage::Process::Options options;
  options.command = {program(name)};
  options.command.insert(options.command.end(), arguments.begin(), arguments.end());
  options.log = folder_ / (name + ".log");
  auto process = stage::Process::start(options);
  if (!process) throw std::runtime_error(process.error().message());
  return std::move(*process);
}

stage::Process Rig::start(const std::string& name, const Strings& sets) {
  return start_program("prehend-" + name, lab_arguments(sets));
}

Answer Rig::run(const std::string& name, const Strings& arguments, double limit_s) {
  static std::atomic<int> count = 0;
  const std::string stem = "run-" + std::to_string(++count);
  stage::Process::Options options;
  options.command = {program(name)};
  options.command.insert(options.command.end(), arguments.begin(), arguments.end());
  options.log = folder_ / (stem + ".log");
  options.output = folder_ / (stem + ".out");
  auto process = stage::Process::start(options);
  if (!process) throw std::runtime_error(process.error().message());
  const auto exit = process->wait(seconds(limit_s));
  process->stop(seconds(5));
  return {exit ? exit->code : -1, file_text(options.output), file_text(options.log)};
}

std::string Rig::scene(int seed) {
  const std::string file = (folder_ / ("scene-" + std::to_string(seed) + ".toml")).string();
  const Answer answer =
      run("prehend", {"scene", "--seed", std::to_string(seed), "--output", file}, 30);
  if (answer.exit_code != 0) throw std::runtime_error(answer.log);
  return file;
}

std::vector<pid_t> processes_with(const std::string& text) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (file_text(entry.path() / "cmdline").find(text) != std::string::npos)
      found.push_back(std::stoi(name));
  }
  return found;
}

}  // namespace prehend::integration
