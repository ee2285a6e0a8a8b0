// A writer of another make, as a lab may have it: Cyclone DDS, which does not send keys beside its
// samples. Waits for a reader of both topics, writes to two instances of each and disposes one.
//
//   cyclone_writer DOMAIN PARTITION
#define _DEFAULT_SOURCE  // setenv
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "Perception.h"

static dds_entity_t must(dds_entity_t result, const char* what) {
  if (result >= 0) return result;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(-result));
  exit(3);
}

static dds_entity_t make_writer(dds_entity_t participant, dds_entity_t publisher,
                                const dds_topic_descriptor_t* type, const char* name) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t topic = must(dds_create_topic(participant, type, name, NULL, NULL), "topic");
  const dds_entity_t writer = must(dds_create_writer(publisher, topic, qos, NULL), "writer");
  dds_delete_qos(qos);
  return writer;
}

static void wait_for_reader(dds_entity_t writer) {
  dds_publication_matched_status_t matched = {0};
  while (matched.current_count == 0) {
    dds_sleepfor(DDS_MSECS(10));
    must(dds_get_publication_matched_status(writer, &matched), "status");
  }
}

static void write_detection(dds_entity_t writer, uint32_t track, uint64_t number) {
  prehend_v1_ObjectDetection detection;
  memset(&detection, 0, sizeof detection);
  detection.track = track;
  detection.sequence_number = number;
  must(dds_write(writer, &detection), "write");
}

static prehend_v1_CameraImage image_of(const char* camera, uint64_t number) {
  static uint8_t picture[1000];
  prehend_v1_CameraImage image;
  memset(&image, 0, sizeof image);
  strncpy(image.camera, camera, sizeof image.camera - 1);
  image.sequence_number = number;
  image.data._buffer = picture;
  image.data._length = image.data._maximum = sizeof picture;
  return image;
}

static void write_image(dds_entity_t writer, const char* camera, uint64_t number) {
  const prehend_v1_CameraImage image = image_of(camera, number);
  must(dds_write(writer, &image), "write");
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  // Where the recorder of the test is.
  setenv(
      "CYCLONEDDS_URI",
      "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
      1);
  const dds_entity_t participant =
      must(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, argv[2]);
  const dds_entity_t publisher = must(dds_create_publisher(participant, qos, NULL), "publisher");
  dds_delete_qos(qos);
  const dds_entity_t detections =
      make_writer(participant, publisher, &prehend_v1_ObjectDetection_desc, "object/detection");
  const dds_entity_t images =
      make_writer(participant, publisher, &prehend_v1_CameraImage_desc, "camera/image");
  wait_for_reader(detections);
  wait_for_reader(images);

  for (uint64_t i = 0; i < 6; ++i) {
    write_detection(detections, i % 2 == 0 ? 4 : 7, i);
    write_image(images, i % 2 == 0 ? "left" : "the camera on the right", i);
  }
  prehend_v1_ObjectDetection gone;
  memset(&gone, 0, sizeof gone);
  gone.track = 4;
  must(dds_dispose(detections, &gone), "dispose");
  const prehend_v1_CameraImage left = image_of("left", 0);
  must(dds_dispose(images, &left), "dispose");
  const prehend_v1_CameraImage right = image_of("the camera on the right", 0);
  must(dds_dispose(images, &right), "dispose");
  must(dds_wait_for_acks(detections, DDS_SECS(10)), "acknowledgement");
  must(dds_wait_for_acks(images, DDS_SECS(10)), "acknowledgement");
  puts("written");
  fflush(stdout);
  pause();  // its end would be the end of its instances
  return 0;
}
