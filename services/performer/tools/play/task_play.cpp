#include "services/performer/tools/play/task_play.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/convert/names.hpp"
#include "common/dds/topics.hpp"
#include "common/service/membership.hpp"
#include "common/tasks/files/task_file.hpp"
#include "common/tasks/table.hpp"

namespace prehend::performer {

namespace {

constexpr std::uint64_t elsewhere = 1000;  // seed of the second scene beside that of the first
constexpr std::string_view task_kind = ".task";

/// What the lab says.
struct Ears {
  dds::Participant participant;
  dds::Reader<v1::ServiceStatus> statuses;
  dds::Reader<v1::GloveFrame> frames;
  dds::Reader<v1::DemonstratedSegment> segments;
  dds::Reader<v1::TaskProgress> progress;
  dds::Reader<v1::GraspReport> reports;
  dds::Reader<v2::HandCommand> commands;
  dds::Reader<v1::ArmState> arms;

  static Expected<Ears> create(const service::Config& config) {
    auto made = dds::Participant::create(service::membership(config, "prehend", "viewer"));
    if (!made) return tl::unexpected(made.error());
    auto statuses = made->reader(dds::service_status);
    auto frames = made->reader(dds::glove_frame);
    auto segments = made->reader(dds::demonstration_segment);
    auto progress = made->reader(dds::task_progress);
    auto reports = made->reader(dds::grasp_report);
    auto commands = made->reader(dds::robot_command);
    auto arms = made->reader(dds::arm_state);
    if (!arms) return tl::unexpected(arms.error());
    if (!statuses) return tl::unexpected(statuses.error());
    if (!frames) return tl::unexpected(frames.error());
    if (!segments) return tl::unexpected(segments.error());
    if (!progress) return tl::unexpected(progress.error());
    if (!reports) return tl::unexpected(reports.error());
    if (!commands) return tl::unexpected(commands.error());
    return Ears{std::move(*made),     std::move(*statuses), std::move(*frames),
                std::move(*segments), std::move(*progress), std::move(*reports),
                std::move(*commands), std::move(*arms)};
  }
};

/// A person shows, the lab understands, and a performer does it again elsewhere.
class TaskPlay {
 public:
  /// Both must outlive it.
  TaskPlay(const TaskPlayOptions& options, stage::Stage& stage)
      : options_(options), stage_(stage) {}

  Expected<TaskPlayOutcome> run() {
    if (auto ok = prepare(); !ok) return tl::unexpected(ok.error());
    if (auto ok = put_up(); !ok) return tl::unexpected(ok.error());
    if (is_shown())
      if (auto ok = show(); !ok) return tl::unexpected(ok.error());
    auto record = tasks::load_record(task_file_);
    if (!record) return tl::unexpected(record.error());
    outcome_.task = std::move(record->task);
    if (is_shown()) {
      const Eigen::Vector2d put = outcome_.task.steps.front().X_RO.translation().head<2>();
      if (outcome_.task.steps.front().reference == tasks::the_table)
        outcome_.place_error = (put - place_).norm();
    }
    if (auto ok = perform(); !ok) return tl::unexpected(ok.error());
    outcome_.arm = arm_;
    return outcome_;
  }

 private:
  bool is_shown() const { return !options_.task.ends_with(task_kind); }

  /// Scenes, and the names of all that is needed.
  Expected<void> prepare() {
    if (!options_.arm.empty()) stage_.set("robot.arm=" + arm_setting());
    if (!options_.hand.empty()) stage_.set("simulation.hand=" + options_.hand);
    if (options_.keep) log::info("scenes, tasks and logs are in {}", stage_.folder().string());
    const auto config = stage_.config();
    if (!config) return tl::unexpected(config.error());
    outcome_.hand = config->text("simulation.hand");
    const auto arm = stage::carrying_arm(*config);
    if (!arm) return tl::unexpected(arm.error());
    if (*arm) arm_.emplace(**arm);
    const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
    if (!catalogue) return tl::unexpected(catalogue.error());
    return is_shown() ? prepare_show(*catalogue) : prepare_known(*catalogue);
  }

  /// What runs elsewhere takes a folder by its whole path.
  std::string arm_setting() const {
    if (options_.arm.find('/') == std::string::npos) return options_.arm;
    return std::filesystem::absolute(options_.arm).string();
  }

