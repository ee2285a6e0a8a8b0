// A DDS program of another make of mind: Fast DDS with its defaults, so with shared memory. Waits
// to be killed.
//   shared_memory_peer DOMAIN
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  using namespace eprosima::fastdds::dds;
  if (!DomainParticipantFactory::get_instance()->create_participant(std::atoi(argv[1]),
                                                                    PARTICIPANT_QOS_DEFAULT))
    return 3;
  std::puts("ready");
  std::fflush(stdout);
  ::pause();
}
