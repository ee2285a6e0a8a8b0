#pragma once

#include "common/dds/fastdds.hpp"

#if PREHEND_FAST_DDS == 2
#include <fastrtps/xmlparser/XMLProfileManager.h>
#else
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#endif

namespace prehend::test {

/// Whether participants of this process hand samples over by pointers to each other's readers, as
/// is the default, or use the network like those of others. For participants to come. Fast DDS
/// 2.9.1 ends the process (StatefulWriter::intraprocess_gap on a reader that is gone) when one of
/// its participants leaves while another ends a reader.
inline void deliver_within_process(bool may) {
#if PREHEND_FAST_DDS == 2
  namespace library = eprosima::fastrtps;
  library::LibrarySettingsAttributes settings;
#else
  namespace library = eprosima::fastdds;
  library::LibrarySettings settings;
#endif
  settings.intraprocess_delivery = may ? library::INTRAPROCESS_FULL : library::INTRAPROCESS_OFF;
#if PREHEND_FAST_DDS == 2
  library::xmlparser::XMLProfileManager::library_settings(settings);
#else
  library::dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
#endif
}

}  // namespace prehend::test
