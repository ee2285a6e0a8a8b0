#include <CLI/CLI.hpp>

#include "common/base/log.hpp"
#include "common/tool/output.hpp"
#include "common/tool/program.hpp"
#include "services/recorder/tools/dataset/export.hpp"

int main(int argc, char** argv) {
  using namespace prehend;
  log::set_name("recording");
  CLI::App app{"Training data of recordings; `prehend recording export` calls it.",
               "prehend-dataset"};
  recorder::DatasetOptions options;
  app.add_option("SOURCE", options.sources, "recordings, and folders of them")->required();
  app.add_option("--format", options.format, "layout")
      ->required()
      ->check(CLI::IsMember(recorder::dataset_formats()));
  app.add_option("-o,--output", options.output, "what is made")->required();
  recorder::add_dataset_options(app, options);
  return tool::with_whole_output([&] {
    const auto code = tool::parse(app, argc, argv);
    return code ? *code : recorder::dataset::write_dataset(options);
  });
}
