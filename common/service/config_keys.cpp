#include "common/service/config.hpp"

namespace prehend::service {

using Numbers = std::vector<double>;
using Text = std::string;
using Names = std::vector<std::string>;

// A pose is seven numbers: x, y, z in metres, then the quaternion w, x, y, z.
const std::vector<ConfigKey>& config_keys() {
  static const std::vector<ConfigKey> keys{
      {"lab.rig", Text("lab"),
       "the set-up of one glove and one robot hand; samples stay within it"},
      {"lab.domain", std::int64_t{0}, "DDS domain, 0 to 232"},
      {"lab.network", Text("laptop"),
       "how services reach each other: laptop, lan, server or wan (deploy/dds)"},
      {"lab.server", Names{}, "ADDRESS:PORT of each discovery server, for the network server"},
      {"lab.services", Names{"glove", "recognition", "mapping", "simulation"},
       "what a complete lab has: `prehend status` says who of them is missing"},
      {"lab.peers", Names{},
       "wan: HOST or HOST:PORT of the site that listens; empty: this is the one that listens"},
      {"lab.listen", Text(""),
       "wan: HOST:PORT where other sites dial this process, when a gateway forwards the port; "
       "empty: at its own address, the first free port from 7420"},
      {"lab.keys", Text(""),
       "folder of this process's keys, or of all, from `prehend keys`; empty: not secured"},
      {"lab.insecure", false,
       "join a network wan without keys: whoever reaches this host may then lead the hand"},
      {"lab.lockstep", false, "follow lab/clock instead of the system clock"},
      {"lab.scene", Text(""),
       "scene file: what stands on the table; empty where only cameras know"},
      {"lab.catalogue", Text("share:models/objects/catalogue.toml"),
       "the objects that the lab knows"},

      {"tracker.X_WT", Numbers{0, 0, 0, 1, 0, 0, 0}, "tracker's frame on the table"},

      {"glove.name", Text("glove"), "key of this glove's topics"},
      {"glove.device", Text(""),
       "what measures the hand, see `prehend glove devices`; empty: the first of these"},
      {"glove.user", Text("anyone"), "who wears the glove"},
      {"glove.hand", Text("right"), "right, or left, which is mirrored into a right one"},
      {"glove.calibration", Text(""), "the user's file from prehend glove calibrate; empty: none"},
      {"glove.hand_scale", 1.0, "length of the user's hand, 1 = average adult"},
      {"glove.port", Text(""), "serial port, host:port where datagrams come, or topic of ROS 2"},
      {"glove.senders", Names{},
       "addresses whose datagrams are heard; empty: those of this machine"},
      {"glove.token_file", Text(""),
       "file with the line that every datagram must begin with; empty: none"},
      {"glove.baud", std::int64_t{115200}, "bits per second on that port"},
      {"glove.sites", Names{"back_of_hand", "thumb", "index", "little"},
       "where the tracker's sensors sit, in the order of their addresses"},
      {"glove.wrist_port", Text(""), "serial port of a tracker on the back of a joint-angle glove"},
      {"glove.format", Text("position_matrix"), "records asked of the tracker"},
      {"glove.mode", Text("stream"), "stream, or point: the tracker is asked for each frame"},
      {"glove.range", std::int64_t{72}, "inches, of the tracker: 36, 72 or 144"},
      {"glove.hemisphere", Text("left"),
       "side of the transmitter where the hand is: front, rear, left, right, upper or lower"},
      {"glove.buttons", false, "the tracker has a mouse; its buttons go to glove/button"},
      {"glove.feedback_force", 20.0,
       "N on a robot's finger that hold the wearer's back with all a glove has; 0: it never does"},
      {"glove.file", Text(""), "recording to play"},
      {"glove.rate", 30.0, "Hz, of the synthetic hand, a joint-angle glove, and in point mode"},

      {"camera.name", Text("camera"), "key of this camera's topic"},
      {"camera.width", std::int64_t{640}, "px"},
      {"camera.height", std::int64_t{480}, "px"},
      {"camera.focal", Numbers{620, 620}, "px, horizontal and vertical"},
      {"camera.centre", Numbers{319.5, 239.5}, "px, principal point"},
      {"camera.distortion", Numbers{0, 0, 0, 0, 0}, "OpenCV's k1 k2 p1 p2 k3"},
      {"camera.X_WC", Numbers{0, -0.75, 0.8, 0.36650123, -0.93041757, 0, 0},
       "camera in the table's frame; z looks into the scene, x right, y down"},

      {"recognition.source", Text(""),
       "where pictures come from, see `prehend camera sources`; empty: the first of these"},
      {"recognition.path", Text(""),
       "device file, video file or stream, folder of pictures, or topic of ROS 2"},
      {"recognition.rate", 10.0, "Hz, at which pictures are taken"},
      {"recognition.model", Text("share:trained/objects.model"), "trained object models"},
      {"recognition.preview", Text(""),
       "jpeg that always shows the last picture and what is in it"},
      {"recognition.accept", 0.7, "least probability of a published detection"},

      {"mapping.hand", Text(""), "kind of robot hand: the name of a folder, or its path"},
      {"mapping.hand_name", Text("hand"), "key of robot/command"},
      {"mapping.model", Text(""), "trained mapping model; empty: that of the hand"},
      {"mapping.intelligent", true, "let detections improve the mapping"},
      {"mapping.placement", true, "let them correct the hand's placement as well"},
      {"mapping.glove", Text(""),
       "glove.name of the glove that leads; empty: the first that comes"},
      {"mapping.other_hands", Names{},
       "hands in the same world that this one keeps off, by their names in robot/state"},
      {"mapping.clutch_speed", 0.1, "m/s, at which the hands come together after an interruption"},
      {"mapping.clutch_turn_speed", 0.5, "rad/s, at which their orientations do"},
      {"mapping.clutch_finger_speed", 0.5, "rad/s, at which their fingers do"},
      {"mapping.mode", Text(""),
       "how fingers are answered, see services/mapping; empty: by the trained network"},

      {"simulation.hand", Text(""), "kind of robot hand: the name of a folder, or its path"},
      {"simulation.hand_name", Text("hand"), "key of robot/command"},
      {"simulation.hands", Names{},
       "several hands in one world, each NAME:HAND, as left:barrett_left; none: hand and "
       "hand_name"},
      {"simulation.rate", 500.0, "Hz, physics steps"},
      {"simulation.state_rate", 100.0, "Hz, robot/state and object/state"},
      {"simulation.brake", 20.0, "m/s², by which the arm brakes at a stop; else 10"},
      {"simulation.brake_turn", 100.0, "rad/s², by which its turn brakes at a stop; else 50"},

      {"demonstration.tasks", Text(""),
       "folder of tasks; empty: «tasks» in that of systemd or the user"},
      {"demonstration.model", Text(""),
       "from `prehend demonstration train`; empty: the object and the palm alone tell grasps"},
      {"demonstration.objects", Text("seen"),
       "where objects are: seen (object/detection) or simulated (object/state)"},
      {"demonstration.accept", 0.3, "least probability of a grasp that is named"},

      {"performer.tries", std::int64_t{24}, "grasps of each step that are tried in thought"},

      {"robot.device", Text("barrett"), "the robot at the end of the wire, see services/robot"},
      {"robot.port", Text(""), "its serial port, or its controller in ROS 2"},
      {"robot.network", Text("laptop"), "how nodes of ROS 2 are reached: laptop or lan"},
      {"robot.baud", std::int64_t{0}, "bits per second on that port; 0: as the robot is sold"},
      {"robot.id", std::int64_t{0}, "of a gripper or hand on its line; 0: as it is sold"},
      {"robot.wiring", Text(""),
       "which servo moves what; empty: dynamixel.toml in the folder of mapping.hand"},
      {"robot.hand_name", Text("hand"), "key of robot/command"},
      {"robot.rate", 100.0, "Hz, of commands to the robot, and of robot/state"},
      {"robot.home", false,
       "home the robot whenever it does not know where its joints are; it moves"},
      {"robot.max_temperature", 60.0, "°C, of its motors: hotter, it stops"},
      {"robot.lost_after", 0.3, "s without a sound answer, after which it stops"},

      {"robot.arm", Text(""),
       "the arm that carries the simulated hand: a name or folder of models/arms; empty: it flies"},
      {"robot.arm_name", Text("arm"), "key of arm/command and arm/state"},
      {"robot.X_WA", Numbers{0, -0.7, 0, 0.70710678, 0, 0, 0.70710678},
       "where the arm stands on the table"},
      {"robot.X_EB", Numbers{},
       "how the arm's end holds the hand's base; empty: on its flange, bent by robot.bracket"},
      {"robot.bracket", 0.7, "rad, by which a bracket bends the hand on the flange, 0 to 1.2"},

      {"ros.trajectories", Text("joint_trajectory"),
       "the topic of ROS 2 by whose trajectories prehend-ros-lead leads the hand"},
      {"ros.wrist_poses", Text("wrist_pose"),
       "topic of ROS 2 whose poses lead the base of the robot hand"},
      {"ros.network", Text("laptop"),
       "how nodes of ROS 2 that lead, or are hand or camera, are reached: laptop or lan"},

      {"gate.max_age", 0.2, "s: robots refuse commands that are older, or as far ahead"},
      {"gate.max_silence", 0.3, "s without a command, after which another writer may lead"},
      {"gate.box", Numbers{-10, -10, -10, 10, 10, 10},
       "m, on the table: where the base may be, lower x, y, z, upper x, y, z"},
      {"gate.effort", 1.0,
       "how much of the effort of hand.toml the fingers may use, above 0 up to 1"},
      {"gate.base_speed", 1.2, "m/s, of the base"},
      {"gate.base_acceleration", 300.0, "m/s², of the base"},
      {"gate.base_turn_speed", 3.6, "rad/s, of the base"},
      {"gate.base_turn_acceleration", 900.0, "rad/s², of the base"},

      {"console.address", Text("127.0.0.1"),
       "where the page is served; beyond this machine only with certificate and token"},
      {"console.port", std::int64_t{8765}, "its TCP port; 0: any that is free"},
      {"console.certificate", Text(""),
       "PEM file, for https; self: made at each start; empty: http"},
      {"console.key", Text(""), "PEM file with the certificate's private key"},
      {"console.token_file", Text(""), "file with the token without which nobody looks"},
      {"console.hosts", Names{}, "names by which the page is reached, beside the address"},
      {"console.viewers", Names{},
       "origins of other sites that may look, as https://app.foxglove.dev; none gives orders"},

      {"teacher.folder", Text(""),
       "where what is taught is kept; empty: prehend/taught in the user's data folder"},
      {"teacher.users", std::int64_t{60}, "synthetic people that are learnt from beside the user"},

      {"metrics.address", Text("127.0.0.1"),
       "where `prehend metrics` answers; 0.0.0.0: at every interface"},
      {"metrics.port", std::int64_t{9478}, "its TCP port; 0: any that is free"},

      {"keys.revocation_max_age", 0.0,
       "days, after which a list of revoked keys is called old (prehend keys refresh); 0: never"},
      {"keys.refuse_old_list", false, "with such a list nobody joins"},

      {"safety.on_stop", Text("hold"),
       "what the fingers do at a stop: hold (keep their squeeze) or open; the base stays"},
      {"safety.deadman", false,
       "robots move only while somebody holds consent (prehend consent); not set: real ones do so"},
      {"safety.button", std::int64_t{0},
       "number of the button of glove.name that gives consent while it is held; 0: none"},
      {"safety.audit", Text(""),
       "folder where robots log who led and stopped them; empty: nowhere"},
      {"safety.state", Text(""),
       "folder where robots keep a stop until its release; empty: that of systemd or the user"},
      {"safety.start_stopped", false, "a robot obeys nothing before its first release"},
  };
  return keys;
}

const std::vector<std::string>& other_variables() {
  static const std::vector<std::string> names{
      "PREHEND_SHARE",        // common/base/paths.hpp
      "PREHEND_LOG",          // common/tool/program.hpp
      "PREHEND_SEED",         // containers (deploy): the scene, the gateway between sites,
      "PREHEND_GATEWAY",      //
      "PREHEND_HANDS",        // two that carry something together,
      "PREHEND_TRACKER",      // devices on the host,
      "PREHEND_CAMERA",       //
      "PREHEND_RECORDING",    // and what is played instead
      "PREHEND_LONG",         // tests
      "PREHEND_SHARED_DATA",  // tests, `prehend study`
  };
  return names;
}

}  // namespace prehend::service
