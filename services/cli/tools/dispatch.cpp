#include "services/cli/tools/dispatch.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/base/paths.hpp"
#include "services/cli/tools/arguments.hpp"

namespace prehend::cli {

const std::vector<Tool>& tools() {
  static const std::vector<Tool> table{
      {"record", "prehend-record", "topics into a file"},
      {"replay", "prehend-replay", "a file back to topics"},
      {"check", "prehend-check", "do services still answer as recorded"},
      {"recording", "prehend-recording", "what is in recordings, parts of them, training data"},
      {"console", "prehend-console", "the lab in a browser"},
      {"ros", "prehend-ros", "tell nodes of ROS 2, without a bridge, what the hand does"},
      {"ros-lead", "prehend-ros-lead", "let nodes of ROS 2 lead the hand by trajectories"},
      {"glove", "prehend-glove-tool", "calibrate, register and watch a glove; decode, emulate"},
      {"camera", "prehend-camera", "calibrate a camera with a chessboard"},
      {"objects", "prehend-objects", "train, detect and evaluate object models"},
      {"teach", "prehend-teach", "show postures to learn a mapping from"},
      {"train", "prehend-train", "train a mapping model for a robot hand"},
      {"study", "prehend-study", "repeat the thesis's experiments and the grasp benchmark"},
      {"benchmark", "prehend-benchmark", "judge any mapping by the benchmark's takes"},
      {"demonstration", "prehend-demonstration-tool",
       "train and evaluate the recognition of grasps"},
      {"demonstrate", "prehend-demonstrate", "show the lab a task"},
      {"tasks", "prehend-tasks", "tasks that were shown: list, show, check, run"},
      {"hand", "prehend-hand", "is this URDF a usable hand; make it one"},
      {"arm", "prehend-arm", "is this URDF a usable arm; make it one; inverse kinematics"},
      {"robot", "prehend-robot-tool", "a robot at the end of a wire: emulate, check, home, status"},
      {"grasp", "prehend-grasp", "plan grasps, export them, quality of given contacts"},
  };
  return table;
}

int become(const Tool& tool, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{(program_directory() / tool.program).string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& argument : command) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(pointers.front(), pointers.data());
  return complain({std::strerror(errno), command.front(), "is it built and installed?"},
                  exit_broken);
}

}  // namespace prehend::cli
