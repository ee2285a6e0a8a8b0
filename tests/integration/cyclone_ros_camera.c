// A camera that is a node of ROS 2: tells the picture in FILE, and a lens of its size that is FOCAL
// px long, ten times a second, without asking whether they come, as drivers of cameras do. Ends by
// a signal.
//
//   cyclone_ros_camera DOMAIN NAMESPACE FILE WIDTH HEIGHT FOCAL
#include "cyclone_node.h"

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  static uint8_t data[4 << 20];
  FILE* file = fopen(argv[3], "rb");
  if (!file) return 2;
  sensor_msgs_msg_dds__CompressedImage_ picture;
  memset(&picture, 0, sizeof picture);
  picture.header_.frame_id_ = picture.format_ = "jpeg";
  picture.data_._buffer = data;
  picture.data_._length = picture.data_._maximum = (uint32_t)fread(data, 1, sizeof data, file);
  fclose(file);
  sensor_msgs_msg_dds__CameraInfo_ lens;
  memset(&lens, 0, sizeof lens);
  lens.header_.frame_id_ = "camera";
  lens.distortion_model_ = "plumb_bob";
  lens.width_ = (uint32_t)atoi(argv[4]);
  lens.height_ = (uint32_t)atoi(argv[5]);
  lens.k_[0] = lens.k_[4] = atof(argv[6]);
  lens.k_[2] = (lens.width_ - 1) / 2.0;
  lens.k_[5] = (lens.height_ - 1) / 2.0;
  lens.k_[8] = 1;

  const dds_entity_t node = join(argv[1]);
  char name[256];
  snprintf(name, sizeof name, "%s/camera_info", argv[2]);
  const dds_entity_t lenses =
      make_writer(node, &sensor_msgs_msg_dds__CameraInfo__desc, name, false);
  snprintf(name, sizeof name, "%s/image/compressed", argv[2]);
  const dds_entity_t pictures =
      make_writer(node, &sensor_msgs_msg_dds__CompressedImage__desc, name, false);
  while (true) {
    must(dds_write(lenses, &lens), "write");
    must(dds_write(pictures, &picture), "write");
    dds_sleepfor(DDS_MSECS(100));
  }
}
