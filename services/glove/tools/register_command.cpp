#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/finite_number.hpp"
#include "common/base/toml_text.hpp"
#include "services/glove/core/calibration/toucher.hpp"
#include "services/glove/tools/asking.hpp"
#include "services/glove/tools/commands.hpp"

namespace prehend::glove {
namespace {

struct RegisterArguments {
  service::LabArguments lab;
  std::vector<std::string> points;  // X,Y,Z
  std::string from;
  double height = 0, limit = 300;
  bool write = false, json = false;
};

Expected<std::vector<Eigen::Vector3d>> known_points(const RegisterArguments& arguments) {
  if (arguments.points.empty())
    return std::vector<Eigen::Vector3d>{
        {-0.2, -0.15, 0}, {0.2, -0.15, 0}, {0.2, 0.15, 0}, {-0.2, 0.15, 0}};
  std::vector<Eigen::Vector3d> points;
  for (const std::string& text : arguments.points) {
    const auto numbers = finite_list(text);
    if (!numbers || numbers->size() != 3)
      return fail("must be X,Y,Z in m", "--point " + text, "for example 0.1,0.2,0.3");
    points.emplace_back(numbers->data());
  }
  return points;
}

int register_with(const RegisterArguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const auto points = known_points(arguments);
  if (!points) return service::complain(points.error(), exit_wrong_use);
  std::vector<Eigen::Vector3d> sensor = *points;
  for (Eigen::Vector3d& p : sensor) p.z() += arguments.height;
  if (const auto usable = register_tracker(sensor, sensor); !usable)
    return service::complain(usable.error(), exit_wrong_use);
  auto input =
      arguments.from.empty() ? FrameInput::live(*config) : FrameInput::recorded(arguments.from);
  if (!input) return service::complain(input.error(), exit_broken);

  Toucher toucher(sensor);
  const bool touched = ask(
      *input, toucher, arguments.limit,
      [&](const Eigen::Vector3d& p) {
        return fmt::format("touch ({:.3f}, {:.3f}, {:.3f}) m with the index fingertip", p.x(),
                           p.y(), p.z() - arguments.height);
      },
      [](double wobble) { return fmt::format("taken, moved {:.1f} mm", 1000 * wobble); });
  if (!touched) return exit_no;
  const auto result = toucher.result();
  if (!result) return service::complain(result.error(), exit_no);
  const std::string line = x_wt_line(result->X_WT);
  log::info("residual {:.1f} mm, worst point {:.1f} mm", 1000 * result->residual,
            1000 * result->worst);
  if (arguments.write) {
    const std::string file = arguments.lab.file();
    if (const auto written = write_line(file, "tracker", "X_WT", line); !written)
      return service::complain(written.error(), exit_broken);
    log::info("written to {}", file);
  }
  if (arguments.json) {
    const Eigen::Vector3d p = result->X_WT.translation();
    const Eigen::Quaterniond q(result->X_WT.linear());
    std::cout << nlohmann::ordered_json{{"X_WT", {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}},
                                        {"residual_m", result->residual},
                                        {"worst_m", result->worst}}
                     .dump()
              << '\n';
  } else {
    std::cout << "[tracker]\n" << line << '\n';
  }
  return exit_done;
}

}  // namespace

void add_register(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "register", "find the tracker's place by touching points of the table; the glove must run");
  const auto a = std::make_shared<RegisterArguments>();
  a->lab.add_to(*command);
  command
      ->add_option("--point", a->points,
                   "X,Y,Z of a point on the table, m, in the order of touching; repeatable; "
                   "default: (±0.2, ±0.15, 0) from the near left one anticlockwise")
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_option("--height", a->height, "m, of the index sensor above what it touches")
      ->check(CLI::Range(0.0, 0.05));
  command->add_option("--from", a->from, "a recording instead of a running glove (MCAP)");
  command->add_option("--limit", a->limit, "s after which it gives up")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  command->add_flag("--write", a->write, "write tracker.X_WT into the configuration file");
  command->add_flag("--json", a->json, "print the outcome as one JSON document");
  program.on(*command, [a] { return register_with(*a); });
}

}  // namespace prehend::glove
