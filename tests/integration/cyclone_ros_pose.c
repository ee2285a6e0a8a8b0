// A node of ROS 2 that tells where the hand's base shall be: waits for a reader, tells the same
// pose COUNT times, 20 ms apart, without a stamp and without a turn, and ends when all have come.
//
//   cyclone_ros_pose DOMAIN TOPIC FRAME COUNT X Y Z
#include "cyclone_node.h"

int main(int argc, char** argv) {
  if (argc != 8) return 2;
  const dds_entity_t node = join(argv[1]);
  geometry_msgs_msg_dds__PoseStamped_ pose;
  memset(&pose, 0, sizeof pose);
  pose.header_.frame_id_ = argv[3];
  pose.pose_.position_.x_ = atof(argv[5]);
  pose.pose_.position_.y_ = atof(argv[6]);
  pose.pose_.position_.z_ = atof(argv[7]);
  pose.pose_.orientation_.w_ = 1;
  const dds_entity_t writer =
      make_writer(node, &geometry_msgs_msg_dds__PoseStamped__desc, argv[2], true);
  for (int i = 0; i < atoi(argv[4]); ++i) {
    must(dds_write(writer, &pose), "write");
    dds_sleepfor(DDS_MSECS(20));
  }
  must(dds_wait_for_acks(writer, DDS_SECS(10)), "acknowledgement");
  dds_delete(node);
  return 0;
}
