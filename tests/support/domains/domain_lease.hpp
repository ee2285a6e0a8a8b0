#pragma once

#include <filesystem>

namespace prehend::test {

/// A DDS domain that no other test on this machine has for as long as this object lives, with the
/// 250 ports of the domain from 7400 + 250 times its number on (DDSI-RTPS 2.3, 9.6.1.1). When the
/// process ends, however it ends, the kernel takes it back. Domain 0 stays the users'; beyond 100
/// lie ports from 32768 on, which the system gives to anybody.
class DomainLease {
 public:
  /// Waits while all are taken.
  DomainLease() : DomainLease("/run/lock/prehend-domains", 100) {}
  /// The domains 1 to `last`, each of them once among all who lease from the same file.
  DomainLease(const std::filesystem::path& file, int last);
  ~DomainLease();
  DomainLease(const DomainLease&) = delete;
  DomainLease& operator=(const DomainLease&) = delete;

  int domain() const { return domain_; }
  /// One of twenty ports, UDP and TCP, for servers that must be told theirs: of the domain, and
  /// those of its last participants, which no test has so many of.
  int port(int number = 0) const { return 7400 + 250 * domain_ + 180 + number; }
  /// From now on it passes to the program that this process becomes, and to all that it starts.
  void keep_over_exec() const;

 private:
  int file_;
  int domain_;
};

}  // namespace prehend::test
