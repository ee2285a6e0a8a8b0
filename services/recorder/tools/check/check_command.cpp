#include "services/recorder/tools/check/check_command.hpp"

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/recording/types/idl.hpp"
#include "common/stage/temporary_folder.hpp"
#include "services/recorder/tools/check/check.hpp"
#include "services/recorder/tools/check/check_report.hpp"
#include "services/recorder/tools/terminal/progress_line.hpp"

namespace prehend::recorder {

int check_command(const std::vector<std::string>& texts) {
  CLI::App app{
      "Runs services on the recorded inputs and compares what they publish with what was\n"
      "recorded. Exit code 0: the same, 1: different, 2: wrong use, 3: it could not be found out.",
      "prehend check"};
  CheckOptions options;
  std::string tolerances, junit;
  bool json = false, rewrite = false, quiet = false, keep = false;
  options.lab.add_to(app);
  app.add_option("recording", options.file, "an .mcap file")->required();
  app.add_option("--service", options.services,
                 "only this one, on its recorded inputs: glove, recognition, mapping, planner\n"
                 "or simulation; repeatable")
      ->type_size(1)
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"glove", "recognition", "mapping", "planner", "simulation"}));
  app.add_option("--tolerances", tolerances, "another table than share/prehend/tolerances.toml");
  app.add_option("--junit", junit, "write the verdict as JUnit XML to this file");
  app.add_flag("--update", rewrite, "write the recording again with the answers of now");
  app.add_flag("--keep", keep, "keep what the services said");
  app.add_flag("--json", json, "one JSON document on standard output");
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto code = service::parse(app, texts)) return *code;

  const auto config = options.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const auto types = recording::types::load_contract();
  if (!types) return service::complain(types.error(), exit_broken);
  const auto table = tolerances.empty() ? recording::ToleranceTable::load_defaults()
                                        : recording::ToleranceTable::load(tolerances);
  if (!table) return service::complain(table.error(), exit_wrong_use);
  const auto folder = stage::TemporaryFolder::create(keep);
  if (!folder) return service::complain(folder.error(), exit_broken);
  options.log_folder = folder->path();

  ProgressLine progress(quiet || json);
  const auto checked = check(options, *types, *table, [&](double share) {
    progress.show(fmt::format("checking {:3.0f} %", 100 * share));
  });
  progress.clear();
  if (!checked) return service::complain(checked.error(), exit_broken);
  std::cout << (json ? to_json(checked->report) + "\n" : printable(to_text(*checked), "\n"))
            << std::flush;
  if (!junit.empty()) {
    std::ofstream stream(junit);
    stream << to_junit(options.file.string(), *checked);
    if (!stream.flush()) return service::complain({"cannot be written", junit, ""}, exit_broken);
  }
  if (checked->report.same()) return exit_done;
  if (!rewrite) return exit_no;
  if (const auto updated = update(options.file, *checked); !updated)
    return service::complain(updated.error(), exit_broken);
  log::info("{} now holds these answers", options.file.string());
  return exit_done;
}

}  // namespace prehend::recorder
