#include "services/demonstration/tools/demo/task_demo.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/arm/mounting.hpp"
#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/dds/topics.hpp"
#include "common/model/arm_choice.hpp"
#include "common/service/lab.hpp"
#include "common/service/membership.hpp"
#include "services/demonstration/core/person/table.hpp"
#include "services/demonstration/files/task_file.hpp"

namespace prehend::demonstration {

namespace {

using Clock = std::chrono::steady_clock;
using Strings = std::vector<std::string>;

constexpr std::uint64_t elsewhere = 1000;  // seed of the second scene beside that of the first
constexpr std::string_view task_kind = ".task";

volatile std::sig_atomic_t interrupted = 0;

/// Ctrl-C ends the demonstration, not this program at once, so that the services are stopped.
void watch_for_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(number, &action, nullptr);
}

std::string_view to_string(v1::HandPhase phase) {
  constexpr std::array<std::string_view, 6> names{"rest", "approach", "close",
                                                  "hold", "release",  "retract"};
  const auto at = static_cast<std::size_t>(phase);
  return at < names.size() ? names[at] : "unknown";
}

std::string_view to_string(v1::GraspType type) {
  constexpr std::array<std::string_view, 4> names{"none", "power wrap", "circular sphere",
                                                  "precision"};
  const auto at = static_cast<std::size_t>(type);
  return at < names.size() ? names[at] : "unknown";
}

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

class TaskDemo {
 public:
  explicit TaskDemo(const TaskDemoOptions& options)
      : options_(options),
        end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(seconds(options.timeout))) {
  }

  Expected<TaskDemoOutcome> run() {
    if (auto ok = prepare(); !ok) return tl::unexpected(ok.error());
    if (auto ok = start(); !ok) return tl::unexpected(ok.error());
    if (is_shown())
      if (auto ok = show(); !ok) return tl::unexpected(ok.error());
    auto record = load_record(task_file_);
    if (!record) return tl::unexpected(record.error());
    outcome_.task = std::move(record->task);
    if (is_shown()) {
      const Eigen::Vector2d put = outcome_.task.steps.front().X_RO.translation().head<2>();
      if (outcome_.task.steps.front().reference == the_table)
        outcome_.place_error = (put - place_).norm();
    }
    if (auto ok = perform(); !ok) return tl::unexpected(ok.error());
    return outcome_;
  }

 private:
  bool is_shown() const { return !options_.task.ends_with(task_kind); }

  /// Scenes, and the names of all that is needed.
  Expected<void> prepare() {
    sets_ = options_.lab.overrides();
    sets_.push_back(fmt::format("lab.rig=demo-{}-{:x}", ::getpid(),
                                std::chrono::system_clock::now().time_since_epoch().count()));
    if (!options_.arm.empty()) sets_.push_back("robot.arm=" + arm_setting());
    if (!options_.hand.empty()) sets_.push_back("simulation.hand=" + options_.hand);
    auto folder = service::TemporaryFolder::create(options_.keep);
    if (!folder) return tl::unexpected(folder.error());
    folder_.emplace(std::move(*folder));
    if (options_.keep) log::info("scenes, tasks and logs are in {}", folder_->path().string());
    const auto config = service::Config::load(options_.lab.file(), sets_);
    if (!config) return tl::unexpected(config.error());
    outcome_.hand = config->text("simulation.hand");
    if (auto ok = expect_arm(config->text("robot.arm")); !ok) return ok;
    const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
    if (!catalogue) return tl::unexpected(catalogue.error());
    return is_shown() ? prepare_show(*catalogue) : prepare_known(*catalogue);
  }

  /// What runs elsewhere takes a folder by its whole path.
  std::string arm_setting() const {
    if (options_.arm.find('/') == std::string::npos) return options_.arm;
    return std::filesystem::absolute(options_.arm).string();
  }

  Expected<void> expect_arm(const std::string& name) {
    if (name.empty()) return {};
    auto arm = model::load_arm(name);
    if (!arm) return tl::unexpected(arm.error());
    const auto hand = model::HandModel::load(model::hand_directory(outcome_.hand));
    if (!hand) return tl::unexpected(hand.error());
    if (const auto fits = arm::check_fit(*arm, *hand); !fits) return fits;
    outcome_.arm = TaskDemoOutcome::Arm{arm->name};
    arm_ = std::move(*arm);
    return {};
  }

  /// Objects of a task, on a table.
  TableOptions table() const {
    TableOptions made;
    if (arm_) reachable(made);
    return made;
  }

