#include "services/mapping/tools/lessons/lessons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/base/workers.hpp"
#include "common/dds/topics.hpp"
#include "common/learning/training_set.hpp"
#include "common/service/order_book.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/files/model_places.hpp"
#include "services/mapping/service/messages.hpp"
#include "services/mapping/tools/training/derived_scheme.hpp"
#include "services/mapping/tools/training/teach.hpp"
#include "services/mapping/tools/training/training_run.hpp"

namespace prehend::mapping {
namespace {

namespace fs = std::filesystem;

constexpr int postures = 7;  // basic ones that a person is asked for, as `prehend teach` does
constexpr std::size_t max_name = 32;

/// Ends a training from within: a network takes long, and an end must not wait for it.
struct Ended {};

/// It becomes a part of files' names.
Expected<void> check_name(const std::string& name) {
  const bool good = !name.empty() && name.size() <= max_name &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return std::isalnum(c) || c == '-' || c == '_';
                    });
  if (!good) return wrong_use("is no name", name, "up to 32 letters, digits, - and _");
  return {};
}

/// The user's own, where lab.toml names none.
fs::path folder_of(const service::Config& config) {
  if (fs::path named = config.path("teacher.folder"); !named.empty()) return named;
  const char *data = std::getenv("XDG_DATA_HOME"), *home = std::getenv("HOME");
  const fs::path base =
      data && *data ? fs::path(data) : fs::path(home ? home : "/") / ".local" / "share";
  return base / "prehend" / "taught";
}

}  // namespace

class Lessons::Topics {
 public:
  Topics(service::Shell& shell, model::HandModel hand, Scheme scheme, TrainingRun run)
      : shell_(shell),
        hand_(std::move(hand)),
        scheme_(std::move(scheme)),
        run_(std::move(run)),
        folder_(folder_of(shell.config())),
        progress_(shell.publish(dds::mapping_training)),
        replies_(shell.publish(dds::operator_reply)) {
    message_.hand(hand_.name());
    shell.subscribe(dds::hand_posture, Handler<v1::HandPosture>([this](auto& s, auto& i) {
                      if (!i.gone && teacher_) see(s);
                    }));
    shell.subscribe(dds::operator_command,
                    Handler<v1::OperatorCommand>([this](auto& s, auto& i) { on_order(s, i); }));
    shell.on_tick(std::chrono::milliseconds(200), [this](Time) {
      if (teacher_ || trains_) tell();
    });
  }
  ~Topics() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
  }

  void tell() {
    if (teacher_) {
      const auto* asked = teacher_->asked();
      message_.step(asked ? asked->posture : "");
      message_.shown(static_cast<std::uint32_t>(teacher_->shown().size()));
      message_.share(message_.asked() ? 1.0 * message_.shown() / message_.asked() : 0);
      message_.message(teacher_->waiting_for());
    } else if (trains_) {
      message_.share(share_);
    }
    message_.sequence_number(sequence_number_++);
    message_.stamp_ns(to_ns(shell_.now()));
    progress_.publish(message_);
  }

 private:
  template <class T>
  using Handler = std::function<void(const T&, const dds::SampleInfo&)>;

  void on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info) {
    if (info.gone || order.action() != v1::ACTION_TEACH || order.target().to_string() != "teacher")
      return;
    if (const auto known = orders_.find(order.id().to_string())) return replies_.publish(*known);
    const auto meant = service::meant_now(order, service::given_by(order, shell_.writer_of(info)),
                                          shell_.role_of(info), shell_.now());
    const auto executed = meant.and_then([&] { return obey(order.argument().to_string()); });
    v1::OperatorReply reply;
    reply.id(order.id());
    reply.stamp_ns(to_ns(shell_.now()));
    reply.service("teacher");
    reply.done(executed.has_value());
    reply.message((executed ? *executed : executed.error().message()).substr(0, 255));
    if (executed) orders_.add(reply);
    replies_.publish(reply);
  }

  Expected<std::string> obey(const std::string& words) {
    if (trains_) return fail("trains, and takes no order until that is done", "teacher");
    const std::size_t space = words.find(' ');
    const std::string verb = words.substr(0, space),
                      name = space == std::string::npos ? "" : words.substr(space + 1);
    if (verb == "show") return begin(name);
    if (verb == "train") return train(name);
    if (verb != "again" && verb != "end")
      return wrong_use("is none of show NAME, again, end, train NAME", "teach");
    if (!teacher_) return fail("nothing is shown now", "teacher");
    if (verb == "again") {
      if (!teacher_->redo()) return fail("nothing was shown yet", "teacher");
      tell();
      return to_show();
    }
    teacher_.reset();
    change(v1::TRAINING_IDLE, "given up");
    return "given up";
  }

  std::string to_show() const {
    return teacher_ && teacher_->asked() ? fmt::format("show «{}»", teacher_->asked()->posture)
                                         : "all is shown";
  }

  Expected<std::string> begin(const std::string& name) {
    if (auto good = check_name(name); !good) return tl::unexpected(good.error());
    auto asked = curriculum(hand_, scheme_, name, 1, postures, {});
    message_.name(name);
    message_.asked(static_cast<std::uint32_t>(asked.size()));
    teacher_.emplace(std::move(asked), TeachOptions{});
    change(v1::TRAINING_SHOWING, "");
    return to_show();
  }

  void see(const v1::HandPosture& message) {
    const auto hand = posture_from_message(message);
    if (!hand) return shell_.status().drop(hand.error().what);
    const auto seen = features(hand->fingertips, hand->hand_scale);
    if (!seen) return shell_.status().drop(seen.error().what);
    const auto shown = teacher_->see(*seen, hand->stamp);
    if (!shown) return;
    log::info("«{}» was shown, quality {:.0f} %", shown->pair.posture, 100 * shown->quality);
    tell();
    if (teacher_->asked()) return;
    const std::vector<Shown> all = teacher_->shown();
    teacher_.reset();
    if (const auto file = keep(all))
      change(v1::TRAINING_DONE, *file);
    else
      change(v1::TRAINING_FAILED, file.error().message());
  }

  fs::path file_of(const std::string& ending) const {
    return folder_ / (hand_.name() + "-" + message_.name().to_string() + ending);
  }

  Expected<std::string> keep(const std::vector<Shown>& shown) {
    const learning::TrainingSet set = taught_set(hand_, scheme_, shown);
    std::error_code failed;
    fs::create_directories(folder_, failed);
    const fs::path file = file_of(".set");
    auto kept = learning::check(set).and_then([&] { return check_consistent(set); }).and_then([&] {
      return learning::save(file, set);
    });
    if (!kept) return tl::unexpected(kept.error());
    return file.string();
  }

  Expected<std::string> train(const std::string& name) {
    if (auto good = check_name(name); !good) return tl::unexpected(good.error());
    if (teacher_) return fail("postures are being shown", "teacher", "end it first");
    message_.name(name);
    const fs::path set = file_of(".set"), made = file_of(".mapping");
    if (!fs::exists(set)) return fail("nothing was shown under this name", name, "show " + name);
    TrainingRun run = run_;
    run.taught = {set};
    if (thread_.joinable()) thread_.join();
    share_ = 0;
    trains_ = true;
    message_.step("");
    change(v1::TRAINING_COMPUTING, "");
    thread_ = std::thread([this, run = std::move(run), made] {
      Expected<void> outcome;
      try {
        outcome = learn(run, made);
      } catch (const Ended&) {
        return;
      }
      const auto [phase, message] = outcome
                                        ? std::pair(v1::TRAINING_DONE, made.string())
                                        : std::pair(v1::TRAINING_FAILED, outcome.error().message());
      shell_.post([this, phase = phase, message = message] {
        trains_ = false;
        message_.share(phase == v1::TRAINING_DONE ? 1 : message_.share());
        change(phase, message);
      });
    });
    return "trains; see mapping/training";
  }

  /// On one core, since a lab runs beside it. Throws Ended as soon as this process shall end.
  Expected<void> learn(const TrainingRun& run, const fs::path& made) {
    const auto one_core = [](std::size_t count, const auto& work) {
      share_work(count, 1, work, [](std::size_t) {});
    };
    return run_training(run, hand_, scheme_, one_core,
                        [this](std::string_view, double share) {
                          if (ends_) throw Ended();
                          share_ = share;
                        })
        .and_then([&](const TrainedMapping& trained) {
          return save_mapping_model(made, trained.model, hand_);
        });
  }

  void change(v1::TrainingPhase phase, const std::string& message) {
    message_.phase(phase);
    message_.message(message.substr(0, 255));
    tell();
    if (!message.empty()) log::info("{}", message);
  }

  service::Shell& shell_;
  const model::HandModel hand_;
  const Scheme scheme_;
  const TrainingRun run_;
  const fs::path folder_;  // where what is taught is kept
  service::Shell::Output<v1::TrainingProgress> progress_;
  service::Shell::Output<v1::OperatorReply> replies_;
  service::OrderBook orders_;
  v1::TrainingProgress message_;
  std::uint64_t sequence_number_ = 0;
  std::optional<Teacher> teacher_;  // while somebody shows
  bool trains_ = false;
  std::thread thread_;  // that trains
  std::atomic<double> share_ = 0;
  std::atomic<bool> ends_ = false;
};

