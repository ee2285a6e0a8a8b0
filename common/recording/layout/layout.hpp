#pragma once

#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/dds/raw.hpp"
#include "common/recording/mcap/record.hpp"

/// How DDS lies in an MCAP file. A channel carries one kind of change of one instance by one
/// writer, so that a message needs nothing beside what MCAP gives it:
///
///   log_time      reception, publish_time  the writer's source time stamp
///   sequence      the writer's number, its low 32 bits
///   data          the payload with its encapsulation header, as it was on the wire
///
/// The channel's metadata names DDS type, writer, instance, keyedness, rig (partition) and QoS.
/// Several channels thus have one topic. Ends of instances have channels without data whose topic
/// and encoding viewers pass by; their metadata says of which topic they are.
namespace prehend::recording {

/// What all messages of a channel have in common.
struct Stream {
  dds::RawTopic topic;
  dds::Guid writer{}, instance{};
  std::string rig;
  dds::RawSample::Kind kind = dds::RawSample::Kind::data;
};

/// The channel for a stream; ids of channel and schema are the caller's.
recording::mcap::Channel to_channel(const Stream& stream);

/// The stream of a channel. Channels that others wrote have no such metadata: they get the QoS of
/// topic_table where it knows the topic, else reliable without keys, and `schema`, its name, as
/// type. Fails on metadata that cannot be and on messages that are not CDR.
Expected<Stream> to_stream(const recording::mcap::Channel& channel, std::string_view schema);

/// «reliable transient_local keep_last=1 deadline_ms=100 lifespan_ms=200 exclusive»
std::string to_text(const dds::TopicQos& qos);
/// What the text does not say is as in `otherwise`. «shared» undoes «exclusive», and a deadline or
/// lifespan of 0 an other one.
Expected<dds::TopicQos> qos_of(std::string_view text,
                               const dds::TopicQos& otherwise = {.writer_depth = 0});

std::string to_hex(const dds::Guid& guid);

/// Message encodings.
inline constexpr std::string_view cdr_encoding = "cdr";
inline constexpr std::string_view end_encoding = "end";

/// Names of metadata records and attachments.
inline constexpr std::string_view losses_record = "losses";  // topic: samples lost, at the end
inline constexpr std::string_view idl_record = "idl";        // type: one self-contained text
inline constexpr std::string_view configuration_record = "configuration";  // lab.toml, key: value
inline constexpr std::string_view scene_attachment = "scene.toml";
inline constexpr std::string_view catalogue_attachment = "catalogue.toml";

}  // namespace prehend::recording
