// A node of ROS 2 as far as DDS sees it: Cyclone DDS, in no partition, with the QoS that such nodes
// ask for. Prints what it hears first on each topic, until it has heard all of them, and where the
// frames stand that are named.
//
//   cyclone_ros_reader DOMAIN FRAME...
#define _DEFAULT_SOURCE  // setenv
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "messages.h"

static dds_entity_t must(dds_entity_t result, const char* what) {
  if (result >= 0) return result;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(-result));
  exit(3);
}

static dds_entity_t make_reader(dds_entity_t participant, const dds_topic_descriptor_t* type,
                                const char* name, bool kept) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, kept ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kept ? 1 : 10);
  const dds_entity_t topic = must(dds_create_topic(participant, type, name, NULL, NULL), "topic");
  const dds_entity_t reader = must(dds_create_reader(participant, topic, qos, NULL), "reader");
  dds_delete_qos(qos);
  return reader;
}

// The next message, or nothing.
static const void* take(dds_entity_t reader, void* place) {
  void* samples[1] = {place};
  dds_sample_info_t info[1];
  return dds_take(reader, samples, info, 1, 1) == 1 && info[0].valid_data ? samples[0] : NULL;
}

static void print_joints(const sensor_msgs_msg_dds__JointState_* state) {
  printf("joints %d %u %s", state->header_.stamp_.sec_, state->header_.stamp_.nanosec_,
         state->header_.frame_id_);
  for (uint32_t i = 0; i < state->name_._length; ++i)
    printf(" %s=%.9g/%.9g/%.9g", state->name_._buffer[i], state->position_._buffer[i],
           i < state->velocity_._length ? state->velocity_._buffer[i] : -1,
           i < state->effort_._length ? state->effort_._buffer[i] : -1);
  puts("");
}

static void print_transforms(const tf2_msgs_msg_dds__TFMessage_* message, char** wanted) {
  for (uint32_t i = 0; i < message->transforms_._length; ++i) {
    const geometry_msgs_msg_dds__TransformStamped_* t = &message->transforms_._buffer[i];
    const geometry_msgs_msg_dds__Vector3_* p = &t->transform_.translation_;
    const geometry_msgs_msg_dds__Quaternion_* q = &t->transform_.rotation_;
    for (char** frame = wanted; *frame; ++frame) {
      if (strcmp(*frame, t->child_frame_id_) != 0) continue;
      printf("frame %s %s %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", t->header_.frame_id_,
             t->child_frame_id_, p->x_, p->y_, p->z_, q->x_, q->y_, q->z_, q->w_);
      for (char** rest = frame; *rest; ++rest) *rest = rest[1];
      break;
    }
  }
}

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  setenv(
      "CYCLONEDDS_URI",
      "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
      1);
  const dds_entity_t node =
      must(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  const dds_entity_t joints =
      make_reader(node, &sensor_msgs_msg_dds__JointState__desc, "rt/joint_states", false);
  const dds_entity_t description =
      make_reader(node, &std_msgs_msg_dds__String__desc, "rt/robot_description", true);
  const dds_entity_t moving = make_reader(node, &tf2_msgs_msg_dds__TFMessage__desc, "rt/tf", false);
  const dds_entity_t fixed =
      make_reader(node, &tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true);

  static sensor_msgs_msg_dds__JointState_ state;
  static std_msgs_msg_dds__String_ text;
  static tf2_msgs_msg_dds__TFMessage_ transforms;
  bool told = false, described = false;
  char** wanted = argv + 2;
  for (int i = 0; i < 3000 && !(told && described && !*wanted); ++i) {
    if (take(joints, &state) && !told) {
      told = true;
      print_joints(&state);
    }
    if (take(description, &text) && !described) {
      described = true;
      printf("description %zu\n", strlen(text.data_));
    }
    if (take(moving, &transforms)) print_transforms(&transforms, wanted);
    if (take(fixed, &transforms)) print_transforms(&transforms, wanted);
    dds_sleepfor(DDS_MSECS(10));
  }
  dds_delete(node);
  return told && described && !*wanted ? 0 : 1;
}