Lessons::Lessons(std::unique_ptr<Topics> topics) : topics_(std::move(topics)) {}
Lessons::~Lessons() = default;

Expected<std::unique_ptr<Lessons>> Lessons::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  if (shell.lockstep())
    return wrong_use("nobody is taught in lockstep", "lab.lockstep", "set it to false");
  const std::string& kind = config.text("mapping.hand");
  if (kind.empty()) return wrong_use("names no hand", "mapping.hand", model::hand_hint());
  auto hand = model::HandModel::load(model::hand_directory(kind));
  if (!hand) return tl::unexpected(hand.error());
  const std::int64_t users = config.integer("teacher.users");
  if (users < 0 || users > 1000) return wrong_use("is none of 0 to 1000", "teacher.users");
  const ModelPlaces places = model_places(kind);
  TrainingRun run;
  run.catalogue = config.path("lab.catalogue");
  run.grasps = places.grasps;
  run.closures.made_for = places.made_for;
  run.people.users = static_cast<int>(users);
  // What is installed is not written to.
  if (!fs::exists(run.grasps)) run.grasps = folder_of(config) / (hand->name() + ".grasps");
  auto scheme = load_or_derive(places.scheme, *hand);
  if (!scheme) return tl::unexpected(scheme.error());
  auto topics =
      std::make_unique<Topics>(shell, std::move(*hand), std::move(*scheme), std::move(run));
  topics->tell();
  std::unique_ptr<Lessons> made(new Lessons(std::move(topics)));
  shell.status().running();
  return made;
}

}  // namespace prehend::mapping
