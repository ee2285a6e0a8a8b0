// `prehend grasp taxonomy` and `prehend grasp classify`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/to_terminal.hpp"
#include "common/model/task_kinds.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"
#include "services/planner/tools/grasp/quality_file.hpp"
#include "services/planner/tools/picture/class_picture.hpp"
#include "services/planner/tools/picture/grasp_picture.hpp"
#include "services/planner/tools/planning/grasp_class.hpp"
#include "services/planner/tools/planning/grasp_file.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;

constexpr int picture_width = 320, picture_height = 240;  // px

struct TaxonomyArguments {
  service::CatalogueArgument catalogue;
  std::string object, task, pictures;
  std::vector<std::string> needed;
  bool json = false;
};

struct ClassifyArguments {
  std::string file;
  bool json = false;
};

template <class Values>
std::vector<std::string> words(const Values& values, const auto& names) {
  std::vector<std::string> made;
  for (const auto value : values) made.emplace_back(names.name(value));
  return made;
}

Json to_json(const model::GraspTaxonomy& taxonomy, const model::GraspClass& one) {
  Json robot = Json::object();
  for (const std::string& hand : model::hand_names()) robot[hand] = taxonomy.robot_type(one, hand);
  std::vector<std::string> shapes;
  for (const model::ShapeKind shape : one.shapes) shapes.emplace_back(model::to_string(shape));
  return {{"name", one.name},
          {"feix", one.feix},
          {"kind", model::grasp_kinds.name(one.kind)},
          {"form", model::grasp_forms.name(one.form)},
          {"opposition", model::oppositions.name(one.opposition)},
          {"opposed", words(one.opposed, model::finger_names)},
          {"thumb", model::thumb_places.name(one.thumb)},
          {"approach", model::approaches.name(one.approach)},
          {"blocks", words(one.blocks, model::object_parts)},
          {"shapes", shapes},
          {"width_m", {one.min_width, one.max_width}},
          {"robot", robot}};
}

std::vector<std::string> names_of(const model::TaskKinds& tasks) {
  std::vector<std::string> made;
  for (const model::TaskKind& kind : tasks.kinds()) made.push_back(kind.name);
  return made;
}

/// How plausible each class is for the object and task that were named; all 1 without.
Expected<std::vector<double>> fits(const TaxonomyArguments& arguments,
                                   const model::GraspTaxonomy& taxonomy) {
  std::vector<model::ObjectPart> needed;
  for (const std::string& name : arguments.needed)
    needed.push_back(*model::object_parts.value(name));
  if (!arguments.task.empty()) {
    const auto tasks = model::TaskKinds::of_the_house();
    if (!tasks) return tl::unexpected(tasks.error());
    const model::TaskKind* task = tasks->of_task(arguments.task);
    if (!task)
      return fail("is no kind of task", arguments.task,
                  fmt::format("there are {}", fmt::join(names_of(*tasks), ", ")));
    needed.insert(needed.end(), task->keep_free.begin(), task->keep_free.end());
  }
  std::vector<double> made = taxonomy.fit_to_task(needed);
  if (arguments.object.empty()) return made;
  const auto body = find_body(arguments.catalogue, arguments.object);
  if (!body) return tl::unexpected(body.error());
  const auto of_object = taxonomy.fit_to_object(body->shape);
  for (std::size_t i = 0; i < made.size(); ++i) made[i] *= of_object[i];
  return made;
}

/// One picture a class, NAME.png.
Expected<void> draw_all(const model::GraspTaxonomy& taxonomy, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(error.message(), folder.string(), "choose another folder");
  for (const model::GraspClass& kind : taxonomy.classes()) {
    std::string name = kind.name;
    std::replace(name.begin(), name.end(), ' ', '-');
    const Drawing drawing = draw_class(kind);
    const Viewpoint view =
        view_of_class(drawing, static_cast<double>(picture_width) / picture_height);
    if (auto saved =
            save(folder / (name + ".png"), drawing.draw(view, picture_width, picture_height));
        !saved)
      return saved;
  }
  return {};
}

int show(const TaxonomyArguments& arguments) {
  const auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tool::complain(taxonomy.error());
  const auto fit = fits(arguments, *taxonomy);
  if (!fit) return tool::complain(fit.error(), exit_wrong_use);
  if (!arguments.pictures.empty())
    if (const auto drawn = draw_all(*taxonomy, arguments.pictures); !drawn)
      return tool::complain(drawn.error(), exit_broken);
  const bool asked =
      !arguments.object.empty() || !arguments.needed.empty() || !arguments.task.empty();
  Json document{{"classes", Json::array()}};
  if (!arguments.json)
    to_terminal("{:18} {:>4} {:9} {:9} {:5} {:7} {:8} {:6} {:15} {:9} {}{}\n", "class", "Feix",
                "kind", "form", "by", "fingers", "thumb", "from", "blocks", "width mm", "robot",
                asked ? "  fit" : "");
  for (std::size_t i = 0; i < fit->size(); ++i) {
    const model::GraspClass& one = taxonomy->classes()[i];
    if (arguments.json) {
      document["classes"].push_back(to_json(*taxonomy, one));
      if (asked) document["classes"].back()["fit"] = (*fit)[i];
      continue;
    }
    to_terminal("{:18} {:4} {:9} {:9} {:5} {:7} {:8} {:6} {:15} {:9} {}{}\n", one.name, one.feix,
                model::grasp_kinds.name(one.kind), model::grasp_forms.name(one.form),
                model::oppositions.name(one.opposition), one.opposed.size(),
                model::thumb_places.name(one.thumb), model::approaches.name(one.approach),
                fmt::format("{}", fmt::join(words(one.blocks, model::object_parts), ", ")),
                fmt::format("{:.0f}-{:.0f}", 1000 * one.min_width, 1000 * one.max_width), one.robot,
                asked ? fmt::format("  {:.2f}", (*fit)[i]) : "");
  }
  if (arguments.json) std::cout << document.dump(2) << "\n";
  return exit_done;
}