  Expected<void> prepare_show(const model::Catalogue& catalogue) {
    TableOptions table = this->table();
    table.objects = {options_.object};
    for (const char* other : {"Cup", "Wood cube", "Vitamins"})
      if (other != options_.object && table.objects.size() < 3) table.objects.push_back(other);
    const auto shown = draw_show(catalogue, table);
    if (!shown) return tl::unexpected(shown.error());
    table.free = {place_};
    auto again = drawn_table(catalogue, options_.seed + elsewhere, table);
    if (!again) return tl::unexpected(again.error());
    sets_.push_back(fmt::format("glove.hand_scale={:.3f}", shown->demonstrator.hand_scale));
    sets_.push_back("glove.device=topic");
    sets_.push_back("demonstration.tasks=" + (folder_->path() / "tasks").string());
    const auto file = task_path(options_.task, folder_->path() / "tasks");
    if (!file) return tl::unexpected(file.error());
    task_file_ = *file;
    return write(shown_file(), *shown).and_then([&] { return write(again_file(), *again); });
  }

  /// A table, and a place on it that is free. Some tables have none.
  Expected<model::Scene> draw_show(const model::Catalogue& catalogue, const TableOptions& table) {
    constexpr std::uint64_t draws = 50;
    for (std::uint64_t n = 0;; ++n) {
      auto shown = drawn_table(catalogue, options_.seed + n * 1'000'000, table);
      if (!shown) return shown;
      const auto place = free_place(*shown, options_.seed, table);
      if (!place && n + 1 < draws) continue;
      if (!place) return tl::unexpected(place.error());
      place_ = *place;
      return shown;
    }
  }

  Expected<void> prepare_known(const model::Catalogue& catalogue) {
    task_file_ = std::filesystem::absolute(options_.task);
    const auto task = load_task(task_file_);
    if (!task) return tl::unexpected(task.error());
    TableOptions table = this->table();
    const auto need = [&](const std::string& name) {
      auto& known = table.objects;
      if (name != the_table && std::find(known.begin(), known.end(), name) == known.end())
        known.push_back(name);
    };
    for (const Step& step : task->steps) {
      need(step.object);
      need(step.reference);
      if (step.reference == the_table) table.free.push_back(step.X_RO.translation().head<2>());
    }
    auto scene = drawn_table(catalogue, options_.seed + elsewhere, table);
    if (!scene) return tl::unexpected(scene.error());
    return write(again_file(), *scene);
  }

  std::filesystem::path shown_file() const { return folder_->path() / "shown.toml"; }
  std::filesystem::path again_file() const { return folder_->path() / "again.toml"; }

  static Expected<void> write(const std::filesystem::path& file, const model::Scene& scene) {
    return write_file(file, model::to_toml(scene));
  }

  Expected<void> start() {
    const auto config = service::Config::load(options_.lab.file(), sets_);
    if (!config) return tl::unexpected(config.error());
    auto ears = Ears::create(*config);
    if (!ears) return tl::unexpected(ears.error());
    ears_.emplace(std::move(*ears));
    lab_.emplace(options_.lab.file(), sets_, folder_->path());
    std::vector<std::pair<std::string, std::filesystem::path>> services{
        {"simulation", again_file()}};
    if (is_shown()) {
      services.emplace_back("glove", shown_file());
      services.emplace_back("demonstration", shown_file());
    }
    for (const auto& [name, scene] : services)
      if (auto made = lab_->start_service(name, {"lab.scene=" + scene.string()}); !made)
        return made;
    return until("starting", [&] {
      return std::all_of(services.begin(), services.end(),
                         [&](const auto& each) { return up_.contains(each.first); });
    });
  }

  /// Listens until something holds.
  Expected<void> until(const std::string& what, const std::function<bool()>& holds,
                       std::string_view may_end = {}) {
    while (!holds()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      listen();
      options_.tell(doing_.empty() ? what : what + ", " + doing_);
      if (interrupted) return fail("interrupted", "demo", {}, exit_no);
      if (Clock::now() > end_)
        return fail(fmt::format("{} took longer than {:.0f} s", what, options_.timeout), "demo");
      if (const auto casualty = lab_->casualty(may_end)) return tl::unexpected(*casualty);
    }
    return {};
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
      if (!sample.info.gone && arm_) hear(sample.data);
    for (const auto& sample : ears_->commands.take())
      if (!sample.info.gone) outcome_.grasp_type = to_string(sample.data.grasp_type());
  }