  /// Objects of a task, on a table.
  tasks::TableOptions table() const {
    tasks::TableOptions made;
    if (arm_) tasks::reachable(made);
    return made;
  }

  Expected<void> prepare_show(const model::Catalogue& catalogue) {
    tasks::TableOptions table = this->table();
    table.objects = {options_.object};
    for (const char* other : {"Cup", "Wood cube", "Vitamins"})
      if (other != options_.object && table.objects.size() < 3) table.objects.push_back(other);
    const auto shown = draw_show(catalogue, table);
    if (!shown) return tl::unexpected(shown.error());
    table.free = {place_};
    auto again = tasks::drawn_table(catalogue, options_.seed + elsewhere, table);
    if (!again) return tl::unexpected(again.error());
    stage_.set(fmt::format("glove.hand_scale={:.3f}", shown->demonstrator.hand_scale));
    stage_.set("glove.device=topic");
    stage_.set("demonstration.tasks=" + (stage_.folder() / "tasks").string());
    const auto file = tasks::task_path(options_.task, stage_.folder() / "tasks");
    if (!file) return tl::unexpected(file.error());
    task_file_ = *file;
    return write(shown_file(), *shown).and_then([&] { return write(again_file(), *again); });
  }

  /// A table, and a place on it that is free. Some tables have none.
  Expected<model::Scene> draw_show(const model::Catalogue& catalogue,
                                   const tasks::TableOptions& table) {
    constexpr std::uint64_t draws = 50;
    for (std::uint64_t n = 0;; ++n) {
      auto shown = tasks::drawn_table(catalogue, options_.seed + n * 1'000'000, table);
      if (!shown) return shown;
      const auto place = tasks::free_place(*shown, options_.seed, table);
      if (!place && n + 1 < draws) continue;
      if (!place) return tl::unexpected(place.error());
      place_ = *place;
      return shown;
    }
  }

  Expected<void> prepare_known(const model::Catalogue& catalogue) {
    task_file_ = std::filesystem::absolute(options_.task);
    const auto task = tasks::load_task(task_file_);
    if (!task) return tl::unexpected(task.error());
    tasks::TableOptions table = this->table();
    const auto need = [&](const std::string& name) {
      auto& known = table.objects;
      if (name != tasks::the_table && std::find(known.begin(), known.end(), name) == known.end())
        known.push_back(name);
    };
    for (const tasks::Step& step : task->steps) {
      need(step.object);
      need(step.reference);
      if (step.reference == tasks::the_table)
        table.free.push_back(step.X_RO.translation().head<2>());
    }
    auto scene = tasks::drawn_table(catalogue, options_.seed + elsewhere, table);
    if (!scene) return tl::unexpected(scene.error());
    return write(again_file(), *scene);
  }

  std::filesystem::path shown_file() const { return stage_.folder() / "shown.toml"; }
  std::filesystem::path again_file() const { return stage_.folder() / "again.toml"; }

  static Expected<void> write(const std::filesystem::path& file, const model::Scene& scene) {
    return write_file(file, model::to_toml(scene));
  }

  Expected<void> put_up() {
    const auto config = stage_.config();
    if (!config) return tl::unexpected(config.error());
    auto ears = Ears::create(*config);
    if (!ears) return tl::unexpected(ears.error());
    ears_.emplace(std::move(*ears));
    stage_.on_look([this] {
      listen();
      return doing_;
    });
    std::vector<std::pair<std::string, std::filesystem::path>> services{
        {"simulation", again_file()}};
    if (is_shown()) {
      services.emplace_back("glove", shown_file());
      services.emplace_back("demonstration", shown_file());
    }
    for (const auto& [name, scene] : services)
      if (auto made = stage_.start_service(name, {"lab.scene=" + scene.string()}); !made)
        return made;
    return stage_.until(
        "starting",
        [&] {
          return std::all_of(services.begin(), services.end(),
                             [&](const auto& each) { return up_.contains(each.first); });
        },
        [] {
          return Error{"the services did not come up", "demo", {}};
        });
  }

