#include "services/performer/service/service.hpp"

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/dds/topics.hpp"
#include "common/tasks/files/task_file.hpp"

namespace prehend::performer {
namespace {

constexpr const char* our_name = "performer";

}  // namespace

void remember(const std::filesystem::path& file, const Performed& performed) {
  // Read anew: it may have been shown again meanwhile.
  auto record = tasks::load_record(file);
  if (!record) return log::warning(record.error());
  record->runs.push_back({std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now()),
                          performed.hand, performed.done, performed.reason});
  if (auto saved = tasks::save_record(file, *record); !saved) log::warning(saved.error());
}

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  auto performer = Performer::create(shell);
  if (!performer) return tl::unexpected(performer.error());
  return std::unique_ptr<Service>(
      new Service(shell, std::move(*performer),
                  tasks::task_folder(shell.config().path("demonstration.tasks").string())));
}

Service::Service(service::Shell& shell, std::unique_ptr<Performer> performer,
                 std::filesystem::path tasks)
    : shell_(shell),
      performer_(std::move(performer)),
      tasks_(std::move(tasks)),
      replies_(shell.publish(dds::operator_reply)) {
  shell.subscribe(dds::operator_command, std::function([this](const v1::OperatorCommand& order,
                                                              const dds::SampleInfo& info) {
                    if (!info.gone) on_order(order, info);
                  }));
  shell.busy_while([this] { return performer_->moves(); });
}

void Service::on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info) {
  if (order.target().to_string() != our_name) return;
  const auto action = order.action();
  if (action != v1::ACTION_START && action != v1::ACTION_STOP) return;
  if (const auto known = orders_.find(order.id().to_string())) return replies_.publish(*known);
  const std::string by = service::given_by(order, shell_.writer_of(info));
  const std::string name = order.argument().to_string();
  const auto executed =
      action == v1::ACTION_STOP
          ? stop(name, by)
          : service::meant_now(order, by, shell_.role_of(info), shell_.now()).and_then([&] {
              return start(name);
            });
  if (executed)
    log::info("{}, by order of {}", *executed, by);
  else
    log::warning(executed.error());
  v1::OperatorReply reply;
  reply.id(order.id());
  reply.stamp_ns(to_ns(shell_.now()));
  reply.service(our_name);
  reply.done(executed.has_value());
  reply.message((executed ? *executed : executed.error().message()).substr(0, 255));
  if (executed) orders_.add(reply);
  replies_.publish(reply);
}

Expected<std::string> Service::start(const std::string& name) {
  // A name, not a path: who orders is elsewhere, and knows nothing of our files.
  if (name.find('/') != std::string::npos || name.ends_with(".task"))
    return wrong_use("is no name of a task", name, "prehend tasks list");
  const auto file = tasks::task_path(name, tasks_);
  if (!file) return tl::unexpected(file.error());
  auto task = tasks::load_task(*file);
  if (!task) return tl::unexpected(task.error());
  const auto begun = performer_->begin(
      std::move(*task), {}, [this, file = *file, name](const Expected<Performed>& performed) {
        if (performed && performed->moved) remember(file, *performed);
        const bool done = performed && performed->done;
        shell_.status().count(done ? "tasks done" : "tasks not done");
        if (done)
          log::info("{} is done", name);
        else
          log::warning("{} is not done: {}", name,
                       performed ? performed->reason : performed.error().message());
      });
  if (!begun) return tl::unexpected(begun.error());
  return "doing " + name;
}

Expected<std::string> Service::stop(const std::string& name, const std::string& by) {
  if (!performer_->task()) return fail("no task is being done", our_name, "", exit_no);
  if (!name.empty() && name != performer_->task()->name)
    return fail("is not being done; what is done is " + performer_->task()->name, name, "",
                exit_no);
  performer_->stop("ended by " + by);
  return performer_->task()->name + " ends";
}

}  // namespace prehend::performer
