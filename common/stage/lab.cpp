#include "common/stage/lab.hpp"

#include <fmt/format.h>

#include <csignal>
#include <span>

#include "common/base/paths.hpp"

namespace prehend::stage {

Lab::Lab(std::string config, std::vector<std::string> sets, std::filesystem::path logs)
    : config_(std::move(config)), sets_(std::move(sets)), logs_(std::move(logs)) {}

Lab::~Lab() {
  stop();
}

Expected<void> Lab::start_service(const std::string& name, const std::vector<std::string>& sets) {
  std::vector<std::string> arguments{"--config", config_};
  std::vector<std::string> all = sets_;
  all.insert(all.end(), sets.begin(), sets.end());
  for (const std::string& set : all) arguments.insert(arguments.end(), {"--set", set});
  return start(name, "prehend-" + name, arguments);
}

Expected<void> Lab::start(const std::string& name, const std::string& program,
                          const std::vector<std::string>& arguments) {
  Process::Options options;
  options.command = {(program_directory() / program).string()};
  options.command.insert(options.command.end(), arguments.begin(), arguments.end());
  options.log = logs_ / (name + ".log");
  auto process = Process::start(options);
  if (!process) return tl::unexpected(process.error());
  members_.push_back({name, std::move(*process)});
  return {};
}

std::optional<Process::Exit> Lab::ended(std::string_view name) {
  for (Member& member : members_)
    if (member.name == name) return member.process.exit();
  return std::nullopt;
}

std::optional<Error> Lab::casualty(std::string_view may_end) {
  for (Member& member : members_) {
    const auto exit = member.process.exit();
    if (!exit || (member.name == may_end && exit->code == 0)) continue;
    std::string how = exit->signal ? fmt::format("was killed by signal {}", exit->signal)
                                   : fmt::format("ended with exit code {}", exit->code);
    const std::string said = last_lines(member.process.log(), 5);
    if (!said.empty()) how += "; it said:\n" + said;
    return Error{how, member.name, ""};
  }
  return std::nullopt;
}

void Lab::stop() {
  // Who hears all the others was started before them: a recorder takes what they still say.
  const std::span others = std::span(members_).subspan(members_.empty() ? 0 : 1);
  for (Member& member : others) member.process.signal(SIGTERM);
  for (Member& member : others) member.process.stop(seconds(3));
  if (!members_.empty()) members_.front().process.stop(seconds(3));
  members_.clear();
}

}  // namespace prehend::stage