  void listen() {
    for (const auto& sample : ears_->statuses.take())
      if (!sample.info.gone &&
          (sample.data.state() == v1::STATE_RUNNING || sample.data.state() == v1::STATE_DEGRADED))
        up_.insert(sample.data.name().to_string());
    for (const auto& sample : ears_->frames.take())
      if (!sample.info.gone)
        outcome_.frames =
            std::max<std::uint64_t>(outcome_.frames, sample.data.sequence_number() + 1);
    for (const auto& sample : ears_->segments.take())
      if (!sample.info.gone) hear(sample.data);
    for (const auto& sample : ears_->progress.take())
      if (!sample.info.gone)
        doing_ = fmt::format("{:.0f} % of the task", 100 * sample.data.share());
    for (const auto& sample : ears_->reports.take())
      if (!sample.info.gone && !outcome_.grasp)
        outcome_.grasp = {static_cast<int>(sample.data.contacts().size()), sample.data.epsilon(),
                          sample.data.volume(), sample.data.force_closure(), sample.data.held()};
    for (const auto& sample : ears_->arms.take())
      if (!sample.info.gone && arm_) arm_->hear(sample.data);
    for (const auto& sample : ears_->commands.take())
      if (!sample.info.gone)
        outcome_.grasp_type = convert::grasp_names.name(sample.data.grasp_type(), "none");
  }

  void hear(const v1::DemonstratedSegment& segment) {
    if (outcome_.phases.empty()) first_ns_ = segment.begin_ns();
    const std::string phase(convert::phase_names.name(segment.phase()));
    outcome_.phases.push_back({phase, segment.object().to_string(),
                               1e-9 * static_cast<double>(segment.begin_ns() - first_ns_),
                               1e-9 * static_cast<double>(segment.end_ns() - first_ns_)});
    doing_ = phase;
  }

  std::vector<std::string> in_show() const { return {"lab.scene=" + shown_file().string()}; }

  Expected<void> order(const std::string& which) {
    const auto exit =
        stage_.run("showing", "prehend-demonstrate", {"--name", options_.task, which}, in_show());
    if (!exit) return tl::unexpected(exit.error());
    if (exit->code == exit_done) return {};
    return fail(stage_.last_words("prehend-demonstrate"), "demonstrate", {}, exit_no);
  }

  /// Once more where the lab refused what it saw: on a busy machine a hand is not seen for a while.
  Expected<void> show() {
    auto shown = show_once();
    if (shown || shown.error().exit != exit_no) return shown;
    log::warning("it is shown again, since: {}", shown.error().message());
    outcome_.phases.clear();
    return show_once();
  }

  Expected<void> show_once() {
    if (auto ok = order("--begin"); !ok) return ok;
    const auto exit = stage_.run(
        "showing", "prehend-person",
        {"--put", fmt::format("{}={:.4f},{:.4f}", options_.object, place_.x(), place_.y()),
         "--seed", std::to_string(options_.seed)},
        in_show());
    if (!exit) return tl::unexpected(exit.error());
    if (exit->code != exit_done) return fail(stage_.last_words("prehend-person"), "person");
    return order("--end");
  }

  Expected<void> perform() {
    doing_.clear();
    const auto output = stage_.folder() / "performed.json";
    const auto exit =
        stage_.run("doing it again", "prehend-tasks", {"run", task_file_.string(), "--json"},
                   {"lab.scene=" + again_file().string()}, output);
    if (!exit) return tl::unexpected(exit.error());
    listen();
    const auto text = read_file(output);
    const auto document = nlohmann::json::parse(text.value_or(""), nullptr, false);
    if (!document.is_object()) {
      outcome_.reason = stage_.last_words("prehend-tasks");
      return {};
    }
    outcome_.done = document.value("done", false);
    outcome_.reason = document.value("reason", "");
    for (const auto& step : document["steps"])
      outcome_.steps.push_back({step.value("object", ""), step.value("reason", ""),
                                step.value("done", false), step.value("error_m", 0.0),
                                step.value("error_rad", 0.0)});
    return {};
  }

  const TaskPlayOptions& options_;
  stage::Stage& stage_;
  std::filesystem::path task_file_;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();  // where the object is put, as shown
  std::optional<stage::ArmUse> arm_;
  std::optional<Ears> ears_;
  std::set<std::string> up_;
  std::int64_t first_ns_ = 0;
  std::string doing_;
  TaskPlayOutcome outcome_;
};

}  // namespace

Expected<TaskPlayOutcome> play_task(const TaskPlayOptions& options) {
  auto stage = stage::Stage::create({options.lab, options.timeout, options.keep, options.tell});
  if (!stage) return tl::unexpected(stage.error());
  return TaskPlay(options, *stage).run();
}

}  // namespace prehend::performer
