#include "services/demonstration/service/service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/task_kinds.hpp"
#include "common/service/order_book.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/demonstration/core/observation/grasp_judge.hpp"
#include "services/demonstration/core/observation/task_prior.hpp"
#include "services/demonstration/core/observation/watcher.hpp"
#include "services/demonstration/files/recogniser_file.hpp"
#include "services/demonstration/service/messages.hpp"

namespace prehend::demonstration {

namespace {

constexpr const char* our_name = "demonstration";
constexpr Duration patience = std::chrono::milliseconds(500);  // with a hand that is silent

/// What the service was started with.
struct Setting {
  model::GraspTaxonomy taxonomy;
  model::TaskKinds task_kinds;
  model::Catalogue catalogue;
  std::vector<TaskRecogniser> recognisers;  // the first one is used
  std::filesystem::path folder;             // of tasks; empty: none is kept
  std::map<std::string, tasks::TaskRecord> tasks;
  std::string glove;
  double accept = 0;
  bool simulated = false;  // objects are those of object/state
};

std::string in_words(const tasks::TaskModel& task) {
  std::vector<std::string> words;
  for (const tasks::Step& step : task.steps) {
    const Eigen::Vector3d p = step.X_RO.translation();
    words.push_back(fmt::format("{} ({}) to {:.0f}, {:.0f} cm of {}", step.object,
                                step.grasp.empty() ? "any grasp" : step.grasp, 100 * p.x(),
                                100 * p.y(), step.reference));
  }
  return fmt::format("{}: {}", task.name, fmt::join(words, "; then "));
}

Expected<std::map<std::string, tasks::TaskRecord>> tasks_in(const std::filesystem::path& folder) {
  std::map<std::string, tasks::TaskRecord> made;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(error.message(), folder.string(), "set demonstration.tasks");
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().extension() != ".task") continue;
    auto record = tasks::load_record(at->path());
    if (record)
      made[record->task.name] = std::move(*record);
    else
      log::warning(record.error());  // one damaged file does not make us forget the others
  }
  return made;
}

}  // namespace

class Service::Topics {
 public:
  Topics(service::Shell& shell, Setting setting)
      : shell_(shell),
        setting_(std::move(setting)),
        judge_(setting_.taxonomy,
               setting_.recognisers.empty() ? nullptr : &setting_.recognisers.front().recogniser,
               learnt_objects()),
        watcher_(WatcherOptions{}),
        grasps_(shell.publish(dds::demonstration_grasp)),
        segments_(shell.publish(dds::demonstration_segment)),
        models_(shell.publish(dds::task_model)),
        replies_(shell.publish(dds::operator_reply)) {
    shell.subscribe(dds::hand_posture,
                    Handler<v1::HandPosture>([this](auto& s, auto& i) { on_posture(s, i); }));
    shell.subscribe(dds::object_detection,
                    Handler<v1::ObjectDetection>([this](auto& s, auto& i) { on_detection(s, i); }));
    shell.subscribe(dds::object_state,
                    Handler<v1::ObjectState>([this](auto& s, auto& i) { on_state(s, i); }));
    shell.subscribe(dds::operator_command,
                    Handler<v1::OperatorCommand>([this](auto& s, auto& i) { on_order(s, i); }));
    shell.on_tick(std::chrono::milliseconds(200), [this](Time now) { on_tick(now); });
  }

 private:
  template <class T>
  using Handler = std::function<void(const T&, const dds::SampleInfo&)>;

  void on_posture(const v1::HandPosture& message, const dds::SampleInfo& info) {
    if (info.gone) return;
    if (message.glove().to_string() != setting_.glove)
      return shell_.status().drop("posture of another glove");
    const Time now = shell_.now();
    if (followed_ && *followed_ != info.participant && now - last_posture_ < patience) {
      second_ = now;
      return shell_.status().drop("posture of a second hand");
    }
    followed_ = info.participant;
    last_posture_ = now;
    const auto hand = hand_from_message(message);
    if (!hand) return shell_.status().drop(hand.error().what);
    const SeenObject* object = watcher_.object_at(*hand);
    const std::string name = object ? object->name : std::string();
    if (name != at_) judge_.begin();
    at_ = name;
    judge_.expect(prior_of_task(name));
    v1::DemonstratedGrasp grasp =
        to_message(judge_.kinds(), judge_.see(*hand, object), setting_.accept);
    // A hand that is at nothing grasps nothing.
    if (!object) grasp.grasp("");
    const std::string kind = grasp.grasp().to_string();
    if (auto seen = watcher_.see(*hand, kind); !seen)
      return shell_.status().drop(seen.error().what);
    grasp.glove(message.glove());
    grasp.sequence_number(grasp_count_++);
    grasp.stamp_ns(message.stamp_ns());
    grasp.origin_ns(message.origin_ns());
    grasp.object(name);
    grasps_.publish(grasp);
    shell_.status().latency("posture to grasp", shell_.now() - now);
    for (const TimedSegment& each : watcher_.news()) publish(each, message.stamp_ns());
    origin_ns_ = message.origin_ns();
  }

