#pragma once

/// Fast DDS, as far as its releases differ: 2.9 of Debian 12 and 3.1 of Debian 13. What is written
/// alike for both but called otherwise has one name here; nobody else asks for the release, but for
/// the few places that say why.
#if __has_include(<fastrtps/utils/md5.h>)
#define PREHEND_FAST_DDS 2
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/SocketTransportDescriptor.h>
#include <fastdds/rtps/transport/TCPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/config.h>
#include <fastrtps/types/TypesBase.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/utils/md5.h>
#define PREHEND_FAST_DDS_RELEASE FASTRTPS_VERSION_STR
#else
#define PREHEND_FAST_DDS 3
#include <fastdds/config.hpp>
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/rtps/common/Guid.hpp>
#include <fastdds/rtps/common/InstanceHandle.hpp>
#include <fastdds/rtps/common/Locator.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/SocketTransportDescriptor.hpp>
#include <fastdds/rtps/transport/TCPv4TransportDescriptor.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#include <fastdds/utils/md5.hpp>
#define PREHEND_FAST_DDS_RELEASE FASTDDS_VERSION_STR
#endif

#include <cstdint>
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>

namespace prehend::dds {

namespace fdds = eprosima::fastdds::dds;
namespace transport = eprosima::fastdds::rtps;

#if PREHEND_FAST_DDS == 2

namespace rtps = eprosima::fastrtps::rtps;
using DdsDuration = eprosima::fastrtps::Duration_t;
using DdsTime = eprosima::fastrtps::Time_t;
using DiscoveryProtocol = rtps::DiscoveryProtocol_t;
using Md5 = ::MD5;
using PayloadArgument = rtps::SerializedPayload_t*;  // of TopicDataType::deserialize
inline constexpr const char* profiles_variable = "FASTRTPS_DEFAULT_PROFILES_FILE";
inline constexpr const char* profiles_file = "DEFAULT_FASTRTPS_PROFILES.xml";
inline const DdsDuration endless = eprosima::fastrtps::c_TimeInfinite;

/// Of a secured peer the listener is told before the handshake, with its identity token.
inline constexpr bool hides_secured_peers = false;

inline bool succeeded(bool written) {
  return written;
}
inline bool succeeded(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}

inline std::string name_of(fdds::TopicDataType&& type) {
  return type.getName();
}
inline bool has_key(const fdds::TopicDataType& type) {
  return type.m_isGetKeyDefined;
}
inline std::uint32_t serialized_size(fdds::TopicDataType& type, const void* message) {
  return type.getSerializedSizeProvider(const_cast<void*>(message))();
}
inline bool serialize(fdds::TopicDataType& type, const void* message,
                      rtps::SerializedPayload_t& payload) {
  return type.serialize(const_cast<void*>(message), &payload);
}
inline bool deserialize(fdds::TopicDataType& type, rtps::SerializedPayload_t& payload,
                        void* message) {
  return type.deserialize(&payload, message);
}
/// Fast CDR 1 knows no other.
inline bool is_first_representation(const rtps::SerializedPayload_t*) {
  return true;
}
/// Fast CDR 1 throws where a message ends too early.
inline bool is_whole(fdds::TopicDataType&, const rtps::SerializedPayload_t&, const void*) {
  return true;
}
inline bool find_key(fdds::TopicDataType& type, const void* message,
                     rtps::InstanceHandle_t& handle) {
  return type.getKey(const_cast<void*>(message), &handle, false);
}

/// Types are not described to others: the contract is.
inline void describe_nothing(fdds::TopicDataType& type) {
  type.auto_fill_type_object(false);
  type.auto_fill_type_information(false);
}
inline DdsDuration& heartbeat_period(auto& times) {
  return times.heartbeatPeriod;
}

#else

namespace rtps = eprosima::fastdds::rtps;
using DdsDuration = fdds::Duration_t;
using DdsTime = fdds::Time_t;
using DiscoveryProtocol = rtps::DiscoveryProtocol;
using Md5 = eprosima::fastdds::MD5;
using PayloadArgument = rtps::SerializedPayload_t&;  // of TopicDataType::deserialize
inline constexpr const char* profiles_variable = "FASTDDS_DEFAULT_PROFILES_FILE";
inline constexpr const char* profiles_file = "DEFAULT_FASTDDS_PROFILES.xml";
inline const DdsDuration endless = fdds::c_TimeInfinite;

/// Of a secured peer the listener is told only when it has been let in, without its identity token.
inline constexpr bool hides_secured_peers = true;

/// Only this tells whether a call has succeeded: write() returned true then, now it returns 0.
inline bool succeeded(bool) = delete;
inline bool succeeded(fdds::ReturnCode_t code) {
  return code == fdds::RETCODE_OK;
}

// Our structs are final: on the wire the first representation is what 2.9 writes.
inline constexpr auto representation = fdds::XCDR_DATA_REPRESENTATION;
inline std::string name_of(fdds::TopicDataType&& type) {
  return type.get_name();
}
inline bool has_key(const fdds::TopicDataType& type) {
  return type.is_compute_key_provided;
}
inline std::uint32_t serialized_size(fdds::TopicDataType& type, const void* message) {
  return type.calculate_serialized_size(message, representation);
}
inline bool serialize(fdds::TopicDataType& type, const void* message,
                      rtps::SerializedPayload_t& payload) {
  return type.serialize(message, payload, representation);
}
inline bool deserialize(fdds::TopicDataType& type, rtps::SerializedPayload_t& payload,
                        void* message) {
  return type.deserialize(payload, message);
}
/// Nobody of ours writes the second one. Fast CDR 2 makes room for as many elements as a sequence
/// of it says to have, before it looks whether they are there: a damaged length takes all memory.
inline bool is_first_representation(const rtps::SerializedPayload_t& payload) {
  constexpr rtps::octet first_of_xcdr2 = 6;  // encapsulations that are numbered so or higher
  return payload.length >= 2 && payload.data[0] == 0 && payload.data[1] < first_of_xcdr2;
}
/// Whether a payload brought all of a message that was read from it. Where it ends between two
/// members, Fast CDR 2 leaves those that are missing as they were, and is content. Its calculated
/// sizes are bounds, so the message is written again.
inline bool is_whole(fdds::TopicDataType& type, const rtps::SerializedPayload_t& payload,
                     const void* message) {
  rtps::SerializedPayload_t again(type.calculate_serialized_size(message, representation));
  return type.serialize(message, again, representation) && again.length <= payload.length;
}
inline bool find_key(fdds::TopicDataType& type, const void* message,
                     rtps::InstanceHandle_t& handle) {
  return type.compute_key(message, handle, false);
}

/// Types are not described to others: the contract is. Their code is generated without.
inline void describe_nothing(fdds::TopicDataType&) {}
inline DdsDuration& heartbeat_period(auto& times) {
  return times.heartbeat_period;
}

#endif

}  // namespace prehend::dds
