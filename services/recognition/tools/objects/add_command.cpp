// `prehend objects add`.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/base/log.hpp"
#include "common/base/to_terminal.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/model/bounding_shape.hpp"
#include "common/model/mesh.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "services/recognition/cameras/camera.hpp"
#include "services/recognition/core/rendering/strangers.hpp"
#include "services/recognition/core/rendering/training_views.hpp"
#include "services/recognition/files/catalogue_entry.hpp"
#include "services/recognition/files/model_file.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "services/recognition/service/service.hpp"
#include "services/recognition/tools/objects/commands.hpp"
#include "services/recognition/tools/taking/view_taker.hpp"

namespace prehend::recognition {
namespace {

using Clock = std::chrono::steady_clock;

/// As the service looks at pictures.
constexpr int max_side = 640;
constexpr double max_size = 2;  // m

struct AddArguments {
  service::LabArguments lab;
  std::string name, shape, mesh, model, catalogue, keep, source;
  std::vector<double> size;
  double scale = 1, mass = 0.2, limit = 60;
  int views = 16;
  bool json = false;
};

/// The next picture, nothing when there is none yet, an error when there will be none.
using Next = std::function<Expected<std::optional<Picture>>()>;

Expected<Next> from_topic(const service::Config& config) {
  auto participant = dds::Participant::create(service::membership(config, "objects-add", "viewer"));
  if (!participant) return tl::unexpected(participant.error());
  const auto shared = std::make_shared<dds::Participant>(std::move(*participant));
  auto reader = shared->reader(dds::camera_image);
  if (!reader) return tl::unexpected(reader.error());
  auto images = std::make_shared<std::decay_t<decltype(*reader)>>(std::move(*reader));
  return [shared, images, name = config.text("camera.name"),
          last = Clock::now()]() mutable -> Expected<std::optional<Picture>> {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    for (const auto& sample : images->take()) {
      if (sample.info.gone || sample.data.camera().to_string() != name) continue;
      auto picture = decode_picture(sample.data.data(), "camera/image");
      if (!picture) return tl::unexpected(picture.error());
      last = Clock::now();
      return std::move(*picture);
    }
    if (Clock::now() - last > std::chrono::seconds(10))
      return fail("no picture for 10 s", "camera/image",
                  "is prehend-recognition running? Or name a --source");
    return std::nullopt;
  };
}

/// Those that can show how an object is turned about.
std::string source_words() {
  return camera_words({CameraLine::topic, CameraLine::device, CameraLine::stream,
                       CameraLine::folder, CameraLine::nodes});
}

Expected<Next> from_camera(const service::Config& config, const std::string& source) {
  const auto [name, path] = camera_source(source);
  const auto kind = find_camera(name);
  if (!kind) return tl::unexpected(kind.error());
  const auto model = configured_camera(config);
  if (!model) return tl::unexpected(model.error());
  const CameraOptions wanted{name, path, *model, 10};
  if (kind->synthetic) return fail("shows one scene only", source, "give " + source_words());
  auto opened = open_camera(wanted, model::Catalogue(), nullptr);
  if (!opened) return tl::unexpected(opened.error());
  const std::shared_ptr<Camera> camera = std::move(*opened);
  return [camera]() -> Expected<std::optional<Picture>> {
    auto picture = camera->next();
    if (!picture) return tl::unexpected(picture.error());
    return std::move(*picture);
  };
}

constexpr std::string_view rendered = "rendered";  // of --source

/// What --size lists, and what is asked for.
struct ShapeQuestion {
  model::ShapeKind kind;
  std::size_t numbers;
  const char* sizes;
  Eigen::Vector3d (*size)(const std::vector<double>&);
};
constexpr std::array questions{
    ShapeQuestion{model::ShapeKind::box, 3, "depth, length, height",
                  [](const std::vector<double>& s) { return Eigen::Vector3d(s[0], s[1], s[2]); }},
    ShapeQuestion{model::ShapeKind::cylinder, 2, "radius, height",
                  [](const std::vector<double>& s) { return Eigen::Vector3d(s[0], s[0], s[1]); }},
    ShapeQuestion{model::ShapeKind::sphere, 1, "radius",
                  [](const std::vector<double>& s) { return Eigen::Vector3d(s[0], s[0], s[0]); }},
    ShapeQuestion{model::ShapeKind::cone, 3, "radius below, radius above, height",
                  [](const std::vector<double>& s) { return Eigen::Vector3d(s[0], s[1], s[2]); }}};

/// What bounds the mesh; the shape that was asked for, if any, of that size.
Expected<model::Shape> shape_of_mesh(const AddArguments& arguments) {
  const auto mesh = model::load_mesh(arguments.mesh, arguments.scale);
  if (!mesh) return tl::unexpected(mesh.error());
  const model::Shape made = model::bounding_shape(*mesh);
  const Eigen::Vector3d mm = 1e3 * model::bounds(*mesh).sizes();
  if (mm.maxCoeff() > max_size * 1e3 || mm.maxCoeff() < 5)
    return fail(fmt::format("is {:.6g} x {:.6g} x {:.6g} mm large", mm.x(), mm.y(), mm.z()),
                arguments.mesh, "--scale says how many metres a unit of the file is: 0.001 for mm");
  if (!arguments.size.empty() || !arguments.shape.empty())
    return fail("has its shape and size from its mesh", arguments.name,
                "leave out --shape and --size, or --mesh");
  return made;
}

/// Asks on the terminal for what the arguments do not say.
Expected<model::Shape> shape_of(AddArguments& arguments) {
  if (!arguments.mesh.empty()) return shape_of_mesh(arguments);
  const bool asks = ::isatty(STDIN_FILENO) == 1 && !arguments.json;
  const auto ask = [&](const std::string& question) {
    fmt::print(stderr, "{} ", question);
    std::string line;
    std::getline(std::cin, line);
    return line;
  };
  if (arguments.shape.empty()) {
    if (!asks)
      return fail("needs a shape", arguments.name,
                  "--shape " + model::shape_words() + ", or --mesh");
    arguments.shape = ask("Shape (" + model::shape_words() + ")?");
  }
  const auto kind = model::shape_from_string(arguments.shape);
  const auto known = std::find_if(questions.begin(), questions.end(),
                                  [&](const ShapeQuestion& each) { return each.kind == kind; });
  if (known == questions.end()) return fail("is no shape", arguments.shape, model::shape_words());
  if (arguments.size.empty()) {
    if (!asks)
      return fail("needs a size", arguments.name, std::string("--size, in m: ") + known->sizes);
    std::string line = ask(fmt::format("Size in mm ({})?", known->sizes));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    for (double v; numbers >> v;) arguments.size.push_back(v / 1000);
  }
  model::Shape made;
  if (arguments.size.size() == known->numbers) made = {*kind, known->size(arguments.size)};
  if (!model::is_valid(made) || made.size.maxCoeff() > max_size)
    return fail(
        "has no such size", arguments.shape,
        fmt::format("give --size in metres, above 0 and up to {}: {}", max_size, known->sizes));
  return made;
}

/// A folder and a line of TOML are named so.
bool is_plain(const std::string& name) {
  return !name.empty() && name.size() <= 64 && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == ' ' || c == '-' || c == '_' || c == '.' ||
                  c == '\'' || c >= 0x80;
         });
}