Json to_json(const GraspLooks& looks, const model::GraspTaxonomy& taxonomy,
             const std::string& hand) {
  const model::GraspClass& one = *taxonomy.find(looks.name);
  return {{"class", looks.name},
          {"feix", one.feix},
          {"kind", model::grasp_kinds.name(looks.kind)},
          {"form", model::grasp_forms.name(looks.form)},
          {"fingers", looks.fingers},
          {"enclosed", looks.enclosed},
          {"opposing", looks.opposing},
          {"around", looks.around},
          {"width_m", looks.width},
          {"robot", taxonomy.robot_type(one, hand)}};
}

/// Of every grasp in a file: a plan, or one grasp as JSON.
Expected<std::vector<GraspLooks>> looks_in(const std::string& file,
                                           const model::GraspTaxonomy& taxonomy,
                                           std::string& name) {
  std::vector<GraspLooks> made;
  const auto add = [&](const std::vector<analysis::Contact>& contacts, const Pose& X_OB,
                       const std::optional<model::Shape>& shape) -> Expected<void> {
    const auto hand = find_hand(name);
    if (!hand) return tl::unexpected(hand.error());
    const Eigen::Vector3d approach_O = (X_OB * hand->X_BG()).linear().col(2);
    auto looks = looks_of(*hand, contacts, approach_O, shape, taxonomy);
    if (!looks) return fail(looks.error().what, fmt::format("{}, grasp {}", file, made.size()));
    made.push_back(std::move(*looks));
    return {};
  };
  const auto plan = load_plan(file);
  if (plan) {
    name = plan->hand;
    for (const grasping::PlannedGrasp& grasp : plan->grasps)
      if (auto ok = add(grasp.contacts, grasp.X_OB, plan->object.shape); !ok)
        return tl::unexpected(ok.error());
    return made;
  }
  const auto grasp = read_grasp(file);
  if (!grasp)
    return fail("is neither a plan nor a grasp as JSON: " + grasp.error().what, file,
                "name what prehend grasp plan or export --index wrote");
  if (!grasp->hand)
    return fail("names no hand", file, "write it with prehend grasp export --index");
  name = grasp->hand->name;
  if (auto ok = add(grasp->contacts, grasp->hand->X_OB, grasp->shape); !ok)
    return tl::unexpected(ok.error());
  return made;
}

int classify(const ClassifyArguments& arguments) {
  const auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tool::complain(taxonomy.error());
  std::string hand;
  const auto looks = looks_in(arguments.file, *taxonomy, hand);
  if (!looks) return tool::complain(looks.error(), exit_wrong_use);
  Json document{{"hand", hand}, {"grasps", Json::array()}};
  for (std::size_t i = 0; i < looks->size(); ++i) {
    const GraspLooks& one = (*looks)[i];
    document["grasps"].push_back(to_json(one, *taxonomy, hand));
    if (!arguments.json)
      to_terminal("{:3}  {:18} {} {}, {} fingers{}, {:.0f} mm\n", i, one.name,
                  model::grasp_kinds.name(one.kind), model::grasp_forms.name(one.form), one.fingers,
                  one.enclosed ? " and more than their tips" : "", 1000 * one.width);
  }
  if (arguments.json) std::cout << document.dump(2) << "\n";
  return looks->empty() ? exit_no : exit_done;
}

}  // namespace

void add_taxonomy(tool::Program& program) {
  auto arguments = std::make_shared<TaxonomyArguments>();
  CLI::App* command = program.app().add_subcommand(
      "taxonomy", "Cutkosky's sixteen kinds of grasps, and which of ours imitates each.");
  command->add_option("--object", arguments->object, "says how well each kind fits this object");
  arguments->catalogue.add_to(*command);
  command
      ->add_option("--keep-free", arguments->needed,
                   "what the task needs: opening, handle, blade; kinds that lie on it do not fit")
      ->check(CLI::IsMember({"opening", "handle", "blade"}));
  command->add_option("--task", arguments->task,
                      "what is to be done with it: pour, fill, cut, ...; kinds that lie on what "
                      "this needs do not fit");
  command->add_option("--pictures", arguments->pictures,
                      "folder for a picture of each kind: a hand that grasps so");
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return show(*arguments); });
}

void add_classify(tool::Program& program) {
  auto arguments = std::make_shared<ClassifyArguments>();
  CLI::App* command =
      program.app().add_subcommand("classify",
                                   "Which kind of human grasp each planned grasp looks like. Exit "
                                   "code 0: done, 1: the plan has\n"
                                   "no grasp, 2: wrong use or file.");
  command
      ->add_option("FILE", arguments->file,
                   "that `prehend grasp plan --output` or `export --index` wrote")
      ->required();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return classify(*arguments); });
}

}  // namespace prehend::planner
