// A node of ROS 2 as far as DDS sees it: Cyclone DDS, in no partition, with the QoS of such nodes.
// Waits for a reader, tells it one trajectory of one point, and ends when that has come. Without
// joints the trajectory is empty.
//
//   cyclone_ros_writer DOMAIN TOPIC SECONDS JOINT=POSITION...
#define _DEFAULT_SOURCE  // setenv
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "messages.h"

enum { max_joints = 32 };

static dds_entity_t must(dds_entity_t result, const char* what) {
  if (result >= 0) return result;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(-result));
  exit(3);
}

static void wait_for_reader(dds_entity_t writer) {
  dds_publication_matched_status_t matched = {0};
  while (matched.current_count == 0) {
    dds_sleepfor(DDS_MSECS(10));
    must(dds_get_publication_matched_status(writer, &matched), "status");
  }
}

int main(int argc, char** argv) {
  if (argc < 4 || argc > 4 + max_joints) return 2;
  setenv(
      "CYCLONEDDS_URI",
      "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
      1);
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

  const dds_entity_t node =
      must(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  char name[256];
  snprintf(name, sizeof name, "rt/%s", argv[2]);
  const dds_entity_t topic = must(
      dds_create_topic(node, &trajectory_msgs_msg_dds__JointTrajectory__desc, name, NULL, NULL),
      "topic");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  const dds_entity_t writer = must(dds_create_writer(node, topic, qos, NULL), "writer");
  dds_delete_qos(qos);
  wait_for_reader(writer);
  must(dds_write(writer, &trajectory), "write");
  must(dds_wait_for_acks(writer, DDS_SECS(10)), "acknowledgement");
  dds_delete(node);
  return 0;
}
