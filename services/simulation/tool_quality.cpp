// `prehend grasp quality`: epsilon, volume and the rest of given contacts.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <prehend/analysis/approach.hpp>
#include <prehend/analysis/grasp_map.hpp>
#include <prehend/analysis/grip_forces.hpp>
#include <prehend/analysis/wrench_space.hpp>
#include <prehend/base/log.hpp>
#include <string>
#include <vector>

#include "quality_file.hpp"
#include "tool.hpp"
#include "wrench_picture.hpp"

namespace prehend::simulation {
namespace {

using Json = nlohmann::ordered_json;

// The full hull of more wrenches can take minutes; those of a hundred contacts take a few seconds.
constexpr Eigen::Index most_for_full = 1000;
// The L∞ space and the programs of the grip grow faster than ε.
constexpr std::size_t most_for_details = 50;

struct QualityArguments {
  std::string file, method = "full", picture;
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
  if (wrenches.cols() > most_for_full)
    return fail(fmt::format("the full hull of {} wrenches would take too long", wrenches.cols()),
                {}, "use --method fast, or fewer contacts or edges");
  const auto quality = analysis::wrench_quality(wrenches);
  if (!quality) return tl::unexpected(quality.error());
  return Measured{*quality, quality->volume};
}

Json columns(const Eigen::Matrix4Xd& forces) {
  Json list = Json::array();
  for (const auto& force : forces.colwise())
    list.push_back(Json{{"force_n", {force[0], force[1], force[2]}}, {"moment_nm", force[3]}});
  return list;
}

/// The grip with the smallest largest normal force that bears the load; null when none does.
Expected<Json> grip_against(const GraspFile& grasp) {
  // As if each contact were pushed along its normal by a drive of its own.
  const auto count = static_cast<Eigen::Index>(grasp.contacts.size());
  Eigen::MatrixXd normals = Eigen::MatrixXd::Zero(4 * count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    normals.block<3, 1>(4 * i, i) = grasp.contacts[static_cast<std::size_t>(i)].normal_O;
  const auto grip = analysis::least_torques(grasp.contacts, *grasp.load_O, normals,
                                            Eigen::VectorXd::Ones(count), grasp.edges);
  if (!grip) return tl::unexpected(grip.error());
  if (!*grip) return Json();
  return Json{{"largest_normal_force_n", (*grip)->effort}, {"contacts", columns((*grip)->forces)}};
}

/// What only contacts, not bare wrenches, tell.
Expected<Json> details(const GraspFile& grasp) {
  Json made = Json::object();
  const auto map = analysis::transmission(analysis::grasp_map(grasp.contacts, grasp.torque_scale));
  made["isotropy"] = map.isotropy;
  made["smallest_singular_value"] = map.smallest;
  made["ellipsoid_volume"] = map.volume;
  made["internal_force_dimension"] =
      analysis::internal_force_dimension(grasp.contacts, grasp.torque_scale);
  if (grasp.contacts.size() <= most_for_details) {
    std::vector<Eigen::MatrixXd> by_contact;
    for (const analysis::Contact& contact : grasp.contacts)
      by_contact.push_back(analysis::edge_wrenches(contact, grasp.torque_scale, grasp.edges));
    const auto linf = analysis::linf_resistance(by_contact);
    if (!linf) return tl::unexpected(linf.error());
    made["epsilon_linf"] = linf->epsilon;
    const auto squeeze = analysis::best_squeeze(grasp.contacts, grasp.edges);
    if (!squeeze) return tl::unexpected(squeeze.error());
    made["squeeze_margin"] = *squeeze ? Json((*squeeze)->margin) : Json();
    if (grasp.load_O) {
      auto grip = grip_against(grasp);
      if (!grip) return grip;
      made["grip"] = std::move(*grip);
    }
  }
  if (grasp.approach_O && grasp.shape)
    made["skewness_rad"] = analysis::skewness(*grasp.shape, *grasp.approach_O);
  return made;
}

void print(const Measured& measured, const Json& more) {
  fmt::print("epsilon        {:.6f}\n", measured.epsilon);
  if (measured.volume) fmt::print("volume         {:.6g}\n", *measured.volume);
  fmt::print("force closure  {}\n", measured.force_closure ? "yes" : "no");
  if (measured.force_closure) {
    const Eigen::VectorXd& w = measured.weakest_direction;
    fmt::print("hardest load   {:.3f} {:.3f} {:.3f} | {:.3f} {:.3f} {:.3f}\n", w[0], w[1], w[2],
               w[3], w[4], w[5]);
  }
  for (const auto& [key, value] : more.items())
    if (value.is_number()) fmt::print("{:24} {:.6g}\n", key, value.get<double>());
  if (more.contains("grip"))
    fmt::print("{}\n", more["grip"].is_null()
                           ? "the load         slips, however hard the grip"
                           : fmt::format("{:24} {:.6g}", "largest_normal_force_n",
                                         more["grip"]["largest_normal_force_n"].get<double>()));
}

int refused(const Error& error, int exit_code) {
  log::error("{}", error.message());
  return exit_code;
}

int quality(const QualityArguments& arguments) {
  const auto grasp = read_grasp(arguments.file);
  if (!grasp) return refused(grasp.error(), 2);
  const auto before = std::chrono::steady_clock::now();
  const auto measured = measure(grasp->wrenches, arguments.method == "fast");
  const double milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
  if (!measured) return refused(measured.error(), 2);
  Json more = Json::object();
  if (!grasp->contacts.empty()) {
    auto told = details(*grasp);
    if (!told) return refused(told.error(), 2);
    more = std::move(*told);
  }
  if (!arguments.picture.empty())
    if (const auto drawn = draw_wrench_space(grasp->wrenches, *measured, arguments.picture); !drawn)
      return refused(drawn.error(), 3);
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
  fmt::print("{}\n", document.dump(2));
  return 0;
}

}  // namespace

void add_quality(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<QualityArguments>();
  CLI::App* command = app.add_subcommand(
      "quality",
      "Epsilon, volume and other measures of given contacts or wrenches.\nFILE holds "
      "{\"contacts\":[{\"position_m\",\"normal\",\"friction\",\"torsion_m\"?,\"tangent\"?}],"
      "\"center_of_mass_m\"?,\"torque_scale_m\",\"edges\"?,\"load\"?,\"approach\"?,\"shape\"?} or "
      "{\"wrenches\":[[6]...]}.\nExit code 0: measured, 2: wrong use or file, 3: no picture.");
  command->add_option("FILE", arguments->file, "contacts or wrenches as JSON")->required();
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  command
      ->add_option(
          "--method", arguments->method,
          "full: the whole convex hull by Qhull, with its volume; fast: only as much of it "
          "as epsilon needs")
      ->capture_default_str()
      ->check(CLI::IsMember({"full", "fast"}));
  command->add_option("--picture", arguments->picture,
                      "draw the force and torque space as PNG (by gnuplot)");
  command->callback([arguments, &exit_code] { exit_code = quality(*arguments); });
}

}  // namespace prehend::simulation
