// `prehend grasp quality`: epsilon, volume and the rest of given contacts.
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <prehend/analysis/wrench_space.hpp>
#include <prehend/base/log.hpp>
#include <string>
#include <vector>

#include "quality_file.hpp"
#include "tool.hpp"

namespace prehend::simulation {
namespace {

struct QualityArguments {
  std::string file, method = "full";
  bool json = false;
};

int quality(const QualityArguments& arguments) {
  const auto wrenches = read_wrenches(arguments.file);
  if (!wrenches) {
    log::error("{}", wrenches.error().message());
    return 2;
  }
  const auto before = std::chrono::steady_clock::now();
  const auto measured = analysis::wrench_quality(*wrenches);
  const double milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
  if (!measured) {
    log::error("{}", measured.error().message());
    return 2;
  }
  const Eigen::VectorXd& weakest = measured->weakest_direction;
  if (arguments.json) {
    const nlohmann::ordered_json document{
        {"epsilon", measured->epsilon},
        {"volume", measured->volume},
        {"force_closure", measured->force_closure},
        {"weakest_direction", std::vector<double>(weakest.begin(), weakest.end())},
        {"milliseconds", milliseconds}};
    std::printf("%s\n", document.dump(2).c_str());
  } else {
    std::printf("epsilon        %.6f\nvolume         %.6g\nforce closure  %s\n", measured->epsilon,
                measured->volume, measured->force_closure ? "yes" : "no");
    if (measured->force_closure)
      std::printf("hardest load   %.3f %.3f %.3f | %.3f %.3f %.3f\n", weakest[0], weakest[1],
                  weakest[2], weakest[3], weakest[4], weakest[5]);
  }
  return 0;
}

}  // namespace

void add_quality(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<QualityArguments>();
  CLI::App* command = app.add_subcommand(
      "quality",
      "Epsilon and volume of the grasp wrench space of given contacts.\nExit code 0: "
      "measured, 2: wrong use or file.");
  command->add_option("FILE", arguments->file, "contacts or wrenches as JSON")->required();
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  command->add_option("--method", arguments->method, "full: the whole convex hull by Qhull")
      ->capture_default_str()
      ->check(CLI::IsMember({"full", "fast"}));
  command->callback([arguments, &exit_code] { exit_code = quality(*arguments); });
}

}  // namespace prehend::simulation
