#pragma once

#include "common/dds/release/fastdds.hpp"

#if PREHEND_FAST_DDS == 2
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif

namespace prehend::dds {

/// Has the participants of this process find each other over the network like those of others, and
/// hand over by pointers to each other's readers nothing but samples. Fast DDS 2.9.1 ends the
/// process (StatefulWriter::intraprocess_delivery and _gap on a reader that is gone) when one of
/// them leaves while another still finds it; a recorder has two. Samples over the network as well
/// would lock a writer up whose instances end (StatefulWriter::check_acked_status does not come
/// back; test_lockstep, 1 run in 3). Fast DDS 3 needs none of this. To be called before the first
/// one joins.
inline void find_over_the_network_within_process() {
#if PREHEND_FAST_DDS == 2
  namespace library = eprosima::fastrtps;
  library::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = library::INTRAPROCESS_USER_DATA_ONLY;
  library::xmlparser::XMLProfileManager::library_settings(settings);
#endif
}

}  // namespace prehend::dds
