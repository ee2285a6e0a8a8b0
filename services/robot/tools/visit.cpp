#include "services/robot/tools/visit.hpp"

#include <fmt/format.h>

#include <csignal>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "services/robot/devices/line.hpp"
#include "services/robot/service/options.hpp"

namespace prehend::robot {
namespace {

constexpr Duration to_answer = std::chrono::seconds(5);
constexpr Duration to_home = std::chrono::seconds(60);

volatile std::sig_atomic_t interrupted = 0;
extern "C" void on_interrupt(int) {
  interrupted = 1;
}

/// Ctrl-C must not leave a motor running: the line says farewell at its end.
void end_orderly_when_interrupted() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
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

}  // namespace

int visit(const VisitArguments& arguments, bool homes) {
  const auto config = arguments.lab.load();
  if (!config) return tool::complain(config.error(), exit_wrong_use);
  auto robot = connection_of(*config);
  if (!robot) return tool::complain(robot.error());
  Driver& driver = *robot->driver;
  end_orderly_when_interrupted();
  Line line(driver, robot->port, robot->baud);
  if (!exchange_until(line, to_answer, [&] { return interrupted != 0 || has_answered(driver); }))
    return tool::complain({driver.trouble(), robot->port,
                           "is it switched on, is robot.baud right, and no service on that port?"},
                          exit_broken);
  if (!homes || interrupted != 0 || driver.phase() == Phase::faulted)
    return tell(*robot, arguments.json,
                !homes && interrupted == 0 && driver.phase() != Phase::faulted);
  driver.home();
  bool began = false;
  const bool over = exchange_until(line, to_home, [&] {
    began |= driver.phase() == Phase::homing;
    return interrupted != 0 || (began && driver.phase() != Phase::homing && has_answered(driver));
  });
  return tell(*robot, arguments.json, over && driver.phase() == Phase::ready);
}

}  // namespace prehend::robot
