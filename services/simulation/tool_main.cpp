// prehend grasp: what can be said of a grasp without a world around it.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <prehend/analysis/wrench_space.hpp>
#include <prehend/base/log.hpp>
#include <string>
#include <vector>

#include "quality_file.hpp"

namespace {

int quality(const std::string& file, bool json) {
  const auto wrenches = prehend::simulation::read_wrenches(file);
  if (!wrenches) {
    prehend::log::error("{}", wrenches.error().message());
    return 2;
  }
  const auto before = std::chrono::steady_clock::now();
  const auto measured = prehend::analysis::wrench_quality(*wrenches);
  const double milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
  if (!measured) {
    prehend::log::error("{}", measured.error().message());
    return 2;
  }
  const Eigen::VectorXd& weakest = measured->weakest_direction;
  if (json) {
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

int main(int argc, char** argv) {
  CLI::App app("What can be said of a grasp.", "prehend grasp");
  app.require_subcommand(1);
  prehend::log::set_name("grasp");
  std::string file, method = "full";
  bool json = false;
  CLI::App* sub = app.add_subcommand(
      "quality",
      "Epsilon and volume of the grasp wrench space of given contacts.\nExit code 0: "
      "measured, 2: wrong use or file.");
  sub->add_option("FILE", file, "contacts or wrenches as JSON")->required();
  sub->add_flag("--json", json, "one JSON document on standard output");
  sub->add_option("--method", method, "full: the whole convex hull by Qhull")
      ->capture_default_str()
      ->check(CLI::IsMember({"full", "fast"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (method == "fast") {
    prehend::log::error("--method fast is not built yet (use --method full)");
    return 2;
  }
  return quality(file, json);
}
