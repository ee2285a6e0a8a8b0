#include "services/robot/tools/visit.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/robot/kept_stop.hpp"
#include "common/tool/interrupt.hpp"
#include "services/robot/devices/line.hpp"
#include "services/robot/service/options.hpp"

namespace prehend::robot {
namespace {

constexpr Duration to_answer = std::chrono::seconds(8);
constexpr Duration to_home = std::chrono::seconds(60);

/// Ctrl-C must not leave a motor running: the line says farewell at its end.
void end_orderly_when_interrupted() {
  tool::note_interrupts();
}

/// It has said what it is and how it fares.
bool has_answered(const Driver& driver) {
  return driver.phase() == Phase::configured || driver.phase() == Phase::ready ||
         (driver.phase() == Phase::faulted && !driver.identity().empty());
}

int tell(const Connection& robot, bool json, bool good) {
  const Driver& driver = *robot.driver;
  nlohmann::json document{{"device", robot.device},        {"port", robot.port},
                          {"identity", driver.identity()}, {"state", to_string(driver.phase())},
                          {"trouble", driver.trouble()},   {"temperature_c", nullptr},
                          {"joints_rad", nullptr}};
  std::string text =
      fmt::format("{} at {}: {}", robot.device, robot.port, to_string(driver.phase()));
  if (!driver.trouble().empty()) text += ", " + driver.trouble();
  if (!driver.identity().empty()) text += "\n  " + driver.identity();
  if (const auto& reading = driver.reading()) {
    document["joints_rad"] =
        std::vector<double>(reading->dof.data(), reading->dof.data() + reading->dof.size());
    for (std::size_t d = 0; d < robot.hand->dofs().size(); ++d)
      text += fmt::format("\n  {:<10} {:6.3f} rad", robot.hand->dofs()[d].name,
                          reading->dof[static_cast<Eigen::Index>(d)]);
    if (reading->temperature) {
      document["temperature_c"] = *reading->temperature;
      text += fmt::format("\n  {:<10} {:6.1f} °C", "motors", *reading->temperature);
    }
  }
  std::cout << (json ? document.dump() : text) << '\n';
  return good ? exit_done : exit_no;
}

/// A stop that the service keeps holds for us as well.
Expected<void> may_move(const service::Config& config) {
  const auto kept = KeptStop::create(config, config.text("robot.hand_name"));
  if (!kept)
    return fail("whether the hand is stopped cannot be told", kept.error().message(),
                "set safety.state to a folder");
  const auto stop = kept->recall();
  if (!stop) return {};
  return fail("is stopped by " + stop->by + (stop->reason.empty() ? "" : ": " + stop->reason),
              config.text("robot.hand_name"),
              "start the service, and prehend release --reason …, when it is safe");
}

}  // namespace

int visit(const VisitArguments& arguments, bool homes) {
  const auto config = arguments.lab.load();
  if (!config) return tool::complain(config.error(), exit_wrong_use);
  auto robot = connection_of(*config);
  if (!robot) return tool::complain(robot.error());
  if (homes)
    if (const auto may = may_move(*config); !may) return tool::complain(may.error(), exit_no);
  Driver& driver = *robot->driver;
  end_orderly_when_interrupted();
  Line line(driver, robot->open);
  if (!exchange_until(line, to_answer, [&] { return tool::interrupted() || has_answered(driver); }))
    return tool::complain(
        line.trouble(robot->port,
                     "is it switched on, is robot.baud right, and no service on that port?"),
        exit_broken);
  if (!homes || tool::interrupted() || driver.phase() == Phase::faulted)
    return tell(*robot, arguments.json,
                !homes && !tool::interrupted() && driver.phase() != Phase::faulted);
  driver.home();
  bool began = false;
  const bool over = exchange_until(line, to_home, [&] {
    began |= driver.phase() == Phase::homing;
    return tool::interrupted() || !may_move(*config) ||
           (began && driver.phase() != Phase::homing && has_answered(driver));
  });
  return tell(*robot, arguments.json, over && driver.phase() == Phase::ready);
}

}  // namespace prehend::robot
