#include "tests/support/domains/domain_lease.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

namespace prehend::test {
namespace {

[[noreturn]] void give_up(const std::filesystem::path& file) {
  throw std::system_error(errno, std::generic_category(), file.string());
}

/// The file, which all users may lock. In a folder that is everybody's the kernel lets nobody
/// create what another user has made, so it is opened first.
int open_shared(const std::filesystem::path& file) {
  while (true) {
    int opened = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    if (opened >= 0) return opened;
    if (errno != ENOENT) give_up(file);
    opened = ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (opened >= 0) {
      ::fchmod(opened, 0666);  // whatever the umask says
      return opened;
    }
    if (errno != EEXIST) give_up(file);  // somebody else was faster
  }
}

/// Locks the byte whose number is the domain. The lock belongs to this opening of the file, not to
/// the process: two leases of one process differ as well.
bool take(int opened, int domain, const std::filesystem::path& file) {
  struct flock one {};
  one.l_type = F_WRLCK;
  one.l_whence = SEEK_SET;
  one.l_start = domain;
  one.l_len = 1;
  if (::fcntl(opened, F_OFD_SETLK, &one) == 0) return true;
  if (errno != EAGAIN && errno != EACCES && errno != EINTR) give_up(file);
  return false;
}

/// The kernel can wait for one byte, but not for any of them.
constexpr std::chrono::milliseconds look_again{20};

}  // namespace

DomainLease::DomainLease(const std::filesystem::path& file, int last) : file_(open_shared(file)) {
  // Begins elsewhere in each process: the domain of a test that has just ended rests for a while.
  for (int next = ::getpid();; ++next) {
    domain_ = 1 + next % last;
    if (take(file_, domain_, file)) return;
    if ((next + 1 - ::getpid()) % last == 0) std::this_thread::sleep_for(look_again);
  }
}

DomainLease::~DomainLease() {
  ::close(file_);
}

void DomainLease::keep_over_exec() const {
  ::fcntl(file_, F_SETFD, 0);
}

}  // namespace prehend::test