  const ObjectLikelihood* learnt_objects() const {
    if (setting_.recognisers.empty()) return nullptr;
    const auto& objects = setting_.recognisers.front().objects;
    return objects ? &*objects : nullptr;
  }

  /// What the task that is being shown says of grasps; nothing where none is.
  Eigen::VectorXd prior_of_task(const std::string& object) const {
    if (!watcher_.task() || object.empty()) return {};
    const auto known = setting_.tasks.find(*watcher_.task());
    const auto keep_free = setting_.task_kinds.keep_free(*watcher_.task());
    if (known == setting_.tasks.end() && keep_free.empty()) return {};
    static const std::vector<tasks::ShownTask> never;
    return task_prior(judge_.kinds(), setting_.taxonomy, keep_free,
                      known == setting_.tasks.end() ? never : known->second.shown, object);
  }

  void on_detection(const v1::ObjectDetection& message, const dds::SampleInfo& info) {
    if (info.gone || setting_.simulated) return;
    take(object_from_message(message));
  }

  void on_state(const v1::ObjectState& message, const dds::SampleInfo& info) {
    if (info.gone || !setting_.simulated) return;
    const auto X_WO = convert::from_message(message.X_WO());
    if (!X_WO) return shell_.status().drop("pose of an object not usable");
    const model::CatalogueObject* known = setting_.catalogue.find(message.body().to_string());
    if (!known) return shell_.status().drop("object that is not in the catalogue");
    take(SeenObject{from_ns(message.stamp_ns()), known->name, known->shape, *X_WO});
  }

  void take(const Expected<SeenObject>& object) {
    const auto seen =
        object.and_then([this](const SeenObject& value) { return watcher_.see(value); });
    if (!seen) shell_.status().drop(seen.error().what);
  }

  void on_order(const v1::OperatorCommand& message, const dds::SampleInfo& info) {
    if (info.gone || message.target().to_string() != our_name) return;
    const auto action = message.action();
    if (action != v1::ACTION_START && action != v1::ACTION_STOP) return;
    if (const auto known = orders_.find(message.id().to_string())) return replies_.publish(*known);
    const std::string argument = message.argument().to_string();
    const auto answer = action == v1::ACTION_START ? begin(argument) : end(argument);
    v1::OperatorReply reply;
    reply.id(message.id());
    reply.stamp_ns(to_ns(shell_.now()));
    reply.service(our_name);
    reply.done(answer.has_value());
    reply.message((answer ? *answer : answer.error().message()).substr(0, 255));
    if (answer)
      log::info("{}", *answer);
    else
      log::warning(answer.error());
    orders_.add(reply);
    replies_.publish(reply);
  }

  Expected<std::string> begin(const std::string& task) {
    if (auto path = tasks::task_path(task, "."); !path || task.ends_with(".task"))
      return wrong_use("cannot be the name of a task", task,
                       "use letters, digits, spaces, dots, - and _");
    if (auto begun = watcher_.begin(task, shell_.now()); !begun)
      return tl::unexpected(begun.error());
    return "watching " + task;
  }

  Expected<std::string> end(const std::string& task) {
    if (watcher_.task() && !task.empty() && task != *watcher_.task())
      return fail("is not being shown; what is shown is " + *watcher_.task(), task);
    std::vector<TimedSegment> rest;
    shown_ = watcher_.task().value_or("");
    const Time now = shell_.now();
    const auto seen = watcher_.end(now, rest);
    for (const TimedSegment& each : rest) publish(each, to_ns(now));
    if (!seen) return tl::unexpected(seen.error());
    return learn(*seen, now);
  }