Expected<TrainingClass> take_views(const AddArguments& arguments, const Next& next) {
  ViewTaker taker(arguments.views);
  std::string said;
  const Clock::time_point begin = Clock::now();
  while (!taker.done()) {
    if (taker.hint() != said) log::info("{}", said = taker.hint());
    const auto picture = next();
    if (!picture && !taker.views().empty()) break;  // the source has ended; is it enough?
    if (!picture) return tl::unexpected(picture.error());
    if (std::chrono::duration<double>(Clock::now() - begin).count() > arguments.limit) break;
    if (*picture && taker.see(shrink(**picture, max_side)))
      log::info("view {} of {}", taker.views().size(), arguments.views);
  }
  if (taker.views().size() < 3)
    return fail(fmt::format("{} of at least 3 views", taker.views().size()), arguments.name,
                taker.hint());
  return TrainingClass{arguments.name, taker.views()};
}

/// From a camera, or as it would look.
Expected<TrainingClass> views_of(const AddArguments& arguments, const service::Config& config,
                                 const model::CatalogueObject& drawn) {
  if (arguments.source == rendered) {
    const auto camera = configured_camera(config);
    if (!camera) return tl::unexpected(camera.error());
    return TrainingClass{arguments.name,
                         training_views(Renderer({drawn}), drawn, *camera, arguments.views, 1)};
  }
  const bool by_topic = arguments.source.empty() || arguments.source == topic_camera().name;
  const auto next = by_topic ? from_topic(config) : from_camera(config, arguments.source);
  if (!next) return tl::unexpected(next.error());
  return take_views(arguments, *next);
}

Expected<void> keep(const std::filesystem::path& folder, const TrainingClass& views) {
  std::error_code error;
  std::filesystem::create_directories(folder / views.name, error);
  if (error) return fail(error.message(), folder.string(), "is the place writable?");
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const std::string name = fmt::format("view_{:03}", i);
    for (const auto& saved :
         {save_jpeg(folder / views.name / (name + ".jpg"), views.views[i].picture),
          save_png(folder / views.name / (name + ".mask.png"), views.views[i].mask)})
      if (!saved) return saved;
  }
  return {};
}

/// A model or a catalogue of the user's own that is not there yet begins as the lab's.
Expected<std::filesystem::path> own_model(const service::Config& config, const std::string& given) {
  const auto labs = config.path("recognition.model");
  if (given.empty()) return labs;
  std::error_code error;
  if (!std::filesystem::exists(given, error)) std::filesystem::copy_file(labs, given, error);
  if (error) return fail(error.message(), given, "it would begin as a copy of " + labs.string());
  return given;
}

