#include "common/service/life_cycle.hpp"
#include "services/ros/tools/lead/leader.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::ros::Leader>(
      argc, argv,
      {.name = "ros-lead",
       .description = "Lets nodes of ROS 2, in the domain ROS_DOMAIN_ID, lead the robot hand by "
                      "trajectories of its joints",
       .role = "performer"});
}
