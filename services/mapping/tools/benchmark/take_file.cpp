#include "services/mapping/tools/benchmark/take_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/dds/raw.hpp"
#include "common/proto/benchmark_take.pb.h"
#include "common/proto/pose_numbers.hpp"
#include "common/proto/sealed_file.hpp"
#include "common/recording/layout/layout.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"
#include "common/recording/types/idl.hpp"
#include "common/recording/types/schema_text.hpp"
#include "services/mapping/service/messages.hpp"
#include "services/mapping/tools/benchmark/lab_messages.hpp"
#include "services/mapping/tools/benchmark/own_by_messages.hpp"

namespace prehend::mapping {

namespace {

namespace mcap = recording::mcap;

constexpr std::string_view kind = "benchmark-take";
constexpr const char* attachment_name = "take";
constexpr Duration camera_period = std::chrono::milliseconds(100);
/// Times of a take count from zero.
constexpr Duration beginning = take_beginning;

/// A topic of the file.
class Track {
 public:
  static Expected<Track> add(mcap::Writer& writer, const recording::types::Library& types,
                             const dds::TopicInfo& topic, const dds::RawSample& first) {
    recording::Stream stream{dds::raw_topic(topic), {1}, first.instance, "benchmark"};
    const auto* type = types.find(stream.topic.type);
    if (!type)
      return fail("is not in share/prehend/idl", stream.topic.type, "is all of it installed?");
    const auto schema = writer.add_schema(recording::types::ros2_name(type->name), "ros2msg",
                                          recording::types::ros2msg(*type));
    if (!schema) return tl::unexpected(schema.error());
    const mcap::Channel made = recording::to_channel(stream);
    const auto id = writer.add_channel(*schema, made.topic, made.message_encoding, made.metadata);
    if (!id) return tl::unexpected(id.error());
    return Track(writer, *id);
  }

  Expected<void> write(const dds::RawSample& sample, Time stamp) {
    const auto time = static_cast<std::uint64_t>(to_ns(stamp));
    return writer_->write(mcap::Message{id_, ++sequence_, time, time, sample.payload});
  }

