// A node of ROS 2 as far as DDS sees it: Cyclone DDS, in no partition, with the QoS of such nodes.
// Waits for a reader, tells it one trajectory of one point, and ends when that has come. Without
// joints the trajectory is empty.
//
//   cyclone_ros_writer DOMAIN TOPIC SECONDS JOINT=POSITION...
#include "cyclone_node.h"

enum { max_joints = 32 };

int main(int argc, char** argv) {
  if (argc < 4 || argc > 4 + max_joints) return 2;
  char* names[max_joints];
  double positions[max_joints];
  uint32_t count = 0;
  for (char** joint = argv + 4; *joint; ++joint, ++count) {
    char* value = strchr(*joint, '=');
    if (!value) return 2;
    *value = 0;
    names[count] = *joint;
    positions[count] = atof(value + 1);
  }
  trajectory_msgs_msg_dds__JointTrajectoryPoint_ point;
  memset(&point, 0, sizeof point);
  point.positions_._buffer = positions;
  point.positions_._length = point.positions_._maximum = count;
  const double seconds = atof(argv[3]);
  point.time_from_start_.sec_ = (int32_t)seconds;
  point.time_from_start_.nanosec_ = (uint32_t)(1e9 * (seconds - (int32_t)seconds));
  trajectory_msgs_msg_dds__JointTrajectory_ trajectory;
  memset(&trajectory, 0, sizeof trajectory);
  trajectory.header_.frame_id_ = "";
  trajectory.joint_names_._buffer = names;
  trajectory.joint_names_._length = trajectory.joint_names_._maximum = count;
  trajectory.points_._buffer = &point;
  trajectory.points_._length = trajectory.points_._maximum = count > 0 ? 1 : 0;

  const dds_entity_t node = join(argv[1]);
  const dds_entity_t writer =
      make_writer(node, &trajectory_msgs_msg_dds__JointTrajectory__desc, argv[2], true);
  must(dds_write(writer, &trajectory), "write");
  must(dds_wait_for_acks(writer, DDS_SECS(10)), "acknowledgement");
  dds_delete(node);
  return 0;
}