  /// As `prehend demo --arm` counts it, but to the end of the task.
  void hear(const v1::ArmState& state) {
    for (std::size_t i = 0; i < arm_->joints.size() && i < state.velocity().size(); ++i)
      outcome_.arm->worst_joint_speed =
          std::max(outcome_.arm->worst_joint_speed,
                   std::abs(state.velocity()[i]) / arm_->joints[i].velocity);
    ++arm_states_;
    hindered_ += state.hindrance() == v1::HINDRANCE_JOINT_LIMIT ||
                 state.hindrance() == v1::HINDRANCE_COLLISION ||
                 state.hindrance() == v1::HINDRANCE_REACH;
    outcome_.arm->out_of_reach = static_cast<double>(hindered_) / arm_states_;
  }

  void hear(const v1::DemonstratedSegment& segment) {
    if (outcome_.phases.empty()) first_ns_ = segment.begin_ns();
    outcome_.phases.push_back({std::string(to_string(segment.phase())),
                               segment.object().to_string(),
                               1e-9 * static_cast<double>(segment.begin_ns() - first_ns_),
                               1e-9 * static_cast<double>(segment.end_ns() - first_ns_)});
    doing_ = std::string(to_string(segment.phase()));
  }

  /// Runs one of our programs in the lab, to its end.
  Expected<service::Process::Exit> run(const std::string& what, const std::string& program,
                                       Strings arguments, const std::filesystem::path& scene,
                                       const std::filesystem::path& output = {}) {
    Strings command{(program_directory() / program).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--config", options_.lab.file()});
    Strings sets = sets_;
    sets.push_back("lab.scene=" + scene.string());
    for (const std::string& set : sets) command.insert(command.end(), {"--set", set});
    auto process = service::Process::start(
        {.command = command, .log = folder_->path() / (program + ".log"), .output = output});
    if (!process) return tl::unexpected(process.error());
    std::optional<service::Process::Exit> exit;
    if (auto ok = until(what, [&] { return (exit = process->exit()).has_value(); }); !ok)
      return tl::unexpected(ok.error());
    return *exit;
  }

  Expected<void> order(const std::string& which) {
    const auto exit =
        run("showing", "prehend-demonstrate", {"--name", options_.task, which}, shown_file());
    if (!exit) return tl::unexpected(exit.error());
    if (exit->code == exit_done) return {};
    return fail(service::last_lines(folder_->path() / "prehend-demonstrate.log", 1), "demonstrate",
                {}, exit_no);
  }

  Expected<void> show() {
    if (auto ok = order("--begin"); !ok) return ok;
    const auto exit =
        run("showing", "prehend-person",
            {"--put", fmt::format("{}={:.4f},{:.4f}", options_.object, place_.x(), place_.y()),
             "--seed", std::to_string(options_.seed)},
            shown_file());
    if (!exit) return tl::unexpected(exit.error());
    if (exit->code != exit_done)
      return fail(service::last_lines(folder_->path() / "prehend-person.log", 1), "person");
    return order("--end");
  }

  Expected<void> perform() {
    doing_.clear();
    const auto output = folder_->path() / "performed.json";
    const auto exit = run("doing it again", "prehend-tasks", {"run", task_file_.string(), "--json"},
                          again_file(), output);
    if (!exit) return tl::unexpected(exit.error());
    listen();
    const auto text = read_file(output);
    const auto document = nlohmann::json::parse(text.value_or(""), nullptr, false);
    if (!document.is_object()) {
      outcome_.reason = service::last_lines(folder_->path() / "prehend-tasks.log", 1);
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

  const TaskDemoOptions& options_;
  Clock::time_point end_;
  Strings sets_;
  std::optional<service::TemporaryFolder> folder_;
  std::filesystem::path task_file_;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();  // where the object is put, as shown
  std::optional<model::ArmModel> arm_;
  int arm_states_ = 0, hindered_ = 0;
  std::optional<Ears> ears_;
  std::optional<service::Lab> lab_;  // after the folder: stopped before it is removed
  std::set<std::string> up_;
  std::int64_t first_ns_ = 0;
  std::string doing_;
  TaskDemoOutcome outcome_;
};

}  // namespace

Expected<TaskDemoOutcome> run_task_demo(const TaskDemoOptions& options) {
  watch_for_interrupts();
  return TaskDemo(options).run();
}

}  // namespace prehend::demonstration
