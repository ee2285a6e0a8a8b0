#include "common/ros2/nodes/type_hash.hpp"

#include <algorithm>

namespace prehend::ros2 {
namespace {

constexpr std::pair<std::string_view, std::string_view> hashes[] = {
    {"diagnostic_msgs/DiagnosticArray",
     "typehash=RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e;"},
    {"geometry_msgs/PoseArray",
     "typehash=RIHS01_af0cc36d190e104d546d168d6b39df04fa4b4ccecf59cb4c9ed328d3d5004aa0;"},
    {"geometry_msgs/PoseStamped",
     "typehash=RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8;"},
    {"sensor_msgs/CameraInfo",
     "typehash=RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275;"},
    {"sensor_msgs/CompressedImage",
     "typehash=RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a;"},
    {"sensor_msgs/Image",
     "typehash=RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47;"},
    {"sensor_msgs/JointState",
     "typehash=RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e;"},
    {"std_msgs/String",
     "typehash=RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18;"},
    {"tf2_msgs/TFMessage",
     "typehash=RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087;"},
    {"trajectory_msgs/JointTrajectory",
     "typehash=RIHS01_179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e;"},
    {"vision_msgs/Detection3DArray",
     "typehash=RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018;"},
};

}  // namespace

std::span<const std::pair<std::string_view, std::string_view>> announced_hashes() {
  return hashes;
}

std::string_view announced_hash(std::string_view type) {
  const auto* found = std::ranges::find(hashes, type, [](const auto& row) { return row.first; });
  return found == std::end(hashes) ? std::string_view() : found->second;
}

}  // namespace prehend::ros2
