// A camera that is a node of ROS 2: tells the picture in FILE, and a lens of its size that is FOCAL
// px long, ten times a second, without asking whether they come, as drivers of cameras do. A file
// that ends with .rgb has the bytes of its pixels, and is told raw. Ends by a signal.
//
//   cyclone_ros_camera DOMAIN NAMESPACE FILE WIDTH HEIGHT FOCAL
#include "cyclone_node.h"

static uint8_t data[4 << 20];

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  FILE* file = fopen(argv[3], "rb");
  if (!file) return 2;
  const uint32_t size = (uint32_t)fread(data, 1, sizeof data, file);
  fclose(file);
  const bool is_raw = strstr(argv[3], ".rgb") != NULL;
  const uint32_t width = (uint32_t)atoi(argv[4]), height = (uint32_t)atoi(argv[5]);

  sensor_msgs_msg_dds__CompressedImage_ compressed;
  memset(&compressed, 0, sizeof compressed);
  compressed.header_.frame_id_ = compressed.format_ = "jpeg";
  compressed.data_._buffer = data;
  compressed.data_._length = compressed.data_._maximum = size;
  sensor_msgs_msg_dds__Image_ raw;
  memset(&raw, 0, sizeof raw);
  raw.header_.frame_id_ = "camera";
  raw.encoding_ = "rgb8";
  raw.width_ = width;
  raw.height_ = height;
  raw.step_ = 3 * width;
  raw.data_ = compressed.data_;
  sensor_msgs_msg_dds__CameraInfo_ lens;
  memset(&lens, 0, sizeof lens);
  lens.header_.frame_id_ = "camera";
  lens.distortion_model_ = "plumb_bob";
  lens.width_ = width;
  lens.height_ = height;
  lens.k_[0] = lens.k_[4] = atof(argv[6]);
  lens.k_[2] = (width - 1) / 2.0;
  lens.k_[5] = (height - 1) / 2.0;
  lens.k_[8] = 1;

  const dds_entity_t node = join(argv[1]);
  char name[256];
  snprintf(name, sizeof name, "%s/camera_info", argv[2]);
  const dds_entity_t lenses =
      make_writer(node, &sensor_msgs_msg_dds__CameraInfo__desc, name, false);
  snprintf(name, sizeof name, is_raw ? "%s/image_raw" : "%s/image/compressed", argv[2]);
  const dds_entity_t pictures = make_writer(
      node,
      is_raw ? &sensor_msgs_msg_dds__Image__desc : &sensor_msgs_msg_dds__CompressedImage__desc,
      name, false);
  const void* picture = is_raw ? (const void*)&raw : (const void*)&compressed;
  while (true) {
    must(dds_write(lenses, &lens), "write");
    must(dds_write(pictures, picture), "write");
    dds_sleepfor(DDS_MSECS(100));
  }
}
