#pragma once

namespace prehend::dds {

/// Participants of this process speak with each other as with those of others. Otherwise Fast DDS
/// hands samples over by pointers to each other's readers, and in 2.9.1 the process ends with a
/// segmentation fault when one participant leaves while another ends a reader. To be called before
/// the first participant.
void deliver_by_network_only();

}  // namespace prehend::dds
