#include "common/stage/stage.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <thread>
#include <utility>

#include "common/base/paths.hpp"
#include "common/tool/interrupt.hpp"

namespace prehend::stage {
namespace {

constexpr std::chrono::milliseconds moment{20};

std::string own_rig() {
  return fmt::format("demo-{}-{:x}", ::getpid(),
                     std::chrono::system_clock::now().time_since_epoch().count());
}

}  // namespace

Expected<Stage> Stage::create(const StageOptions& options) {
  tool::note_interrupts();
  auto folder = TemporaryFolder::create(options.keep);
  if (!folder) return tl::unexpected(folder.error());
  return Stage(options, std::move(*folder));
}

Stage::Stage(const StageOptions& options, TemporaryFolder folder)
    : options_(options),
      sets_(options.lab.overrides()),
      folder_(std::move(folder)),
      lab_({}, {}, folder_.path()) {
  sets_.push_back("lab.rig=" + own_rig());
  begin_anew();
}

void Stage::begin_anew() {
  end_ = std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds(options_.timeout));
}

Expected<service::Config> Stage::config() const {
  auto config = service::Config::load(file(), sets_);
  if (config) return config;
  Error error = config.error();
  error.exit = exit_wrong_use;
  return tl::unexpected(std::move(error));
}

std::vector<std::string> Stage::with_lab(std::vector<std::string> arguments,
                                         const std::vector<std::string>& sets) const {
  arguments.insert(arguments.end(), {"--config", file()});
  for (const auto* some : {&sets_, &sets})
    for (const std::string& set : *some) arguments.insert(arguments.end(), {"--set", set});
  return arguments;
}

Expected<void> Stage::start_service(const std::string& name, const std::vector<std::string>& sets) {
  return start(name, "prehend-" + name, {}, sets);
}

Expected<void> Stage::start(const std::string& name, const std::string& program,
                            std::vector<std::string> arguments,
                            const std::vector<std::string>& sets) {
  return lab_.start(name, program, with_lab(std::move(arguments), sets));
}

Expected<Process::Exit> Stage::run(const std::string& what, const std::string& program,
                                   std::vector<std::string> arguments,
                                   const std::vector<std::string>& sets,
                                   const std::filesystem::path& output) {
  std::vector<std::string> command = with_lab(std::move(arguments), sets);
  command.insert(command.begin(), (program_directory() / program).string());
  auto process = Process::start({.command = command, .log = log_of(program), .output = output});
  if (!process) return tl::unexpected(process.error());
  std::optional<Process::Exit> exit;
  const auto ended = until(
      what, [&] { return (exit = process->exit()).has_value(); },
      [&] {
        return Error{
            fmt::format("{} took longer than {:.0f} s", what, options_.timeout), program, {}};
      });
  if (!ended) return tl::unexpected(ended.error());
  return *exit;
}

std::filesystem::path Stage::log_of(const std::string& name) const {
  return folder() / (std::filesystem::path(name).filename().string() + ".log");
}

std::string Stage::last_words(const std::string& name) const {
  return last_lines(log_of(name), 1);
}

bool Stage::has_ended(std::string_view name) {
  return lab_.ended(name).has_value();
}

Expected<void> Stage::look(const std::string& what) {
  std::this_thread::sleep_for(moment);
  const std::string seen = look_();
  options_.progress(seen.empty() ? what : fmt::format("{:<12} {}", what, seen));
  if (tool::interrupted()) return fail("interrupted", "demo", {}, exit_no);
  if (auto casualty = lab_.casualty(may_end_)) return tl::unexpected(std::move(*casualty));
  return {};
}

Expected<void> Stage::until(const std::string& what, const std::function<bool()>& holds,
                            const std::function<Error()>& late) {
  while (!holds()) {
    if (auto looked = look(what); !looked) return looked;
    if (is_late()) return tl::unexpected(late());
  }
  return {};
}

Expected<void> Stage::until_there(const std::string& what, const std::filesystem::path& file,
                                  const std::function<Error()>& late) {
  return until(
      what, [&] { return exists(symlink_status(file)); }, late);
}

}  // namespace prehend::stage
