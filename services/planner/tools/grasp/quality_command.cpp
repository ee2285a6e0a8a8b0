// `prehend grasp quality`: epsilon, volume and the rest of given contacts.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/analysis/wrench_space.hpp"
#include "common/base/log.hpp"
#include "common/base/to_terminal.hpp"
#include "services/planner/tools/grasp/commands.hpp"
#include "services/planner/tools/grasp/contact_measures.hpp"
#include "services/planner/tools/grasp/quality_file.hpp"
#include "services/planner/tools/grasp/wrench_picture.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;

// The full hull of more wrenches can take minutes; those of a hundred contacts take a few seconds.
constexpr Eigen::Index max_for_full = 1000;
struct QualityArguments {
  std::string file, method = "full", picture, hand;
  std::vector<double> load;
  bool json = false;
};

struct Measured : analysis::Resistance {
  std::optional<double> volume;
};

Expected<Measured> measure(const Eigen::MatrixXd& wrenches, bool fast) {
  if (fast) {
    const auto resistance = analysis::l1_resistance(wrenches);
    if (!resistance) return tl::unexpected(resistance.error());
    return Measured{*resistance, std::nullopt};
  }
  if (wrenches.cols() > max_for_full)
    return fail(fmt::format("the full hull of {} wrenches would take too long", wrenches.cols()),
                {}, "use --method fast, or fewer contacts or edges");
  const auto quality = analysis::wrench_quality(wrenches);
  if (!quality) return tl::unexpected(quality.error());
  return Measured{*quality, quality->volume};
}

void print(const Measured& measured, const Json& more) {
  to_terminal("epsilon        {:.6f}\n", measured.epsilon);
  if (measured.volume) to_terminal("volume         {:.6g}\n", *measured.volume);
  to_terminal("force closure  {}\n", measured.force_closure ? "yes" : "no");
  if (measured.force_closure) {
    const Eigen::VectorXd& w = measured.weakest_direction;
    to_terminal("hardest load   {:.3f} {:.3f} {:.3f} | {:.3f} {:.3f} {:.3f}\n", w[0], w[1], w[2],
                w[3], w[4], w[5]);
  }
  for (const auto& [key, value] : more.items())
    if (value.is_number()) to_terminal("{:24} {:.6g}\n", key, value.get<double>());
  const auto say = [&](const char* key, const char* number) {
    if (!more.contains(key)) return;
    if (more[key].is_null()) {
      to_terminal("the load slips, however hard the grip\n");
    } else {
      to_terminal("{:24} {:.6g}\n", number, more[key][number].get<double>());
    }
  };
  say("grip", "largest_normal_force_n");
  say("least_torques", "effort");
}

int quality(const QualityArguments& arguments) {
  auto grasp = read_grasp(arguments.file);
  if (!grasp) return tool::complain(grasp.error(), exit_wrong_use);
  if (grasp->hand && !arguments.hand.empty()) grasp->hand->name = arguments.hand;
  if (!arguments.load.empty())
    grasp->load_O = Eigen::Map<const Eigen::Matrix<double, 6, 1>>(arguments.load.data());
  const auto before = std::chrono::steady_clock::now();
  const auto measured = measure(grasp->wrenches, arguments.method == "fast");
  const double milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
  if (!measured) return tool::complain(measured.error(), exit_wrong_use);
  Json more = Json::object();
  if (!grasp->contacts.empty()) {
    auto told = contact_measures(*grasp);
    if (!told) return tool::complain(told.error(), exit_wrong_use);
    more = std::move(*told);
  }
  if (!arguments.picture.empty())
    if (const auto drawn = draw_wrench_space(grasp->wrenches, *measured, arguments.picture); !drawn)
      return tool::complain(drawn.error(), exit_broken);
  if (!arguments.json) {
    print(*measured, more);
    return 0;
  }
  const Eigen::VectorXd& weakest = measured->weakest_direction;
  Json document{{"epsilon", measured->epsilon},
                {"volume", measured->volume ? Json(*measured->volume) : Json()},
                {"force_closure", measured->force_closure},
                {"weakest_direction", std::vector<double>(weakest.begin(), weakest.end())},
                {"milliseconds", milliseconds}};
  document.update(more);
  to_terminal("{}\n", document.dump(2));
  return 0;
}

}  // namespace

void add_quality(tool::Program& program) {
  auto arguments = std::make_shared<QualityArguments>();
  CLI::App* command = program.app().add_subcommand(
      "quality",
      "Epsilon, volume and other measures of given contacts or wrenches.\nFILE holds "
      "{\"contacts\":[{\"position_m\",\"normal\",\"friction\",\"torsion_m\"?,\"tangent\"?}],"
      "\"center_of_mass_m\"?,\"torque_scale_m\",\"edges\"?,\"load\"?,\"approach\"?,\"shape\"?} or "
      "{\"wrenches\":[[6]...]}, or is what prehend grasp export --index writes.\nExit code 0: "
      "measured, 2: wrong use or file, 3: no picture.");
  command->add_option("FILE", arguments->file, "contacts or wrenches as JSON")->required();
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  command
      ->add_option(
          "--method", arguments->method,
          "full: the whole convex hull by Qhull, with its volume; fast: only as much of it "
          "as epsilon needs")
      ->capture_default_str()
      ->check(CLI::IsMember({"full", "fast"}));
  command->add_option("--hand", arguments->hand, "folder of the hand, if it is none of the lab");
  command
      ->add_option("--load", arguments->load,
                   "wrench on the object, N and N m about its centre of mass, to be held with the "
                   "least forces; and with the least torques, if the file names a hand")
      ->expected(6)
      ->check(CLI::Range(-1e9, 1e9));
  command->add_option("--picture", arguments->picture,
                      "draw the force and torque space as PNG (by gnuplot)");
  program.on(*command, [arguments] { return quality(*arguments); });
}

}  // namespace prehend::planner
