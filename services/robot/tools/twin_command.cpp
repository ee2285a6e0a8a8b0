// `prehend robot twin`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/base/clock.hpp"
#include "common/base/to_terminal.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "common/tool/interrupt.hpp"
#include "services/robot/core/parting.hpp"
#include "services/robot/tools/commands.hpp"

namespace prehend::robot {
namespace {

constexpr Duration looks_every = std::chrono::milliseconds(5);
constexpr Duration fresh = std::chrono::milliseconds(100);  // news of the twin
constexpr Duration settling = std::chrono::seconds(3);      // of a twin that is led
constexpr Duration to_appear = std::chrono::seconds(10);

struct TwinArguments {
  service::LabArguments lab;
  std::string twin = "twin";
  double seconds = 0, within = 0.1, patience = 0.3;
  bool json = false;
};

/// Tells the twin what the robot is told, and compares what they say.
class SideBySide {
 public:
  static Expected<std::unique_ptr<SideBySide>> create(const service::Config& config,
                                                      const TwinArguments& arguments) {
    const std::string& name = config.text("robot.hand_name");
    if (arguments.twin == name)
      return wrong_use("the twin needs a name of its own", "--twin", "give twin");
    if (!config.text("lab.keys").empty())
      return wrong_use("a twin is led in no lab with keys", "lab.keys", "leave the keys out");
    auto participant = dds::Participant::create(service::membership(config, "twin", "mapping"));
    if (!participant) return tl::unexpected(participant.error());
    auto commands = participant->reader(dds::robot_command);
    if (!commands) return tl::unexpected(commands.error());
    auto states = participant->reader(dds::robot_state);
    if (!states) return tl::unexpected(states.error());
    auto led = participant->writer(dds::robot_command);
    if (!led) return tl::unexpected(led.error());
    std::unique_ptr<SideBySide> made(new SideBySide(name, arguments, std::move(*participant),
                                                    std::move(*commands), std::move(*states),
                                                    std::move(*led)));
    made->told_ = {config.text("mapping.hand"), config.text("simulation.hand")};
    return made;
  }

  Expected<void> step(Time now) {
    for (auto& sample : commands_.take())
      if (!sample.info.gone && sample.data.hand().to_string() == name_) lead(sample.data, now);
    for (const auto& sample : states_.take()) {
      if (sample.info.gone) continue;
      const std::string whose = sample.data.hand().to_string();
      if (whose == arguments_.twin) twin_ = News{sample.data, now};
      if (whose != name_) continue;
      robot_seen_ = true;
      if (const auto heard = hear(sample.data, now); !heard) return heard;
    }
    return {};
  }

  /// Whom nothing was heard of yet; empty: both are there.
  std::string missing() const {
    return !robot_seen_ ? name_ : !twin_ ? arguments_.twin : std::string();
  }
  const std::optional<Parting>& parting() const { return parting_; }
  const model::HandModel* hand() const { return hand_.get(); }
  double since_begin(Time time) const { return to_seconds(time - *begun_); }

 private:
  struct News {
    v1::HandState state;
    Time heard;
  };

  SideBySide(std::string name, const TwinArguments& arguments, dds::Participant participant,
             dds::Reader<v2::HandCommand> commands, dds::Reader<v1::HandState> states,
             dds::Writer<v2::HandCommand> led)
      : name_(std::move(name)),
        arguments_(arguments),
        participant_(std::move(participant)),
        commands_(std::move(commands)),
        states_(std::move(states)),
        led_(std::move(led)) {}

  void lead(v2::HandCommand command, Time now) {
    command.hand(arguments_.twin);
    command.sequence_number(++sequence_);
    command.stamp_ns(to_ns(now));
    (void)led_.write(command);
    if (led_since_) return;
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    led_.raw().get_publication_matched_status(status);
    if (status.current_count > 0) led_since_ = now;
  }

