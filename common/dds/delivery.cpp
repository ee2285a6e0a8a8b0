#include "common/dds/delivery.hpp"

#include <mutex>

#include "common/dds/fastdds.hpp"

#if PREHEND_FAST_DDS == 2
#include <fastrtps/xmlparser/XMLProfileManager.h>
#else
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#endif

namespace prehend::dds {

namespace {

void deliver_by_network() {
#if PREHEND_FAST_DDS == 2
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
#else
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
#endif
}

}  // namespace

void deliver_by_network_only() {
  static std::once_flag once;
  std::call_once(once, deliver_by_network);
}

}  // namespace prehend::dds
