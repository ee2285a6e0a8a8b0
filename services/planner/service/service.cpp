#include "services/planner/service/service.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/base/workers.hpp"
#include "common/convert/detection.hpp"
#include "common/dds/topics.hpp"
#include "services/planner/core/plan_book.hpp"
#include "services/planner/files/plan_store.hpp"
#include "services/planner/service/messages.hpp"

namespace prehend::planner {
namespace {

constexpr std::size_t max_told = 1000;  // objects
constexpr Duration period = std::chrono::milliseconds(20);

/// Searches rounds in a thread of its own, at the lowest priority: who moves a hand goes first.
class Searcher {
 public:
  using Done = std::function<void(const PlanBook::Work&, bool more)>;
  explicit Searcher(Done done)
      : done_(std::move(done)), thread_([this](std::stop_token stop) { run(stop); }) {}

  bool is_busy() const { return busy_; }
  /// Not while it is busy.
  void search(PlanBook::Work work) {
    busy_ = true;
    {
      const std::lock_guard lock(mutex_);
      work_ = std::move(work);
    }
    wake_.notify_one();
  }
  /// `done` has been handled.
  void rest() { busy_ = false; }

 private:
  void run(const std::stop_token& stop) {
    if (!be_last())
      log::warning("may not step back: searches at the priority of whoever moves a hand");
    while (!stop.stop_requested()) {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [this] { return work_.has_value(); })) return;
      const PlanBook::Work work = *std::exchange(work_, std::nullopt);
      lock.unlock();
      const bool more = work.search->try_next([&](std::size_t count, const auto& attempt) {
        const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
        share_work(
            count, threads,
            [&](std::size_t i) {
              be_last();
              if (!stop.stop_requested()) attempt(i);
            },
            [](std::size_t) {});
      });
      if (!stop.stop_requested()) done_(work, more);
    }
  }

  /// Priorities are those of threads, in Linux.
  static bool be_last() {
    return ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), 19) == 0;
  }

  Done done_;
  bool busy_ = false;  // of the shell's thread
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<PlanBook::Work> work_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace

class Service::Topics {
 public:
  Topics(service::Shell& shell, std::unique_ptr<const model::HandModel> hand,
         std::unique_ptr<const grasping::CatalogueBodies> catalogue, PlanStore store)
      : shell_(shell),
        hand_(std::move(hand)),
        catalogue_(std::move(catalogue)),
        book_(*hand_, *catalogue_, std::move(store)),
        hand_name_(shell.config().text("mapping.hand_name")),
        output_(shell.publish(dds::grasp_candidates)) {
    shell.subscribe(dds::object_detection, std::function([this](const v1::ObjectDetection& message,
                                                                const dds::SampleInfo& info) {
                      on_detection(message, info);
                    }));
    if (!shell.lockstep())
      searcher_.emplace([this](const PlanBook::Work& work, bool more) {
        shell_.post([this, work, more] { on_searched(work, more); });
      });
    shell.on_tick(period, [this](Time now) {
      if (shell_.lockstep()) search_in_lockstep(now);
      go_on();
    });
  }

 private:
  void on_detection(const v1::ObjectDetection& message, const dds::SampleInfo& info) {
    if (info.gone) return forget(message.track());
    const auto seen = convert::from_message(message);
    if (!seen) return shell_.status().drop(seen.error().what);
    const auto taken = book_.observe(*seen);
    if (!taken) shell_.status().drop(taken.error().what);
    tell_whether(*seen, taken ? std::string() : taken.error().what);
  }

  /// Who waits for grasps hears that none are looked for, and that they are after all. What is
  /// planned for stays so while it is seen: the hand that takes it hides and tilts it.
  void tell_whether(const model::Detection& seen, const std::string& refusal) {
    const auto told = refusals_.find(seen.track);
    const bool is_new = told == refusals_.end();
    if (is_new ? refusals_.size() >= max_told : told->second.empty() || told->second == refusal)
      return;
    refusals_[seen.track] = refusal;
    // Of what is planned for, the plan is the first word.
    if (is_new && refusal.empty()) return;
    publish({seen, Plan{.complete = !refusal.empty(), .reason = refusal}});
  }

