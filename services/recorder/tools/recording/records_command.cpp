#include <CLI/CLI.hpp>
#include <iostream>
#include <iterator>
#include <memory>

#include "common/base/file_text.hpp"
#include "services/recorder/tools/recording/commands.hpp"
#include "services/recorder/tools/recording/records_json.hpp"

namespace prehend::recorder {
namespace {

int print(const std::string& file) {
  if (auto done = print_records(file, std::cout); !done) return complain_of(file, done.error());
  return exit_done;
}

int write(const std::string& document, const std::string& to) {
  std::string text;
  if (document == "-") {
    text.assign(std::istreambuf_iterator<char>(std::cin), {});
  } else {
    auto read = read_file(document);
    if (!read) return complain(read.error(), exit_broken);
    text = std::move(*read);
  }
  auto done = write_records(text, to);
  if (done) return exit_done;
  done.error().where = document + (done.error().where.empty() ? "" : ": " + done.error().where);
  return complain(done.error(), exit_no);
}

}  // namespace

void add_records(tool::Program& program) {
  auto* command = program.app().add_subcommand("records", "every record as JSON");
  const auto file = std::make_shared<std::string>();
  command->add_option("FILE", *file, "recording")->required();
  const auto json = std::make_shared<bool>(true);
  command->add_flag("--json", *json, "it is JSON in any case");
  program.on(*command, [file, json] { return print(*file); });
}

void add_write(tool::Program& program) {
  auto* command = program.app().add_subcommand("write", "a file made of records as JSON");
  const auto document = std::make_shared<std::string>("-");
  const auto to = std::make_shared<std::string>();
  command->add_option("JSON", *document, "as `records` prints it; - is standard input")
      ->capture_default_str();
  command->add_option("-o,--output", *to, "recording to write")->required();
  program.on(*command, [document, to] { return write(*document, *to); });
}

}  // namespace prehend::recorder
