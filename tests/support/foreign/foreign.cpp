#include "tests/support/foreign/foreign.hpp"

#include <fmt/format.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/base64.hpp"
#include "common/recording/mcap/writer.hpp"

namespace prehend::test {
namespace {

namespace pb = google::protobuf;
using Bytes = std::vector<std::uint8_t>;
using Field = pb::FieldDescriptorProto;

/// CDR of ROS 2 behind its four bytes, or the packed bytes of ROS 1.
class Wire {
 public:
  explicit Wire(bool packed) : packed_(packed) {
    if (!packed) bytes_ = {0, 1, 0, 0};
  }
  template <class Number>
  void number(Number value) {
    if (!packed_)
      while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_.push_back(0);
    const auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(value);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  void text(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size() + (packed_ ? 0 : 1)));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    if (!packed_) bytes_.push_back(0);
  }
  void raw(const std::string& bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void numbers(const std::vector<double>& all) {
    number(static_cast<std::uint32_t>(all.size()));
    for (const double each : all) number(each);
  }
  void header() {
    if (packed_) number(std::uint32_t{7});  // seq
    number(std::uint32_t{1'700'000'000});
    number(std::uint32_t{5});
    text("base");
  }
  Bytes bytes() const { return bytes_; }

 private:
  bool packed_;
  Bytes bytes_;
};

const std::string bar = std::string(80, '=') + "\n";
const std::string header_of_ros1 =
    bar + "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const std::string header_of_ros2 =
    bar + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + bar +
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const std::string poses_of_msg =
    bar + "MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n" + bar +
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + bar +
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

std::string idl(const std::string& package, const std::string& name, const std::string& body,
                const std::string& includes = {}) {
  return fmt::format(
      "{0}IDL: {1}/msg/{2}\n// generated from rosidl_adapter/resource/msg.idl.em\n{3}"
      "module {1} {{\n  module msg {{\n"
      "    module {2}_Constants {{\n      const string WORD = \"a; word\";\n"
      "      const int32 BELOW = -1;\n    }};\n"
      "    @verbatim (language=\"comment\", text=\n      \"What it is; (all of it)\" \"\\n\"\n"
      "      \"and more\")\n    struct {2} {{\n{4}    }};\n  }};\n}};\n",
      bar, package, name, includes, body);
}

std::string header_of_idl() {
  // A part stands before those that it needs.
  return idl("std_msgs", "Header", "builtin_interfaces::msg::Time stamp;\n string frame_id;\n",
             "#include \"builtin_interfaces/msg/Time.idl\"\n") +
         idl("builtin_interfaces", "Time", "int32 sec;\n uint32 nanosec;\n");
}

Field field(const std::string& name, int number, Field::Type type, bool many = false,
            const std::string& of = {}) {
  Field made;
  made.set_name(name);
  made.set_number(number);
  made.set_type(type);
  made.set_label(many ? Field::LABEL_REPEATED : Field::LABEL_OPTIONAL);
  if (!of.empty()) made.set_type_name(of);
  return made;
}

pb::FileDescriptorSet descriptors() {
  pb::FileDescriptorSet set;
  pb::FileDescriptorProto& file = *set.add_file();
  file.set_name("robot.proto");
  file.set_package("other");
  file.set_syntax("proto3");
  const auto add = [&](const std::string& name, const std::vector<Field>& fields) {
    pb::DescriptorProto& type = *file.add_message_type();
    type.set_name(name);
    for (const Field& each : fields) *type.add_field() = each;
  };
  add("Joints",
      {field("name", 1, Field::TYPE_STRING, true), field("position", 2, Field::TYPE_DOUBLE, true),
       field("velocity", 3, Field::TYPE_DOUBLE, true)});
  add("Point", {field("x", 1, Field::TYPE_DOUBLE), field("y", 2, Field::TYPE_DOUBLE),
                field("z", 3, Field::TYPE_DOUBLE)});
  add("Turn", {field("x", 1, Field::TYPE_DOUBLE), field("y", 2, Field::TYPE_DOUBLE),
               field("z", 3, Field::TYPE_DOUBLE), field("w", 4, Field::TYPE_DOUBLE)});
  add("Pose", {field("position", 1, Field::TYPE_MESSAGE, false, ".other.Point"),
               field("orientation", 2, Field::TYPE_MESSAGE, false, ".other.Turn")});
  add("Place", {field("pose", 1, Field::TYPE_MESSAGE, false, ".other.Pose")});
  add("Picture", {field("format", 1, Field::TYPE_STRING), field("data", 2, Field::TYPE_BYTES)});
  add("Raster", {field("width", 1, Field::TYPE_FIXED32), field("height", 2, Field::TYPE_FIXED32),
                 field("encoding", 3, Field::TYPE_STRING), field("step", 4, Field::TYPE_FIXED32),
                 field("data", 5, Field::TYPE_BYTES)});
  add("Yes", {field("data", 1, Field::TYPE_BOOL)});
  return set;
}

/// A message of that type; `fill` sets its fields through the JSON-like path of names.
class Dynamic {
 public:
  explicit Dynamic(const std::string& name) {
    const auto set = descriptors();
    const pb::FileDescriptor* file = pool_.BuildFile(set.file(0));
    if (!file) throw std::runtime_error("descriptors");
    message_.reset(factory_.GetPrototype(file->FindMessageTypeByName(name))->New());
  }
  pb::Message& message() { return *message_; }
  static const pb::FieldDescriptor* in(const pb::Message& message, const std::string& field) {
    return message.GetDescriptor()->FindFieldByName(field);
  }
  static pb::Message& part(pb::Message& message, const std::string& field) {
    return *message.GetReflection()->MutableMessage(&message, in(message, field));
  }
  static void set(pb::Message& message, const std::string& field, double value) {
    message.GetReflection()->SetDouble(&message, in(message, field), value);
  }
  Bytes bytes() const {
    const std::string text = message_->SerializeAsString();
    return {text.begin(), text.end()};
  }

 private:
  pb::DescriptorPool pool_;
  pb::DynamicMessageFactory factory_;
  std::unique_ptr<pb::Message> message_;
};

void must(const Expected<void>& done) {
  if (!done) throw std::runtime_error(done.error().message());
}

Bytes of_json(const nlohmann::json& json) {
  const std::string text = json.dump();
  return {text.begin(), text.end()};
}

Schema schema(Stack stack, const std::string& package, const std::string& name,
              const std::string& msg_fields, const std::string& idl_fields,
              const std::string& protobuf, bool pose = false) {
  switch (stack) {
    case Stack::ros1:
      return {package + "/" + name, "ros1msg",
              msg_fields + header_of_ros1 + (pose ? poses_of_msg : "")};
    case Stack::ros2msg:
      return {package + "/msg/" + name, "ros2msg",
              msg_fields + header_of_ros2 + (pose ? poses_of_msg : "")};
    case Stack::ros2idl: {
      std::string text = idl(package, name, idl_fields) + header_of_idl();
      if (pose)
        text += idl("geometry_msgs", "Pose",
                    "geometry_msgs::msg::Point position;\ngeometry_msgs::msg::Quaternion "
                    "orientation;\n") +
                idl("geometry_msgs", "Point", "double x;\ndouble y;\ndouble z;\n") +
                idl("geometry_msgs", "Quaternion", "double x;\ndouble y;\ndouble z;\ndouble w;\n");
      return {package + "/msg/" + name, "ros2idl", text};
    }
    case Stack::json:
      return {name, "jsonschema", "{\"type\": \"object\"}"};
    case Stack::protobuf:
      return {"other." + protobuf, "protobuf", descriptors().SerializeAsString()};
  }
  return {};
}

}  // namespace

std::string encoding_of(Stack stack) {
  switch (stack) {
    case Stack::ros1:
      return "ros1";
    case Stack::json:
      return "json";
    case Stack::protobuf:
      return "protobuf";
    default:
      return "cdr";
  }
}

Schema joints_schema(Stack stack) {
  return schema(stack, "sensor_msgs", "JointState",
                "# of joints\nHeader header\nstring[] name\nfloat64[] position\nfloat64[] "
                "velocity\nfloat64[] effort\n",
                "std_msgs::msg::Header header;\nsequence<string> name;\nsequence<double> "
                "position;\nsequence<double> velocity;\nsequence<double> effort;\n",
                "Joints");
}
Schema place_schema(Stack stack) {
  return schema(stack, "geometry_msgs", "PoseStamped",
                "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                "std_msgs::msg::Header header;\ngeometry_msgs::msg::Pose pose;\n", "Place", true);
}
Schema picture_schema(Stack stack) {
  return schema(stack, "sensor_msgs", "CompressedImage",
                "std_msgs/Header header\nstring format\nuint8[] data\n",
                "std_msgs::msg::Header header;\nstring format;\nsequence<uint8> data;\n",
                "Picture");
}
Schema raster_schema(Stack stack) {
  return schema(stack, "sensor_msgs", "Image",
                "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 "
                "is_bigendian\nuint32 step\nuint8[] data\n",
                "std_msgs::msg::Header header;\nuint32 height;\nuint32 width;\nstring "
                "encoding;\nuint8 is_bigendian;\nuint32 step;\nsequence<uint8> data;\n",
                "Raster");
}
Schema yes_schema(Stack stack) {
  return schema(stack, "std_msgs", "Bool", "bool data\n", "boolean data;\n", "Yes");
}

Bytes message(Stack stack, const Joints& joints) {
  if (stack == Stack::json)
    return of_json({{"name", joints.names},
                    {"position", joints.position},
                    {"velocity", joints.velocity},
                    {"effort", nullptr}});
  if (stack == Stack::protobuf) {
    Dynamic made("Joints");
    pb::Message& m = made.message();
    for (const std::string& name : joints.names)
      m.GetReflection()->AddString(&m, Dynamic::in(m, "name"), name);
    for (const double x : joints.position)
      m.GetReflection()->AddDouble(&m, Dynamic::in(m, "position"), x);
    for (const double x : joints.velocity)
      m.GetReflection()->AddDouble(&m, Dynamic::in(m, "velocity"), x);
    return made.bytes();
  }
  Wire wire(stack == Stack::ros1);
  wire.header();
  wire.number(static_cast<std::uint32_t>(joints.names.size()));
  for (const std::string& name : joints.names) wire.text(name);
  wire.numbers(joints.position);
  wire.numbers(joints.velocity);
  wire.numbers({});
  return wire.bytes();
}

Bytes message(Stack stack, const Place& place) {
  const auto& [p, q] = place;
  if (stack == Stack::json)
    return of_json({{"pose",
                     {{"position", {{"x", p[0]}, {"y", p[1]}, {"z", p[2]}}},
                      {"orientation", {{"x", q[0]}, {"y", q[1]}, {"z", q[2]}, {"w", q[3]}}}}}});
  if (stack == Stack::protobuf) {
    Dynamic made("Place");
    pb::Message& pose = Dynamic::part(made.message(), "pose");
    const char* names[] = {"x", "y", "z", "w"};
    for (int i = 0; i < 3; ++i) Dynamic::set(Dynamic::part(pose, "position"), names[i], p[i]);
    for (int i = 0; i < 4; ++i) Dynamic::set(Dynamic::part(pose, "orientation"), names[i], q[i]);
    return made.bytes();
  }
  Wire wire(stack == Stack::ros1);
  wire.header();
  for (const double x : p) wire.number(x);
  for (const double x : q) wire.number(x);
  return wire.bytes();
}

Bytes picture_message(Stack stack, const std::string& bytes) {
  if (stack == Stack::json) return of_json({{"format", "jpeg"}, {"data", base64(bytes)}});
  if (stack == Stack::protobuf) {
    Dynamic made("Picture");
    pb::Message& m = made.message();
    m.GetReflection()->SetString(&m, Dynamic::in(m, "format"), "jpeg");
    m.GetReflection()->SetString(&m, Dynamic::in(m, "data"), bytes);
    return made.bytes();
  }
  Wire wire(stack == Stack::ros1);
  wire.header();
  wire.text("jpeg");
  wire.raw(bytes);
  return wire.bytes();
}

Bytes message(Stack stack, const Raster& raster) {
  const auto& [width, height, pixels] = raster;
  const std::uint32_t step = 3 * width;
  if (stack == Stack::json)
    return of_json({{"width", width},
                    {"height", height},
                    {"encoding", "bgr8"},
                    {"step", step},
                    {"data", base64(pixels)}});
  if (stack == Stack::protobuf) {
    Dynamic made("Raster");
    pb::Message& m = made.message();
    const pb::Reflection& fields = *m.GetReflection();
    fields.SetUInt32(&m, Dynamic::in(m, "width"), width);
    fields.SetUInt32(&m, Dynamic::in(m, "height"), height);
    fields.SetUInt32(&m, Dynamic::in(m, "step"), step);
    fields.SetString(&m, Dynamic::in(m, "encoding"), "bgr8");
    fields.SetString(&m, Dynamic::in(m, "data"), pixels);
    return made.bytes();
  }
  Wire wire(stack == Stack::ros1);
  wire.header();
  wire.number(height);
  wire.number(width);
  wire.text("bgr8");
  wire.number(std::uint8_t{0});
  wire.number(step);
  wire.raw(pixels);
  return wire.bytes();
}

Bytes yes_message(Stack stack, bool yes) {
  if (stack == Stack::json) return of_json({{"data", yes}});
  if (stack == Stack::protobuf) {
    Dynamic made("Yes");
    pb::Message& m = made.message();
    m.GetReflection()->SetBool(&m, Dynamic::in(m, "data"), yes);
    return made.bytes();
  }
  Wire wire(stack == Stack::ros1);
  wire.number(static_cast<std::uint8_t>(yes ? 1 : 0));
  return wire.bytes();
}

void write_recording(const std::filesystem::path& file, Stack stack, const std::string& picture,
                     const Raster& raster) {
  const bool is_raw = !raster.pixels.empty();
  auto writer = recording::mcap::Writer::create(file).value();
  const auto add = [&](const std::string& topic, const Schema& schema) {
    const auto id = writer.add_schema(schema.name, schema.encoding, schema.data).value();
    return writer.add_channel(id, topic, encoding_of(stack)).value();
  };
  const auto states = add("/joint_states", joints_schema(stack));
  const auto commands = add("/command", joints_schema(stack));
  const auto tool = add("/tool", place_schema(stack));
  const auto run = add("/run", yes_schema(stack));
  const bool sees = is_raw || !picture.empty();
  const auto camera =
      sees ? add("/camera", is_raw ? raster_schema(stack) : picture_schema(stack)) : 0;
  std::uint32_t sequence = 0;
  const auto write = [&](std::uint16_t channel, int ms, const Bytes& data) {
    const std::uint64_t time =
        1'700'000'000'000'000'000 + static_cast<std::uint64_t>(ms) * 1'000'000;
    must(writer.write(recording::mcap::Message{channel, ++sequence, time, time, data}));
  };
  for (int ms = 0; ms <= 2000; ms += 20) {
    const double t = ms / 1000.0;
    if (ms % 40 == 0)
      write(states, ms, message(stack, Joints{{"a", "b"}, {t, 2 * t}, {1, 2}}));
    else
      write(states, ms, message(stack, Joints{{"b", "a"}, {2 * t, t}, {2, 1}}));
    write(commands, ms, message(stack, Joints{{"a", "b"}, {t + 0.1, 2 * t + 0.1}, {}}));
    write(tool, ms, message(stack, Place{{t, 0, 0.5}, {0, 0, std::sin(t / 2), std::cos(t / 2)}}));
    if (sees && ms % 100 == 0)
      write(camera, ms, is_raw ? message(stack, raster) : picture_message(stack, picture));
    if (ms == 200 || ms == 900 || ms == 1100 || ms == 1800)
      write(run, ms, yes_message(stack, ms == 200 || ms == 1100));
  }
  must(writer.close());
}

std::string columns_of_recording(bool pictures, const std::string& episodes) {
  return "robot = \"theirs\"\ntask = \"wave\"\n" + episodes +
         "[[state]]\ntopic = \"/joint_states\"\nfield = \"position\"\nnames = \"name\"\n"
         "[[action]]\ntopic = \"/command\"\nfield = \"position\"\nnames = \"name\"\n"
         "[[observation]]\nname = \"tool\"\ntopic = \"/tool\"\nfield = \"pose\"\n"
         "[[observation]]\nname = \"speed_of_b\"\ntopic = \"/joint_states\"\nfield = "
         "\"velocity\"\nnames = \"name\"\nonly = [\"b\"]\n" +
         (pictures ? "[[picture]]\nname = \"front\"\ntopic = \"/camera\"\nfield = \"data\"\n" : "");
}

}  // namespace prehend::test