  void forget(std::uint32_t track) {
    book_.remove(track);
    refusals_.erase(track);
    if (told_.erase(track) == 0) return;
    v2::GraspCandidates gone;
    gone.hand(hand_name_);
    gone.track(track);
    output_.dispose(gone);
  }

  void on_searched(const PlanBook::Work& work, bool more) {
    searcher_->rest();
    book_.searched(work, more);
    shell_.status().count("rounds searched");
    go_on();
  }

  /// A round a period of the lab's clock: when something is known follows from that clock alone,
  /// and a cycle takes seconds at most, however long a search.
  void search_in_lockstep(Time now) {
    if (now < next_round_) return;
    next_round_ = now + period;
    const auto work = book_.next();
    if (!work) return;
    const bool more = work->search->try_next([](std::size_t count, const auto& attempt) {
      share_work(count, 0, attempt, [](std::size_t) {});
    });
    book_.searched(*work, more);
  }

  /// Tells what is new, and searches on.
  void go_on() {
    for (const TrackPlan& planned : book_.news()) publish(planned);
    if (!searcher_ || searcher_->is_busy()) return;
    if (auto work = book_.next()) searcher_->search(std::move(*work));
  }

  void publish(const TrackPlan& planned) {
    v2::GraspCandidates message = to_message(planned, hand_name_, *hand_);
    message.sequence_number(sequence_number_++);
    told_.insert(planned.seen.track);
    output_.publish(message);
    if (!planned.plan.complete) return;
    if (planned.plan.grasps.empty())
      log::info("{}: no grasp: {}", planned.seen.name, planned.plan.reason);
    else
      log::info("{}: grasps from {} sides, room to spare {:.0f} %", planned.seen.name,
                planned.plan.grasps.size(), 100 * planned.plan.grasps.front().room);
  }

  service::Shell& shell_;
  std::unique_ptr<const model::HandModel> hand_;  // the book refers to both
  std::unique_ptr<const grasping::CatalogueBodies> catalogue_;
  PlanBook book_;
  std::string hand_name_;
  service::Shell::Output<v2::GraspCandidates> output_;
  std::set<std::uint32_t> told_;
  std::map<std::uint32_t, std::string> refusals_;  // by track, why; empty: it is planned for
  std::uint64_t sequence_number_ = 0;
  Time next_round_;
  std::optional<Searcher> searcher_;  // last: it uses all of the above
};

Service::Service(std::unique_ptr<Topics> topics) : topics_(std::move(topics)) {}
Service::~Service() = default;

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  std::string kind = config.text("mapping.hand");
  if (kind.empty()) kind = config.text("simulation.hand");
  if (kind.empty()) return wrong_use("names no hand", "mapping.hand", model::hand_hint());
  const auto folder = model::hand_directory(kind);
  auto hand = model::HandModel::load(folder);
  if (!hand) return tl::unexpected(hand.error());
  auto catalogue = model::Catalogue::load(config.path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto bodies = grasping::CatalogueBodies::create(*catalogue);
  if (!bodies) return tl::unexpected(bodies.error());
  auto kept = std::make_unique<const model::HandModel>(std::move(*hand));
  // In lockstep the same is answered on every machine, whatever this one has searched before.
  const auto state = shell.lockstep() ? std::filesystem::path() : state_directory();
  PlanStore store =
      plan_store(state.empty() ? state : state / "grasps" / kept->name(), folder, *kept);
  log::info("grasps of {}", kept->name());
  std::unique_ptr<Service> made(new Service(std::make_unique<Topics>(
      shell, std::move(kept), std::make_unique<const grasping::CatalogueBodies>(std::move(*bodies)),
      std::move(store))));
  shell.status().running();
  return made;
}

}  // namespace prehend::planner
