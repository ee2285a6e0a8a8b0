// `prehend objects add`.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/base/log.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "services/recognition/cameras/camera.hpp"
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

struct AddArguments {
  service::LabArguments lab;
  std::string name, shape, model, catalogue, keep, source;
  std::vector<double> size;
  double mass = 0.2, limit = 60;
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
  return camera_words(
      {CameraLine::topic, CameraLine::device, CameraLine::stream, CameraLine::folder});
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

/// Asks on the terminal for what the arguments do not say.
Expected<model::Shape> shape_of(AddArguments& arguments) {
  const bool asks = ::isatty(STDIN_FILENO) == 1 && !arguments.json;
  const auto ask = [&](const char* question) {
    fmt::print(stderr, "{} ", question);
    std::string line;
    std::getline(std::cin, line);
    return line;
  };
  if (arguments.shape.empty()) {
    if (!asks) return fail("needs a shape", arguments.name, "--shape box or cylinder or sphere");
    arguments.shape = ask("Shape (box, cylinder, sphere)?");
  }
  model::Shape made;
  const auto kind = model::shape_from_string(arguments.shape);
  if (!kind || *kind == model::ShapeKind::unknown)
    return fail("is no shape", arguments.shape, "box, cylinder or sphere");
  made.kind = *kind;
  const char* question = *kind == model::ShapeKind::box        ? "Depth, length, height in mm?"
                         : *kind == model::ShapeKind::cylinder ? "Radius, height in mm?"
                                                               : "Radius in mm?";
  if (arguments.size.empty()) {
    if (!asks)
      return fail("needs a size", arguments.name, std::string("--size, in m: ") + question);
    std::string line = ask(question);
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    for (double v; numbers >> v;) arguments.size.push_back(v / 1000);
  }
  const std::vector<double>& s = arguments.size;
  if (*kind == model::ShapeKind::box && s.size() == 3) made.size = {s[0], s[1], s[2]};
  if (*kind == model::ShapeKind::cylinder && s.size() == 2) made.size = {s[0], s[0], s[1]};
  if (*kind == model::ShapeKind::sphere && s.size() == 1) made.size = {s[0], s[0], s[0]};
  if (!model::is_valid(made) || made.size.maxCoeff() > 2)
    return fail("is no size in metres", arguments.shape, question);
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
    return fail(fmt::format("only {} view(s)", taker.views().size()), arguments.name, taker.hint());
  return TrainingClass{arguments.name, taker.views()};
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

int add(AddArguments& arguments) {
  const Clock::time_point begin = Clock::now();
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  if (!is_plain(arguments.name))
    return service::complain({"is no name for an object", arguments.name, "letters and digits"},
                             exit_wrong_use);
  const auto shape = shape_of(arguments);
  if (!shape) return service::complain(shape.error(), exit_wrong_use);
  const auto path = [&](const std::string& given, const char* key) {
    return given.empty() ? config->path(key) : std::filesystem::path(given);
  };
  const auto model_file = path(arguments.model, "recognition.model");
  const auto catalogue_file = path(arguments.catalogue, "lab.catalogue");
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

  const bool by_topic = arguments.source.empty() || arguments.source == topic_camera().name;
  const auto next = by_topic ? from_topic(*config) : from_camera(*config, arguments.source);
  if (!next) return service::complain(next.error(), exit_broken);
  const auto views = take_views(arguments, *next);
  if (!views) return service::complain(views.error(), exit_no);
  if (!arguments.keep.empty())
    if (const auto kept = keep(arguments.keep, *views); !kept)
      return service::complain(kept.error(), exit_broken);
  const auto grown = with_class(std::move(*models), *views);
  if (!grown) return service::complain(grown.error(), exit_no);
  if (!listed) {
    const auto entry = described_by(arguments.name, *shape, arguments.mass, views->views);
    if (const auto added = append_to_catalogue(catalogue_file, entry); !added)
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
    fmt::print(
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
  command->add_option("--shape", a->shape, "box, cylinder or sphere; else it is asked for");
  command->add_option("--size", a->size, "m: depth,length,height, or radius,height, or radius")
      ->delimiter(',');
  command->add_option("--mass", a->mass, "kg")->check(CLI::Range(0.001, 20.0));
  command->add_option("--source", a->source, source_words() + "; default: pictures by topic");
  command->add_option("--views", a->views, "wanted")->check(CLI::Range(3, 60));
  command->add_option("--seconds", a->limit, "after which it goes on with what it has")
      ->check(CLI::Range(1.0, 3600.0));
  command->add_option("--keep", a->keep, "folder for the views, as `train` reads them");
  command->add_option("--model", a->model, "to extend; else that of lab.toml");
  command->add_option("--catalogue", a->catalogue, "to extend; else that of lab.toml");
  a->lab.add_to(*command);
  command->add_flag("--json", a->json, "one JSON document");
  program.on(*command, [a] { return add(*a); });
}

}  // namespace prehend::recognition
