// prehend-person: a person who does not exist shows a task, for who has neither glove nor camera;
// or nobody, where simulated objects are to be seen as by their markers.
#include "services/demonstration/tools/person/person_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "common/base/finite_number.hpp"
#include "common/dds/topics.hpp"
#include "common/service/arguments.hpp"
#include "common/service/shell.hpp"
#include "services/demonstration/tools/person/outputs.hpp"

namespace prehend::demonstration {
namespace {

constexpr Duration frame_period = std::chrono::microseconds(33'333);
constexpr int frames_a_picture = 3;
/// A hand that is heard only once it moves has never been at rest: all have met meanwhile.
constexpr Duration at_rest = std::chrono::seconds(1);

struct Arguments {
  service::LabArguments lab;
  std::vector<std::string> puts;  // OBJECT=x,y[,z]
  bool markers = false;
  std::uint64_t seed = 1;
};

Expected<std::unique_ptr<service::Shell>> join(const Arguments& arguments) {
  return service::Shell::create(
      arguments.lab.for_service(),
      {.name = "person", .description = "Shows a task.", .role = "replayer", .restarts = false});
}

Expected<Transfer> transfer_of(const std::string& text, const model::Catalogue& catalogue) {
  const auto wrong = [&] {
    return wrong_use("is no OBJECT=x,y or OBJECT=x,y,z", text, "metres on the table");
  };
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) return wrong();
  Transfer made{text.substr(0, equals), Eigen::Vector3d::Zero(), 0};
  const model::CatalogueObject* known = catalogue.find(made.object);
  if (!known) return wrong_use("is not in the catalogue", made.object);
  const auto numbers = finite_list(std::string_view(text).substr(equals + 1));
  if (!numbers || (numbers->size() != 2 && numbers->size() != 3) ||
      std::any_of(numbers->begin(), numbers->end(), [](double n) { return std::abs(n) >= 5; }))
    return wrong();
  made.to = {(*numbers)[0], (*numbers)[1],
             numbers->size() == 3 ? (*numbers)[2] : model::half_extents(known->shape).z()};
  return made;
}

Expected<Exit> show(const Arguments& arguments) {
  auto shell = join(arguments);
  if (!shell) return tl::unexpected(shell.error());
  const auto catalogue = model::Catalogue::load((*shell)->config().path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto scene = model::load_scene((*shell)->config().path("lab.scene"), *catalogue);
  if (!scene) return tl::unexpected(scene.error());
  std::vector<Transfer> transfers;
  for (const std::string& put : arguments.puts) {
    auto transfer = transfer_of(put, *catalogue);
    if (!transfer) return tl::unexpected(transfer.error());
    transfers.push_back(std::move(*transfer));
  }
  const auto person = Person::create(*scene, *catalogue, transfers, arguments.seed);
  if (!person) return tl::unexpected(person.error());
  const Output hand = hand_output(**shell, *person, 2 * arguments.seed);
  const Output objects = object_output(**shell, *person, 2 * arguments.seed + 1);
  (*shell)->status().running();
  std::optional<Time> begun;
  int frame = 0;
  (*shell)->on_tick(frame_period, [&](Time now) {
    if (!begun) begun = now;
    const double t = std::max(0.0, to_seconds(now - *begun - at_rest));
    if (t > person->duration()) return (*shell)->stop();
    if (frame++ % frames_a_picture == 0) objects(t, now);
    hand(t, now);
  });
  return (*shell)->run();
}

Expected<Exit> see_markers(const Arguments& arguments) {
  auto shell = join(arguments);
  if (!shell) return tl::unexpected(shell.error());
  const auto catalogue = model::Catalogue::load((*shell)->config().path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  const MarkerOutput markers = marker_output(**shell, *catalogue, arguments.seed);
  (*shell)->subscribe(dds::object_state,
                      std::function([&](const v1::ObjectState& state, const dds::SampleInfo& info) {
                        if (!info.gone) markers(state);
                      }));
  (*shell)->status().running();
  return (*shell)->run();
}

}  // namespace

int person_command(const std::vector<std::string>& texts) {
  CLI::App app{
      "A person who does not exist takes objects of the scene (lab.scene) and puts them elsewhere, "
      "one "
      "after\nthe other; writes glove/frame and object/detection. Or, with --markers, only says "
      "where\nsimulated objects are, as cameras do that see markers on them. For demonstrations "
      "and "
      "tests.",
      "prehend-person"};
  Arguments arguments;
  arguments.lab.add_to(app);
  auto* all = app.add_option_group("what is shown")->require_option(1);
  all->add_option("--put", arguments.puts,
                  "OBJECT=x,y or OBJECT=x,y,z of its centre, m; repeatable")
      ->type_size(1)
      ->allow_extra_args(false);
  all->add_flag("--markers", arguments.markers, "where the simulation has its objects");
  app.add_option("--seed", arguments.seed, "of its times and of noise")->capture_default_str();
  if (const auto code = service::parse(app, texts)) return *code;
  const auto ended = arguments.markers ? see_markers(arguments) : show(arguments);
  return ended ? *ended : service::complain(ended.error());
}

}  // namespace prehend::demonstration
