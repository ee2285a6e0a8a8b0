// A node of ROS 2 as far as DDS sees it: Cyclone DDS, in no partition, with the QoS that such nodes
// ask for. Prints what it hears first on each topic, and what its writer announces of the type,
// until it has heard all of them, and where the frames stand that are named.
//
//   cyclone_ros_reader DOMAIN FRAME...
#include <stdbool.h>

#include "cyclone_node.h"

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

static void print_joints(const void* message) {
  const sensor_msgs_msg_dds__JointState_* state = message;
  printf("joints %d %u %s", state->header_.stamp_.sec_, state->header_.stamp_.nanosec_,
         state->header_.frame_id_);
  for (uint32_t i = 0; i < state->name_._length; ++i)
    printf(" %s=%.9g/%.9g/%.9g", state->name_._buffer[i], state->position_._buffer[i],
           i < state->velocity_._length ? state->velocity_._buffer[i] : -1,
           i < state->effort_._length ? state->effort_._buffer[i] : -1);
  puts("");
}

static void print_description(const void* message) {
  const std_msgs_msg_dds__String_* text = message;
  printf("description %zu\n", strlen(text->data_));
}

static void print_detections(const void* message) {
  const vision_msgs_msg_dds__Detection3DArray_* all = message;
  printf("detections %u", all->detections_._length);
  for (uint32_t i = 0; i < all->detections_._length; ++i) {
    const vision_msgs_msg_dds__Detection3D_* one = &all->detections_._buffer[i];
    printf(" %s=%.9g/%.9g", one->results_._buffer[0].hypothesis_.class_id_,
           one->bbox_.center_.position_.x_, one->bbox_.size_.z_);
  }
  puts("");
}

static void print_diagnostics(const void* message) {
  const diagnostic_msgs_msg_dds__DiagnosticStatus_* one =
      ((const diagnostic_msgs_msg_dds__DiagnosticArray_*)message)->status_._buffer;
  printf("diagnostics %u %s: %s\n", one->level_, one->name_, one->message_);
}

static void print_picture(const void* message) {
  const sensor_msgs_msg_dds__CompressedImage_* picture = message;
  printf("picture %s %s %u\n", picture->header_.frame_id_, picture->format_,
         picture->data_._length);
}

static void print_lens(const void* message) {
  const sensor_msgs_msg_dds__CameraInfo_* lens = message;
  printf("lens %u %u %.9g\n", lens->width_, lens->height_, lens->k_[0]);
}

// What the first writer of this topic says of its type.
static void print_announced(dds_entity_t reader, const char* topic) {
  dds_instance_handle_t writers[1];
  if (dds_get_matched_publications(reader, writers, 1) < 1) return;
  dds_builtintopic_endpoint_t* writer = dds_get_matched_publication_data(reader, writers[0]);
  if (!writer) return;
  void* said = NULL;
  size_t size = 0;
  if (dds_qget_userdata(writer->qos, &said, &size))
    printf("announced %s %.*s\n", topic, (int)size, (const char*)said);
  dds_free(said);
  dds_builtintopic_free_endpoint(writer);
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

// What is heard once.
static sensor_msgs_msg_dds__JointState_ state;
static std_msgs_msg_dds__String_ text;
static vision_msgs_msg_dds__Detection3DArray_ detections;
static diagnostic_msgs_msg_dds__DiagnosticArray_ diagnostics;
static sensor_msgs_msg_dds__CompressedImage_ picture;
static sensor_msgs_msg_dds__CameraInfo_ lens;

static struct Topic {
  const char* name;
  const dds_topic_descriptor_t* type;
  bool kept;
  void* place;
  void (*print)(const void*);
  dds_entity_t reader;
  bool heard;
} topics[] = {{"rt/joint_states", &sensor_msgs_msg_dds__JointState__desc, false, &state,
               print_joints, 0, false},
              {"rt/robot_description", &std_msgs_msg_dds__String__desc, true, &text,
               print_description, 0, false},
              {"rt/detections", &vision_msgs_msg_dds__Detection3DArray__desc, false, &detections,
               print_detections, 0, false},
              {"rt/diagnostics", &diagnostic_msgs_msg_dds__DiagnosticArray__desc, false,
               &diagnostics, print_diagnostics, 0, false},
              {"rt/camera/image/compressed", &sensor_msgs_msg_dds__CompressedImage__desc, false,
               &picture, print_picture, 0, false},
              {"rt/camera/camera_info", &sensor_msgs_msg_dds__CameraInfo__desc, false, &lens,
               print_lens, 0, false}};
enum { topics_count = sizeof topics / sizeof *topics };

// Is there none left to hear?
static bool listen(void) {
  bool all = true;
  for (struct Topic* topic = topics; topic < topics + topics_count; ++topic) {
    if (take(topic->reader, topic->place) && !topic->heard) {
      topic->heard = true;
      topic->print(topic->place);
      print_announced(topic->reader, topic->name);
    }
    all = all && topic->heard;
  }
  return all;
}

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const dds_entity_t node = join(argv[1]);
  for (struct Topic* topic = topics; topic < topics + topics_count; ++topic)
    topic->reader = make_reader(node, topic->type, topic->name, topic->kept);
  const dds_entity_t moving = make_reader(node, &tf2_msgs_msg_dds__TFMessage__desc, "rt/tf", false);
  const dds_entity_t fixed =
      make_reader(node, &tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true);

  static tf2_msgs_msg_dds__TFMessage_ transforms;
  bool all = false;
  char** wanted = argv + 2;
  for (int i = 0; i < 3000 && !(all && !*wanted); ++i) {
    all = listen();
    if (take(moving, &transforms)) print_transforms(&transforms, wanted);
    if (take(fixed, &transforms)) print_transforms(&transforms, wanted);
    dds_sleepfor(DDS_MSECS(10));
  }
  print_announced(moving, "rt/tf");
  print_announced(fixed, "rt/tf_static");
  dds_delete(node);
  return all && !*wanted ? 0 : 1;
}