 private:
  Track(mcap::Writer& writer, std::uint16_t id) : writer_(&writer), id_(id) {}
  mcap::Writer* writer_;
  std::uint16_t id_;
  std::uint32_t sequence_ = 0;
};

Expected<void> write_topics(mcap::Writer& writer, const BenchmarkTake& take) {
  const auto types = recording::types::load_contract();
  if (!types) return tl::unexpected(types.error());
  const RecordedTake& recorded = take.recorded;
  auto hands = Track::add(
      writer, *types, dds::hand_posture,
      raw_sample(dds::hand_posture, to_message(recorded.postures.front(), recorded.user)));
  if (!hands) return tl::unexpected(hands.error());
  auto objects = Track::add(
      writer, *types, dds::object_detection,
      raw_sample(dds::object_detection, to_message(seen_object(take, recorded.X_WO, Time{}))));
  if (!objects) return tl::unexpected(objects.error());

  Time camera{};
  std::uint64_t pictures = 0, frames = 0;
  for (Posture posture : recorded.postures) {
    for (; camera <= posture.stamp; camera += camera_period) {
      auto seen = to_message(seen_object(take, recorded.X_WO, camera + beginning));
      seen.sequence_number(pictures++);
      if (auto done = objects->write(raw_sample(dds::object_detection, seen), camera + beginning);
          !done)
        return done;
    }
    posture.stamp += beginning;
    posture.origin += beginning;
    auto hand = to_message(posture, recorded.user);
    hand.sequence_number(frames++);
    if (auto done = hands->write(raw_sample(dds::hand_posture, hand), posture.stamp); !done)
      return done;
  }
  return {};
}

std::string describe(const model::HandModel& hand, const BenchmarkTake& take) {
  const RecordedTake& recorded = take.recorded;
  messages::BenchmarkTake message;
  message.set_number(static_cast<std::uint32_t>(take.number));
  message.set_user(recorded.user);
  message.set_real(take.real);
  message.set_grasps(encode_robot_grasps(hand, {take.grasp}));
  const auto standing = proto::pose_numbers(recorded.X_WO);
  message.mutable_object_pose()->Add(standing.begin(), standing.end());
  message.set_closed_ns(to_ns(recorded.closed));
  message.set_seen_shape(std::string(model::to_string(recorded.seen_shape.kind)));
  message.mutable_seen_size()->Add(recorded.seen_shape.size.begin(),
                                   recorded.seen_shape.size.end());
  const auto seen = proto::pose_numbers(recorded.X_OS);
  message.mutable_seen_pose()->Add(seen.begin(), seen.end());
  message.mutable_covariance()->Add(recorded.covariance.data(), recorded.covariance.data() + 16);
  return message.SerializeAsString();
}

Expected<BenchmarkTake> read_description(const std::string& bytes, const model::HandModel& hand) {
  messages::BenchmarkTake message;
  if (!message.ParseFromString(bytes) || message.seen_size_size() != 3 ||
      message.covariance_size() != 16)
    return fail("describes no take");
  auto grasps = decode_robot_grasps(message.grasps(), hand);
  if (!grasps) return tl::unexpected(grasps.error());
  const auto X_WO =
      proto::pose_from_numbers({message.object_pose().begin(), message.object_pose().end()});
  const auto X_OS =
      proto::pose_from_numbers({message.seen_pose().begin(), message.seen_pose().end()});
  const auto shape = model::shape_from_string(message.seen_shape());
  if (grasps->size() != 1 || !X_WO || !X_OS || !shape) return fail("describes no take");
  BenchmarkTake take{
      static_cast<int>(message.number()), std::move(grasps->front()), {}, message.real()};
  RecordedTake& recorded = take.recorded;
  recorded.user = message.user();
  recorded.X_WO = *X_WO;
  recorded.closed = from_ns(message.closed_ns());
  recorded.seen_shape = {*shape, Eigen::Vector3d::Map(message.seen_size().data())};
  recorded.X_OS = *X_OS;
  recorded.covariance = Eigen::Matrix4d::Map(message.covariance().data());
  if (!model::is_valid(recorded.seen_shape) || !recorded.covariance.allFinite())
    return fail("describes no take");
  return take;
}

}  // namespace

BenchmarkTake as_read(BenchmarkTake take) {
  for (Posture& posture : take.recorded.postures) posture = as_read(posture);
  return take;
}

Expected<void> save_take(const std::filesystem::path& file, const model::HandModel& hand,
                         const BenchmarkTake& take) {
  auto writer = mcap::Writer::create(file, {.profile = "prehend"});
  if (!writer) return tl::unexpected(writer.error());
  if (auto done = write_topics(*writer, take); !done) return done;
  const std::string sealed = proto::seal(kind, describe(hand, take));
  const mcap::Attachment attachment{.name = attachment_name,
                                    .media_type = "application/octet-stream",
                                    .data = mcap::view(sealed)};
  if (auto done = writer->write(attachment); !done) return done;
  return writer->close();
}

Expected<std::vector<Posture>> read_postures(const std::filesystem::path& file) {
  auto reader = mcap::Reader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  std::vector<Posture> postures;
  mcap::MessageCursor cursor = reader->messages({.wanted = [](const mcap::Channel& channel) {
    return channel.topic == dds::hand_posture.name;
  }});
  while (true) {
    const auto read = cursor.next();
    if (!read) return fail(read.error().what, file.string());
    if (!*read) break;
    dds::RawSample sample;
    sample.payload.assign((*read)->message.data.begin(), (*read)->message.data.end());
    v1::HandPosture message;
    if (!dds::decode(dds::hand_posture, sample, message)) continue;
    if (auto posture = posture_from_message(message)) postures.push_back(std::move(*posture));
  }
  if (postures.empty()) return fail("has no usable hand/posture", file.string());
  const Duration first = postures.front().stamp.time_since_epoch();
  for (Posture& posture : postures) {
    posture.stamp -= first;
    posture.origin -= first;
  }
  return postures;
}

Expected<BenchmarkTake> load_take(const std::filesystem::path& file, const model::HandModel& hand) {
  const auto broken = [&](const Error& error) {
    return fail(error.what, file.string(), "write it again: prehend benchmark --export");
  };
  auto reader = mcap::Reader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  const auto& attachments = reader->contents().attachments;
  const auto index = std::ranges::find_if(
      attachments, [](const auto& one) { return one.name == attachment_name; });
  if (index == attachments.end()) return broken({"is a recording, but no take", {}, {}});
  mcap::Bytes buffer;
  const auto attachment = reader->attachment(*index, buffer);
  if (!attachment) return broken(attachment.error());
  const auto bytes = proto::unseal(mcap::text(attachment->data), kind);
  if (!bytes) return broken(bytes.error());
  auto take = read_description(*bytes, hand);
  if (!take) return broken(take.error());
  auto postures = read_postures(file);
  if (!postures) return broken(postures.error());
  take->recorded.postures = std::move(*postures);
  return take;
}

Expected<std::vector<BenchmarkTake>> load_takes(const std::filesystem::path& folder,
                                                const model::HandModel& hand) {
  std::error_code error;
  std::vector<BenchmarkTake> takes;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".mcap") continue;
    auto take = load_take(entry.path(), hand);
    if (!take) return tl::unexpected(take.error());
    takes.push_back(std::move(*take));
  }
  if (error) return fail(error.message(), folder.string(), "is the path right?");
  if (takes.empty())
    return fail("holds no takes", folder.string(), "prehend benchmark --export writes some");
  std::ranges::sort(takes, {}, &BenchmarkTake::number);
  const auto twin = std::ranges::adjacent_find(takes, {}, &BenchmarkTake::number);
  if (twin != takes.end())
    return fail(fmt::format("holds take {} twice", twin->number), folder.string());
  return takes;
}

}  // namespace prehend::mapping