Expected<std::filesystem::path> own_catalogue(const service::Config& config,
                                              const std::string& given) {
  const auto labs = config.path("lab.catalogue");
  if (given.empty()) return labs;
  if (std::error_code error; !std::filesystem::exists(given, error))
    if (auto copied = copy_catalogue(labs, given); !copied) return tl::unexpected(copied.error());
  return given;
}

int add(AddArguments& arguments) {
  const Clock::time_point begin = Clock::now();
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  if (!is_plain(arguments.name))
    return service::complain({"is no name for an object", arguments.name, "letters and digits"},
                             exit_wrong_use);
  const auto shape = shape_of(arguments);
  if (!shape) return service::complain(shape.error(), exit_wrong_use);
  const auto model_place = own_model(*config, arguments.model);
  if (!model_place) return service::complain(model_place.error(), exit_broken);
  const auto catalogue_place = own_catalogue(*config, arguments.catalogue);
  if (!catalogue_place) return service::complain(catalogue_place.error(), exit_broken);
  const auto &model_file = *model_place, &catalogue_file = *catalogue_place;
  // What would fail at the end is looked at before anybody turns an object for a minute.
  auto models = load_models(model_file);
  if (!models) return service::complain(models.error(), exit_broken);
  const auto catalogue = model::Catalogue::load(catalogue_file);
  if (!catalogue) return service::complain(catalogue.error(), exit_broken);
  const bool listed = catalogue->find(arguments.name) != nullptr;
  for (const ObjectClass& c : models->classes)
    if (c.name == arguments.name)
      return service::complain({"is known already", arguments.name, "choose another name"},
                               exit_wrong_use);

  // Without a camera it looks as the catalogue says, or as anything of its name might.
  const auto drawn =
      listed ? *catalogue->find(arguments.name) : imagined(arguments.name, *shape, arguments.mass);
  const auto views = views_of(arguments, *config, drawn);
  if (!views) return service::complain(views.error(), exit_no);
  if (!arguments.keep.empty())
    if (const auto kept = keep(arguments.keep, *views); !kept)
      return service::complain(kept.error(), exit_broken);
  const auto grown = with_class(std::move(*models), *views);
  if (!grown) return service::complain(grown.error(), exit_no);
  if (!listed) {
    const auto entry = arguments.source == rendered
                           ? drawn
                           : described_by(arguments.name, *shape, arguments.mass, views->views);
    std::optional<MeshFile> mesh;
    if (!arguments.mesh.empty()) mesh = {arguments.mesh, arguments.scale};
    if (const auto added = append_to_catalogue(catalogue_file, entry, mesh); !added)
      return service::complain(added.error(), exit_broken);
  }
  if (const auto saved = save_models(model_file, *grown); !saved)
    return service::complain(saved.error(), exit_broken);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"name", arguments.name},
                                        {"views", views->views.size()},
                                        {"classes", grown->classes.size()},
                                        {"seconds", seconds}}
              << "\n";
  else
    to_terminal(
        "{} learned from {} views in {:.0f} s; {} knows {} objects. Start recognition anew.\n",
        arguments.name, views->views.size(), seconds, model_file.string(), grown->classes.size());
  return exit_done;
}

}  // namespace

void add_add(tool::Program& program) {
  auto a = std::make_shared<AddArguments>();
  CLI::App* command = program.app().add_subcommand(
      "add",
      "Learns a new object from the camera: clear the table, put the object on it, turn it.");
  command->add_option("name", a->name, "of the object")->required();
  command->add_option("--shape", a->shape, model::shape_words() + "; else it is asked for");
  command
      ->add_option("--size", a->size,
                   "m: depth,length,height of a box; radius,height; radius; radius below,radius "
                   "above,height of a cone")
      ->delimiter(',');
  command->add_option("--mesh", a->mesh, "closed STL or OBJ, z up: instead of shape and size")
      ->check(CLI::ExistingFile);
  command->add_option("--scale", a->scale, "metres per unit of the mesh")
      ->check(CLI::PositiveNumber);
  command->add_option("--mass", a->mass, "kg")->check(CLI::Range(0.001, 20.0));
  command->add_option("--source", a->source,
                      source_words() + "; default: pictures by topic; rendered: without a camera");
  command->add_option("--views", a->views, "wanted")->check(CLI::Range(3, 60));
  command->add_option("--seconds", a->limit, "after which it goes on with what it has")
      ->check(CLI::Range(1.0, 3600.0));
  command->add_option("--keep", a->keep, "folder for the views, as `train` reads them");
  command->add_option("--model", a->model,
                      "to extend, or to begin as a copy of the lab's; else that of lab.toml");
  command->add_option("--catalogue", a->catalogue,
                      "to extend, or to begin as a copy of the lab's; else that of lab.toml");
  a->lab.add_to(*command);
  command->add_flag("--json", a->json, "one JSON document");
  program.on(*command, [a] { return add(*a); });
}

}  // namespace prehend::recognition