  Expected<std::string> learn(const Demonstration& seen, Time now) {
    tasks::TaskRecord record;
    if (const auto known = setting_.tasks.find(seen.task); known != setting_.tasks.end())
      record = known->second;
    record.shown.push_back(seen.steps);
    auto task = learn_task(seen.task, record.shown);
    if (!task) return tl::unexpected(task.error());
    record.task = std::move(*task);
    if (!setting_.folder.empty()) {
      const auto saved =
          tasks::task_path(seen.task, setting_.folder).and_then([&](const auto& path) {
            return tasks::save_record(path, record);
          });
      if (!saved) return tl::unexpected(saved.error());
    }
    publish(record.task, now);
    setting_.tasks[seen.task] = std::move(record);
    return in_words(setting_.tasks[seen.task].task);
  }

  void publish(const TimedSegment& segment, std::int64_t stamp_ns) {
    v1::DemonstratedSegment message = to_message(segment);
    message.glove(setting_.glove);
    message.sequence_number(segment_count_++);
    message.stamp_ns(stamp_ns);
    message.origin_ns(origin_ns_);
    message.task(watcher_.task().value_or(shown_));
    segments_.publish(message);
  }

  void publish(const tasks::TaskModel& task, Time now) {
    v1::TaskModel message = to_message(task);
    message.sequence_number(model_count_++);
    message.stamp_ns(to_ns(now));
    models_.publish(message);
  }

  void on_tick(Time now) {
    if (!told_) {
      told_ = true;
      for (const auto& [name, record] : setting_.tasks) publish(record.task, now);
    }
    std::string line;
    if (second_ && now - *second_ < patience)
      line = "a second hand is shown; the first one is followed";
    else if (watcher_.task() && now - last_posture_ > patience)
      line = "the hand is not seen while " + *watcher_.task() + " is shown";
    if (line == line_) return;
    line_ = line;
    if (line.empty()) return shell_.status().running();
    log::warning("{}", line);
    shell_.status().degraded(line);
  }

  service::Shell& shell_;
  Setting setting_;
  GraspJudge judge_;
  Watcher watcher_;
  service::OrderBook orders_;
  service::Shell::Output<v1::DemonstratedGrasp> grasps_;
  service::Shell::Output<v1::DemonstratedSegment> segments_;
  service::Shell::Output<v1::TaskModel> models_;
  service::Shell::Output<v1::OperatorReply> replies_;
  std::optional<dds::GuidPrefix> followed_;
  Time last_posture_{};
  std::optional<Time> second_;     // when a second hand was seen
  std::string at_, shown_, line_;  // object that the hand is at; task that ended; complaint
  std::int64_t origin_ns_ = 0;
  std::uint64_t grasp_count_ = 0, segment_count_ = 0, model_count_ = 0;
  bool told_ = false;
};

Service::Service(std::unique_ptr<Topics> topics) : topics_(std::move(topics)) {}
Service::~Service() = default;

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tl::unexpected(taxonomy.error());
  auto task_kinds = model::TaskKinds::of_the_house();
  if (!task_kinds) return tl::unexpected(task_kinds.error());
  auto catalogue = model::Catalogue::load(config.path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  const std::string& objects = config.text("demonstration.objects");
  if (objects != "seen" && objects != "simulated")
    return wrong_use("there is no «" + objects + "»", "demonstration.objects",
                     "choose seen or simulated");
  Setting setting{.taxonomy = std::move(*taxonomy),
                  .task_kinds = std::move(*task_kinds),
                  .catalogue = std::move(*catalogue),
                  .recognisers = {},
                  .folder = {},
                  .tasks = {},
                  .glove = config.text("glove.name"),
                  .accept = config.number("demonstration.accept"),
                  .simulated = objects == "simulated"};
  if (const auto file = config.path("demonstration.model"); !file.empty()) {
    auto loaded = load_recognisers(file);
    if (!loaded) return tl::unexpected(loaded.error());
    setting.recognisers = std::move(*loaded);
  }
  // What a recording is checked by depends on nothing else, and changes nothing.
  if (!shell.lockstep()) {
    setting.folder = tasks::task_folder(config.path("demonstration.tasks").string());
    if (setting.folder.empty())
      return fail("there is no folder for tasks", "demonstration.tasks", "name one");
    auto tasks = tasks_in(setting.folder);
    if (!tasks) return tl::unexpected(tasks.error());
    setting.tasks = std::move(*tasks);
    log::info("tasks are kept in {}", setting.folder.string());
  }
  std::unique_ptr<Service> made(new Service(std::make_unique<Topics>(shell, std::move(setting))));
  shell.status().running();
  return made;
}

}  // namespace prehend::demonstration