  Expected<void> hear(const v1::HandState& state, Time now) {
    // It may come from elsewhere.
    if (!led_since_ || now - *led_since_ < settling) return {};
    if (!twin_ || now - twin_->heard > fresh) return {};
    if (state.model().to_string() != twin_->state.model().to_string())
      return wrong_use("stands for " + twin_->state.model().to_string() + ", the robot is " +
                           state.model().to_string(),
                       arguments_.twin, "set simulation.hand = " + state.model().to_string());
    if (!hand_) {
      auto loaded =
          model::named_hand(state.model().to_string(), told_).and_then(model::HandModel::load);
      if (!loaded) return tl::unexpected(loaded.error());
      hand_ = std::make_unique<const model::HandModel>(std::move(*loaded));
      parting_.emplace(*hand_, Parting::Options{arguments_.within, seconds(arguments_.patience)});
      begun_ = now;
    }
    const Eigen::VectorXd one = convert::from_message(state.dof());
    const Eigen::VectorXd other = convert::from_message(twin_->state.dof());
    const auto count = static_cast<Eigen::Index>(hand_->dofs().size());
    if (one.size() != count || other.size() != count) return {};
    for (const std::size_t d : parting_->compare(one, other, now)) {
      if (arguments_.json) continue;
      const auto i = static_cast<Eigen::Index>(d);
      to_terminal("{:7.1f} s  {} parts: robot {:.3f}, twin {:.3f}\n", since_begin(now),
                  hand_->dofs()[d].name, one[i], other[i]);
      std::fflush(stdout);
    }
    return {};
  }

  std::string name_;
  const TwinArguments& arguments_;
  dds::Participant participant_;
  dds::Reader<v2::HandCommand> commands_;
  dds::Reader<v1::HandState> states_;
  dds::Writer<v2::HandCommand> led_;
  std::vector<std::string> told_;  // hands that lab.toml names
  std::unique_ptr<const model::HandModel> hand_;
  std::optional<Parting> parting_;
  std::optional<Time> led_since_, begun_;
  std::optional<News> twin_;
  bool robot_seen_ = false;
  std::uint64_t sequence_ = 0;
};

int tell(const SideBySide& both, const TwinArguments& arguments) {
  const Parting& parting = *both.parting();
  nlohmann::ordered_json document{{"twin", arguments.twin},
                                  {"compared", parting.compared()},
                                  {"parted", parting.parted()},
                                  {"dofs", nlohmann::ordered_json::array()}};
  for (std::size_t d = 0; d < parting.dofs().size(); ++d) {
    const Parting::Dof& dof = parting.dofs()[d];
    const std::string& name = both.hand()->dofs()[d].name;
    nlohmann::ordered_json entry{{"name", name}, {"worst", dof.worst}, {"parted_s", nullptr}};
    if (dof.parted) entry["parted_s"] = both.since_begin(*dof.parted);
    document["dofs"].push_back(entry);
    if (!arguments.json)
      to_terminal(
          "{:<12} at most {:.3f} apart{}\n", name, dof.worst,
          dof.parted ? fmt::format("; parted at {:.1f} s", both.since_begin(*dof.parted)) : "");
  }
  if (arguments.json) std::cout << document.dump() << '\n';
  return parting.parted() ? exit_no : exit_done;
}

int run(const TwinArguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return tool::complain(config.error(), exit_wrong_use);
  auto both = SideBySide::create(*config, arguments);
  if (!both) return tool::complain(both.error());
  tool::note_interrupts();
  const Time begun = process_now();
  std::optional<Time> joined;
  while (!tool::interrupted()) {
    std::this_thread::sleep_for(looks_every);
    const Time now = process_now();
    if (const auto stepped = (*both)->step(now); !stepped) return tool::complain(stepped.error());
    if (!joined && (*both)->parting()) joined = now;
    const std::string who = (*both)->missing();
    if (!who.empty() && now - begun > to_appear)
      return tool::complain({"says nothing", who,
                             "start prehend-robot, and prehend-simulation with "
                             "simulation.hand_name = " +
                                 arguments.twin},
                            exit_broken);
    if (joined && arguments.seconds > 0 && now - *joined > seconds(arguments.seconds)) break;
  }
  return joined ? tell(**both, arguments) : exit_no;
}

}  // namespace

void add_twin(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "twin",
      "tells a simulated hand what the robot is told, and shows where they part; until SIGTERM or\n"
      "Ctrl-C. Exit code 1: they parted");
  const auto a = std::make_shared<TwinArguments>();
  a->lab.add_to(*command);
  command->add_option("--twin", a->twin, "what the simulated hand is called")
      ->capture_default_str();
  command->add_option("--seconds", a->seconds, "ends by itself after so long; 0: does not")
      ->check(CLI::Range(0.0, 86400.0));
  command->add_option("--within", a->within, "rad, by which joints may differ")
      ->check(CLI::Range(1e-3, 3.0))
      ->capture_default_str();
  command->add_option("--patience", a->patience, "s, for which they may differ by more")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  command->add_flag("--json", a->json, "a JSON document");
  program.on(*command, [a] { return run(*a); });
}

}  // namespace prehend::robot
